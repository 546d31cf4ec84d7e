"""Quad meshes as FreeCAD and pictures need them: points, polygons, and triangles of the polygons."""
import numpy


class Polygons:
    """points: array (n, 3); full, trimmed: lists of polygons, each a list of point numbers from 0, counter-clockwise."""

    def __init__(self, points, full, trimmed):
        self.points = points
        self.full = full
        self.trimmed = trimmed

    @classmethod
    def from_obj(cls, text):
        """Of a quads.obj."""
        points, groups, current = [], {"trimmed": [], "quads": []}, "quads"
        for line in text.splitlines():
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                points.append((float(words[1]), float(words[2]), float(words[3])))
            elif words[0] == "g":
                current = words[1]
            elif words[0] == "f":
                groups[current].append([int(w.split("/")[0]) - 1 for w in words[1:]])
        return cls(numpy.array(points).reshape(-1, 3), groups["quads"], groups["trimmed"])

    def edges(self):
        """The polygons' edges, each once, as pairs of point numbers in rising order."""
        pairs = set()
        for polygon in self.full + self.trimmed:
            for a, b in zip(polygon, polygon[1:] + polygon[:1]):
                pairs.add((min(a, b), max(a, b)))
        return sorted(pairs)

    def elements(self):
        """Triangles and convex quads that cover the polygons with their edges, as point numbers: for finite elements."""
        result = list(map(tuple, self.full))
        for polygon in self.trimmed:
            if len(polygon) == 4 and _is_convex(self.points[polygon]):
                result.append(tuple(polygon))
            else:
                result += _clip_ears(self.points, polygon)
        return result

    def triangles(self):
        """Triangles that cover the polygons, as point numbers."""
        result = []
        for a, b, c, d in self.full:
            result += [(a, b, c), (a, c, d)]
        for polygon in self.trimmed:
            result += _clip_ears(self.points, polygon)
        return result


def _is_convex(corners):
    sides = numpy.roll(corners, -1, axis=0) - corners
    turns = numpy.cross(numpy.roll(sides, 1, axis=0), sides)
    least = 1e-3 * (numpy.linalg.norm(sides, axis=1) * numpy.linalg.norm(numpy.roll(sides, 1, axis=0), axis=1))
    return bool((turns @ turns.sum(axis=0) > least * numpy.linalg.norm(turns.sum(axis=0))).all())


def _clip_ears(points, polygon):
    """Ear clipping in the polygon's mean plane; takes the least bad ear where the outline is not simple there."""
    if len(polygon) == 3:
        return [tuple(polygon)]
    corners = points[polygon]
    centred = corners - corners.mean(axis=0)
    normal = numpy.cross(centred, numpy.roll(centred, -1, axis=0)).sum(axis=0)
    axis = int(numpy.argmax(numpy.abs(normal)))
    flat = centred[:, [(axis + 1) % 3, (axis + 2) % 3]]
    if normal[axis] < 0:
        flat = flat[:, ::-1]
    flat = flat.tolist()
    left, triangles = list(range(len(polygon))), []
    while len(left) > 3:
        i = _best_ear(flat, left)
        a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
        triangles.append((polygon[a], polygon[b], polygon[c]))
        del left[i]
    triangles.append(tuple(polygon[i] for i in left))
    return triangles


def _best_ear(flat, left):
    def turn(a, b, c):
        (ax, ay), (bx, by), (cx, cy) = flat[a], flat[b], flat[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    best, best_score = 0, None
    for i, b in enumerate(left):
        a, c = left[i - 1], left[(i + 1) % len(left)]
        size = turn(a, b, c)
        blocked = any(
            turn(a, b, p) >= 0 and turn(b, c, p) >= 0 and turn(c, a, p) >= 0
            for p in left
            if flat[p] not in (flat[a], flat[b], flat[c])
        )
        edges = sum(
            (flat[q][0] - flat[p][0]) ** 2 + (flat[q][1] - flat[p][1]) ** 2 for p, q in ((a, b), (b, c), (c, a))
        )
        score = (size > 0 and not blocked, size > 0, size / edges if edges > 0 else 0.0)
        if best_score is None or score > best_score:
            best, best_score = i, score
    return best
