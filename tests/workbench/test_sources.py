"""The same surface given as file, shape, faces, document, mesh and arrays."""
import pytest

import trimquad

FEW = dict(quads=80)


def area(result):
    return result.shape.Area


@pytest.mark.parametrize("suffix", ["step", "stp", "iges", "brep"])
def test_cad_files(sheet, tmp_path, suffix):
    path = str(tmp_path / f"sheet.{suffix}")
    {"brep": sheet.exportBrep, "iges": sheet.exportIges}.get(suffix, sheet.exportStep)(path)
    assert area(trimquad.convert(path, trimquad.Options(**FEW))) == pytest.approx(sheet.Area, rel=2e-3)


def test_a_shape_and_a_list_of_faces(sheet):
    assert area(trimquad.convert(sheet, trimquad.Options(**FEW))) == pytest.approx(sheet.Area, rel=2e-3)
    assert area(trimquad.convert(sheet.Faces, trimquad.Options(**FEW))) == pytest.approx(sheet.Area, rel=2e-3)


def test_a_placed_shape_stays_where_it_is(sheet):
    import FreeCAD

    sheet.Placement = FreeCAD.Placement(FreeCAD.Vector(100, 20, 3), FreeCAD.Rotation(FreeCAD.Vector(1, 1, 0), 40))
    made = trimquad.convert(sheet, trimquad.Options(**FEW)).shape
    assert made.Faces[0].CenterOfMass.distanceToPoint(sheet.Faces[0].CenterOfMass) < 0.1


def test_a_mesh_and_its_arrays(sheet):
    import Mesh

    points, triangles = sheet.tessellate(0.2)
    flat = [tuple(p) for p in points]
    from_arrays = trimquad.convert((flat, triangles), trimquad.Options(relative_tolerance=5e-3, **FEW))
    mesh = Mesh.Mesh([[points[i] for i in t] for t in triangles])
    from_mesh = trimquad.convert(mesh, trimquad.Options(relative_tolerance=5e-3, **FEW))
    assert area(from_arrays) == pytest.approx(sheet.Area, rel=2e-2)
    assert area(from_mesh) == pytest.approx(sheet.Area, rel=2e-2)
    assert from_mesh.report["input"]["kind"] == "mesh"


def test_mesh_files(sheet, tmp_path):
    import Mesh

    points, triangles = sheet.tessellate(0.2)
    mesh = Mesh.Mesh([[points[i] for i in t] for t in triangles])
    for suffix in ("obj", "off", "ply", "stl"):
        path = str(tmp_path / f"sheet.{suffix}")
        mesh.write(path)
        result = trimquad.convert(path, trimquad.Options(relative_tolerance=5e-3, **FEW))
        assert result.failed == []
        assert len(result.regions) == 1


def test_a_document_gives_its_final_visible_shapes(document, tmp_path):
    import FreeCAD

    big, small = document.addObject("Part::Box", "Big"), document.addObject("Part::Cylinder", "Small")
    cut = document.addObject("Part::Cut", "Cut")
    cut.Base, cut.Tool = big, small
    hidden = document.addObject("Part::Sphere", "Hidden")
    hidden.Visibility = False
    document.recompute()
    expected = cut.Shape.Area
    path = str(tmp_path / "part.FCStd")
    document.saveAs(path)
    FreeCAD.closeDocument(document.Name)
    result = trimquad.convert(path, trimquad.Options(quads=100))
    assert sum(r.region.area for r in result.regions) == pytest.approx(expected, rel=2e-2)
    assert result.report["input"]["kind"] == "cad"
    assert FreeCAD.listDocuments() == {}


def test_a_document_with_only_a_mesh_gives_the_mesh(document, sheet, tmp_path):
    import FreeCAD
    import Mesh

    points, triangles = sheet.tessellate(0.2)
    item = document.addObject("Mesh::Feature", "Scan")
    item.Mesh = Mesh.Mesh([[points[i] for i in t] for t in triangles])
    path = str(tmp_path / "scan.FCStd")
    document.saveAs(path)
    FreeCAD.closeDocument(document.Name)
    result = trimquad.convert(path, trimquad.Options(relative_tolerance=5e-3, **FEW))
    assert result.report["input"]["kind"] == "mesh"
    assert result.failed == []
