"""SplineShell: an object's faces rebuilt as trimmed B-spline faces."""
from ..deviation import face_deviations
from ..error import Error
from ..options import Options
from . import conversion

PROPERTIES = (
    ("App::PropertyLinkSub", "Source", "Source", "The object, or the faces of it, that is converted", None),
    ("App::PropertyLength", "EdgeLength", "Quads", "Length of a quad's edge; 0: from the number of quads", 0.0),
    ("App::PropertyInteger", "Quads", "Quads", "About how many quads, where no edge length is given", 1000),
    ("App::PropertyAngle", "FeatureAngle", "Quads", "Edges sharper than this separate surfaces", 30.0),
    ("App::PropertyEnumeration", "Features", "Quads", "What sharp edges do; automatic: trim for CAD, align for meshes",
     ["automatic", "trim", "align", "ignore"]),
    ("App::PropertyEnumeration", "Boundary", "Quads", "Whether quads follow the boundary", ["free", "aligned"]),
    ("App::PropertyStringList", "Align", "Quads", "Edges that quads follow: Edge3; of meshes loop:2, angle:30-90", []),
    ("App::PropertyStringList", "Free", "Quads", "Edges that quads need not follow", []),
    ("App::PropertyStringList", "FeaturePoints", "Quads", "Points that become vertices: Vertex5 or x,y,z", []),
    ("App::PropertyString", "Field", "Quads", "What the quads follow: curvature, smooth, or a file", "curvature"),
    ("App::PropertyFloat", "FieldWeight", "Quads", "How closely, up to 1; 0: 0.1 for curvature, 1 for a file", 0.0),
    ("App::PropertyLength", "FillHoles", "Quads", "Holes whose boundary is shorter do not disturb the quads; 0: none", 0.0),
    ("App::PropertyFloat", "MergeSlivers", "Quads", "Trimmed cells under this part of a whole one merge; 0: none", 0.0),
    ("App::PropertyBool", "Optimal", "Quads", "Prove that the numbers of quads are the best; slower", False),
    ("App::PropertyLength", "Tolerance", "B-splines", "Largest deviation; 0: from the relative tolerance", 0.0),
    ("App::PropertyFloat", "RelativeTolerance", "B-splines", "Largest deviation as a fraction of the diagonal", 1e-3),
    ("App::PropertyInteger", "Degree", "B-splines", "Degree of the B-splines, 2 to 5", 3),
    ("App::PropertyLength", "Deviation", "Result", "Largest deviation that was measured", 0.0),
    ("App::PropertyFloatList", "FaceDeviations", "Result", "Each face's largest deviation, in the order of the faces", []),
    ("App::PropertyFloat", "AllowedDeviation", "Result", "The tolerance that the faces were made to keep", 0.0),
    ("App::PropertyStringList", "FailedRegions", "Result", "Regions that could not be converted, and why", []),
)
RESULTS = ("Deviation", "FaceDeviations", "AllowedDeviation", "FailedRegions")


class SplineShell:
    """Proxy of a Part::FeaturePython. All data are in properties; `Shape` holds the B-spline faces."""

    TYPE = "TrimQuad::SplineShell"

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
            elif kind == "App::PropertyEnumeration" and value != obj.getEnumerationsOfProperty(name):
                chosen = getattr(obj, name)
                setattr(obj, name, value)  # an earlier version knew fewer
                setattr(obj, name, chosen)
        for name in RESULTS:
            obj.setEditorMode(name, 1)

    def onDocumentRestored(self, obj):
        self.ensure_properties(obj)

    def execute(self, obj):
        try:
            result = result_of(obj)
        except Error as error:
            raise RuntimeError(str(error)) from None
        obj.FailedRegions = [f"{r.name}: {r.error}" for r in result.failed]
        shape = result.shape
        if shape is None:
            raise RuntimeError(obj.FailedRegions[0])
        obj.Shape = shape
        obj.AllowedDeviation = result.options.tolerance
        faces = [face for region in face_deviations(result) for face in region]
        obj.FaceDeviations = [face.max for face in sorted(faces)]
        obj.Deviation = max(r.fitted.max_deviation for r in result.regions if r.fitted is not None)

    def dumps(self):
        return {"type": self.Type}

    def loads(self, state):
        self.Type = (state or {}).get("type", self.TYPE)

    # FreeCAD 0.20 and 0.21 know these names only.
    __getstate__, __setstate__ = dumps, loads


def options_of(obj):
    """The Options that a SplineShell's properties say."""
    edge_length, tolerance = float(obj.EdgeLength), float(obj.Tolerance)
    return Options(
        edge_length=edge_length or None,
        quads=None if edge_length else obj.Quads,
        features=None if obj.Features == "automatic" else obj.Features,
        feature_angle=float(obj.FeatureAngle),
        boundary=obj.Boundary,
        align=list(obj.Align),
        free=list(obj.Free),
        feature_points=list(obj.FeaturePoints),
        field=obj.Field,
        field_weight=float(obj.FieldWeight) or None,
        fill_holes=float(obj.FillHoles),
        merge_slivers=float(obj.MergeSlivers),
        optimal=bool(obj.Optimal),
        tolerance=tolerance or None,
        relative_tolerance=None if tolerance else obj.RelativeTolerance,
        degree=obj.Degree,
    )


def result_of(obj):
    """The Result of a SplineShell. Raises Error."""
    return conversion.result_of(conversion.source_of(obj.Source), options_of(obj))
