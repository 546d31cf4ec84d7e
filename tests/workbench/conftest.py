import os
import sys

import pytest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(ROOT, "TrimQuadWorkbench"), os.path.dirname(__file__)]
if not any(os.path.exists(os.path.join(p, "FreeCAD.so")) for p in sys.path):
    sys.path.append("/usr/lib/freecad-python3/lib")

EXAMPLES = ("hood", "tube", "sheet", "box_with_fillets")


def pytest_addoption(parser):
    parser.addoption("--data", help="folder of further CAD and mesh files that must convert or be refused cleanly")


def pytest_generate_tests(metafunc):
    if "data_file" in metafunc.fixturenames:
        folder = metafunc.config.getoption("--data")
        names = sorted(os.listdir(folder)) if folder else []
        files = [os.path.join(folder, n) for n in names if os.path.isfile(os.path.join(folder, n))]
        metafunc.parametrize("data_file", files, ids=[os.path.basename(f) for f in files])


@pytest.fixture(scope="session")
def example_path():
    return lambda name: os.path.join(ROOT, "examples", name + ".step")


@pytest.fixture(scope="session")
def converted(example_path, tmp_path_factory):
    """Result and output folder of an example, converted once."""
    import trimquad

    done = {}

    def convert(name):
        if name not in done:
            options = trimquad.Options(quads=400, write=["seamless", "gridmap", "quads", "nurbs", "report"])
            result = trimquad.convert(example_path(name), options)
            out = tmp_path_factory.mktemp(name)
            result.write(str(out))
            done[name] = (result, out)
        return done[name]

    return convert


@pytest.fixture
def sheet():
    """A small wavy Part face: quick to convert."""
    return wavy_face()


def wavy_face(size=60.0, height=2.0):
    import math

    import FreeCAD
    import Part

    surface = Part.BSplineSurface()
    steps = [size * i / 6 for i in range(7)]
    surface.interpolate(
        [[FreeCAD.Vector(x, y, height * math.sin(4 * x / size) * math.cos(3 * y / size)) for y in steps] for x in steps]
    )
    return surface.toShape()


@pytest.fixture
def document():
    import FreeCAD

    document = FreeCAD.newDocument()
    document.UndoMode = 1
    name = document.Name
    yield document
    if name in FreeCAD.listDocuments():
        FreeCAD.closeDocument(name)
