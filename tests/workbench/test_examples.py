"""The four examples from STEP to STEP: the main promise."""
import json
import re

import numpy
import pytest
from conftest import EXAMPLES

ONE_FACE = ("hood", "tube", "sheet")
INPUT_EULER = {"hood": [-1], "tube": [0], "sheet": [1], "box_with_fillets": [0, 0, 0, 0]}


def read(path):
    import FreeCAD  # noqa: F401
    import Part

    shape = Part.Shape()
    shape.read(str(path))
    return shape


def measures(shape):
    """Area, volume (about the origin) and centre of the surface, from fine triangles: OpenCASCADE's own integrals over
    trimmed B-splines are off by a percent, its bounding boxes reach to the poles."""
    points, triangles = shape.tessellate(0.02)
    corners = numpy.array([tuple(p) for p in points])[numpy.array(triangles)]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    areas = numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1) / 2
    volume = numpy.einsum("ij,ij->", a, numpy.cross(b, c)) / 6
    return areas.sum(), volume, (areas[:, None] * corners.mean(axis=1)).sum(axis=0) / areas.sum()


def euler(text):
    """Of the polygons in an OBJ, from the vertices that they use."""
    polygons = [[int(w) for w in line.split()[1:]] for line in text.splitlines() if line.startswith("f ")]
    edges = {frozenset(e) for p in polygons for e in zip(p, p[1:] + p[:1])}
    return len({v for p in polygons for v in p}) - len(edges) + len(polygons)


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_region_goes_through(converted, name):
    result, _ = converted(name)
    assert [str(r.error) for r in result.failed] == []


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_model_is_valid_in_freecad_after_step_and_after_brep(converted, name):
    _, out = converted(name)
    for suffix in ("step", "brep"):
        shape = read(out / f"nurbs.{suffix}")
        assert shape.isValid()
        # Raises where OpenCASCADE's Boolean operations would find a fault.
        shape.check(True)


@pytest.mark.parametrize("name", EXAMPLES)
def test_area_and_centre_are_those_of_the_input(converted, example_path, name):
    given, made = read(example_path(name)), read(converted(name)[1] / "nurbs.step")
    (area, _, centre), (made_area, _, made_centre) = measures(given), measures(made)
    assert made_area == pytest.approx(area, rel=2e-3)
    assert numpy.linalg.norm(made_centre - centre) < 2e-3 * given.BoundBox.DiagonalLength


@pytest.mark.parametrize("name", ONE_FACE)
def test_an_open_surface_becomes_one_trimmed_face(converted, name):
    _, out = converted(name)
    shape = read(out / "nurbs.step")
    assert len(shape.Faces) == 1
    assert shape.Faces[0].Surface.TypeId == "Part::GeomBSplineSurface"


def test_a_solid_stays_a_solid_of_the_same_volume(converted, example_path):
    given, made = read(example_path("box_with_fillets")), read(converted("box_with_fillets")[1] / "nurbs.step")
    assert len(made.Solids) == 1
    assert len(made.Faces) == 4
    assert made.Solids[0].isClosed()
    assert measures(made)[1] == pytest.approx(measures(given)[1], rel=2e-3)


def test_the_hood_keeps_its_two_cut_outs(converted):
    shape = read(converted("hood")[1] / "nurbs.step")
    assert len(shape.Faces[0].Wires) == 3


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_deviation_in_the_report_is_under_the_tolerance(converted, name):
    result, _ = converted(name)
    for region in result.report["regions"]:
        assert 0 <= region["nurbs"]["max_deviation"] <= region["nurbs"]["tolerance"]
        assert region["nurbs"]["max_gap"] <= 1e-6


@pytest.mark.parametrize("name", EXAMPLES)
def test_quads_have_the_euler_characteristic_of_the_input_and_only_quads_inside(converted, name):
    result, out = converted(name)
    files = sorted(out.glob("quads*.obj"))
    assert len(files) == len(result.regions)
    found = []
    for path in files:
        text = path.read_text()
        found.append(euler(text))
        full = re.split(r"^g ", text, flags=re.M)
        quads = next(part for part in full if part.startswith("quads"))
        assert all(len(line.split()) == 5 for line in quads.splitlines() if line.startswith("f "))
    assert found == [r.region.euler for r in result.regions]
    assert sorted(found) == INPUT_EULER[name]


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_number_of_quads_is_about_what_was_asked_for(converted, name):
    result, _ = converted(name)
    cells = sum(r.quads.statistics["quads"] + 0.5 * r.quads.statistics["trimmed"] for r in result.regions)
    assert 0.6 * 400 < cells < 1.6 * 400


@pytest.mark.parametrize("name", EXAMPLES)
def test_maps_give_every_triangle_a_positive_area(converted, name):
    _, out = converted(name)
    for path in [*out.glob("gridmap*.obj"), *out.glob("seamless*.obj")]:
        images = map_of_obj(path.read_text())[2]
        a, b = images[:, 1] - images[:, 0], images[:, 2] - images[:, 0]
        assert numpy.all(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0)


def map_of_obj(text):
    """Points, triangles and corner images of a gridmap.obj or seamless.obj."""
    lines = [line.split() for line in text.splitlines()]
    points = numpy.array([[float(w) for w in line[1:]] for line in lines if line[0] == "v"])
    images = numpy.array([[float(w) for w in line[1:]] for line in lines if line[0] == "vt"])
    pairs = numpy.array([[[int(n) - 1 for n in w.split("/")] for w in line[1:]] for line in lines if line[0] == "f"])
    return points, pairs[:, :, 0], images[pairs[:, :, 1]]


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_result_gives_its_field_and_its_map(converted, name):
    result, out = converted(name)
    for index, item in enumerate(result.regions):
        path = out / ("gridmap.obj" if len(result.regions) == 1 else f"gridmap-{index}.obj")
        points, triangles, uv = map_of_obj(path.read_text())
        assert numpy.array_equal(points, item.map.points)
        # Triangles may begin at another corner.
        assert numpy.array_equal(numpy.sort(triangles), numpy.sort(item.map.triangles))
        assert numpy.allclose(uv.mean(axis=1), item.map.uv.mean(axis=1))
        corners = item.region.points[item.region.corners]
        normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= numpy.linalg.norm(normals, axis=1)[:, None]
        assert item.directions.shape == (item.region.triangles, 3)
        assert numpy.allclose(numpy.linalg.norm(item.directions, axis=1), 1)
        assert numpy.abs((item.directions * normals).sum(axis=1)).max() < 1e-9
        assert sum(s.index for s in item.singularities) == sum(k * n for k, n in item.field.singularities.items())


REGION_KEYS = {"name", "status", "error", "cut_from", "mesh", "features", "holes", "singularities", "seamless", "tmesh", "quantization",
               "embedding", "gridmap", "quads", "histograms", "nurbs", "seconds"}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_report_has_its_keys(converted, name):
    report = json.loads((converted(name)[1] / "report.json").read_text())
    assert {"input", "options", "regions", "cuts", "seconds_total", "peak_memory_mb", "version"} <= set(report)
    assert {"path", "kind", "faces", "edges"} <= set(report["input"])
    assert report["options"]["quads"] == 400 and report["options"]["edge_length"] > 0
    for region in report["regions"]:
        assert set(region) == REGION_KEYS
        assert region["status"] == "ok" and region["error"] is None
        assert {"triangles", "vertices", "boundary_loops", "euler"} == set(region["mesh"])
        assert {"flipped_before", "flipped", "iterations"} <= set(region["seamless"])
        assert {"flipped", "distortion_start", "distortion_end", "iterations"} <= set(region["gridmap"])
        assert {"quads", "trimmed", "merged_slivers", "dropped_slivers", "irregular_vertices", "angle_deviation",
                "edge_length"} == set(region["quads"])
        assert sum(region["histograms"]["edge_length"]["counts"]) > 0
        assert {"faces", "control_points", "degree", "max_deviation", "rms_deviation", "max_deviation_at", "face_deviations",
                "folds", "bridged_holes", "without_singularities", "max_gap", "tolerance"} == set(region["nurbs"])
        assert set(region["seconds"]) == {"tessellate", "field", "seamless", "partition", "quantize", "reembed",
                                          "optimize", "extract", "fit", "write"}


@pytest.mark.parametrize("edge_length", [5.0, 3.0, 1.5])
def test_free_quads_of_the_roof_keep_their_shape_at_every_edge_length(example_path, edge_length):
    """The paper's Fig. 12: of a strongly curved boundary, aligned quads are bent and squeezed."""
    import trimquad

    free, aligned = (trimquad.convert(example_path("roof/station"), trimquad.Options(
        edge_length=edge_length, boundary=boundary, write=["quads"])).regions[0].quads.statistics
        for boundary in ("free", "aligned"))
    assert free["irregular_vertices"] == 0 < aligned["irregular_vertices"]
    assert free["angle_deviation"]["mean"] < aligned["angle_deviation"]["mean"] / 3
    assert free["edge_length"]["std"] < aligned["edge_length"]["std"] / 5
    assert free["edge_length"]["mean"] == pytest.approx(edge_length, rel=0.02)
