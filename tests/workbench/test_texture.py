"""Grid maps as textured models, with the program's own picture on every quad or one of the user's."""
import json

import FreeCAD  # noqa: F401 (before its modules)
import numpy
import Part
import pytest
from matplotlib import image

import trimquad
from trimquad import cli
from trimquad.texture import pattern_image, quad_image, write_image

RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.2, 0.8)


def test_the_texture_is_the_grid_map_on_the_triangles(tmp_path):
    result = trimquad.convert(Part.makeSphere(20), trimquad.Options(quads=100, write=["gridmap", "texture"]))
    assert result.write(str(tmp_path)) == ["gridmap.obj", "texture.mtl", "texture.obj", "texture.png"]
    lines = (tmp_path / "texture.obj").read_text().splitlines()
    geometry = [line for line in lines if line.split()[0] in ("v", "vt", "f")]
    assert geometry == [x for x in (tmp_path / "gridmap.obj").read_text().splitlines() if x.split()[0] in ("v", "vt", "f")]
    assert lines[0] == "mtllib texture.mtl"
    name = next(line.split()[1] for line in lines if line.startswith("usemtl "))
    material = (tmp_path / "texture.mtl").read_text().splitlines()
    assert f"newmtl {name}" in material and "map_Kd texture.png" in material


def test_the_textures_picture_fits_on_itself_over_every_seam(tmp_path):
    write_image(str(tmp_path / "texture.png"), quad_image())
    pixels = image.imread(str(tmp_path / "texture.png"))[:, :, :3]
    assert len({tuple(p) for p in pixels.reshape(-1, 3)}) == 3
    assert (pixels == numpy.rot90(pixels)).all()
    assert (pixels[0] == pixels[-1]).all()


def test_textures_of_several_regions_share_a_material_and_go_with_their_result(tmp_path):
    options = trimquad.Options(quads=100, write=["texture", "report"])
    names = trimquad.convert(Part.makeBox(30, 20, 10), options).write(str(tmp_path))
    assert names == ["report.json", *(f"texture-{k}.obj" for k in range(6)), "texture.mtl", "texture.png"]
    options.write = ["report"]
    trimquad.convert(Part.makePlane(30, 20), options).write(str(tmp_path))
    assert [p.name for p in tmp_path.iterdir()] == ["report.json"]


def halves(path):
    """A picture, red above, blue below."""
    pixels = numpy.empty((40, 20, 3))
    pixels[:20], pixels[20:] = RED, BLUE
    image.imsave(str(path), pixels)
    return pixels


def colours_of(path):
    """Parts of a picture that are red and blue rather than anything else."""
    pixels = image.imread(str(path))[:, :, :3]
    red, blue = (pixels[:, :, 0] > 2 * pixels[:, :, 2]).mean(), (pixels[:, :, 2] > 2 * pixels[:, :, 0]).mean()
    return red, blue


def test_a_pattern_of_ones_own_lies_on_every_quad_with_its_top_at_v_1(tmp_path):
    halves(tmp_path / "halves.png")
    Part.makePlane(30, 20).exportBrep(str(tmp_path / "plane.brep"))
    out = tmp_path / "out"
    status = cli.main(["convert", str(tmp_path / "plane.brep"), "--out", str(out), "--edge-length", "5", "--quiet",
                       "--pattern", str(tmp_path / "halves.png"), "--write", "texture,pictures"])
    assert status == 0
    assert (image.imread(str(out / "texture.png")) == image.imread(str(tmp_path / "halves.png"))).all()
    red, blue = colours_of(out / "textured.png")
    assert red > 0.1 and blue > 0.1 and abs(red - blue) < 0.02


def test_a_quad_is_painted_as_its_picture(tmp_path):
    from trimquad.pictures import view_axes
    from trimquad.textured_picture import write_textured

    right, up, _ = view_axes().T
    square = numpy.array([0 * right, right, right + up, up])
    triangles = numpy.array([[0, 1, 2], [0, 2, 3]])
    uv = numpy.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)[triangles]
    write_textured([(square[triangles], uv)], halves(tmp_path / "halves.png"), str(tmp_path / "seen.png"))
    pixels = image.imread(str(tmp_path / "seen.png"))[:, :, :3]
    painted = numpy.flatnonzero((pixels.min(axis=2) < 0.9).any(axis=1))
    middle = pixels.shape[1] // 2
    top, bottom = pixels[painted[0] + 20, middle], pixels[painted[-1] - 20, middle]
    assert top[0] > 2 * top[2] and bottom[2] > 2 * bottom[0]


def test_what_hides_a_surface_hides_its_pattern(tmp_path):
    from trimquad.pictures import view_axes
    from trimquad.textured_picture import write_textured

    right, up, towards = view_axes().T
    square = numpy.array([0 * right, right, right + up, up])[numpy.array([[0, 1, 2], [0, 2, 3]])]
    uv = numpy.full((2, 3, 2), 0.25)
    red, blue = numpy.full((1, 1, 3), RED), numpy.array([[RED, BLUE]])
    behind = (square, uv + (0.5, 0))  # blue
    write_textured([behind, (square + towards, uv)], blue, str(tmp_path / "near_last.png"))
    write_textured([(square + towards, uv), behind], blue, str(tmp_path / "near_first.png"))
    write_textured([(square, uv)], red, str(tmp_path / "alone.png"))
    for name in ("near_last", "near_first"):
        assert numpy.allclose(colours_of(tmp_path / f"{name}.png"), colours_of(tmp_path / "alone.png"), atol=5e-3)


def test_patterns_may_be_grey_or_transparent(tmp_path):
    image.imsave(str(tmp_path / "rgba.png"), numpy.array([[[1, 0, 0, 0.0], [1, 0, 0, 1.0]]]))
    assert pattern_image(str(tmp_path / "rgba.png")).tolist() == [[[1, 1, 1], [1, 0, 0]]]
    from PIL import Image

    Image.new("L", (3, 2), 51).save(str(tmp_path / "grey.png"))
    assert numpy.allclose(pattern_image(str(tmp_path / "grey.png")), numpy.full((2, 3, 3), 0.2))


@pytest.mark.parametrize(
    "name, content, words",
    [("none.png", None, "No such file"), ("text.png", b"no picture", "cannot be read as a picture"),
     ("cut.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "cannot be read as a picture"), ("folder", "", "folder")],
)
def test_patterns_that_are_no_pictures_are_refused_with_one_line(tmp_path, capsys, name, content, words):
    path = tmp_path / name
    if content == "":
        path.mkdir()
    elif content is not None:
        path.write_bytes(content)
    status = cli.main(["convert", "part.step", "--out", str(tmp_path / "out"), "--pattern", str(path), "--write", "texture"])
    (line,) = capsys.readouterr().err.splitlines()
    assert status == 2 and str(path) in line and words in line
    assert not (tmp_path / "out").exists()


def test_a_report_names_patterns_and_fields_that_were_given_as_paths(tmp_path):
    halves(tmp_path / "halves.png")
    (tmp_path / "field.txt").write_text("0 0 0 1 0 0\n")
    options = trimquad.Options(quads=20, pattern=tmp_path / "halves.png", field=tmp_path / "field.txt",
                               write=["texture", "report"])
    trimquad.convert(Part.makePlane(30, 20), options).write(str(tmp_path / "out"))
    written = json.loads((tmp_path / "out" / "report.json").read_text())["options"]
    assert written["pattern"] == str(tmp_path / "halves.png") and written["field"] == str(tmp_path / "field.txt")


def test_a_pattern_without_a_texture_is_refused(capsys, tmp_path):
    assert cli.main(["convert", "part.step", "--out", str(tmp_path), "--pattern", "a.png"]) == 2
    assert "--write texture is missing" in capsys.readouterr().err
