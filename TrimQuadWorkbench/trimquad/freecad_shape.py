"""Shapes between FreeCAD and the compiled stages, as FreeCAD's binary form of BREP: bit exact, no file on disk."""
import os
import tempfile
from contextlib import contextmanager

from .error import input_error


def shape_to_bytes(shape):
    """The bytes of a Part.Shape, placement and orientation included."""
    with _scratch_file() as (handle, name):
        shape.exportBinary(name)
        with open(name, "rb") as stream:
            return stream.read()


def shape_from_bytes(data):
    """The Part.Shape of bytes made by `shape_to_bytes` or by the compiled stages. Raises Error(input)."""
    try:
        import FreeCAD  # noqa: F401  (Part does not work without it)
        import Part
    except ImportError as error:
        raise input_error("shape", f"shapes and their pictures need FreeCAD's Python modules on the path ({error})") from None
    with _scratch_file() as (handle, name):
        with open(name, "wb") as stream:
            stream.write(data)
        shape = Part.Shape()
        shape.importBinary(name)
        return shape


@contextmanager
def _scratch_file():
    """FreeCAD reads and writes this form through named files only; in memory where the system can do that."""
    if hasattr(os, "memfd_create") and os.path.isdir("/proc/self/fd"):
        handle = os.memfd_create("shape")
        try:
            yield handle, f"/proc/self/fd/{handle}"
        finally:
            os.close(handle)
    else:
        handle, name = tempfile.mkstemp(suffix=".bin")
        os.close(handle)
        try:
            yield handle, name
        finally:
            os.unlink(name)
