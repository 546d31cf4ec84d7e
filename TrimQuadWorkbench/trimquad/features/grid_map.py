"""GridMap: the grid of the map that a SplineShell's quads were made from, and its singular vertices."""
import FreeCAD
import numpy

from ..error import Error
from ..grid_lines import grid_lines
from .spline_shell import result_of

PROPERTIES = (
    ("App::PropertyLink", "Shell", "Source", "The B-spline faces whose source and options this map shares", None),
    ("App::PropertyVectorList", "CheckerCorners", "Map", "Corners of the triangles, three by three", []),
    ("App::PropertyVectorList", "CheckerImages", "Map", "Their places in the plane of the map, in quads", []),
    ("App::PropertyVectorList", "GridLines", "Map", "Ends of the pieces of grid lines, two by two", []),
    ("App::PropertyVectorList", "AlignedEdges", "Map", "Ends of the aligned edges, two by two", []),
    ("App::PropertyVectorList", "SingularPoints", "Map", "Where other than four quads meet", []),
    ("App::PropertyIntegerList", "SingularIndices", "Map", "Their indices in quarter turns: 4 less the quads there", []),
    ("App::PropertyInteger", "Singularities", "Result", "How many singular vertices the map has", 0),
)
HIDDEN = ("CheckerCorners", "CheckerImages", "GridLines", "AlignedEdges", "SingularPoints", "SingularIndices")


class GridMap:
    """Proxy of an App::FeaturePython. All data are in properties; the view draws them."""

    TYPE = "TrimQuad::GridMap"

    def __init__(self, obj):
        self.Type = self.TYPE
        obj.Proxy = self
        self.ensure_properties(obj)

    def ensure_properties(self, obj):
        for kind, name, group, about, value in PROPERTIES:
            if not hasattr(obj, name):
                obj.addProperty(kind, name, group, about)
                if value is not None:
                    setattr(obj, name, value)
        for name in HIDDEN:
            obj.setEditorMode(name, 2)
        obj.setEditorMode("Singularities", 1)

    def onDocumentRestored(self, obj):
        self.ensure_properties(obj)

    def execute(self, obj):
        if obj.Shell is None:
            raise RuntimeError("the map has no B-spline faces that it belongs to; set Shell")
        try:
            result = result_of(obj.Shell)
        except Error as error:
            raise RuntimeError(str(error)) from None
        fill(obj, result.regions)

    def dumps(self):
        return {"type": self.Type}

    def loads(self, state):
        self.Type = (state or {}).get("type", self.TYPE)

    # FreeCAD 0.20 and 0.21 know these names only.
    __getstate__, __setstate__ = dumps, loads


def fill(obj, regions):
    """Set the properties of a GridMap from RegionResults."""
    corners, images, lines, aligned, singular = [], [], [], [], []
    for item in regions:
        if item.map is not None:
            corners += _vectors(item.map.points[item.map.triangles])
            images += _vectors(numpy.pad(item.map.uv.reshape(-1, 2), ((0, 0), (0, 1))))
            lines += _vectors(grid_lines(item.map.points, item.map.triangles, item.map.uv))
        aligned += _vectors(item.region.points[item.region.aligned])
        singular += item.singularities
    obj.CheckerCorners = corners
    obj.CheckerImages = images
    obj.GridLines = lines
    obj.AlignedEdges = aligned
    obj.SingularPoints = [FreeCAD.Vector(*s.position) for s in singular]
    obj.SingularIndices = [s.index for s in singular]
    obj.Singularities = len(singular)


def _vectors(segments):
    return [FreeCAD.Vector(*p) for p in segments.reshape(-1, 3).tolist()]
