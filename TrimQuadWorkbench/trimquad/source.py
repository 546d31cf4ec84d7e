"""What a conversion starts from: a file, FreeCAD's shapes and meshes, or arrays."""
import os
import zipfile

from .error import input_error, system_error
from .freecad_shape import shape_to_bytes
from .native import load

CAD_KINDS = (".step", ".stp", ".iges", ".igs", ".brep", ".brp")
MESH_KINDS = (".obj", ".off", ".ply", ".stl")


class Source:
    """An input that is not read yet.

    Made on the thread that owns the FreeCAD objects: they are copied into bytes at once, so that another thread may
    work on them.

    path   the file, or what the input is called
    kind   'cad' or 'mesh'; for .FCStd known after `read`
    """

    def __init__(self, thing, faces=None):
        """
        thing  a path; a Part.Shape; a list of Part shapes; a Mesh.Mesh; or a pair (points, triangles) of arrays of
               shapes (n, 3) and (m, 3)
        faces  convert only these of the shape, as names ('Face3') or numbers from 1
        """
        self.path = None
        self.faces = [_face_number(f) for f in faces] if faces else None
        self._read = self._reader(thing)

    def read(self):
        """The native shape or triangle soup."""
        try:
            thing = self._read()
        except (OSError, MemoryError) as error:
            raise system_error("read", error, self.path or "") from None
        if self.faces:
            thing = thing.sub_shape(self.faces)
        return thing

    def content(self):
        """Bytes that are equal exactly where the inputs are; only for FreeCAD's objects and arrays."""
        return self.data

    def _reader(self, thing):
        if isinstance(thing, (str, os.PathLike)):
            return self._file_reader(os.fspath(thing))
        self.path = "selection" if self.faces else "shape"
        if hasattr(thing, "exportBinary"):
            return self._shape_reader(thing)
        if hasattr(thing, "Topology"):
            points, triangles = thing.Topology
            return self._mesh_reader([tuple(p) for p in points], triangles)
        if isinstance(thing, (list, tuple)) and thing and all(hasattr(x, "exportBinary") for x in thing):
            return self._shape_reader(_joined(thing))
        if isinstance(thing, (list, tuple)) and len(thing) == 2:
            return self._mesh_reader(*thing)
        raise input_error(
            "read",
            f"cannot convert a {type(thing).__name__}; give a path, a Part.Shape, a list of faces, a Mesh.Mesh, or "
            "(points, triangles)",
        )

    def _file_reader(self, path):
        self.path = path
        suffix = os.path.splitext(path)[1].lower()
        if suffix in CAD_KINDS:
            self.kind = "cad"
            return lambda: load().read_shape(path)
        if suffix in MESH_KINDS:
            self.kind = "mesh"
            return lambda: load().read_mesh(path)
        if suffix == ".fcstd":
            self.kind = "cad"
            return lambda: self._read_document(path)
        known = " ".join((*CAD_KINDS, ".FCStd", *MESH_KINDS))
        raise input_error("read", f"{path}: not a kind of file that can be read, which are {known}")

    def _shape_reader(self, shape):
        self.kind = "cad"
        if shape.isNull():
            raise input_error("read", "the shape is null; recompute the object that it comes from")
        if not shape.Faces:
            raise input_error("read", f"the shape has no faces, it is a {shape.ShapeType}")
        self.data = shape_to_bytes(shape)
        return lambda: load().shape_from_freecad(self.data)

    def _mesh_reader(self, points, triangles):
        import numpy

        self.kind = "mesh"
        try:
            points = numpy.ascontiguousarray(points, dtype=float).reshape(-1, 3)
            triangles = numpy.ascontiguousarray(triangles, dtype=numpy.int32).reshape(-1, 3)
        except (TypeError, ValueError) as error:
            raise input_error("read", f"points and triangles must be arrays of three columns: {error}") from None
        self.data = points.tobytes() + triangles.tobytes()
        return lambda: load().mesh_from_arrays(points, triangles)

    def _read_document(self, path):
        shapes, meshes = _document_contents(path)
        if shapes:
            return self._shape_reader(_joined(shapes))()
        if meshes:
            points, triangles = [], []
            for mesh_points, mesh_triangles in meshes:
                triangles += [tuple(i + len(points) for i in t) for t in mesh_triangles]
                points += [tuple(p) for p in mesh_points]
            return self._mesh_reader(points, triangles)()
        raise input_error("read", f"{path}: no object in it has a face; save the document with its shapes")


def _face_number(face):
    text = str(face)
    number = text[4:] if text.startswith("Face") else text
    if not number.isdigit() or int(number) < 1:
        raise input_error("read", f"'{face}' is not the name of a face, such as Face3")
    return int(number)


def _joined(shapes):
    if len(shapes) == 1:
        return shapes[0]
    import FreeCAD  # noqa: F401  (Part does not work without it)
    import Part

    return Part.makeCompound(list(shapes))


def _document_contents(path):
    """Shapes and mesh topologies of a document's final objects: those that no other object with a shape is made of,
    and of these the visible ones where any is visible."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            damaged = archive.testzip()
    except (zipfile.BadZipFile, EOFError) as error:
        raise input_error("read", f"{path}: not a FreeCAD document, or a truncated one ({error})") from None
    if damaged or "Document.xml" not in names:
        raise input_error("read", f"{path}: a damaged FreeCAD document ({damaged or 'no Document.xml'})")
    try:
        import FreeCAD
        import Part  # noqa: F401  (registers the shape properties)
    except ImportError as error:
        raise input_error(
            "read", f"{path}: reading a FreeCAD document needs FreeCAD's Python modules on the path ({error})"
        ) from None
    document = next((d for d in FreeCAD.listDocuments().values() if d.FileName == os.path.abspath(path)), None)
    opened = document is None
    if opened:
        for kind in ("Wrn", "Err", "Msg", "Log"):
            FreeCAD.Console.SetStatus("Console", kind, False)
        try:
            document = FreeCAD.openDocument(path, True)
        except Exception as error:
            raise input_error("read", f"{path}: FreeCAD cannot open it: {' '.join(str(error).split())}") from None
    try:
        solid = [o for o in document.Objects if _has_faces(o)]
        solid = [o for o in solid if not any(_made_of(user, o) for user in solid)]
        solid = [o for o in solid if o.Visibility] or solid
        meshes = [o for o in document.Objects if o.isDerivedFrom("Mesh::Feature") and o.Mesh.CountFacets]
        meshes = [o for o in meshes if o.Visibility] or meshes
        return [_placed_shape(o) for o in solid], [o.Mesh.Topology for o in meshes]
    finally:
        if opened:
            FreeCAD.closeDocument(document.Name)


def _has_faces(item):
    shape = getattr(item, "Shape", None)
    return shape is not None and hasattr(shape, "Faces") and not shape.isNull() and bool(shape.Faces)


def _made_of(user, item):
    return user is not item and item in user.OutListRecursive


def _placed_shape(item):
    shape = item.Shape.copy()
    if hasattr(item, "getGlobalPlacement") and hasattr(item, "Placement"):
        container = item.getGlobalPlacement().multiply(item.Placement.inverse())
        shape.Placement = container.multiply(shape.Placement)
    return shape
