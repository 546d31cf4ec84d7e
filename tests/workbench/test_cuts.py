"""Regions of CAD models that fail as a whole are cut along smooth edges inside them."""
import json
import math

import pytest
import trimquad
from trimquad import joining, regions
from trimquad.error import Error


def stand_in(monkeypatch, **parts):
    """Has trimming and joining use these instead of the compiled module's."""
    from trimquad.native import load

    native = load()

    class Native:
        def __getattr__(self, name):
            return parts.get(name) or getattr(native, name)

    monkeypatch.setattr(joining, "load", Native)


def tube():
    """Four planes and four cylinders around a box with rounded edges, open at both ends: one region."""
    import FreeCAD  # noqa: F401  before Part
    import Part

    box = Part.makeBox(10, 8, 3)
    upright = [e for e in box.Edges if abs(e.Vertexes[0].Z - e.Vertexes[-1].Z) > 1]
    return [f for f in box.makeFillet(1, upright).Faces if f.BoundBox.ZLength > 1]


ROUNDING = (1 - math.sqrt(0.5), 1 - math.sqrt(0.5), 1.5)


@pytest.fixture
def large_regions_fail(monkeypatch):
    """Fits fail where a region is half of the tube or more, in one of its roundings."""
    fit, area = regions.fit, sum(f.Area for f in tube())

    def refusing(item, *arguments, **ways):
        if item.region.area > area / 2:
            raise Error("stage", "fit", "refused", item.name, ROUNDING)
        return fit(item, *arguments, **ways)

    monkeypatch.setattr(regions, "fit", refusing)


def converted(**options):
    return trimquad.convert(tube(), trimquad.Options(quads=60, **options))


def test_first_around_the_place_then_between_all_faces(large_regions_fail, tmp_path):
    result = converted()
    assert not result.failed
    first, second = result.cuts
    assert first.region == "region 0" and len(first.edges) == 2 and len(first.parts) == 2
    assert second.region in first.parts and len(second.edges) == 6 and len(second.parts) == 7
    assert len(result.regions) == 8
    assert {r.cut_from for r in result.regions} == {"region 0", second.region}
    shape = result.shape
    assert shape.isValid() and len(shape.Faces) == 8
    # Free are the two ends only.
    uses = [len(shape.ancestorsOfType(e, type(shape.Faces[0]))) for e in shape.Edges]
    free = sum(e.Length for e, count in zip(shape.Edges, uses) if count == 1)
    assert set(uses) == {1, 2} and free == pytest.approx(2 * (2 * 8 + 2 * 6 + 2 * math.pi), rel=1e-3)

    result.write(str(tmp_path))
    report = json.loads((tmp_path / "report.json").read_text())
    assert [(cut["region"], cut["error"]["message"]) for cut in report["cuts"]] == [
        ("region 0", "refused"), (second.region, "refused"),
    ]
    assert {r["name"] for r in report["regions"]} == set(first.parts + second.parts) - {second.region}
    assert sum("'region 0'" in line and "2 of its inner edges" in line for line in result.warnings) == 1


def test_parts_that_touch_agree_on_their_common_edges(large_regions_fail):
    result = converted()
    assert result.spline.loose_edges == 0 and len(result.spline.moved_regions) >= 4  # of 8 in a ring
    largest_gap = 2e-7 * result.model.diagonal
    assert max(edge.Tolerance for edge in result.shape.Edges) <= largest_gap
    for item in result.regions:
        assert item.fitted.max_deviation == item.fitted.deviations[0][0] <= result.options.tolerance


def test_results_do_not_depend_on_threads(large_regions_fail):
    texts = []
    for threads in (1, 3):
        result = converted(threads=threads)
        texts.append([result.shape.exportBrepToString()] + [r.quads.to_obj() for r in result.regions])
    assert texts[0] == texts[1]


@pytest.mark.parametrize("features", ("align", "ignore"))
def test_edges_that_are_to_lie_inside_are_not_cut(large_regions_fail, features):
    result = converted(features=features)
    assert [r.name for r in result.failed] == ["region 0"] and not result.cuts


def test_a_failure_that_no_cut_cures_stays_one(monkeypatch):
    def refusing(item, *_, **__):
        raise Error("stage", "fit", "refused", item.name)

    monkeypatch.setattr(regions, "fit", refusing)
    result = converted()
    assert len(result.cuts) == 1 and len(result.failed) == len(result.regions) == 8
    assert result.shape is None


def test_a_region_that_cannot_be_trimmed_is_cut(monkeypatch):
    def refusing(item, charts, error, result, progress):
        item.fitted, item.error = None, Error("stage", "fit", "refused", item.name)

    native, whole = joining.load(), []

    def trim_model(model, *arguments):
        if len(model.regions) == 1:
            whole.append(model)
            raise Error("stage", "fit", "trims cross", "region 0, Edge1")
        return native.trim_model(model, *arguments)

    stand_in(monkeypatch, trim_model=trim_model)

    monkeypatch.setattr(joining, "_refit", refusing)
    result = converted()
    assert len(whole) == 1 and len(result.cuts) == 1 and not result.failed
    assert result.shape.isValid() and len(result.shape.Faces) == 8


def test_all_regions_that_cannot_be_trimmed_are_fitted_again_before_the_next_trim(monkeypatch):
    import Part

    native, trims, fitted_again = joining.load(), [], []

    def trim_model(*arguments):
        trims.append(arguments)
        if len(trims) == 1:
            error = Error("stage", "fit", "trims cross", "region 2")
            error.others = [Error("stage", "fit", "trims cross", "region 4, Edge3")]
            raise error
        return native.trim_model(*arguments)

    stand_in(monkeypatch, trim_model=trim_model)

    def refit(item, charts, error, result, progress):
        fitted_again.append((item.name, error.where))

    monkeypatch.setattr(joining, "_refit", refit)
    result = trimquad.convert(Part.makeBox(1, 2, 3), trimquad.Options(quads=200))
    assert not result.failed and len(trims) == 2
    assert sorted(fitted_again) == [("region 2", "region 2"), ("region 4", "region 4, Edge3")]


@pytest.fixture
def one_region_fails(monkeypatch):
    """The first trim of a box fails for its region 2, which no other fit helps. Returns the numbers of regions of all trims,
    and how the next ones fail."""
    native, trims, failures = joining.load(), [], ["region 2"]

    def trim_model(model, maps, fits, *arguments):
        trims.append(sum(f is not None for f in fits))
        if failures:
            raise Error("stage", "fit", "encloses nothing", failures.pop(0))
        return native.trim_model(model, maps, fits, *arguments)

    stand_in(monkeypatch, trim_model=trim_model)

    def refit(item, charts, error, result, progress):
        if item.name == "region 2":
            item.fitted, item.error = None, error
        else:
            item.fitted = regions.fit(item, result, native.Progress())

    monkeypatch.setattr(joining, "_refit", refit)
    return trims, failures


def box_in_regions():
    import FreeCAD  # noqa: F401  before Part
    import Part

    return trimquad.convert(Part.makeBox(1, 2, 3), trimquad.Options(quads=200))


def test_before_a_region_is_left_out_those_around_it_are_fitted_more_closely(one_region_fails):
    result = box_in_regions()
    assert not result.failed and one_region_fails[0] == [6, 6]
    around = [joining.CLOSER in r.fitted_in for r in result.regions]
    assert around.count(True) == 4 and not around[2]


def test_a_region_that_was_left_out_is_taken_back_once_those_around_are_others(one_region_fails, monkeypatch):
    trims, failures = one_region_fails
    monkeypatch.setattr(joining, "_fit_again", lambda *_: False)
    assert [r.name for r in box_in_regions().failed] == ["region 2"] and trims == [6, 5]
    # Opposite faces have numbers that differ by one: 0 and 1, 2 and 3, 4 and 5.
    for other, last in (("region 4", [6, 5, 5, 6]), ("region 3", [6, 5, 5])):
        trims.clear()
        failures.extend(["region 2", other])
        assert [r.name for r in box_in_regions().failed] == (["region 2"] if other == "region 3" else [])
        assert trims == last


def test_regions_that_are_at_fault_with_each_other_do_not_take_turns(monkeypatch):
    native, sets = joining.load(), []
    # Of three regions around a corner, only one can stay: the one at fault, by those that are there.
    at_fault = {(0, 2, 4): 0, (0, 2): 0, (2, 4): 2, (0, 4): 4}

    class FaceChecks:
        def __init__(self, checker):
            pass

        def faults(self, model, *_):
            sets.append(tuple(k for k in (0, 2, 4) if k in {face["region"] for face in model.faces}))
            assert len(sets) < 30, sets
            found = [native.FaceFault("crosses another")]
            return [found if at_fault.get(sets[-1]) == face["region"] else [] for face in model.faces]

        def faults_of_whole(self, *_):
            return []

    stand_in(monkeypatch, FaceChecks=FaceChecks)

    def refit(item, charts, error, result, progress):
        item.fitted, item.error = None, error

    monkeypatch.setattr(joining, "_refit", refit)
    monkeypatch.setattr(joining, "_fit_again", lambda *_: False)
    result = box_in_regions()
    assert len(result.failed) == 2 and len(sets[-1]) == 1


def crossing_sides():
    """A shell of a plane and of a vault over it, which share an edge and cross half way."""
    import FreeCAD
    import Part

    edges = []
    for profile in (((0, 0, 0), (10, 0, 0)), ((0, 0, 0), (0, 0, 8), (6, 0, 0), (10, 0, -10))):
        curve = Part.BezierCurve()
        curve.setPoles([FreeCAD.Vector(*p) for p in profile])
        edges.append(curve.toShape())
    return Part.makeShell([edge.extrude(FreeCAD.Vector(0, 12, 0)) for edge in edges])


def test_of_faces_that_cross_in_the_input_one_fails_and_both_are_named():
    result = trimquad.convert(crossing_sides(), trimquad.Options(quads=100))
    (failed,) = result.failed
    assert "Face1 crosses Face2 in the input" in str(failed.error) or "Face2 crosses Face1" in str(failed.error)
    assert all(r.refits == 0 for r in result.regions) and len(result.shape.Faces) == 1


def test_faces_are_named_that_touch_in_the_input_where_they_have_no_common_edge():
    import FreeCAD
    import Part

    # A bent strip, the first edge of which stands on its last face.
    corners = [FreeCAD.Vector(*p) for p in ((5, 0, 0), (5, 0, 6), (10, 0, 6), (10, 0, 0), (0, 0, 0))]
    sides = [Part.makeLine(*ends).extrude(FreeCAD.Vector(0, 12, 0)) for ends in zip(corners, corners[1:])]
    result = trimquad.convert(Part.makeShell(sides), trimquad.Options(quads=100))
    messages = [str(r.error) for r in result.failed]
    assert messages
    for message in messages:
        assert "Face1 touches Face4 in the input" in message or "Face4 touches Face1 in the input" in message


def test_fits_end_with_a_measure_of_work(monkeypatch):
    calls = []

    def fails(item, result, progress, *rest, **ways):
        calls.append(item.name)
        item.work += 100
        raise Error("stage", "fit", "refused", item.name)

    monkeypatch.setattr(regions, "fit", fails)
    import FreeCAD
    import Part

    sphere = Part.makeSphere(10, FreeCAD.Vector(), FreeCAD.Vector(0, 0, 1), -45, 90, 360)
    cap = max(sphere.Faces, key=lambda face: face.Area)
    tries = []
    for most in (1e6, 50):
        monkeypatch.setattr(regions, "MOST_WORK", most)
        calls.clear()
        (failed,) = trimquad.convert(cap, trimquad.Options(quads=300)).failed
        assert str(failed.error).startswith("refused")
        tries.append(len(calls))
    assert tries[1] < tries[0]


def leading_edge(radius):
    """Upper and lower side of a leading edge, 1 deep and 2 long: a shell of two faces."""
    import FreeCAD
    import Part

    height = math.sqrt(2 * radius)
    sides = []
    for sign in (1, -1):
        curve = Part.BezierCurve()
        curve.setPoles([FreeCAD.Vector(*p) for p in ((0, 0, 0), (0, sign * height / 2, 0), (1, sign * height, 0))])
        sides.append(curve.toShape().extrude(FreeCAD.Vector(0, 0, 2)))
    return Part.makeShell(sides)


@pytest.mark.parametrize("radius, cut", ((0.002, True), (0.2, False)))
def test_a_surface_at_fault_is_cut_first_where_it_bends_sharply(monkeypatch, radius, cut):
    native = joining.load()

    class FaceChecks:
        def __init__(self, checker):
            pass

        def faults(self, spline, folded, threads, progress):
            whole = len(spline.faces) == 1 and spline is first
            return [[native.FaceFault("Face1: SelfIntersect")] if whole else [] for _ in spline.faces]

        def faults_of_whole(self, spline, progress):
            return []

    def trim_model(*arguments):
        nonlocal first
        model = native.trim_model(*arguments)
        first = first or model
        return model

    first = None
    stand_in(monkeypatch, FaceChecks=FaceChecks, trim_model=trim_model)
    result = trimquad.convert(leading_edge(radius), trimquad.Options(quads=30, tolerance=0.04))
    assert not result.failed
    if cut:
        assert len(result.cuts) == 1 and len(result.cuts[0].edges) == 1
        assert [r.refits for r in result.regions] == [0, 0] and len(result.shape.Faces) == 2
    else:
        assert not result.cuts and [r.refits for r in result.regions] == [1]


def test_a_surface_with_many_more_poles_than_the_faces_under_it_gives_way_to_theirs(monkeypatch):
    from trimquad.native import load

    whole = converted()
    assert not whole.cuts and load().cad_poles(whole.model, 0) == 8 * 16
    limit, poles = regions._most_poles(0, whole), whole.regions[0].fitted.control_points
    tolerance = whole.options.tolerance / whole.model.diagonal
    assert limit == int(5000 * math.sqrt(1e-4 / tolerance)) and poles < limit
    monkeypatch.setattr(regions, "FEWEST_LIMIT", 1)
    monkeypatch.setattr(regions, "MOST_POLES_OF_CAD", regions.MOST_POLES_OF_CAD * poles / 2 / (limit * 25 * 128 / 5000))
    result = converted()
    assert not result.failed and result.cuts[0].error.stage == "fit" and "poles" in str(result.cuts[0].error)
    assert len(result.shape.Faces) > 1 and result.shape.isValid()
    # A single face has no limit: there is nothing to give way to.
    singles = [k for k in range(len(result.regions)) if load().cad_poles(result.model, k) is None]
    assert singles and all(regions._most_poles(k, result) is None for k in singles)
