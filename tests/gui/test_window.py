"""The add-on in FreeCAD's window: freecad test_window.py COUNTS_FILE. Prints a line a test, writes "PASSED FAILED"."""
import math
import os
import shutil
import sys
import tempfile
import time
import traceback

import FreeCAD
import FreeCADGui
import Part
from PySide import QtCore, QtGui

try:
    from PySide import QtWidgets
except ImportError:  # FreeCAD 0.20
    from PySide import QtGui as QtWidgets

COUNTS_FILE = sys.argv[-1]
TESTS = []
PANELS = []
V = FreeCAD.Vector


def test(function):
    TESTS.append(function)
    return function


def spin(seconds):
    """Let the window work."""
    loop = QtCore.QEventLoop()
    QtCore.QTimer.singleShot(int(1000 * seconds), loop.quit)
    loop.exec_()


def wait_until(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        spin(0.05)


def wavy_face(size=60.0, height=3.0):
    steps = [size * i / 6 for i in range(7)]
    surface = Part.BSplineSurface()
    surface.interpolate(
        [[V(x, y, height * math.sin(4 * x / size) * math.cos(3 * y / size)) for y in steps] for x in steps]
    )
    return surface.toShape()


def new_document(shape):
    document = FreeCAD.newDocument()
    document.UndoMode = 1
    source = document.addObject("Part::Feature", "Source")
    source.Shape = shape
    document.recompute()
    return document, source


def select(source, *names):
    FreeCADGui.Selection.clearSelection()
    for name in names or [""]:
        FreeCADGui.Selection.addSelection(source.Document.Name, source.Name, name)


def record_panels():
    """Every panel that comes up is kept in PANELS."""
    from trimquad.gui.task_panel import ConvertPanel

    original = ConvertPanel.__init__

    def record(self, *arguments):
        original(self, *arguments)
        PANELS.append(self)

    ConvertPanel.__init__ = record


def run_command(**values):
    """Open the panel by the command, fill it in, press OK."""
    FreeCADGui.runCommand("TrimQuad_Convert")
    spin(0.2)
    shown = PANELS[-1]
    for name, value in values.items():
        getattr(shown, name).setValue(value)
    shown.accept()
    return shown


def convert(document, source, *faces, **values):
    select(source, *faces)
    run_command(**values)
    wait_until(lambda: not FreeCADGui.Control.activeDialog())
    return document.SplineShell, document.QuadMesh


@test
def the_workbench_has_its_command_in_menu_and_toolbar():
    FreeCADGui.activateWorkbench("TrimQuadWorkbench")
    spin(0.3)
    assert FreeCADGui.activeWorkbench().MenuText == "TrimQuad"
    assert "TrimQuad_Convert" in FreeCADGui.listCommands()
    window = FreeCADGui.getMainWindow()
    assert any(bar.windowTitle() == "TrimQuad" and bar.actions() for bar in window.findChildren(QtWidgets.QToolBar))
    assert any(action.text().replace("&", "") == "TrimQuad" for action in window.menuBar().actions())


@test
def the_command_converts_the_selected_face_and_leaves_the_view_usable():
    document, source = new_document(Part.makeBox(40, 30, 20))
    ticks = []
    timer = QtCore.QTimer()
    timer.timeout.connect(lambda: ticks.append(1))
    timer.start(10)
    shell, quads = convert(document, source, "Face6", count=60)
    timer.stop()
    assert abs(shell.Shape.Area - 1200) < 1
    assert 30 < quads.FullQuads + quads.TrimmedCells < 120
    assert len(ticks) > 2
    assert not source.ViewObject.Visibility
    assert shell.ViewObject.Proxy.claimChildren() == [quads, document.GridMap]
    assert quads.ViewObject.Proxy.lines.coordIndex.getNum() > 100


@test
def the_grid_map_is_hidden_until_it_is_asked_for_and_its_parts_can_be_switched():
    document, source = new_document(wavy_face())
    convert(document, source, count=80)
    grid = document.GridMap
    view = grid.ViewObject
    assert not view.Visibility
    view.Visibility = True
    spin(0.2)
    assert view.Proxy.grid[1].numVertices.getNum() == len(grid.GridLines) // 2 > 100
    coordinates, images, triangles = view.Proxy.checker
    count = triangles.numVertices.getNum()
    assert 3 * count == coordinates.point.getNum() == images.point.getNum() == len(grid.CheckerImages) > 300
    area = 0.0
    for k in range(0, 3 * count, 3):
        a, b, c = grid.CheckerImages[k : k + 3]
        area += (b - a).cross(c - a).z / 2
    assert 40 < area < 120, "the checker's squares are quads"
    for name, switch in view.Proxy.switches.items():
        shown = name != "ShowGridLines"
        assert getattr(view, name) == shown
        assert switch.whichChild.getValue() == (-3 if shown else -1)  # all, none
        setattr(view, name, True)
        assert switch.whichChild.getValue() == -3
        setattr(view, name, False)
        assert switch.whichChild.getValue() == -1  # none
        setattr(view, name, True)
    folder = tempfile.mkdtemp()
    picture = QtGui.QImage(6, 4, QtGui.QImage.Format_RGB32)
    picture.fill(QtGui.QColor(120, 60, 0))
    assert picture.save(os.path.join(folder, "pattern.png"))
    assert view.Proxy.repeats.scaleFactor.getValue()[0] == 0.5, "the checker is two quads wide"
    view.Pattern = os.path.join(folder, "pattern.png")
    pixels, size, components = view.Proxy.texture.image.getValue()
    assert tuple(size.getValue()) == (6, 4) and components == 3 and pixels[:3] in ("x<\0", b"x<\0")
    assert view.Proxy.repeats.scaleFactor.getValue()[0] == 1
    view.Pattern = ""
    assert view.Proxy.repeats.scaleFactor.getValue()[0] == 0.5
    shutil.rmtree(folder)
    grid.SingularPoints = [FreeCAD.Vector(0, 0, 0), FreeCAD.Vector(1, 0, 0)]
    grid.SingularIndices = [1, -1]
    coordinates, colours, points = view.Proxy.points
    assert points.numPoints.getValue() == coordinates.point.getNum() == colours.rgb.getNum() == 2
    red, blue = colours.rgb[0].getValue(), colours.rgb[1].getValue()
    assert red[0] > red[2] and blue[2] > blue[0]


def coloured_pixels(path):
    """How many pixels of a picture are far from grey."""
    image = QtGui.QImage(path)
    colours = [image.pixelColor(x, y) for x in range(0, 800, 4) for y in range(0, 600, 4)]
    return sum(max(c.red(), c.green(), c.blue()) - min(c.red(), c.green(), c.blue()) > 60 for c in colours)


@test
def faces_are_coloured_by_their_deviation_and_stay_selectable():
    from trimquad.colours import deviation_colour

    document, source = new_document(Part.makeCylinder(10, 20))
    shell, quads = convert(document, source, count=200)
    quads.ViewObject.Visibility = False
    view, count = shell.ViewObject, len(shell.Shape.Faces)
    assert count == len(shell.FaceDeviations) == 3
    assert max(shell.FaceDeviations) == shell.Deviation.Value <= shell.AllowedDeviation
    window = FreeCADGui.ActiveDocument.ActiveView
    window.viewIsometric()
    window.fitAll()
    path = os.path.join(os.path.dirname(COUNTS_FILE), "deviation.png")
    FreeCADGui.Selection.clearSelection()
    spin(0.3)
    window.saveImage(path + ".off.png", 800, 600, "White")
    view.ColourByDeviation = True
    spin(0.3)
    window.saveImage(path, 800, 600, "White")
    assert coloured_pixels(path) > coloured_pixels(path + ".off.png") + 1000

    def shown():
        return [tuple(round(x, 2) for x in c[:3]) for c in view.DiffuseColor]

    def expected():
        return [tuple(round(x, 2) for x in deviation_colour(d / shell.AllowedDeviation)) for d in shell.FaceDeviations]

    assert shown() == expected() and len(set(expected())) > 1
    select(shell, "Face2")
    assert FreeCADGui.Selection.getSelectionEx()[0].SubObjects[0].isSame(shell.Shape.Faces[1])
    view.ShapeColor = (1.0, 0.0, 0.0)
    assert shown() == expected()
    before = list(shell.FaceDeviations)
    shell.RelativeTolerance = 1e-4
    document.recompute()
    assert list(shell.FaceDeviations) != before
    assert shown() == expected()
    view.ColourByDeviation = False
    assert set(shown()) == {(1.0, 0.0, 0.0)}
    view.ColourByDeviation = True
    file = os.path.join(tempfile.mkdtemp(), "part.FCStd")
    document.saveAs(file)
    FreeCAD.closeDocument(document.Name)
    document = FreeCAD.openDocument(file)
    spin(0.3)
    shell = document.SplineShell
    view = shell.ViewObject
    assert view.ColourByDeviation and shown() == expected()


@test
def recomputing_follows_the_source():
    document, source = new_document(wavy_face())
    shell, quads = convert(document, source, count=80)
    area = shell.Shape.Area
    bigger = source.Shape.copy()
    bigger.scale(2)
    source.Shape = bigger
    document.recompute()
    assert abs(shell.Shape.Area / area - 4) < 0.05
    assert abs(quads.Mesh.Area / area - 4) < 0.1


@test
def undo_is_one_step_and_redo_draws_the_quads_again():
    document, source = new_document(wavy_face())
    convert(document, source, count=80)
    document.undo()
    assert [o.Name for o in document.Objects] == ["Source"]
    document.redo()
    spin(0.2)
    assert document.QuadMesh.ViewObject.Proxy.lines.coordIndex.getNum() > 100


@test
def saved_and_reopened_the_quads_are_drawn_and_the_options_can_be_edited():
    document, source = new_document(wavy_face())
    convert(document, source, count=80)
    path = os.path.join(tempfile.mkdtemp(), "part.FCStd")
    document.saveAs(path)
    FreeCAD.closeDocument(document.Name)
    document = FreeCAD.openDocument(path)
    spin(0.3)
    shell, quads = document.SplineShell, document.QuadMesh
    before = quads.FullQuads
    assert quads.ViewObject.Proxy.lines.coordIndex.getNum() > 100
    assert shell.ViewObject.Proxy.claimChildren() == [quads, document.GridMap]
    FreeCADGui.ActiveDocument.setEdit(shell.Name)
    spin(0.2)
    shown = PANELS[-1]
    assert shown.shell is shell and shown.count.value() == 80
    shown.count.setValue(320)
    shown.accept()
    wait_until(lambda: not FreeCADGui.Control.activeDialog())
    assert quads.FullQuads > 2 * before
    document.undo()
    assert quads.FullQuads == before


@test
def cancel_stops_a_long_conversion_and_changes_nothing():
    document, source = new_document(wavy_face(600.0, 20.0))
    select(source)
    shown = run_command(count=60000)
    spin(0.4)
    assert shown.thread is not None
    started = time.monotonic()
    shown.reject()
    wait_until(lambda: shown.thread is None, 20)
    assert time.monotonic() - started < 5
    assert shown.message.text() == "cancelled"
    assert [o.Name for o in document.Objects] == ["Source"]
    shown.reject()
    wait_until(lambda: not FreeCADGui.Control.activeDialog())


@test
def an_unusable_option_is_said_in_the_panel():
    document, source = new_document(wavy_face())
    select(source)
    FreeCADGui.runCommand("TrimQuad_Convert")
    spin(0.2)
    shown = PANELS[-1]
    shown.by_length.setChecked(True)
    shown.length.setValue(1e5)
    shown.accept()
    wait_until(lambda: shown.thread is None)
    assert "larger than the part" in shown.message.text()
    assert [o.Name for o in document.Objects] == ["Source"]
    shown.reject()


@test
def the_view_shows_faces_and_quad_edges():
    document, source = new_document(wavy_face())
    convert(document, source, count=80)
    FreeCADGui.Selection.clearSelection()
    view = FreeCADGui.ActiveDocument.ActiveView
    view.viewIsometric()
    view.fitAll()
    spin(0.5)
    path = os.path.join(os.path.dirname(COUNTS_FILE), "window.png")
    view.saveImage(path, 800, 600, "White")
    image = QtGui.QImage(path)
    colours = {}
    for x in range(0, 800, 4):
        for y in range(0, 600, 4):
            colour = image.pixelColor(x, y)
            key = "white" if min(colour.red(), colour.green(), colour.blue()) > 250 else (
                "line" if colour.red() < 90 and colour.blue() > colour.red() + 15 else "face")
            colours[key] = colours.get(key, 0) + 1
    assert colours.get("face", 0) > 3000, colours
    assert colours.get("line", 0) > 300, colours
    document.QuadMesh.ViewObject.Visibility = False
    spin(0.3)
    view.saveImage(path + ".hidden.png", 800, 600, "White")
    assert QtGui.QImage(path + ".hidden.png") != image


def main():
    record_panels()
    passed = failed = 0
    for function in TESTS:
        name = function.__name__.replace("_", " ")
        try:
            function()
            passed += 1
            print("passed", name, flush=True)
        except BaseException:
            failed += 1
            print("FAILED", name, flush=True)
            print("  " + traceback.format_exc().replace("\n", "\n  "), flush=True)
        finally:
            if FreeCADGui.Control.activeDialog():
                FreeCADGui.Control.closeDialog()
            for name in list(FreeCAD.listDocuments()):
                FreeCAD.closeDocument(name)
    with open(COUNTS_FILE, "w") as stream:
        print(passed, failed, file=stream)
    return 1 if failed else 0


def go():
    try:
        status = main()
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush()
    os._exit(status)  # QApplication.exit would give status 0


QtCore.QTimer.singleShot(1500, go)
