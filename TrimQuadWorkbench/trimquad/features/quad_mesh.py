"""QuadMesh: the trimmed quads that a SplineShell's faces were made on."""
import FreeCAD
import Mesh

from ..error import Error
from .spline_shell import result_of

PROPERTIES = (
    ("App::PropertyLink", "Shell", "Source", "The B-spline faces whose source and options these quads share", None),
    ("App::PropertyVectorList", "Points", "Quads", "Vertices of the polygons", []),
    ("App::PropertyIntegerList", "Polygons", "Quads", "Per polygon: number of corners, then point numbers from 0", []),
    ("App::PropertyInteger", "FullQuads", "Result", "Whole quads", 0),
    ("App::PropertyInteger", "TrimmedCells", "Result", "Cells cut by the boundary", 0),
)


class QuadMesh:
    """Proxy of a Mesh::FeaturePython. `Mesh` holds triangles of the polygons; the view draws the polygons' edges."""

    TYPE = "TrimQuad::QuadMesh"

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
        for name in ("Points", "Polygons"):
            obj.setEditorMode(name, 2)
        for name in ("FullQuads", "TrimmedCells"):
            obj.setEditorMode(name, 1)

    def onDocumentRestored(self, obj):
        self.ensure_properties(obj)

    def execute(self, obj):
        if obj.Shell is None:
            raise RuntimeError("the quads have no B-spline faces that they belong to; set Shell")
        try:
            result = result_of(obj.Shell)
        except Error as error:
            raise RuntimeError(str(error)) from None
        fill(obj, [r.polygons for r in result.regions if r.quads is not None])

    def dumps(self):
        return {"type": self.Type}

    def loads(self, state):
        self.Type = (state or {}).get("type", self.TYPE)

    # FreeCAD 0.20 and 0.21 know these names only.
    __getstate__, __setstate__ = dumps, loads


def fill(obj, parts):
    """Set the properties of a QuadMesh from the Polygons of each region."""
    points, polygons, facets, full, trimmed = [], [], [], 0, 0
    for part in parts:
        first = len(points)
        places = [FreeCAD.Vector(*p) for p in part.points.tolist()]
        points += places
        for polygon in part.full + part.trimmed:
            polygons += [len(polygon), *(first + i for i in polygon)]
        facets += [[places[i] for i in triangle] for triangle in part.triangles()]
        full += len(part.full)
        trimmed += len(part.trimmed)
    obj.Points = points
    obj.Polygons = polygons
    obj.FullQuads = full
    obj.TrimmedCells = trimmed
    obj.Mesh = Mesh.Mesh(facets)


def polygons_of(obj):
    """The polygons of a QuadMesh as lists of point numbers."""
    flat, polygons, i = obj.Polygons, [], 0
    while i < len(flat):
        polygons.append(flat[i + 1 : i + 1 + flat[i]])
        i += 1 + flat[i]
    return polygons


