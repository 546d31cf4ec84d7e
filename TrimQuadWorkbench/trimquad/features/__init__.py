"""Document objects; importable without a GUI.

    import trimquad.features
    shell = trimquad.features.make(document, document.Box, ["Face1"], EdgeLength=5)
"""
from .grid_map import GridMap
from .quad_mesh import QuadMesh
from .spline_shell import SplineShell


def make(document, source, faces=(), **properties):
    """Add the B-spline faces, the quads and the grid map of `source` (an object with a shape or a mesh) to its document.

    faces        names such as 'Face3'; all where empty
    properties   of the SplineShell: EdgeLength, Quads, Tolerance, RelativeTolerance, Degree, FeatureAngle, Features,
                 Boundary, Align, Free, FeaturePoints, Field, FieldWeight, FillHoles, MergeSlivers,
                 Optimal

    Returns the SplineShell, computed; its quads and map depend on it. In a GUI the source is hidden behind the result,
    and the map is hidden until it is asked for.
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
    grid = document.addObject("App::FeaturePython", "GridMap")
    GridMap(grid)
    grid.Label = f"{source.Label} grid map"
    grid.Shell = shell
    import FreeCAD

    if FreeCAD.GuiUp:
        from ..gui import view_providers

        view_providers.SplineShellView(shell.ViewObject)
        view_providers.QuadMeshView(quads.ViewObject)
        view_providers.GridMapView(grid.ViewObject)
        grid.ViewObject.Visibility = False
        source.ViewObject.Visibility = False
    document.recompute([shell, quads, grid])
    return shell
