"""Surfaces fitted over another map of a region than that of its quads."""
import math
import sys
import types

import pytest

import trimquad


def cap(angle):
    """The part of a sphere of radius 10 within so many radians of its pole."""
    import FreeCAD
    import Part

    sphere = Part.makeSphere(10, FreeCAD.Vector(), FreeCAD.Vector(0, 0, 1), 90 - math.degrees(angle), 90, 360)
    return max(sphere.Faces, key=lambda face: face.Area)


def test_a_deep_dome_is_one_surface_though_its_quads_have_irregular_vertices():
    result = trimquad.convert(cap(2.4), trimquad.Options(quads=300, write=["quads", "nurbs", "report"]))
    (region,) = result.regions
    assert region.error is None and len(region.singularities) > 0
    assert region.fitted_without_singularities and not region.fitted.folded
    report = result.report["regions"][0]
    assert report["nurbs"]["faces"] == 1 and report["nurbs"]["without_singularities"] is True
    assert report["quads"]["irregular_vertices"] == len(region.singularities)
    assert len(result.shape.Faces) == 1
    result.shape.check(True)
    assert result.shape.Area == pytest.approx(2 * math.pi * 100 * (1 - math.cos(2.4)), rel=2e-3)
    points, triangles, _ = region.map
    assert len(triangles) == region.region.triangles, "the map of the quads is that of the region itself"


def fit_alike(monkeypatch, *fits):
    """Let surfaces be fitted with these numbers of folds and control points, and none be trimmed."""
    waiting = [
        types.SimpleNamespace(folded=[(0.0, 0.0, 0.0)] * folds, control_points=control_points, samples=1000,
                              max_deviation=0.0)
        for folds, control_points in fits
    ]
    monkeypatch.setattr(sys.modules["trimquad.regions"], "fit", lambda *_: waiting.pop(0))
    monkeypatch.setattr(sys.modules["trimquad.convert"], "trim", lambda *_: None)
    return waiting


@pytest.mark.parametrize("folds, taken", [(0, True), (1, False)])
def test_one_surface_that_folds_is_not_taken_where_several_do_not(monkeypatch, folds, taken):
    waiting = fit_alike(monkeypatch, (folds, 10), (0, 400))
    (region,) = trimquad.convert(cap(2.4), trimquad.Options(quads=300)).regions
    assert len(waiting) == taken
    assert region.fitted_without_singularities == taken
    assert region.fitted.control_points == (10 if taken else 400)


def test_surfaces_that_were_not_taken_at_first_are_not_fitted_anew(monkeypatch):
    regions = sys.modules["trimquad.regions"]
    waiting = fit_alike(monkeypatch, (1, 10), (0, 400))
    result = trimquad.convert(cap(2.4), trimquad.Options(quads=300))
    (region,) = result.regions
    assert waiting == [] and region.fitted_from is region
    work, triangles = region.work, region.mapped_region.triangles
    assert regions.fit_over_another_map(region, result, trimquad.Progress(), [regions.WITHOUT_SINGULARITIES])
    assert region.fitted.control_points == 10 and region.fitted_without_singularities
    assert region.work == work and region.mapped_region.triangles == triangles
    # The model holds the mesh that these surfaces are of.
    assert result.model.regions[0].triangles == region.fitted_from.mapped_region.triangles
    assert region.fitted_from.grid.arrays[1].shape[0] >= region.fitted_from.mapped_region.triangles


def test_one_surface_over_too_distorted_a_map_is_not_looked_for(monkeypatch):
    waiting = fit_alike(monkeypatch, (0, 400))
    monkeypatch.setattr(sys.modules["trimquad.regions"], "MOST_DISTORTION", 4.5)
    (region,) = trimquad.convert(cap(2.4), trimquad.Options(quads=300)).regions
    assert waiting == [] and region.fitted_from is region


def test_where_one_surface_does_not_fit_several_around_singularities_are_tried(monkeypatch):
    regions = sys.modules["trimquad.regions"]
    fit = regions.fit

    def only_several(item, *rest, **options):
        if not item.singularities:
            raise trimquad.Error("stage", "fit", "the tolerance cannot be met", item.name)
        return fit(item, *rest, **options)

    monkeypatch.setattr(regions, "fit", only_several)
    result = trimquad.convert(cap(1.4), trimquad.Options(quads=300))
    (region,) = result.regions
    assert region.singularities == [] and len(region.fitted_from.singularities) > 0
    assert region.error is None and not region.fitted_without_singularities
    assert len(result.shape.Faces) > 1
    result.shape.check(True)
    assert result.report["regions"][0]["quads"]["irregular_vertices"] == 0
    assert any("no single B-spline surface fits" in w for w in result.warnings)


@pytest.mark.parametrize("endless", [False, True])
def test_where_one_surface_is_at_fault_several_over_the_map_of_the_quads_are_tried(monkeypatch, endless):
    joining = sys.modules["trimquad.joining"]
    native = joining.load()

    class FaultySingles:
        """The compiled module, but single faces are at fault."""

        def __getattr__(self, name):
            return getattr(native, name)

        def FaceChecks(self, checker):
            return self

        def faults(self, model, folded, threads, progress):
            fault = native.CHECK_DOES_NOT_END if endless else "Face1: SelfIntersect"
            return [[native.FaceFault(fault)] if len(model.faces) == 1 else [] for _ in model.faces]

        def faults_of_whole(self, model, progress):
            return []

    monkeypatch.setattr(joining, "load", FaultySingles)
    if not endless:  # where it is, the same map is not fitted again
        monkeypatch.setattr(joining, "REFITS", ())
    result = trimquad.convert(cap(2.4), trimquad.Options(quads=300))
    (region,) = result.regions
    assert region.error is None and not region.fitted_without_singularities
    assert len(result.shape.Faces) > 1
    result.shape.check(True)
