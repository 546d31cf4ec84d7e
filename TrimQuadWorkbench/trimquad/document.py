"""A result as a FreeCAD document."""
from .error import input_error


def write_document(result, path):
    """Save the B-spline faces, the quads (also as a mesh for finite elements) and the map of a Result as .FCStd. Needs FreeCAD's modules; raises Error(input)."""
    try:
        import FreeCAD
        import Mesh  # noqa: F401
        import Part  # noqa: F401
    except ImportError as error:
        raise input_error("write", f"--write fcstd needs FreeCAD's Python modules on the path ({error})") from None
    from .features import grid_map
    from .features.quad_mesh import QuadMesh, fill

    document = FreeCAD.newDocument("TrimQuad", hidden=True)
    try:
        if result.native_shape is not None:
            document.addObject("Part::Feature", "BSplines").Shape = result.shape
        parts = [r.polygons for r in result.regions if r.quads is not None]
        if parts:
            quads = document.addObject("Mesh::FeaturePython", "QuadMesh")
            QuadMesh(quads)
            fill(quads, parts)
            quads.purgeTouched()
            _add_fem_mesh(document, parts)
        if any(r.map is not None for r in result.regions):
            grid = document.addObject("App::FeaturePython", "GridMap")
            grid_map.GridMap(grid)
            grid_map.fill(grid, result.regions)
            grid.purgeTouched()
        document.saveAs(path)
    finally:
        FreeCAD.closeDocument(document.Name)


def _add_fem_mesh(document, parts):
    """Where FreeCAD has its Fem module."""
    try:
        import Fem  # noqa: F401
    except ImportError:
        return
    from .fem_mesh import fem_mesh

    document.addObject("Fem::FemMeshObject", "FemMesh").FemMesh = fem_mesh(parts)
