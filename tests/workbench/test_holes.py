"""Holes bridged for the map and cut out again, and slivers merged: from the options to the files."""
import json
import math
import sys
import types

import numpy
import pytest

import trimquad
from trimquad import cli
from trimquad.features import make

ALL = ["seamless", "tmesh", "gridmap", "quads", "nurbs", "report"]


def sheet(size=40, holes=((0.3, 0.35, 0.06), (0.7, 0.6, 0.13))):
    """A wavy sheet of 60 x 60 with round holes (x, y, radius of a sheet of 1 x 1), as points and triangles."""
    points = [
        (60 * i / size, 60 * j / size, 4 * math.sin(4 * i / size) * math.cos(3 * j / size))
        for j in range(size + 1)
        for i in range(size + 1)
    ]
    triangles = []
    for j in range(size):
        for i in range(size):
            if any(math.hypot((i + 0.5) / size - x, (j + 0.5) / size - y) < r for x, y, r in holes):
                continue
            a = i + (size + 1) * j
            b, c, d = a + 1, a + size + 2, a + size + 1
            triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return without_unused(points, triangles)


def pierced_sphere(size=12, holes=(((1, 1, 1), 0.35), ((0, 0, 1), 0.3))):
    """A cube blown up to the unit sphere, with round holes (axis, radius)."""
    axes = [(numpy.array(axis) / numpy.linalg.norm(axis), radius) for axis, radius in holes]
    numbers, points, triangles = {}, [], []

    def vertex(place):
        if place not in numbers:
            numbers[place] = len(points)
            p = 2 * numpy.array(place) / size - 1
            points.append(p / numpy.linalg.norm(p))
        return numbers[place]

    for axis in range(3):
        for side in (0, size):
            for i in range(size):
                for j in range(size):
                    places = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        place = [0, 0, 0]
                        place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = side, i + di, j + dj
                        places.append(tuple(place))
                    middle = sum(numpy.array(p) for p in places) / 4 * 2 / size - 1
                    middle /= numpy.linalg.norm(middle)
                    if any(numpy.linalg.norm(middle - a) < r for a, r in axes):
                        continue
                    a, b, c, d = map(vertex, places if side else places[::-1])
                    triangles += [(a, b, c), (a, c, d)]
    return without_unused(points, triangles)


def without_unused(points, triangles):
    used = sorted({v for t in triangles for v in t})
    number = {v: k for k, v in enumerate(used)}
    return numpy.array([points[v] for v in used]), numpy.array([[number[v] for v in t] for t in triangles])


def directed_sides(polygons):
    sides = [(a, b) for p in polygons for a, b in zip(p, p[1:] + p[:1])]
    assert len(set(sides)) == len(sides), "two polygons have a side in the same direction"
    return set(sides)


def euler(item):
    polygons = item.polygons
    faces = polygons.full + polygons.trimmed
    directed_sides(faces)
    assert {v for p in faces for v in p} == set(range(len(polygons.points)))
    return len(polygons.points) - len(polygons.edges()) + len(faces)


def map_of(text):
    """Points, triangles and their images of a map's OBJ file."""
    points, images, triangles = [], [], []
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["vt"]:
            images.append([float(w) for w in words[1:3]])
        elif words[:1] == ["f"]:
            triangles.append([[int(n) - 1 for n in w.split("/")] for w in words[1:4]])
    triangles = numpy.array(triangles)
    return numpy.array(points), triangles[:, :, 0], numpy.array(images)[triangles[:, :, 1]]


def places(points, triangles):
    """The triangles as corners in space, in an order that does not depend on numbers."""
    return sorted(tuple(sorted(map(tuple, numpy.round(points[t], 9).tolist()))) for t in triangles)


@pytest.mark.parametrize("route", ["direct", "reembed"])
def test_bridged_holes_are_cut_out_of_every_result(tmp_path, route):
    points, triangles = sheet()
    result = trimquad.convert(
        (points, triangles), trimquad.Options(edge_length=6.0, fill_holes=100.0, route=route, write=ALL)
    )
    assert result.failed == [] and result.warnings == []
    result.write(str(tmp_path))
    report = json.loads((tmp_path / "report.json").read_text())["regions"][0]
    assert report["holes"] == {"bridged": 2, "aligned": 0, "ends": 0, "singularities": 0}
    assert report["mesh"]["boundary_loops"] == 3 and report["mesh"]["euler"] == -1
    assert report["singularities"]["loop_turns"] == [4], "the field does not know the holes"
    item = result.regions[0]
    assert euler(item) == item.quads.euler == -1
    assert len(item.directions) == item.region.triangles == len(triangles)

    area = area_of(points, triangles)
    for name in ("seamless.obj", "gridmap.obj"):
        p, t, uv = map_of((tmp_path / name).read_text())
        assert area_of(p, t) == pytest.approx(area, rel=1e-9), f"{name} has what bridges the holes"
        turns = numpy.cross(uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0])
        assert (turns > 0).all()
        if name == "seamless.obj" or route == "direct":
            assert places(p, t) == places(points, triangles)
    shape = result.shape
    assert shape.isValid() and len(shape.Faces) == 1
    assert len(shape.Faces[0].Wires) == 3, "the holes are inner trims"
    assert shape.Area == pytest.approx(area, rel=2e-2)


def area_of(points, triangles):
    corners = points[triangles]
    return 0.5 * numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


def test_only_holes_shorter_than_asked_for_are_bridged():
    for length, bridged, turns in ((0.0, None, [4, -4, -4]), (40.0, 1, [4, -4]), (100.0, 2, [4])):
        options = trimquad.Options(edge_length=6.0, fill_holes=length, write=["seamless", "report"])
        report = trimquad.convert(sheet(), options).report["regions"][0]
        assert (report["holes"] and report["holes"]["bridged"]) == bridged
        assert report["singularities"]["loop_turns"] == turns


def test_a_hole_inside_one_cell_is_an_inner_loop_of_it():
    # Without bridges a boundary between grid lines is no different: the hole lies inside a cell of 12.
    mesh = sheet(holes=((0.5, 0.5, 0.06),))
    result = trimquad.convert(mesh, trimquad.Options(edge_length=20.0, fill_holes=40.0, write=["quads", "report"]))
    assert result.regions[0].holes["bridged"] == 1
    assert euler(result.regions[0]) == 0


@pytest.mark.parametrize("route", ["direct", "reembed"])
def test_a_surface_that_bridges_close_has_irregular_vertices_in_its_holes_too(tmp_path, route):
    points, triangles = pierced_sphere()
    options = trimquad.Options(quads=200, fill_holes=4.0, features="ignore", route=route, write=ALL)
    result = trimquad.convert((points, triangles), options)
    assert result.failed == []
    item = result.regions[0]
    report = result.report["regions"][0]
    assert report["singularities"]["loop_turns"] == []
    # A closed sphere has eight corners; the hole around one of the cube's holds one or more of them.
    assert report["holes"]["singularities"] >= 1
    assert report["singularities"]["count"] + report["holes"]["singularities"] == 8
    assert report["quads"]["irregular_vertices"] == report["singularities"]["count"]
    assert all(s.vertex < len(points) for s in item.singularities)
    assert euler(item) == 0
    assert result.shape.isValid()
    # Surfaces end with their charts; where one went on over the next, OpenCASCADE's check of both did not end.
    assert item.refits == 0


def test_aligned_holes_and_ends_of_tubes_stay_and_a_warning_says_so():
    options = trimquad.Options(edge_length=6.0, boundary="aligned", fill_holes=100.0, write=["seamless"])
    result = trimquad.convert(sheet(), options)
    assert result.regions[0].holes == {"bridged": 0, "aligned": 2, "ends": 0}
    assert result.warnings == ["--fill-holes 100 bridges no hole: of the shorter boundary loops 2 are aligned "
                               "(--free sets them free)"]
    options.free = ["loop:1", "loop:2"]
    result = trimquad.convert(sheet(), options)
    assert result.regions[0].holes["bridged"] == 2 and result.warnings == []

    tube = [(math.cos(math.pi * a / 8), math.sin(math.pi * a / 8), z / 2) for z in range(9) for a in range(16)]
    triangles = []
    for z in range(8):
        for a in range(16):
            p, q = 16 * z + a, 16 * z + (a + 1) % 16
            triangles += [(p, q, q + 16), (p, q + 16, p + 16)]
    result = trimquad.convert((tube, triangles), trimquad.Options(quads=100, fill_holes=50.0, write=["seamless"]))
    assert result.regions[0].holes == {"bridged": 0, "aligned": 0, "ends": 2}
    assert "2 are ends of surfaces" in result.warnings[0]


@pytest.mark.parametrize("route", ["direct", "reembed"])
def test_a_drilled_plate_stays_a_solid(route):
    import FreeCAD
    import Part

    plate = Part.makeBox(60, 40, 5)
    for x, y, radius in ((15, 12, 4), (40, 25, 6)):
        plate = plate.cut(Part.makeCylinder(radius, 9, FreeCAD.Vector(x, y, -2)))
    result = trimquad.convert(plate, trimquad.Options(edge_length=4.0, fill_holes=50.0, route=route))
    assert result.failed == []
    holes = [item.holes for item in result.regions]
    assert sum(h["bridged"] for h in holes) == 4, "two holes in each of two faces"
    assert sum(h["ends"] for h in holes) == 4, "the walls of the holes are tubes"
    assert result.shape.isValid() and result.shape.ShapeType == "Solid"
    assert result.spline.loose_edges == 0
    assert result.shape.Volume == pytest.approx(plate.Volume, rel=1e-3)


def test_directions_from_a_file_go_with_bridges(tmp_path):
    points, triangles = sheet()
    path = tmp_path / "turned.txt"
    path.write_text("1 1 0\n" * len(triangles))
    options = trimquad.Options(edge_length=6.0, fill_holes=100.0, field=str(path), write=["seamless", "report"])
    item = trimquad.convert((points, triangles), options).regions[0]
    assert len(item.directions) == len(triangles)
    angles = numpy.degrees(numpy.arctan2(item.directions[:, 1], item.directions[:, 0])) % 90
    assert numpy.median(numpy.abs(angles - 45)) < 5


@pytest.mark.parametrize("text", ["-1", "nan", "inf", "wide"])
@pytest.mark.parametrize("option", ["--fill-holes", "--merge-slivers"])
def test_an_unusable_value_is_one_line_and_status_2(tmp_path, capsys, option, text):
    arguments = ["convert", "none.obj", "--out", str(tmp_path / "out"), option, text]
    assert cli.main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and option in said


def test_slivers_merge_with_their_neighbours_and_the_rest_stays():
    points, triangles = sheet()
    plain = trimquad.convert((points, triangles), trimquad.Options(edge_length=6.0, write=["quads"]))
    merged = trimquad.convert((points, triangles), trimquad.Options(edge_length=6.0, merge_slivers=0.25, write=["quads"]))
    before, after = plain.regions[0], merged.regions[0]
    counts = after.quads.statistics
    assert before.quads.statistics["merged_slivers"] == 0 and counts["merged_slivers"] > 5
    assert euler(after) == euler(before) == -1
    assert len(after.polygons.points) == len(before.polygons.points)
    assert {tuple(q) for q in after.polygons.full} <= {tuple(q) for q in before.polygons.full}
    assert counts["quads"] + counts["trimmed"] + counts["merged_slivers"] == (
        before.quads.statistics["quads"] + before.quads.statistics["trimmed"]
    )
    assert counts["irregular_vertices"] == before.quads.statistics["irregular_vertices"]
    assert merged.report["regions"][0]["quads"]["merged_slivers"] == counts["merged_slivers"]
    assert smallest_area(after) > 5 * smallest_area(before)


def smallest_area(item):
    points = item.polygons.points

    def area(polygon):
        corners = points[polygon]
        return 0.5 * numpy.linalg.norm(numpy.cross(corners, numpy.roll(corners, -1, axis=0)).sum(axis=0))

    return min(map(area, item.polygons.trimmed))


def test_a_document_object_takes_both_options(document):
    import Mesh

    points, triangles = sheet()
    source = document.addObject("Mesh::Feature", "Pierced")
    source.Mesh = Mesh.Mesh([[tuple(points[v]) for v in t] for t in triangles])
    shell = make(document, source, EdgeLength=6, FillHoles=100, MergeSlivers=0.2)
    assert shell.isValid()
    assert len(shell.Shape.Faces[0].Wires) == 3
    trimmed = document.QuadMesh.TrimmedCells
    shell.MergeSlivers = 0.0
    document.recompute()
    assert document.QuadMesh.TrimmedCells > trimmed


class _FitsNoHoles:
    """The compiled module, but where only a region with fewer boundary loops than `loops` can be fitted."""

    def __init__(self, native, loops):
        self._native, self._loops = native, loops
        self.bridged = 0

    def __getattr__(self, name):
        return getattr(self._native, name)

    def bridge_holes(self, *arguments):
        bridged, counts = self._native.bridge_holes(*arguments)
        self.bridged = max(self.bridged, counts["bridged"])
        return bridged, counts

    def fit_surface(self, region, *rest):
        if region.boundary_loops - self.bridged >= self._loops:
            raise trimquad.Error("stage", "fit", "the tolerance cannot be met", region.name)
        return self._native.fit_surface(region, *rest)


def converted_where_holes_do_not_fit(monkeypatch, loops):
    module = sys.modules["trimquad.regions"]
    native = _FitsNoHoles(module.load(), loops)
    monkeypatch.setattr(module, "load", lambda: native)
    return trimquad.convert(sheet(), trimquad.Options(edge_length=4.0))


def test_where_nothing_fits_surfaces_go_on_behind_small_holes_and_the_quads_stay(monkeypatch):
    # Round holes of 23 and of 49 around, the second wider than is bridged.
    result = converted_where_holes_do_not_fit(monkeypatch, 3)
    (region,) = result.regions
    assert region.error is None and region.fitted_from is not region
    assert region.holes is None and region.fitted_from.holes["bridged"] == 1
    assert any("go on behind 1 small holes" in line for line in result.warnings)
    assert result.report["regions"][0]["nurbs"]["bridged_holes"] == 1
    assert result.report["regions"][0]["features"]["creases"] is True
    assert len(result.shape.Faces) == 1 and len(result.shape.Faces[0].Wires) == 3
    result.shape.check(True)
    points, _, _ = region.map
    assert len(points) == region.region.vertices, "the map of the quads is that of the region itself"


def test_several_surfaces_go_on_behind_small_holes_as_lines_between_them_would_end_there():
    result = trimquad.convert(pierced_sphere(), trimquad.Options(quads=100, features="ignore"))
    (region,) = result.regions
    assert region.error is None and region.fitted_from.holes["bridged"] == 2
    assert region.holes is None and region.region.boundary_loops == 2
    assert len(result.shape.Faces) > 1
    result.shape.check(True)
    points, _, _ = region.map
    assert len(points) == region.region.vertices, "the map of the quads is that of the region itself"


@pytest.mark.parametrize("folds, control_points, taken", [(0, 400, True), (0, 401, False), (1, 10, False)])
def test_folds_give_way_to_surfaces_without_that_need_no_more_control_points(monkeypatch, folds, control_points, taken):
    def fitted(folds, control_points):
        return types.SimpleNamespace(folded=[(0.0, 0.0, 0.0)] * folds, control_points=control_points, samples=1000,
                                     max_deviation=0.0, several=False)

    fits = [fitted(1, 400), fitted(folds, control_points)]
    monkeypatch.setattr(sys.modules["trimquad.regions"], "fit", lambda *_: fits.pop(0))
    monkeypatch.setattr(sys.modules["trimquad.convert"], "trim", lambda *_: None)
    (region,) = trimquad.convert(sheet(), trimquad.Options(edge_length=4.0)).regions
    assert fits == [] and region.error is None
    assert (region.fitted_from is not region) == taken
    assert region.fitted.control_points == (control_points if taken else 400)
    assert region.fitted_from.map is not None and region.polygons is not None


def test_where_nothing_fits_at_all_the_region_is_left_as_it_was(monkeypatch):
    result = converted_where_holes_do_not_fit(monkeypatch, 0)
    (region,) = result.regions
    assert region.error.stage == "fit" and region.fitted is None and region.fitted_from is region
    assert result.shape is None and region.polygons is not None
    assert result.model.regions[0].boundary_loops == 3


class _TrimsOnlyBehindHoles:
    """The compiled module, but where no surface is trimmed whose map does not go on behind a hole."""

    def __init__(self, native):
        self._native, self.own, self.failures = native, None, 0

    def __getattr__(self, name):
        return getattr(self._native, name)

    def trim_model(self, model, grids, fitted, *rest):
        self.own = self.own or grids[0]
        if grids[0] is self.own:
            self.failures += 1
            raise trimquad.Error("stage", "fit", "trims cross", f"{model.regions[0].name}, Edge1")
        return self._native.trim_model(model, grids, fitted, *rest)


def test_where_trims_fail_surfaces_go_on_behind_small_holes_before_anything_else_is_tried(monkeypatch):
    module = sys.modules["trimquad.joining"]
    native = _TrimsOnlyBehindHoles(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    result = trimquad.convert(sheet(), trimquad.Options(edge_length=4.0))
    (region,) = result.regions
    assert native.failures == 1 and region.error is None
    assert region.fitted_from.holes["bridged"] == 1 and region.refits == 0
    assert len(result.shape.Faces) == 1 and len(result.shape.Faces[0].Wires) == 3
    result.shape.check(True)
    points, _, _ = region.map
    assert len(points) == region.region.vertices, "the map of the quads is that of the region itself"


def test_a_hole_is_bridged_once_for_each_map(monkeypatch):
    module = sys.modules["trimquad.regions"]
    native = _FitsNoHoles(module.load(), 3)
    lengths = []

    def bridge_holes(model, index, length, progress):
        lengths.append(length)
        return _FitsNoHoles.bridge_holes(native, model, index, length, progress)

    native.bridge_holes = bridge_holes
    monkeypatch.setattr(module, "load", lambda: native)
    trimquad.convert(sheet(), trimquad.Options(edge_length=4.0))
    assert lengths == [module.SMALL_HOLE * 4.0]
