"""Small triangle meshes of every kind that a map must cope with, as (points, triangles)."""
import math

import numpy


def sheet(columns, rows, place, closed_columns=False, closed_rows=False):
    """A grid of squares, two triangles each, at place(i, j); around where closed."""
    wide, high = columns + (not closed_columns), rows + (not closed_rows)
    points = numpy.array([place(i, j) for i in range(wide) for j in range(high)], dtype=float)
    triangles = []
    for i in range(columns):
        for j in range(rows):
            a, b = i * high + j, (i + 1) % wide * high + j
            c, d = (i + 1) % wide * high + (j + 1) % high, i * high + (j + 1) % high
            triangles += [(a, b, c), (a, c, d)]
    return points, numpy.array(triangles)


def plate_with_holes(cells, holes):
    """A flat plate of cells x cells squares, where `holes(i, j)` says which are missing."""
    points, triangles = sheet(cells, cells, lambda i, j: (i, j, 0))
    keep = [not holes(t // 2 // cells, t // 2 % cells) for t in range(len(triangles))]
    return compact(points, triangles[keep])


def compact(points, triangles):
    used, numbers = numpy.unique(triangles, return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


def voxels(filled, fineness):
    """The surface of a set of unit cubes, each side cut into fineness x fineness squares; outward."""
    numbers, points, triangles = {}, [], []

    def number(place):
        if place not in numbers:
            numbers[place] = len(points)
            points.append(place)
        return numbers[place]

    for cell in sorted(filled):
        for axis in range(3):
            for side in (0, 1):
                neighbour = list(cell)
                neighbour[axis] += 2 * side - 1
                if tuple(neighbour) in filled:
                    continue
                for i in range(fineness):
                    for j in range(fineness):
                        corners = []
                        for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
                            place = [fineness * c for c in cell]
                            place[axis] += fineness * side
                            place[(axis + 1) % 3] += u
                            place[(axis + 2) % 3] += v
                            corners.append(number(tuple(place)))
                        a, b, c, d = corners if side else corners[::-1]
                        triangles += [(a, b, c), (a, c, d)]
    return numpy.array(points, dtype=float) / fineness, numpy.array(triangles)


def smoothed(mesh, steps=30):
    """Each vertex moved to the middle of its neighbours, `steps` times: sharp edges become round."""
    points, triangles = mesh
    sides = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    degree = numpy.bincount(sides[:, 0], minlength=len(points))[:, None]
    points = points.copy()
    for _ in range(steps):
        sums = numpy.zeros_like(points)
        numpy.add.at(sums, sides[:, 0], points[sides[:, 1]])
        points += 0.7 * (sums / degree - points)
    return points, triangles


def sphere(fineness=12):
    points, triangles = voxels({(0, 0, 0)}, fineness)
    points -= 0.5
    return points / numpy.linalg.norm(points, axis=1)[:, None], triangles


def torus(around=48, across=24, radius=3.0, thickness=1.0):
    def place(i, j):
        u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
        distance = radius + thickness * math.cos(v)
        return distance * math.cos(u), distance * math.sin(u), thickness * math.sin(v)

    return sheet(around, across, place, True, True)


def tube(around, along, axis, radius):
    """A tube along axis(t) with its direction and radius(t), t from 0 to 1."""

    def place(i, j):
        t = j / along
        centre, direction = (numpy.array(x, dtype=float) for x in axis(t))
        direction /= numpy.linalg.norm(direction)
        x = numpy.cross(direction, (0.0, 0.0, 1.0) if abs(direction[2]) < 0.9 else (1.0, 0.0, 0.0))
        x /= numpy.linalg.norm(x)
        angle = 2 * math.pi * i / around
        return centre + radius(t) * (math.cos(angle) * x + math.sin(angle) * numpy.cross(direction, x))

    return sheet(around, along, place, closed_columns=True)


def cone(around=48, along=20, height=2.0):
    """With its apex, open below."""
    points, triangles = sheet(
        around, along - 1,
        lambda i, j: (
            (j + 1) / along * math.cos(2 * math.pi * i / around),
            (j + 1) / along * math.sin(2 * math.pi * i / around),
            -height * (j + 1) / along,
        ),
        closed_columns=True,
    )
    top = [(len(points), (i + 1) % around * along, i * along) for i in range(around)]
    # The sheet's columns run downwards, so that it faces inwards as built.
    return numpy.concatenate([points, [(0.0, 0.0, 0.0)]]), numpy.concatenate([triangles[:, ::-1], numpy.array(top)[:, ::-1]])


def with_needles(mesh, count, seed):
    """Caps without height on edges and needles of next to no length at vertices, `count` of each."""
    random = numpy.random.default_rng(seed)
    points, triangles = [numpy.array(p) for p in mesh[0]], [tuple(int(v) for v in t) for t in mesh[1]]
    for _ in range(count):
        a, b, c = triangles[(k := int(random.integers(len(triangles))))]
        points.append(0.6 * points[a] + 0.4 * points[b])
        m = len(points) - 1
        triangles[k] = (a, m, c)
        triangles += [(m, b, c), (a, b, m)]
        a, b, c = triangles[(k := int(random.integers(len(triangles))))]
        points.append(points[a].copy())
        m = len(points) - 1
        triangles[k] = (m, b, c)
        triangles += [(a, b, m), (m, c, a)]
    return numpy.array(points), numpy.array(triangles)


def cut_open(points, triangles):
    """Without the triangles around one vertex: the handles stay."""
    return compact(points, triangles[~(triangles == 0).any(axis=1)])


def _block(*spans):
    return {(x, y, z) for x in range(spans[0]) for y in range(spans[1]) for z in range(spans[2])}


def _holes(i, j):
    return i % 6 in (2, 3) and j % 6 in (2, 3)


def _notches(i, j):
    return (i < 4 and j < 4) or (i > 15 and 6 < j < 12) or (8 < i < 11 and 8 < j < 11)


ARCH = _block(3, 1, 3) - {(1, 0, 0), (1, 0, 1)}
STAIRS = {(x, y, z) for x, y, z in _block(3, 2, 3) if z <= x}

# name: (mesh, options); all have a boundary and can do without irregular vertices.
OPEN = {
    "flat plate": (sheet(20, 12, lambda i, j: (i, j, 0)), {}),
    "hill": (sheet(24, 24, lambda i, j: (i, j, 5 * math.exp(-((i - 12) ** 2 + (j - 12) ** 2) / 30))), {}),
    "plate with 16 holes": (plate_with_holes(24, _holes), {}),
    "notched plate": (plate_with_holes(20, _notches), {}),
    "straight tube": (tube(32, 40, lambda t: ((0, 0, 8 * t), (0, 0, 1)), lambda t: 1), {}),
    "wavy tube": (tube(32, 60, lambda t: ((0, 0, 10 * t), (0, 0, 1)), lambda t: 1 + 0.3 * math.sin(9 * t)), {}),
    "bent tube": (
        tube(32, 60, lambda t: ((4 * math.cos(2 * t), 4 * math.sin(2 * t), 0), (-math.sin(2 * t), math.cos(2 * t), 0)),
             lambda t: 1), {}),
    "cut cone": (tube(40, 24, lambda t: ((0, 0, 3 * t), (0, 0, 1)), lambda t: 2 - 1.5 * t), {}),
    "cone": (cone(), {}),
    "plate with needles": (with_needles(sheet(20, 12, lambda i, j: (i, j, 0.1 * (i - 9) ** 2)), 12, 3), {}),
}

# Constraints, closed surfaces and handles: these need irregular vertices.
CLOSED = {
    "cube": (voxels({(0, 0, 0)}, 12), {}),
    "cube, free": (voxels({(0, 0, 0)}, 12), {"features": "ignore"}),
    "sphere": (sphere(), {}),
    "torus": (torus(), {}),
    "thin torus": (torus(96, 16, 3, 0.5), {}),
    "double torus": (smoothed(voxels(_block(5, 3, 1) - {(1, 1, 0), (3, 1, 0)}, 5)), {}),
    "block with two holes": (voxels(_block(5, 3, 1) - {(1, 1, 0), (3, 1, 0)}, 4), {}),
    "arch": (voxels(ARCH, 5), {}),
    "stairs": (voxels(STAIRS, 4), {}),
    "stairs, trimmed": (voxels(STAIRS, 4), {"features": "trim"}),
    "smooth arch": (smoothed(voxels(ARCH, 6)), {}),
    "sphere with needles": (with_needles(sphere(10), 8, 5), {}),
    "aligned plate": (sheet(20, 12, lambda i, j: (i, j, 0)), {"boundary": "aligned"}),
    "aligned plate with holes": (plate_with_holes(24, _holes), {"boundary": "aligned"}),
    "roof": (sheet(20, 12, lambda i, j: (i, j, -abs(i - 10))), {}),
    "open torus": (cut_open(*torus()), {}),
    "plate with a feature point": (sheet(20, 12, lambda i, j: (i, j, 0)), {"feature_points": [(7.3, 4.6, 0)]}),
}
