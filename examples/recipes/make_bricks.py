#!/usr/bin/env python3
"""Makes bricks.png, the normal map of a wall that tiles (8 bits, green up).

    examples/recipes/make_bricks.py > bricks.png
"""

import math
import random
import struct
import sys
import zlib

SIZE = 256  # pixels, both ways
COURSES = 4
BRICK = SIZE // 2  # pixels, with its joint
COURSE = SIZE // COURSES
JOINT = 7.0  # pixels
BEVEL = 8.0
HEIGHT = 5.0
TILT = 0.04  # largest slope of a brick's face


def rise(distance):
    """From 0 in the joint to 1 on the brick, over the bevel."""
    t = min(max((distance - 0.5 * JOINT) / BEVEL, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def brick_height(x, y, tilts):
    course = int(y // COURSE) % COURSES
    shifted = x + (BRICK // 2 if course % 2 else 0)
    column = int(shifted // BRICK) % 2
    u = shifted % BRICK - 0.5 * BRICK
    v = y % COURSE - 0.5 * COURSE
    edge = rise(0.5 * BRICK - abs(u)) * rise(0.5 * COURSE - abs(v))
    across, along = tilts[course][column]
    return edge * (HEIGHT + across * u + along * v)


def heights():
    seeded = random.Random(1)
    tilts = [[(seeded.uniform(-TILT, TILT), seeded.uniform(-TILT, TILT)) for _ in range(2)]
             for _ in range(COURSES)]
    return [[brick_height(x + 0.5, y + 0.5, tilts) for x in range(SIZE)] for y in range(SIZE)]


def code(component):
    return round(127.5 * component + 127.5)


def pixels(height):
    """The rows of a PNG file: a filter byte, then red, green and blue of each pixel."""
    for y in range(SIZE):
        row = bytearray([0])
        for x in range(SIZE):
            slope_x = 0.5 * (height[y][(x + 1) % SIZE] - height[y][x - 1])
            slope_y = 0.5 * (height[y - 1][x] - height[(y + 1) % SIZE][x])
            length = math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
            row += bytes([code(-slope_x / length), code(-slope_y / length), code(1.0 / length)])
        yield bytes(row)


def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def main():
    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0)
    out = sys.stdout.buffer
    out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
    out.write(chunk(b"IDAT", zlib.compress(b"".join(pixels(heights())), 9)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    main()
