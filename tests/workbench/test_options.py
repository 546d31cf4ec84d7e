import math

import pytest

from trimquad import Error, Options


@pytest.mark.parametrize(
    "given, said",
    [
        ({"edge_length": 0.0}, "--edge-length must be a positive number"),
        ({"edge_length": -1.0}, "--edge-length must be a positive number"),
        ({"edge_length": math.nan}, "--edge-length must be a positive number"),
        ({"edge_length": math.inf}, "--edge-length must be a positive number"),
        ({"edge_length": "5"}, "--edge-length must be a positive number"),
        ({"edge_length": 5.0, "quads": 10}, "two ways to say the same"),
        ({"tolerance": 0.1, "relative_tolerance": 0.1}, "two ways to say the same"),
        ({"tolerance": -0.1}, "--tolerance must be a positive number"),
        ({"relative_tolerance": 0.5}, "at most 0.1"),
        ({"quads": 0}, "--quads must be a whole number from 1"),
        ({"quads": 10**9}, "--quads must be a whole number from 1 to 2000000"),
        ({"degree": 1}, "--degree must be a whole number from 2 to 5"),
        ({"degree": 6}, "--degree must be a whole number from 2 to 5"),
        ({"degree": True}, "--degree must be a whole number from 2 to 5"),
        ({"threads": 0}, "--threads must be a whole number"),
        ({"feature_angle": 0.0}, "--feature-angle must be between 0 and 180"),
        ({"feature_angle": math.nan}, "--feature-angle must be between 0 and 180"),
        ({"fill_holes": -1.0}, "--fill-holes must be a length"),
        ({"boundary": "loose"}, "--boundary must be one of free, aligned"),
        ({"features": "cut"}, "--features must be one of trim, align, ignore"),
        ({"route": "slow"}, "--route must be one of"),
        ({"optimal": "yes"}, "--optimal is on or off"),
        ({"write": ["quads", "pdf"]}, "not 'pdf'"),
        ({"field_weight": 1.5}, "--field-weight must be between 0"),
        ({"field_weight": float("nan")}, "--field-weight must be between 0"),
        ({"field": "smooth", "field_weight": 0.5}, "--field smooth follows neither"),
        ({"write": []}, "--write needs at least one"),
        ({"align": [3]}, "--align is a list of names"),
        ({"free": [""]}, "--free is a list of names"),
        ({"field": ""}, "--field must be one of smooth, curvature"),
        ({"feature_points": ["Edge3"]}, "--feature-points knows names such as Vertex5 and points x,y,z, not 'Edge3'"),
        ({"feature_points": ["1", "2"]}, "three coordinates for each point; there are 2 numbers"),
        ({"feature_points": ["1,2,nan"]}, "finite coordinates"),
    ],
)
def test_an_unusable_option_is_one_line_that_names_it(given, said):
    with pytest.raises(Error) as caught:
        Options(**given).validate()
    assert said in str(caught.value)
    assert caught.value.kind == "input"
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "given",
    [
        {"field": "stress"},
    ],
)
def test_what_this_version_cannot_do_is_refused_rather_than_ignored(given):
    with pytest.raises(Error, match="not in this version yet"):
        Options(**given).validate()


def test_the_edge_length_gives_about_the_wanted_number_of_quads():
    options = Options(quads=250).resolved("cad", area=1000.0, diagonal=50.0, default_threads=2)
    assert options.edge_length == pytest.approx(2.0)


def test_tolerance_and_relative_tolerance_say_the_same():
    relative = Options(relative_tolerance=1e-4).resolved("cad", 1000.0, 50.0, 2)
    absolute = Options(tolerance=5e-3).resolved("cad", 1000.0, 50.0, 2)
    assert relative.tolerance == pytest.approx(absolute.tolerance)
    assert relative.relative_tolerance == pytest.approx(absolute.relative_tolerance)


@pytest.mark.parametrize("length, said", [(60.0, "larger than the part"), (1e-4, "1e+11 quads"), (40.0, "no whole quad")])
def test_an_edge_length_that_does_not_fit_the_part_says_what_it_would_give(length, said):
    with pytest.raises(Error) as caught:
        Options(edge_length=length).resolved("cad", 1000.0, 50.0, 2)
    assert said in str(caught.value)


def test_an_input_without_area_is_refused_in_one_line():
    with pytest.raises(Error) as caught:
        Options().resolved("cad", -1.0, 10.0, 1)
    assert caught.value.kind == "input" and "no area" in str(caught.value)


@pytest.mark.parametrize(
    "given",
    [
        ["Vertex5", "1", "2.5", "-3e-1", "4", "5", "6"],  # as the command line splits them
        ["Vertex5", "1,2.5,-3e-1", "4;5;6"],
        [(1, 2.5, -0.3), "Vertex5", (4, 5, 6)],
    ],
)
def test_feature_points_are_names_and_coordinates_in_any_writing(given):
    vertices, points = Options(feature_points=given).feature_vertices_and_points()
    assert vertices == ["Vertex5"]
    assert points == [(1.0, 2.5, -0.3), (4.0, 5.0, 6.0)]


def test_sharp_edges_trim_cad_and_align_meshes_unless_told_otherwise():
    assert Options().resolved("cad", 1000.0, 50.0, 2).features == "trim"
    assert Options().resolved("mesh", 1000.0, 50.0, 2).features == "align"
    assert Options(features="ignore").resolved("mesh", 1000.0, 50.0, 2).features == "ignore"
