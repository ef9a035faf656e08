#!/usr/bin/env python3
"""Writes bumps.json: reptile skin for the head of LeePerrySmith.glb.

    python3 make_bumps.py path/to/LeePerrySmith.glb > bumps.json

Scatters points evenly over the head, packs them by a few rounds of Lloyd's relaxation (closer
together around the eyes and the mouth), gives each a round bump as large as its neighbours allow,
and hands each bump to the view that it faces most. No bump is cut at a view's border, so
neighbouring views need no cross-fade. A bump that no view sees whole is left out.
"""
import json
import math
import random
import struct
import sys

SPACING = 0.19         # between bumps, object units
OVERLAP = 1.25         # of bumps that would just touch: the flat rims overlap, no skin stays bare
LARGEST = 0.7 * SPACING
FINE = [((0.62, 1.75, 1.9), 0.5), ((-0.62, 1.75, 1.9), 0.5), ((0.0, 0.45, 2.2), 0.45),
        ((0.0, 1.1, 2.5), 0.45), ((1.65, 1.4, 0.0), 0.5), ((-1.65, 1.4, 0.0), 0.5)]
NECK = (-1.6, -0.6)    # the bumps shrink to nothing from the second height down to the first
SAMPLES, ROUNDS, DEPTH_PIXELS = 80000, 12, 384


def add(a, b): return (a[0] + b[0], a[1] + b[1], a[2] + b[2])
def sub(a, b): return (a[0] - b[0], a[1] - b[1], a[2] - b[2])
def mul(a, s): return (a[0] * s, a[1] * s, a[2] * s)
def dot(a, b): return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a): return mul(a, 1.0 / (math.sqrt(dot(a, a)) or 1.0))


def read_glb(path):
    """Positions, normals and triangles of the file's first primitive."""
    data = open(path, "rb").read()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20:20 + length]), 28 + length
    part = gltf["meshes"][0]["primitives"][0]

    def values(index, letter, width):
        accessor = gltf["accessors"][index]
        view = gltf["bufferViews"][accessor["bufferView"]]
        start = binary + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        flat = struct.unpack_from(f"<{accessor['count'] * width}{letter}", data, start)
        return [flat[i:i + width] for i in range(0, len(flat), width)]

    indices = part["indices"]
    letter = {5121: "B", 5123: "H", 5125: "I"}[gltf["accessors"][indices]["componentType"]]
    flat = [i[0] for i in values(indices, letter, 1)]
    return (values(part["attributes"]["POSITION"], "f", 3),
            values(part["attributes"]["NORMAL"], "f", 3), list(zip(*[iter(flat)] * 3)))


def scatter(positions, normals, triangles, generator):
    """Points (position, normal) spread evenly over the area above the neck's lower end."""
    kept = [t for t in triangles if max(positions[i][1] for i in t) > NECK[0]]
    total, ends = 0.0, []
    for a, b, c in kept:
        n = cross(sub(positions[b], positions[a]), sub(positions[c], positions[a]))
        total += math.sqrt(dot(n, n))
        ends.append(total)
    points, k = [], 0
    for s in range(SAMPLES):
        while ends[k] < (s + 0.5) / SAMPLES * total:
            k += 1
        u, v = generator.random(), generator.random()
        if u + v > 1:
            u, v = 1 - u, 1 - v
        at = [add(add(mul(x[kept[k][0]], 1 - u - v), mul(x[kept[k][1]], u)), mul(x[kept[k][2]], v))
              for x in (positions, normals)]
        points.append((at[0], unit(at[1])))
    return points


def spacing(p):
    """Wanted distance between bumps: smaller near the eyes, the mouth, the nose and the ears."""
    scale = 1.0
    for center, reach in FINE:
        d = math.dist(p, center)
        scale = min(scale, 0.5 + 0.5 * min(1.0, max(0.0, d - 0.5 * reach) / reach))
    return SPACING * scale


class Grid:
    """Points in cells, for searching neighbours."""

    def __init__(self, cell):
        self.cell, self.cells = cell, {}

    def key(self, p): return tuple(math.floor(x / self.cell) for x in p)

    def add(self, p, value): self.cells.setdefault(self.key(p), []).append((p, value))

    def near(self, p):
        x, y, z = self.key(p)
        for i in (x - 1, x, x + 1):
            for j in (y - 1, y, y + 1):
                for k in (z - 1, z, z + 1):
                    yield from self.cells.get((i, j, k), ())


def pack(points, generator):
    """Darts that keep their distance, then relaxed; each with the normal of its nearest sample."""
    order = points[:]
    generator.shuffle(order)
    grid, chosen = Grid(SPACING), []
    for p, n in order:
        wanted = 0.8 * spacing(p)
        if all(math.dist(p, q) >= wanted or dot(n, m) < 0 for q, m in grid.near(p)):
            grid.add(p, n)
            chosen.append((p, n))
    for _ in range(ROUNDS):
        grid = Grid(SPACING)
        for i, (p, n) in enumerate(chosen):
            grid.add(p, i)
        sums = [[0.0, (0, 0, 0)] for _ in chosen]
        members = [[] for _ in chosen]
        for p, n in points:
            best = min(((math.dist(p, q), i) for q, i in grid.near(p) if dot(n, chosen[i][1]) > 0),
                       default=None)
            if best:
                weight = spacing(p) ** -4
                sums[best[1]][0] += weight
                sums[best[1]][1] = add(sums[best[1]][1], mul(p, weight))
                members[best[1]].append((p, n))
        chosen = [min(m, key=lambda s: math.dist(s[0], mul(total, 1 / weight)))
                  for m, (weight, total) in zip(members, sums) if m]
    return chosen


def radii(chosen):
    """Half the distance to the nearest neighbour, more where others leave room; then OVERLAP."""
    grid = Grid(1.5 * SPACING)
    for i, (p, _) in enumerate(chosen):
        grid.add(p, i)
    around = [sorted((math.dist(p, q), j) for q, j in grid.near(p) if j != i)[:8]
              for i, (p, _) in enumerate(chosen)]
    out = [0.5 * a[0][0] if a else 0.3 * SPACING for a in around]
    for _ in range(4):
        for i, a in enumerate(around):
            room = min((d - out[j] for d, j in a), default=out[i])
            out[i] = min(max(out[i], room), 0.62 * spacing(chosen[i][0]))
    return [min(OVERLAP * r, LARGEST) for r in out]


class View:
    """An orthographic view of the whole model around the origin, with its depth buffer."""

    def __init__(self, direction, positions, triangles):
        self.direction = unit(direction)
        hint = (0, 0, -1) if abs(self.direction[1]) > 0.99 else (0, 1, 0)
        self.up_hint = hint
        self.right = unit(cross(hint, self.direction))
        self.up = cross(self.direction, self.right)
        seen = [self.to_chart(p) for p in positions]
        self.half = 1.02 * max(max(abs(x), abs(y)) for x, y, _ in seen)
        self.depth = [[-1e9] * DEPTH_PIXELS for _ in range(DEPTH_PIXELS)]
        for triangle in triangles:
            self.draw([seen[i] for i in triangle])

    def to_chart(self, p): return (dot(p, self.right), dot(p, self.up), dot(p, self.direction))

    def pixel(self, x): return (x / self.half + 1) * 0.5 * DEPTH_PIXELS - 0.5

    def draw(self, corners):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = [
            (self.pixel(x), self.pixel(y), z) for x, y, z in corners]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area <= 0:
            return
        for y in range(math.ceil(min(ay, by, cy)), math.floor(max(ay, by, cy)) + 1):
            row = self.depth[y]
            for x in range(math.ceil(min(ax, bx, cx)), math.floor(max(ax, bx, cx)) + 1):
                u = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
                v = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
                if u >= -1e-6 and v >= -1e-6 and u + v <= 1 + 1e-6:
                    row[x] = max(row[x], az + u * (bz - az) + v * (cz - az))

    def sees(self, p, radius):
        """Is the surface within the bump's disc the one that the point lies on?"""
        x, y, z = self.to_chart(p)
        reach = self.pixel(x + radius) - self.pixel(x)
        cx, cy = self.pixel(x), self.pixel(y)
        for j in range(math.floor(cy - reach), math.ceil(cy + reach) + 1):
            for i in range(math.floor(cx - reach), math.ceil(cx + reach) + 1):
                inside = math.hypot(i - cx, j - cy) <= reach
                if inside and abs(self.depth[j][i] - z) > 0.04 + 1.3 * radius:
                    return False
        return True


def main():
    positions, normals, triangles = read_glb(sys.argv[1])
    generator = random.Random(1)
    points = scatter(positions, normals, triangles, generator)
    chosen = pack(points, generator)
    sizes = radii(chosen)
    directions = [(x, y, z) for y in (0, 1, -1) for z in (1, 0, -1) for x in (0, 1, -1)
                  if (x, y, z) not in ((0, 0, 0), (0, -1, 0))]
    views = [View(d, positions, triangles) for d in directions]
    strokes = [[] for _ in views]
    for (p, n), size in zip(chosen, sizes):
        fade = min(1.0, (p[1] - NECK[0]) / (NECK[1] - NECK[0]))
        ranked = sorted(range(len(views)), key=lambda i: -dot(n, views[i].direction))[:3]
        seen = next((i for i in ranked if views[i].sees(p, size) and
                     dot(n, views[i].direction) > 0.78), None)
        if seen is not None and fade > 0.15:
            x, y, _ = views[seen].to_chart(p)
            pressure = round(fade * size / LARGEST, 3)
            strokes[seen].append([[round(x, 3), round(y, 3), pressure]])
    width = 2 * LARGEST
    print('{\n  "version": 1,\n  "comment": "Reptile skin: bumps applied from many views, '
          'written by make_bumps.py.",\n  "edits": [')
    parts = []
    for view, bumps in zip(views, strokes):
        if bumps:
            spec = {"direction": [round(x, 6) for x in view.direction], "up": list(view.up_hint),
                    "center": [0, 0, 0], "width": round(2 * view.half, 3)}
            options = {"profile": "bump", "width": round(width, 4), "height": round(0.26 * width, 4)}
            rows = [", ".join(map(json.dumps, bumps[i:i + 5])) for i in range(0, len(bumps), 5)]
            parts.append('    {\n      "operator": "pen",\n      "view": ' + json.dumps(spec) +
                         ',\n      "effective": {"full": 70, "zero": 80},\n      "options": ' +
                         json.dumps(options) + ',\n      "strokes": [\n        ' +
                         ",\n        ".join(rows) + "\n      ]\n    }")
    print(",\n".join(parts) + "\n  ]\n}")
    print(f"{len(chosen)} bumps, {sum(map(len, strokes))} of them seen whole", file=sys.stderr)


if __name__ == "__main__":
    main()
