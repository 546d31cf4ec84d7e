"""Aligned edges, feature points and fields from files: from the options to the regions that the stages work on."""
import json
import math
import os
import sys

import numpy
import pytest

import trimquad
from conftest import ROOT
from trimquad.native import load

QUADS_ONLY = ["gridmap", "quads", "report"]


def regions(thing, **options):
    """The regions that a conversion starts from, without the stages after."""
    module = sys.modules["trimquad.convert"]  # the package has the function under this name
    from trimquad.source import Source

    source = Source(thing)
    read = source.read()
    build = module._cad_model if source.kind == "cad" else module._mesh_model
    result = build(source, read, trimquad.Options(**options), load().Progress())
    return result


def aligned_length(result):
    total = 0.0
    for item in result.regions:
        ends = item.region.points[item.region.aligned]
        total += numpy.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    return total


@pytest.fixture
def box():
    import FreeCAD  # noqa: F401
    import Part

    return Part.makeBox(10, 20, 30)


@pytest.fixture
def roof():
    """Two flat wings of 8 x 8 squares that meet at a ridge of 90 degrees, as points and triangles."""
    return folded(lambda x: -abs(x - 8))


def folded(height, size=16):
    points = [(x, y, height(x)) for x in range(size + 1) for y in range(size + 1)]
    triangles = []
    for x in range(size):
        for y in range(size):
            a = x * (size + 1) + y
            b = a + size + 1
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    return points, triangles


def test_a_boxs_edges_are_trimmed_or_aligned(box):
    assert len(regions(box).regions) == 6
    result = regions(box, features="align")
    assert len(result.regions) == 1
    assert aligned_length(result) == pytest.approx(240)
    assert result.regions[0].region.features["junctions"] == 8
    assert result.model.curves == []


def test_names_choose_edges_as_freecad_counts_them(box):
    lengths = [edge.Length for edge in box.Edges]
    for number in (1, 5, 12):
        result = regions(box, features="ignore", align=[f"Edge{number}"])
        assert aligned_length(result) == pytest.approx(lengths[number - 1])
    result = regions(box, boundary="aligned", free=["Edge1", "Edge2"])
    assert aligned_length(result) == pytest.approx(480 - 2 * (lengths[0] + lengths[1]))
    assert [c["name"] for c in result.model.curves if not c["aligned"]] == ["Edge1", "Edge2"]


def test_a_selection_keeps_the_names_of_the_whole(box):
    from trimquad.source import Source

    face = box.Faces[5]
    number = next(i for i, e in enumerate(box.Edges, 1) if any(e.isSame(f) for f in face.Edges))
    result = trimquad.convert(Source(box, ["Face6"]), trimquad.Options(
        quads=50, align=[f"Edge{number}"], write=QUADS_ONLY))
    assert aligned_length(result) == pytest.approx(box.Edges[number - 1].Length)
    other = next(i for i, e in enumerate(box.Edges, 1) if not any(e.isSame(f) for f in face.Edges))
    with pytest.raises(trimquad.Error, match=f"Edge{other} is not part of the faces that are converted"):
        trimquad.convert(Source(box, ["Face6"]), trimquad.Options(quads=50, align=[f"Edge{other}"]))


def test_vertices_and_points_become_vertices(box):
    wanted = [tuple(box.Vertexes[2].Point), (3.3, 4.4, 30), (10, 7.7, 0)]
    result = regions(box, features="align", feature_points=["Vertex3", "3.3,4.4,30", (10, 7.7, 0)])
    region = result.regions[0].region
    found = region.points[region.feature_points]
    assert len(found) == 3
    for point in wanted:
        assert numpy.linalg.norm(found - point, axis=1).min() < 1e-9


def test_a_meshs_ridge_is_aligned_by_default(roof):
    result = regions(roof, quads=60)
    assert len(result.regions) == 1
    assert aligned_length(result) == pytest.approx(16)
    assert result.regions[0].region.features["curves"] == 1
    assert len(regions(roof, quads=60, features="trim").regions) == 2
    assert aligned_length(regions(roof, quads=60, features="ignore")) == 0


def test_a_meshs_boundary_is_chosen_by_loop_piece_or_angle(roof):
    whole = 32 + 4 * 8 * math.sqrt(2)
    assert aligned_length(regions(roof, quads=60, features="ignore", align=["loop:0"])) == pytest.approx(whole)
    result = regions(roof, quads=60, features="ignore", boundary="aligned", free=["loop:0/0"])
    assert 0 < aligned_length(result) < whole
    assert [c["name"] for c in result.model.curves if not c["aligned"]] == ["loop:0/0"]
    chosen = regions(roof, quads=60, features="ignore", align=["angle:80-100"])
    assert aligned_length(chosen) == pytest.approx(16)
    with pytest.raises(trimquad.Error, match="no boundary or border called loop:9; it has loop:0/0"):
        regions(roof, align=["loop:9"])


def test_the_report_tells_curves_constraints_and_repairs(roof, tmp_path):
    points, triangles = roof
    # A triangle with a repeated corner, and one twice.
    broken = (points, triangles + [triangles[5], (3, 3, 4)])
    options = trimquad.Options(quads=60, features="ignore", write=QUADS_ONLY)
    trimquad.convert(broken, options).write(str(tmp_path))
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["input"]["repairs"] == {"duplicate_triangles": 1, "repeated_corners": 1}
    assert report["warnings"] == [
        "the mesh was repaired: 1 triangle with a repeated corner dropped, 1 duplicate triangle dropped"
    ]
    assert report["regions"][0]["features"]["aligned_edges"] == 0
    names = [curve["name"] for curve in report["curves"]]
    assert len(names) == len(set(names)) and all(name.startswith("loop:0/") for name in names)


def field_file(tmp_path, name, vectors, header=""):
    path = tmp_path / name
    path.write_text(header + "".join(" ".join(repr(float(x)) for x in v) + "\n" for v in vectors))
    return str(path)


def guidance(thing, path, **options):
    module = sys.modules["trimquad.convert"]  # the package has the function under this name
    from trimquad.source import Source

    result = regions(thing, field=path, **options)
    return result, module._read_field(result, Source(thing).read())


def test_a_file_of_directions_reaches_the_triangles(roof, tmp_path):
    points, triangles = roof
    count = len(triangles)
    for name, vectors, header in (
        ("own.txt", [(1, 1, 0)] * count, "# one per triangle\n"),
        ("vertices.txt", [(1, 1, 0)] * len(points), ""),
        ("other.rawfield", [(1, 1, 0, -1, 1, 0, -1, -1, 0, 1, -1, 0)] * count, f"4 {count}\n"),
        ("other.rosy", [(1, 1, 0)] * count, f"{count}\n4\n"),
        ("placed.txt", [(*p, 1, 1, 0) for p in points], ""),
    ):
        flat = (numpy.array(points) * (1, 1, 0), triangles)
        result, guide = guidance(flat, field_file(tmp_path, name, vectors, header), boundary="aligned", quads=60)
        region = result.regions[0].region
        found = guide(region)
        assert region.triangles > count  # some were split
        angles = numpy.arctan2(found.directions[:, 1], found.directions[:, 0])
        assert len(angles) == region.triangles
        assert numpy.allclose(numpy.cos(4 * angles), -1), name
        assert numpy.allclose(found.weights, 1)


@pytest.mark.parametrize(
    "text, said",
    [
        ("1 0 0\n", "the field has 1 elements, but the mesh has 512 faces and 289 vertices"),
        ("1 0\n", "line 1"),
        ("", "empty"),
    ],
)
def test_an_unusable_field_file_is_one_line(roof, tmp_path, text, said):
    (tmp_path / "bad.txt").write_text(text)
    with pytest.raises(trimquad.Error, match=said) as caught:
        trimquad.convert(roof, trimquad.Options(field=str(tmp_path / "bad.txt")))
    assert caught.value.kind == "input"


def test_a_field_that_is_not_there_and_one_for_a_cad_shape_are_refused(box, tmp_path):
    with pytest.raises(trimquad.Error, match="there is no file"):
        trimquad.convert(box, trimquad.Options(field=str(tmp_path / "none.txt")))
    path = field_file(tmp_path, "by_face.txt", [(1, 0, 0)] * 6)
    with pytest.raises(trimquad.Error, match="give a point before each direction"):
        trimquad.convert(box, trimquad.Options(field=path))


def test_around_a_wing_quads_that_follow_the_wing_alone_are_more_regular():
    path = os.path.join(ROOT, "examples", "flow", "wing.step")
    statistics = {}
    for name, options in (("wing", {"align": ["Edge2", "Edge3"]}), ("all", {"boundary": "aligned"})):
        result = trimquad.convert(path, trimquad.Options(quads=800, write=QUADS_ONLY, **options))
        assert not result.failed
        statistics[name] = result.regions[0].quads.statistics
    assert statistics["wing"]["irregular_vertices"] < statistics["all"]["irregular_vertices"]
    assert statistics["wing"]["angle_deviation"]["mean"] < 0.5 * statistics["all"]["angle_deviation"]["mean"]
