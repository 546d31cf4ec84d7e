"""TrimQuad: CAD faces and triangle meshes to trimmed quad meshes and trimmed B-spline faces.

    import trimquad
    result = trimquad.convert("hood.step", trimquad.Options(edge_length=40))
    result.write("out")

Importable without a GUI. The compiled stages are loaded on first use, so that the FreeCAD add-on can start and say
what is missing where they have not been built.
"""
from .error import Error
from .options import Options

__all__ = ["Error", "Options", "Progress", "Result", "convert"]
__version__ = "0.1.0"


def __getattr__(name):
    if name in ("convert", "Result"):
        from . import convert as module

        globals()["convert"], globals()["Result"] = module.convert, module.Result
        return globals()[name]
    if name == "Progress":
        from .progress import Progress

        return Progress
    raise AttributeError(f"module 'trimquad' has no attribute '{name}'")
