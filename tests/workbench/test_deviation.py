"""Where and how far the B-spline faces leave the input."""
import json

import numpy
import pytest
from conftest import EXAMPLES

import trimquad
from trimquad.colours import BEYOND_TOLERANCE, deviation_colour
from trimquad.deviation import MAP_CHORD, deviation_maps, face_deviations
from trimquad.native import load


def shape_of(path):
    import FreeCAD  # noqa: F401
    import Part

    return Part.read(path)


def distance(shape, point):
    import FreeCAD
    import Part

    return shape.distToShape(Part.Vertex(FreeCAD.Vector(*point)))[0]


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_reported_place_lies_on_the_input_and_as_far_from_the_model_as_reported(converted, example_path, name):
    result, out = converted(name)
    given = shape_of(example_path(name))
    for region in json.loads((out / "report.json").read_text())["regions"]:
        nurbs = region["nurbs"]
        place, largest = nurbs["max_deviation_at"], nurbs["max_deviation"]
        assert distance(given, place) <= 1e-6
        faces = [result.shape.Faces[int(f["face"][4:]) - 1] for f in nurbs["face_deviations"]]
        # What is measured is the surface, not where it is trimmed.
        assert min(distance(face.Surface.toShape(), place) for face in faces) == pytest.approx(largest, rel=0.02, abs=1e-6)


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_face_has_its_deviation_and_the_largest_is_its_region_s(converted, name):
    result, _ = converted(name)
    regions = face_deviations(result)
    assert sorted(f.face for faces in regions for f in faces) == list(range(1, len(result.shape.Faces) + 1))
    for item, faces in zip(result.regions, regions):
        assert max(f.max for f in faces) == item.fitted.max_deviation
        assert all(0 <= f.rms <= f.max for f in faces)


def test_a_region_s_deviations_are_those_of_its_own_faces(converted, example_path):
    """Faces of the result are counted in another order than regions are made."""
    result, _ = converted("box_with_fillets")
    for item, faces in zip(result.regions, face_deviations(result)):
        for f in faces:
            made = result.shape.Faces[f.face - 1]
            off = [distance(made, p) for p in item.region.points[::7]]
            assert max(off) < 2 * result.options.tolerance


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_map_s_points_lie_on_the_model_and_their_distances_are_those_from_the_input(converted, example_path, name):
    import FreeCAD  # noqa: F401
    import Part

    result, _ = converted(name)
    given = shape_of(example_path(name))
    maps = deviation_maps(result, load().Progress())
    areas = [f.Area for f in result.shape.Faces]
    assert len(maps) == len(areas)
    generator = numpy.random.default_rng(5)  # the points that are looked at
    for points, distances, triangles in maps:
        assert distances.max() <= result.options.tolerance
        sides = points[triangles] - points[numpy.roll(triangles, 1, axis=1)]
        assert numpy.linalg.norm(sides, axis=2).max() <= result.model.diagonal / 100
        sides = numpy.sort(numpy.stack([triangles, numpy.roll(triangles, 1, axis=1)], axis=2).reshape(-1, 2), axis=1)
        ends, uses = numpy.unique(sides, axis=0, return_counts=True)
        border = set(ends[uses == 1].ravel().tolist())
        for k in generator.choice(len(points), 12, replace=False):
            # Between two points of a trim curve, the map's border is straight.
            assert distance(result.shape, points[k]) <= result.model.diagonal * MAP_CHORD
            assert min(distance(f.Surface.toShape(), points[k]) for f in result.shape.Faces) <= 1e-7
            # The input may have a nearer point that faces another way. Along its surface, trim curves may leave its edges by a
            # quarter of the tolerance, and by what the surface deviates that they meet in.
            beyond = result.options.tolerance / 4 + result.fit_tolerance if k in border else 0
            assert distance(given, points[k]) <= distances[k] + beyond + 1e-6
        # To OpenCASCADE, a point inside a solid is on it.
        middle = int(numpy.argmax(distances))
        assert distance(Part.makeCompound(given.Faces), points[middle]) == pytest.approx(distances[middle], rel=0.05, abs=1e-6)


def test_a_mesh_s_deviation_is_that_from_its_triangles(tmp_path):
    steps = numpy.linspace(0, 10, 30)
    x, y = numpy.meshgrid(steps, steps)
    points = numpy.stack([x, y, numpy.sin(x / 2) * numpy.cos(y / 3)], axis=-1).reshape(-1, 3)
    first = (numpy.arange(29)[:, None] * 30 + numpy.arange(29)).ravel()
    triangles = numpy.concatenate([numpy.stack([first, first + 1, first + 31], 1), numpy.stack([first, first + 31, first + 30], 1)])
    result = trimquad.convert((points, triangles), trimquad.Options(quads=60, write=["nurbs", "report"]))
    (m,) = deviation_maps(result, load().Progress())
    largest = result.regions[0].fitted.max_deviation
    # Both ways, up to the trim's own deviation.
    assert 0.3 * largest < m.distances.max() <= result.options.tolerance
    m2 = m.points[m.distances.argmax()]
    corners = points[triangles]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    heights = numpy.abs(((m2 - corners[:, 0]) * normals).sum(axis=1)) / numpy.linalg.norm(normals, axis=1)
    near = numpy.linalg.norm(corners.mean(axis=1) - m2, axis=1) < 0.6
    assert heights[near].min() <= m.distances.max() + 1e-12


def test_colours_tell_deviations_apart_and_end_at_the_tolerance():
    parts = [0, 0.2, 0.5, 0.8, 1]
    assert len({deviation_colour(p) for p in parts} | {BEYOND_TOLERANCE}) == 6
    assert deviation_colour(1.0001) == deviation_colour(float("nan")) == BEYOND_TOLERANCE
    assert numpy.allclose(deviation_colour(0.5), deviation_colour(0.5001), atol=1e-3)


def test_the_picture_is_written_and_shows_what_lies_farther_away(sheet, tmp_path):
    """The same model beside a tighter tolerance: more of it is red."""
    from PIL import Image

    result = trimquad.convert(sheet, trimquad.Options(quads=50, write=["nurbs", "pictures"]))
    assert "nurbs-deviation.png" in result.write(str(tmp_path))

    def red():
        pixels = numpy.asarray(Image.open(tmp_path / "nurbs-deviation.png").convert("RGB"), int)
        wanted = numpy.round(255 * numpy.array(BEYOND_TOLERANCE))
        return (numpy.abs(pixels - wanted).max(axis=2) < 12).sum()

    before = red()
    result.options.tolerance = 0.2 * result.regions[0].fitted.max_deviation
    result.write(str(tmp_path))
    assert red() > before + 1000


def test_surfaces_farther_away_than_the_tolerance_are_said_with_the_place(converted):
    import sys

    result, _ = converted("sheet")
    (region,) = result.regions
    warnings, tolerance = list(result.warnings), result.options.tolerance
    try:
        sys.modules["trimquad.convert"]._warn_of_regions(result)
        assert not any("in narrow bulges" in line for line in result.warnings[len(warnings):])
        result.options.tolerance = region.fitted.max_deviation / 2
        sys.modules["trimquad.convert"]._warn_of_regions(result)
        (line,) = [line for line in result.warnings if "in narrow bulges" in line]
        assert f"{region.fitted.max_deviation:.3g} away" in line and " at " in line
    finally:
        result.warnings[:], result.options.tolerance = warnings, tolerance
