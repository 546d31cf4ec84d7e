"""Regions that are fitted again so that their surfaces suit those around them."""
from contextlib import nullcontext
from types import SimpleNamespace

import pytest

import trimquad
from trimquad import joining, regions
from trimquad.error import Error


@pytest.fixture(scope="module")
def plate_with_boss(tmp_path_factory):
    """What lies beyond three of the plate's sides goes its own way, there is a rounding along the fourth: the surface around
    the boss may turn back in the corners between."""
    import FreeCAD
    import Part

    part = Part.makeBox(60, 60, 10, FreeCAD.Vector(-30, -30, 0))
    part = part.fuse(Part.makeCone(14, 10, 25, FreeCAD.Vector(0, 0, 8))).removeSplitter()
    boxes = [(edge, edge.BoundBox) for edge in part.Edges]
    rounded = [edge for edge, box in boxes if box.ZMin > 9.99 and box.ZMax < 10.01 and box.XMax < 20]
    path = tmp_path_factory.mktemp("plate") / "boss.step"
    part.makeFillet(4, rounded).cut(Part.makeCylinder(6, 50, FreeCAD.Vector(0, 0, -2))).exportStep(str(path))
    return path


def test_corners_are_held_where_surfaces_are_loose(plate_with_boss):
    result = trimquad.convert(plate_with_boss, trimquad.Options(relative_tolerance=1e-3))
    assert any(joining.HELD in item.fitted_in and item.holds_corners for item in result.regions)
    assert result.failed == [] and len(result.spline.faces) == len(result.regions)
    assert result.spline.loose_edges == 0 and result.faults == []


def test_what_was_fitted_before_corners_were_held_is_taken_where_that_leads_nowhere(plate_with_boss, monkeypatch):
    held, refit = [], joining._refit

    def refit_unless_held(item, charts, error, result, progress):
        if item.holds_corners:
            held.append(item)
            item.fitted, item.error = None, error
        else:
            refit(item, charts, error, result, progress)

    monkeypatch.setattr(joining, "_refit", refit_unless_held)
    result = trimquad.convert(plate_with_boss, trimquad.Options(relative_tolerance=1e-3))
    assert len(held) == 1 and not held[0].holds_corners and joining.CLOSER in held[0].fitted_in
    assert result.failed == []


def test_a_revision_that_cannot_be_trimmed_is_taken_back_before_the_next(monkeypatch):
    before, crossed = SimpleNamespace(several=True), SimpleNamespace(several=True)
    at_fault = Error("stage", "fit", "the fitted surface crosses that of face 2", "face 1")
    item = regions.RegionResult(SimpleNamespace(name="face 1"))
    item.fitted, item.before_revision = crossed, (before, {4}, at_fault)
    item.refits = joining.REFITS.index(joining.REVISIONS[0]) + 1  # the revision that crossed
    revised = []

    def revise(item, charts, result, progress, smoother):
        revised.append((item.fitted, charts, smoother))  # None is given: no such surfaces

    monkeypatch.setattr(regions, "revised", revise)
    monkeypatch.setattr(regions, "exhausted", lambda *_: True)  # nothing but revisions is left
    monkeypatch.setattr(regions, "fit_over_another_map", lambda *_: False)
    cannot_be_trimmed = Error("stage", "trim", "its edges cross", "face 1")
    progress = SimpleNamespace(stage=lambda *_: nullcontext())
    joining._refit(item, set(), cannot_be_trimmed, SimpleNamespace(exhausted=False), progress)

    assert revised and all(fitted is before and charts == [4] for fitted, charts, _ in revised)
    assert [smoother for *_, smoother in revised] == [way["smoother"] for way in joining.REVISIONS[1:]]
    assert item.fitted is None and item.error is at_fault
