"""Loads the compiled stages and says clearly why they cannot be loaded."""
import os
import sys

from .error import input_error

# The program that checks shapes for the compiled module, in processes of its own.
CHECKER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "_checker")

_module = None


def load():
    """The compiled module. Raises Error(input) where it is missing or made for another OpenCASCADE than FreeCAD's."""
    global _module
    if _module is None:
        try:
            from . import _native
        except ImportError as error:
            raise input_error(
                "setup",
                "the compiled part of TrimQuad cannot be loaded; run scripts/trimquad --version once in its folder "
                f"to build it for this Python ({error})",
            ) from None
        part = sys.modules.get("Part")
        if part is not None and part.OCC_VERSION != _native.occ_version:
            raise input_error(
                "setup",
                f"TrimQuad was built with OpenCASCADE {_native.occ_version}, FreeCAD with {part.OCC_VERSION}; "
                "rebuild it against FreeCAD's OpenCASCADE",
            )
        _module = _native
    return _module
