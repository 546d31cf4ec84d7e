"""Document objects; importable without a GUI.

    import trimquad.features
    shell = trimquad.features.make(document, document.Box, ["Face1"], EdgeLength=5)
"""
from .quad_mesh import QuadMesh
from .spline_shell import SplineShell


def make(document, source, faces=(), **properties):
    """Add the B-spline faces and the quads of `source` (an object with a shape or a mesh) to its document.

    faces        names such as 'Face3'; all where empty
    properties   of the SplineShell: EdgeLength, Quads, Tolerance, RelativeTolerance, Degree, FeatureAngle, Features

    Returns the SplineShell, computed; its quads depend on it. In a GUI the source is hidden behind the result.
    """
    shell = document.addObject("Part::FeaturePython", "SplineShell")
    SplineShell(shell)
    shell.Label = f"{source.Label} B-splines"
    shell.Source = (source, list(faces))
    for name, value in properties.items():
        setattr(shell, name, value)
    quads = document.addObject("Mesh::FeaturePython", "QuadMesh")
    QuadMesh(quads)
    quads.Label = f"{source.Label} quads"
    quads.Shell = shell
    import FreeCAD

    if FreeCAD.GuiUp:
        from ..gui import view_providers

        view_providers.SplineShellView(shell.ViewObject)
        view_providers.QuadMeshView(quads.ViewObject)
        source.ViewObject.Visibility = False
    document.recompute([shell, quads])
    return shell
