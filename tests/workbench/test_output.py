"""What ends up in the output folder, and that it does not depend on chance."""
import json
import os
import sys
import time

import numpy
import pytest
from conftest import wavy_face

import trimquad
from trimquad import regions
from trimquad.error import Error
from trimquad.output import OutputFolder
from trimquad.source import Source


def contents(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.name != "report.json"}


def test_results_are_the_same_bytes_from_run_to_run_and_for_any_number_of_threads(example_path, tmp_path):
    folders = []
    for threads in (1, 2, 4, 1):
        options = trimquad.Options(quads=300, threads=threads)
        out = tmp_path / str(len(folders))
        trimquad.convert(example_path("box_with_fillets"), options).write(str(out))
        folders.append(contents(out))
    assert len(folders[0]) == 10
    assert all(folder == folders[0] for folder in folders[1:])


def test_one_region_has_no_number_in_its_file_names(sheet, tmp_path):
    options = trimquad.Options(quads=50, write=["seamless", "gridmap", "quads", "nurbs", "report"])
    names = trimquad.convert(sheet, options).write(str(tmp_path / "out"))
    assert names == ["gridmap.obj", "nurbs.brep", "nurbs.step", "quads.obj", "report.json", "seamless.obj"]
    assert sorted(os.listdir(tmp_path / "out")) == names


def test_files_of_an_earlier_result_do_not_stay_beside_a_new_one(sheet, example_path, tmp_path):
    out = tmp_path / "out"
    trimquad.convert(example_path("box_with_fillets"), trimquad.Options(quads=100)).write(str(out))
    (out / "notes.txt").write_text("mine")
    (out / "quads-plan.obj").write_text("mine")
    trimquad.convert(sheet, trimquad.Options(quads=50)).write(str(out))
    assert sorted(os.listdir(out)) == [
        "gridmap.obj", "notes.txt", "nurbs.brep", "nurbs.step", "quads-plan.obj", "quads.obj", "report.json"
    ]


def test_files_in_a_folder_without_a_report_are_left_alone(sheet, tmp_path):
    (tmp_path / "quads-7.obj").write_text("mine")
    trimquad.convert(sheet, trimquad.Options(quads=50)).write(str(tmp_path))
    assert (tmp_path / "quads-7.obj").read_text() == "mine"


def test_a_folder_left_by_an_exception_is_as_it_was(tmp_path):
    (tmp_path / "quads.obj").write_text("old")
    with pytest.raises(RuntimeError):
        with OutputFolder(tmp_path) as folder:
            folder.write_text("quads.obj", "new")
            raise RuntimeError
    assert os.listdir(tmp_path) == ["quads.obj"]
    assert (tmp_path / "quads.obj").read_text() == "old"


def test_a_new_folder_left_by_an_exception_is_gone(tmp_path):
    with pytest.raises(RuntimeError):
        with OutputFolder(tmp_path / "a" / "b") as folder:
            folder.write_text("quads.obj", "new")
            raise RuntimeError
    assert os.listdir(tmp_path) == []


def test_a_full_disk_is_one_line(sheet, tmp_path, monkeypatch):
    result = trimquad.convert(sheet, trimquad.Options(quads=50))

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(OutputFolder, "write_text", full)
    with pytest.raises(trimquad.Error, match="No space left on device; free some space") as caught:
        result.write(str(tmp_path / "out"))
    assert caught.value.kind == "input"
    assert not (tmp_path / "out").exists()


def test_cancelling_before_and_during_a_conversion_raises_cancelled(sheet):
    progress = trimquad.Progress()
    progress.cancel()
    with pytest.raises(trimquad.Error) as caught:
        trimquad.convert(sheet, progress=progress)
    assert caught.value.kind == "cancelled"


def test_progress_only_rises_and_ends_at_one(sheet, tmp_path):
    progress = trimquad.Progress()
    result = trimquad.convert(sheet, trimquad.Options(quads=50), progress)
    before_writing = progress.fraction
    assert 0.5 < before_writing < 1
    result.write(str(tmp_path), progress)
    assert progress.fraction == pytest.approx(1)


def test_a_region_that_fails_does_not_stop_the_others(tmp_path, capsys):
    """A crumpled plate is too rough for one smooth surface within the tolerance; a flat one beside it is not."""
    from trimquad import cli

    seed = 7
    random = numpy.random.default_rng(seed)
    n = 4
    places = [(i, j) for i in range(n) for j in range(n)]
    crumpled = [(i, j, random.uniform(-0.7, 0.7)) for i, j in places]
    flat = [(i + 20, j, 0) for i, j in places]
    cells = [n * i + j for i in range(n - 1) for j in range(n - 1)]
    triangles = [t for a in cells for t in ((a, a + n, a + n + 1), (a, a + n + 1, a + 1))]
    path = tmp_path / "both.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in crumpled + flat]
    lines += [f"f {a + k} {b + k} {c + k}" for k in (1, 1 + n * n) for a, b, c in triangles]
    path.write_text("\n".join(lines) + "\n")
    status = cli.main(["convert", str(path), "--out", str(tmp_path / "out"), "--quads", "60", "--features", "ignore",
                       "--relative-tolerance", "1e-5", "--quiet"])
    lines = capsys.readouterr().err.splitlines()
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert status == 3, seed
    assert len(lines) == 1 and "1 of 2 regions failed" in lines[0]
    assert [r["status"] for r in report["regions"]] == ["failed", "ok"]
    failed, through = report["regions"]
    assert failed["error"]["stage"] == "fit" and "tolerance" in failed["error"]["message"]
    assert failed["nurbs"] is None and through["nurbs"]["faces"] == 1
    # What came before the failure is written all the same.
    names = set(os.listdir(tmp_path / "out"))
    assert names == {"gridmap-0.obj", "gridmap-1.obj", "quads-0.obj", "quads-1.obj", "nurbs.step", "nurbs.brep", "report.json"}


@pytest.mark.parametrize("kinds, last", [
    (["seamless", "report"], "seamless"), (["seamless", "pictures"], "seamless"), (["tmesh"], "quantize"),
    (["gridmap"], "optimize"), (["quads", "pictures"], "extract"), (["report"], "extract"),
])
def test_stages_that_nothing_written_needs_are_not_run(sheet, tmp_path, kinds, last):
    result = trimquad.convert(sheet, trimquad.Options(quads=50, write=kinds))
    item = result.regions[0]
    stages = {"seamless": item.seamless, "quantize": item.quantization, "optimize": item.grid, "extract": item.quads,
              "fit": item.fitted}
    reached = list(stages)[: list(stages).index(last) + 1]
    assert [name for name, value in stages.items() if value is not None] == reached
    names = result.write(str(tmp_path))
    if "pictures" in kinds:
        assert "map.png" in names and "nurbs.png" not in names


def test_pictures_and_a_document_are_written_when_asked_for(sheet, tmp_path):
    import FreeCAD

    result = trimquad.convert(sheet, trimquad.Options(quads=50, write=["pictures", "fcstd"]))
    pictures = ["histograms.png", "map.png", "nurbs-deviation.png", "nurbs.png", "quads.png", "tmesh.png", "tmesh_unfolded.png"]
    assert result.write(str(tmp_path)) == [*pictures, "trimquad.FCStd"]
    document = FreeCAD.openDocument(str(tmp_path / "trimquad.FCStd"))
    try:
        kinds = sorted(o.TypeId for o in document.Objects)
        assert kinds == ["App::FeaturePython", "Fem::FemMeshObject", "Mesh::FeaturePython", "Part::Feature"]
        assert document.QuadMesh.Mesh.CountFacets > 50
        assert document.FemMesh.FemMesh.QuadrangleCount >= document.QuadMesh.FullQuads
    finally:
        FreeCAD.closeDocument(document.Name)


def test_only_the_chosen_faces_are_converted(example_path):
    import Part

    box = Part.makeBox(30, 20, 10)
    result = trimquad.convert(Source(box, ["Face1", "Face6"]), trimquad.Options(quads=100))
    assert len(result.regions) == 2
    assert result.shape.Area == pytest.approx(box.Face1.Area + box.Face6.Area, rel=1e-6)


class _AlwaysAtFault:
    """The compiled stages, with a check that finds every face at fault."""

    def __init__(self, native):
        self._native = native
        self.checks = self.revisions = 0

    def __getattr__(self, name):
        return getattr(self._native, name)

    def FaceChecks(self, checker):
        return self

    def smoothed_charts(self, *arguments):
        return self._counted(self._native.smoothed_charts(*arguments))

    def closer_charts(self, *arguments):
        return self._counted(self._native.closer_charts(*arguments))

    def _counted(self, fitted):
        self.revisions += fitted is not None
        return fitted

    def faults(self, spline, folded, threads, progress):
        self.checks += 1
        return [[self._native.FaceFault("Face1: SelfIntersect")]]


def test_a_face_at_fault_is_fitted_again_and_then_refused_by_name(sheet, monkeypatch):
    module = sys.modules["trimquad.joining"]
    native = _AlwaysAtFault(module.load())
    for user in (module, sys.modules["trimquad.regions"]):
        monkeypatch.setattr(user, "load", lambda: native)
    result = trimquad.convert(sheet, trimquad.Options(quads=50))
    (region,) = result.failed
    assert region.refits == len(module.REFITS) + 1
    # Once at first, and whenever a way gives other surfaces; where nothing is to be revised yet, the next way does.
    assert native.checks == 1 + sum("smoother" not in way for way in module.REFITS) + native.revisions
    assert region.error.kind == "stage" and region.error.stage == "fit"
    assert "SelfIntersect" in str(region.error)
    assert len(region.bisections) == sum("cut" in way for way in module.REFITS)
    smoother = sum(way["smoother"] for way in module.REVISIONS)
    assert region.smoothings and max(region.smoothings.values()) == smoother * module.STEPS
    assert region.quads is not None
    assert result.spline is None and result.native_shape is None


def test_a_shell_that_comes_back_to_where_it_began_is_cut_until_its_surfaces_cross_no_more():
    """Beyond its slanted trailing edge, where both sides of a wing end, one surface for both would cross itself."""
    import FreeCAD
    import Part

    def profile(chord, y):
        points = [(100, 0.3), (80, 4.3), (50, 9), (20, 10), (0, 0), (20, -10), (50, -9), (80, -4.3), (100, -0.3)]
        curve = Part.BSplineCurve()
        curve.interpolate([FreeCAD.Vector(chord * x, y, chord * z) for x, z in points])
        return curve.toShape()

    wing = Part.makeRuledSurface(profile(1, 0), profile(0.5, 150))
    result = trimquad.convert(wing, trimquad.Options(quads=600))
    assert not result.failed
    assert result.regions[0].bisections[0] == [0]
    assert 2 <= len(result.shape.Faces) <= 4
    result.shape.check(True)


class _NoCreases:
    """The compiled stages, with a fit that cannot follow creases."""

    def __init__(self, native):
        self._native = native

    def __getattr__(self, name):
        return getattr(self._native, name)

    def fit_surface(self, region, *rest):
        if region.features["aligned_edges"]:
            raise trimquad.Error("stage", "fit", "the tolerance cannot be met", region.name)
        return self._native.fit_surface(region, *rest)


class _NoDirectRoute(_NoCreases):
    """The compiled stages, with a direct route that fails after some time."""

    def grid_map(self, *arguments):
        time.sleep(0.2)
        raise trimquad.Error("stage", "optimize", "triangles stay turned over in the map", "region")


def test_the_seconds_of_a_route_that_failed_count(monkeypatch):
    module = sys.modules["trimquad.regions"]
    native = _NoDirectRoute(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    points = [(x, y, 0.02 * x * y) for y in range(6) for x in range(6)]
    triangles = [t for y in range(5) for x in range(5) for a in [x + 6 * y] for t in ((a, a + 1, a + 7), (a, a + 7, a + 6))]
    result = trimquad.convert((points, triangles), trimquad.Options(edge_length=1, write=("quads",)))
    (region,) = result.regions
    assert region.error is None and region.embedding["route"] == "reembedded"
    assert region.seconds["optimize"] > 0.2
    assert region.seconds["field"] > 0 and region.seconds["seamless"] > 0


def _folded_sheet(crease_from=0):
    """(points, triangles) of a square sheet that is folded along its middle line, from a row of points on."""
    import numpy as np

    n = 16
    steps = np.arange(n + 1.0)
    slope = [0.7 * min(1, max(0, (y - crease_from + 1) / 4)) if crease_from else 0.7 for y in steps]
    points = np.array([(x, y, s * abs(x - 8)) for y, s in zip(steps, slope) for x in steps])
    corner = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    triangles = np.vstack([np.c_[corner, corner + 1, corner + n + 2], np.c_[corner, corner + n + 2, corner + n + 1]])
    return points, triangles


def test_creases_that_cannot_be_fitted_are_rounded_and_the_quads_keep_them(monkeypatch):
    import numpy as np

    module = sys.modules["trimquad.regions"]
    native = _NoCreases(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    options = trimquad.Options(quads=100, relative_tolerance=5e-3, features="align")
    result = trimquad.convert(_folded_sheet(), options)
    (region,) = result.regions
    assert region.error is None and region.fitted_from is not region
    assert region.region.features["aligned_edges"] == 16
    assert any("cannot follow its sharp edges" in line for line in result.warnings)
    assert len(result.shape.Faces) == 1
    result.shape.check(True)
    # Both maps took their time.
    assert all(region.seconds[stage] > seconds for stage, seconds in region.fitted_from.seconds.items())
    # With creases the middle line is one of the grid.
    assert result.report["regions"][0]["features"]["creases"] is False
    x = np.array(region.polygons.points)[:, 0]
    assert np.count_nonzero(np.abs(x - 8) < 1e-9) >= 8


def test_a_mesh_whose_creases_cannot_be_fitted_is_divided_along_them(monkeypatch):
    module = sys.modules["trimquad.regions"]
    native = _NoCreases(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    result = trimquad.convert(_folded_sheet(), trimquad.Options(quads=100))
    assert not result.failed and len(result.regions) == 2
    assert any("divided along its sharp edges into 2 regions" in line for line in result.warnings)
    assert result.report["options"]["features"] == "trim"
    assert len(result.shape.Faces) == 2 and len(result.shape.Edges) == 7
    result.shape.check(True)
    assert all(region.quads is not None for region in result.regions)


@pytest.mark.parametrize("crease_from, given", [(9, {}), (0, {"align": ["loop:0"]}), (0, {"features": "align"})])
def test_a_mesh_that_its_creases_do_not_divide_or_whose_edges_are_chosen_stays_whole(monkeypatch, crease_from, given):
    module = sys.modules["trimquad.regions"]
    native = _NoCreases(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    options = trimquad.Options(quads=100, relative_tolerance=2e-2, **given)
    result = trimquad.convert(_folded_sheet(crease_from=crease_from), options)
    (region,) = result.regions
    # Edges that the user aligned are not rounded.
    assert (region.error is None) == (region.fitted_from is not region) == ("align" not in given)
    assert result.report["options"]["features"] == "align"
    assert not any("divided" in line for line in result.warnings)


def test_a_fit_that_is_given_up_for_dividing_is_gone_on_with_where_the_creases_do_not_divide(monkeypatch):
    options = trimquad.Options(quads=100)
    wanted = trimquad.convert(_folded_sheet(crease_from=9), options)
    monkeypatch.setattr(regions, "MOST_WORK_BEFORE_DIVISION", 0)
    monkeypatch.setattr(regions, "MOST_WORK_BY_TRIANGLE", 0)
    given_up = []
    fit = regions.fit

    def noting(item, *arguments, **ways):
        try:
            return fit(item, *arguments, **ways)
        except Error:
            given_up.append(item.most_work)
            raise

    monkeypatch.setattr(regions, "fit", noting)
    result = trimquad.convert(_folded_sheet(crease_from=9), options)
    assert given_up == [0] and not result.failed
    assert result.report["regions"][0]["features"]["creases"] is True
    assert result.regions[0].fitted.control_points == wanted.regions[0].fitted.control_points


def test_a_mesh_that_cannot_be_fitted_when_it_is_divided_either_is_told_of_as_a_whole(monkeypatch):
    class NoFit(_NoCreases):
        def fit_surface(self, region, *rest):
            raise trimquad.Error("stage", "fit", "the tolerance cannot be met", region.name)

    module = sys.modules["trimquad.regions"]
    native = NoFit(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    result = trimquad.convert(_folded_sheet(), trimquad.Options(quads=100))
    (region,) = result.regions
    assert region.error.stage == "fit" and result.spline is None
    assert region.quads is not None
    assert not any("divided" in line for line in result.warnings)


@pytest.mark.parametrize("least, kept", [(0.25, True), (0.75, False)])
def test_what_can_be_fitted_of_a_divided_mesh_is_better_than_nothing_if_it_is_a_good_part(monkeypatch, least, kept):
    class Half(_NoCreases):
        def fit_surface(self, region, *rest):
            if region.features["aligned_edges"] or region.name.endswith("part 1"):
                raise trimquad.Error("stage", "fit", "the tolerance cannot be met", region.name)
            return self._native.fit_surface(region, *rest)

    module = sys.modules["trimquad.regions"]
    native = Half(module.load())
    monkeypatch.setattr(module, "load", lambda: native)
    monkeypatch.setattr(module, "_without_creases", lambda item, result: None)
    monkeypatch.setattr(sys.modules["trimquad.convert"], "WORTH_DIVIDING", least)
    result = trimquad.convert(_folded_sheet(), trimquad.Options(quads=100))
    if not kept:
        assert result.failed == result.regions and result.report["options"]["features"] == "align"
        return
    assert [region.name for region in result.failed] == ["component 0 part 1"]
    assert len(result.shape.Faces) == 1
