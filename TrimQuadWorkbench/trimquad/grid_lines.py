"""The grid of a map on the surface: where its coordinates are whole numbers."""
import numpy


def grid_lines(points, triangles, uv, step=1.0):
    """The lines on which a coordinate of the map is a multiple of `step` quads.

    points, triangles, uv: of a SurfaceMap. Returns segments (k, 2, 3), each inside one triangle. A line along an edge
    counts in the triangles on both sides.
    """
    corners = points[triangles]
    found = [_lines_of(corners, uv[:, :, axis] / step) for axis in (0, 1)]
    return numpy.concatenate(found) if found else numpy.zeros((0, 2, 3))


def _lines_of(corners, height):
    low, high = numpy.ceil(height.min(axis=1)), numpy.floor(height.max(axis=1))
    counts = numpy.maximum(0, high - low + 1).astype(int)
    owner = numpy.repeat(numpy.arange(len(corners)), counts)
    first = numpy.repeat(numpy.cumsum(counts) - counts, counts)
    level = low[owner] + (numpy.arange(len(owner)) - first)
    corners, above = corners[owner], height[owner] - level[:, None]
    ends = numpy.zeros((len(owner), 2, 3))
    met = numpy.zeros(len(owner), dtype=int)
    # A corner on the line is taken where it begins a side, so that it is met once.
    for k in range(3):
        a, b = above[:, k], above[:, (k + 1) % 3]
        crossed = (a == 0) | (a * b < 0)
        t = numpy.where(a == b, 0.0, a / numpy.where(a == b, 1.0, a - b))
        place = corners[:, k] + t[:, None] * (corners[:, (k + 1) % 3] - corners[:, k])
        use = numpy.flatnonzero(crossed & (met < 2))
        ends[use, met[use]] = place[use]
        met[use] += 1
    return ends[met == 2]
