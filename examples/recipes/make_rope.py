#!/usr/bin/env python3
"""Makes rope.png, the normal map of one turn of a twisted cord, which repeats sideways (8 bits, green up).

    examples/recipes/make_rope.py > rope.png
"""

import math
import struct
import sys
import zlib

from make_bricks import chunk, code

WIDTH, HEIGHT = 128, 128  # pixels; the cord lies along x and fills the height
TWIST = 0.3  # turns of the strands from one side of the cord to the other
GROOVE = 0.3  # depth between strands, in parts of the cord's height
EDGE = 0.97  # where the cord meets the ground, in parts of its half width


def height(x, y):
    across = 1.0 - 2.0 * y / HEIGHT
    if abs(across) >= EDGE:
        return 0.0
    round_height = math.sqrt(1.0 - (across / EDGE) ** 2)
    turn = x / WIDTH + TWIST * across
    strand = abs(math.sin(math.pi * turn)) ** 0.7
    return 0.35 * HEIGHT * round_height * (1.0 - GROOVE + GROOVE * strand)


def rows():
    """The rows of a PNG file: a filter byte, then red, green and blue of each pixel."""
    for j in range(HEIGHT):
        row = bytearray([0])
        for i in range(WIDTH):
            slope_x = height(i + 1.0, j + 0.5) - height(i, j + 0.5)
            slope_y = height(i + 0.5, j) - height(i + 0.5, j + 1.0)
            length = math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
            row += bytes([code(-slope_x / length), code(-slope_y / length), code(1.0 / length)])
        yield bytes(row)


def main():
    out = sys.stdout.buffer
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
    out.write(chunk(b"IDAT", zlib.compress(b"".join(rows()), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    main()
