import numpy
import pytest

from trimquad.polygons import Polygons

TEXT = """# quads
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 2 0 0
v 1.2 0.2 0
v 2 1 0
g quads
f 1 2 3 4
g trimmed
f 2 5 6 7 3
"""


def area(points, triangles):
    a, b, c = (points[[t[i] for t in triangles]] for i in range(3))
    return numpy.cross(b - a, c - a)[:, 2].sum() / 2


def test_an_obj_gives_its_quads_and_its_trimmed_cells():
    polygons = Polygons.from_obj(TEXT)
    assert polygons.full == [[0, 1, 2, 3]]
    assert polygons.trimmed == [[1, 4, 5, 6, 2]]
    assert len(polygons.edges()) == 8


def test_a_concave_cell_is_covered_exactly_once_by_its_triangles():
    polygons = Polygons.from_obj(TEXT)
    triangles = polygons.triangles()
    assert len(triangles) == 5
    x = polygons.points[[1, 4, 5, 6, 2]]
    shoelace = 0.5 * sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(x, numpy.roll(x, -1, axis=0)))
    assert area(polygons.points, triangles) == pytest.approx(1 + shoelace)
    assert all(area(polygons.points, [t]) > 0 for t in triangles)
