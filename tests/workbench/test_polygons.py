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


def test_elements_are_the_quads_convex_trimmed_quads_and_triangles():
    polygons = Polygons.from_obj(TEXT + "v 3 0 0\nv 3 1 0\nf 5 8 9 7\n")
    elements = polygons.elements()
    assert sorted(map(len, elements)) == [3, 3, 3, 4, 4]
    assert sum(area(polygons.points, [(e[0], e[k], e[k + 1])]) for e in elements for k in range(1, len(e) - 1)) == (
        pytest.approx(area(polygons.points, polygons.triangles()))
    )


def test_a_fem_mesh_has_all_points_and_elements():
    pytest.importorskip("FreeCAD")
    pytest.importorskip("Fem")
    from trimquad.fem_mesh import fem_mesh

    polygons = Polygons.from_obj(TEXT)
    mesh = fem_mesh([polygons, polygons])
    assert mesh.NodeCount == 2 * len(polygons.points)
    assert (mesh.QuadrangleCount, mesh.TriangleCount) == (2, 6)
