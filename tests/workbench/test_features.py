"""Document objects without a GUI: made, recomputed, saved, reopened, undone."""
import pytest

from trimquad.features import make


@pytest.fixture
def made(document, sheet):
    source = document.addObject("Part::Feature", "Sheet")
    source.Shape = sheet
    document.openTransaction("Trimmed quads and B-splines")
    shell = make(document, source, Quads=80)
    document.commitTransaction()
    return source, shell, document.getObject("QuadMesh")


def test_making_them_gives_a_valid_shell_and_its_quads(made, sheet):
    _, shell, quads = made
    assert shell.isValid() and quads.isValid()
    assert shell.Shape.isValid()
    assert shell.Shape.Area == pytest.approx(sheet.Area, rel=2e-3)
    assert 40 < quads.FullQuads < 120
    assert quads.Mesh.Area == pytest.approx(sheet.Area, rel=5e-2)
    assert quads.Shell is shell
    assert 0 < shell.Deviation.Value < 0.1
    assert shell.FailedRegions == []


def test_the_map_has_its_grid_lines_on_the_surface(document, made, sheet):
    grid = document.GridMap
    assert grid.isValid() and grid.Shell is made[1]
    assert len(grid.GridLines) % 2 == 0 and len(grid.GridLines) > 500
    assert grid.Singularities == len(grid.SingularPoints) == len(grid.SingularIndices) == 0
    assert max(sheet.distToShape(_vertex(p))[0] for p in grid.GridLines[::97]) < 0.2
    # Every quad has two lines through it, so that lines are about twice as long as all quads' edges.
    length = sum(a.distanceToPoint(b) for a, b in zip(grid.GridLines[::2], grid.GridLines[1::2]))
    assert length == pytest.approx(2 * sheet.Area / (sheet.Area / 80) ** 0.5, rel=0.2)


def _vertex(point):
    import Part

    return Part.Vertex(point)


def test_a_change_of_the_source_is_followed(document, made, sheet):
    source, shell, quads = made
    bigger = sheet.copy()
    bigger.scale(2)
    source.Shape = bigger
    document.recompute()
    assert shell.Shape.Area == pytest.approx(4 * sheet.Area, rel=2e-3)
    assert quads.Mesh.Area == pytest.approx(4 * sheet.Area, rel=5e-2)


def test_a_change_of_an_option_is_followed(document, made):
    _, shell, quads = made
    before = quads.FullQuads
    shell.Quads = 320
    document.recompute()
    assert quads.FullQuads > 2.5 * before


def test_an_unusable_option_marks_the_object_and_keeps_its_shape(document, made):
    _, shell, _ = made
    area = shell.Shape.Area
    shell.Degree = 9
    document.recompute()
    assert not shell.isValid()
    assert shell.Shape.Area == area
    shell.Degree = 3
    document.recompute()
    assert shell.isValid()


def test_saved_and_reopened_they_are_the_same_and_still_follow_their_source(document, made, sheet, tmp_path):
    import FreeCAD

    _, shell, quads = made
    area, facets = shell.Shape.Area, quads.Mesh.CountFacets
    path = str(tmp_path / "part.FCStd")
    document.saveAs(path)
    FreeCAD.closeDocument(document.Name)
    again = FreeCAD.openDocument(path)
    try:
        shell, quads = again.SplineShell, again.QuadMesh
        assert (shell.Proxy.Type, quads.Proxy.Type) == ("TrimQuad::SplineShell", "TrimQuad::QuadMesh")
        assert shell.Shape.Area == pytest.approx(area, rel=1e-9)
        assert quads.Mesh.CountFacets == facets
        bigger = sheet.copy()
        bigger.scale(2)
        again.Sheet.Shape = bigger
        again.recompute()
        assert shell.Shape.Area == pytest.approx(4 * area, rel=2e-3)
    finally:
        FreeCAD.closeDocument(again.Name)


def test_undo_takes_them_away_in_one_step_and_redo_brings_them_back(document, made):
    area = document.SplineShell.Shape.Area
    document.undo()
    assert [o.Name for o in document.Objects] == ["Sheet"]
    document.redo()
    assert sorted(o.Name for o in document.Objects) == ["GridMap", "QuadMesh", "Sheet", "SplineShell"]
    assert document.SplineShell.Shape.Area == area


def test_one_face_of_a_solid(document):
    box = document.addObject("Part::Box", "Box")
    document.recompute()
    shell = make(document, box, ["Face6"], Quads=30)
    assert shell.Shape.Area == pytest.approx(box.Shape.Face6.Area, rel=1e-6)


def test_a_mesh_object_is_a_source_too(document, sheet):
    import Mesh

    points, triangles = sheet.tessellate(0.2)
    scan = document.addObject("Mesh::Feature", "Scan")
    scan.Mesh = Mesh.Mesh([[points[i] for i in t] for t in triangles])
    shell = make(document, scan, Quads=80, RelativeTolerance=5e-3)
    assert shell.Shape.Area == pytest.approx(sheet.Area, rel=2e-2)
