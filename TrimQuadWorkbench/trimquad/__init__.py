"""TrimQuad: CAD faces and triangle meshes to trimmed quad meshes and trimmed B-spline faces.

    import trimquad
    result = trimquad.convert("hood.step", trimquad.Options(edge_length=40))
    result.write("out")

Importable without a GUI. The compiled stages are loaded on first use, so that the FreeCAD add-on can start and say
what is missing where they have not been built.
"""
from .convert import Result, convert
from .error import Error
from .options import Options
from .progress import Progress

__all__ = ["Error", "Options", "Progress", "Result", "convert"]
__version__ = "0.1.0"
