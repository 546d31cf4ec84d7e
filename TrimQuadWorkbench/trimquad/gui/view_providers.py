"""How SplineShell, QuadMesh and GridMap look in the tree and in the 3D view."""
import FreeCAD
import FreeCADGui
import numpy
from pivy import coin

from ..colours import checker_pixels, deviation_colour, point_colour
from ..error import Error
from ..features.quad_mesh import polygons_of
from ..texture import pattern_image
from . import icon_path

# Line colour and width of the quads' edges.
LINE_COLOUR = (0.05, 0.15, 0.35)
LINE_WIDTH = 1.5
# The triangles of the quads lie in the B-spline faces: pushed back a little, they do not flicker through them, and
# the lines stand out of both.
PUSHED_BACK = 2.0
GRID_COLOUR = (0.20, 0.42, 0.68)
ALIGNED_COLOUR = (0.04, 0.49, 0.24)
ALIGNED_WIDTH = 3.0
CHECKER_PIXELS = 64  # a side of the texture, which is two by two quads
IN_FRONT = 5e-3  # of the depth of the scene; faces and triangles are less apart


class _View:
    def __init__(self, vobj):
        vobj.Proxy = self

    def dumps(self):
        return None

    def loads(self, state):
        return None

    # FreeCAD 0.20 and 0.21 know these names only.
    __getstate__, __setstate__ = dumps, loads


class SplineShellView(_View):
    """Can colour each face by its largest deviation; the faces stay faces, to be selected and measured."""

    def __init__(self, vobj):
        self._ensure_properties(vobj)
        super().__init__(vobj)

    def _ensure_properties(self, vobj):
        if not hasattr(vobj, "ColourByDeviation"):
            vobj.addProperty(
                "App::PropertyBool", "ColourByDeviation", "Deviation",
                "Colour each face by its largest deviation: from blue, none, to yellow, all of the tolerance; red beyond",
            )

    def attach(self, vobj):
        self.Object = vobj.Object
        self._ensure_properties(vobj)

    def updateData(self, obj, name):
        vobj = obj.ViewObject
        if name in ("FaceDeviations", "AllowedDeviation") and getattr(vobj, "ColourByDeviation", False):
            self._colour(vobj)

    def onChanged(self, vobj, name):
        if name == "ColourByDeviation":
            if vobj.ColourByDeviation:
                self._colour(vobj)
            else:
                vobj.DiffuseColor = [vobj.ShapeColor[:3]]
        elif name == "DiffuseColor" and getattr(vobj, "ColourByDeviation", False):
            self._colour(vobj)  # FreeCAD gave all faces the shape's new colour

    def _colour(self, vobj):
        colours = self._deviation_colours(vobj.Object)
        if colours and not _alike(colours, vobj.DiffuseColor):
            vobj.DiffuseColor = colours

    @staticmethod
    def _deviation_colours(shell):
        """A colour for each face; none while the deviations are not those of the shape's faces."""
        deviations, allowed = getattr(shell, "FaceDeviations", []), getattr(shell, "AllowedDeviation", 0.0)
        if allowed <= 0 or len(deviations) != len(shell.Shape.Faces):
            return []
        return [deviation_colour(d / allowed) for d in deviations]

    def getIcon(self):
        return icon_path("TrimQuad_SplineShell")

    def claimChildren(self):
        shell = getattr(self, "Object", None)
        if shell is None:
            return []
        return [o for o in shell.InList if getattr(o, "Shell", None) is shell]

    def setEdit(self, vobj, mode=0):
        if mode != 0:
            return None
        from .task_panel import ConvertPanel

        item, names = vobj.Object.Source
        FreeCADGui.Control.showDialog(ConvertPanel(item, [n for n in names if n], vobj.Object))
        return True

    def unsetEdit(self, vobj, mode=0):
        return None

    def doubleClicked(self, vobj):
        vobj.Document.setEdit(vobj.Object.Name)
        return True


def _alike(colours, others):
    """Whether they differ by no more than the 3D view's colours are rounded."""
    return len(colours) == len(others) and all(
        abs(x - y) < 0.005 for colour, other in zip(colours, others) for x, y in zip(colour, other)
    )


class QuadMeshView(_View):
    def attach(self, vobj):
        self.Object = vobj.Object
        offset = coin.SoPolygonOffset()
        offset.factor.setValue(PUSHED_BACK)
        offset.units.setValue(PUSHED_BACK)
        vobj.RootNode.insertChild(offset, 0)
        self.points = coin.SoCoordinate3()
        self.lines = coin.SoIndexedLineSet()
        vobj.RootNode.addChild(self._overlay())
        self._draw(vobj.Object)

    def _overlay(self):
        colour = coin.SoBaseColor()
        colour.rgb.setValue(*LINE_COLOUR)
        style = coin.SoDrawStyle()
        style.lineWidth.setValue(LINE_WIDTH)
        light = coin.SoLightModel()
        light.model.setValue(coin.SoLightModel.BASE_COLOR)
        pick = coin.SoPickStyle()
        pick.style.setValue(coin.SoPickStyle.UNPICKABLE)
        self.switch = coin.SoSwitch()
        self.switch.whichChild.setValue(coin.SO_SWITCH_ALL)
        separator = coin.SoSeparator()
        for node in (pick, light, colour, style, self.points, self.lines):
            separator.addChild(node)
        self.switch.addChild(separator)
        return self.switch

    def updateData(self, obj, name):
        if name in ("Points", "Polygons") and hasattr(self, "lines"):
            self._draw(obj)

    def onChanged(self, vobj, name):
        if name == "Visibility" and hasattr(self, "switch"):
            self.switch.whichChild.setValue(coin.SO_SWITCH_ALL if vobj.Visibility else coin.SO_SWITCH_NONE)

    def _draw(self, obj):
        points, flat = getattr(obj, "Points", []), getattr(obj, "Polygons", [])
        if not points or not flat or max(flat) > max(len(points), 1):
            self.lines.coordIndex.setNum(0)
            return
        indices = []
        for polygon in polygons_of(obj):
            indices += [*polygon, polygon[0], -1]
        self.points.point.setNum(0)
        self.points.point.setValues(0, len(points), [tuple(p) for p in points])
        self.lines.coordIndex.setNum(0)
        self.lines.coordIndex.setValues(0, len(indices), indices)

    def getIcon(self):
        return icon_path("TrimQuad_QuadMesh")


class GridMapView(_View):
    """Draws the map as a checker, its grid lines, the aligned edges and the singular points, each of which can be
    switched off."""

    PARTS = (
        ("ShowChecker", "Draw the surface as a checker: the squares are quads of the map", True),
        ("ShowGridLines", "Draw the lines on which a coordinate of the map is a whole number", False),
        ("ShowAlignedEdges", "Draw the edges that grid lines follow", True),
        (
            "ShowSingularPoints",
            "Draw the vertices where other than four quads meet: red where fewer do, blue where more",
            True,
        ),
    )

    def __init__(self, vobj):
        self._ensure_properties(vobj)
        super().__init__(vobj)

    def _ensure_properties(self, vobj):
        for name, about, shown in self.PARTS:
            if not hasattr(vobj, name):
                vobj.addProperty("App::PropertyBool", name, "Map", about)
                setattr(vobj, name, shown)
        if not hasattr(vobj, "Pattern"):
            vobj.addProperty("App::PropertyFile", "Pattern", "Map", "Picture that is put on every quad instead of the checker")
        if not hasattr(vobj, "PointSize"):
            vobj.addProperty("App::PropertyFloat", "PointSize", "Map", "Size of the singular points in pixels")
            vobj.PointSize = 9.0

    def attach(self, vobj):
        self.Object = vobj.Object
        self._ensure_properties(vobj)
        self.root = coin.SoSeparator()
        # The faces that the map is of would hide it in turns, and the checker its lines and points.
        self.root.addChild(_drawn_nearer(IN_FRONT))
        pick = coin.SoPickStyle()
        pick.style.setValue(coin.SoPickStyle.UNPICKABLE)
        self.root.addChild(pick)
        self.switches = {}
        self.checker = self._checker()
        self.root.addChild(_drawn_nearer(2 * IN_FRONT))
        light = coin.SoLightModel()
        light.model.setValue(coin.SoLightModel.BASE_COLOR)
        self.root.addChild(light)
        self.grid = self._lines("ShowGridLines", GRID_COLOUR, LINE_WIDTH)
        self.aligned = self._lines("ShowAlignedEdges", ALIGNED_COLOUR, ALIGNED_WIDTH)
        self.points = self._points()
        vobj.addDisplayMode(self.root, "Map")
        for name in ("CheckerCorners", "GridLines", "AlignedEdges", "SingularPoints"):
            self.updateData(vobj.Object, name)
        for name in (*self.switches, "PointSize", "Pattern"):
            self.onChanged(vobj, name)

    def getDisplayModes(self, vobj):
        return ["Map"]

    def getDefaultDisplayMode(self):
        return "Map"

    def setDisplayMode(self, mode):
        return mode

    def _switched(self, name):
        switch, separator = coin.SoSwitch(), coin.SoSeparator()
        switch.whichChild.setValue(coin.SO_SWITCH_ALL)
        switch.addChild(separator)
        self.root.addChild(switch)
        self.switches[name] = switch
        return separator

    def _checker(self):
        separator = self._switched("ShowChecker")
        hints, material = coin.SoShapeHints(), coin.SoMaterial()
        hints.vertexOrdering.setValue(coin.SoShapeHints.COUNTERCLOCKWISE)  # with an unknown shape type: both sides lit
        material.diffuseColor.setValue(1, 1, 1)
        self.texture, self.repeats = coin.SoTexture2(), coin.SoTexture2Transform()
        coordinates, images, triangles = coin.SoCoordinate3(), coin.SoTextureCoordinate2(), coin.SoFaceSet()
        for node in (hints, material, self.texture, self.repeats, images, coordinates, triangles):
            separator.addChild(node)
        return coordinates, images, triangles

    def _lines(self, name, colour, width):
        separator = self._switched(name)
        base, style = coin.SoBaseColor(), coin.SoDrawStyle()
        base.rgb.setValue(*colour)
        style.lineWidth.setValue(width)
        coordinates, lines = coin.SoCoordinate3(), coin.SoLineSet()
        for node in (base, style, coordinates, lines):
            separator.addChild(node)
        return coordinates, lines

    def _points(self):
        separator = self._switched("ShowSingularPoints")
        binding = coin.SoMaterialBinding()
        binding.value.setValue(coin.SoMaterialBinding.PER_VERTEX)
        self.style, colours = coin.SoDrawStyle(), coin.SoBaseColor()
        coordinates, points = coin.SoCoordinate3(), coin.SoPointSet()
        for node in (binding, self.style, colours, coordinates, points):
            separator.addChild(node)
        return coordinates, colours, points

    def updateData(self, obj, name):
        if not hasattr(self, "points"):
            return
        if name in ("CheckerCorners", "CheckerImages"):
            coordinates, images, triangles = self.checker
            corners, places = getattr(obj, "CheckerCorners", []), getattr(obj, "CheckerImages", [])
            if len(corners) != len(places):  # one of the two is still to come
                return
            _set_points(coordinates, [tuple(p) for p in corners])
            images.point.setNum(0)
            images.point.setValues(0, len(places), [(p.x, p.y) for p in places])
            triangles.numVertices.setNum(0)
            triangles.numVertices.setValues(0, len(corners) // 3, [3] * (len(corners) // 3))
        elif name in ("GridLines", "AlignedEdges"):
            coordinates, lines = self.grid if name == "GridLines" else self.aligned
            ends = [tuple(p) for p in getattr(obj, name, [])]
            _set_points(coordinates, ends)
            lines.numVertices.setNum(0)
            lines.numVertices.setValues(0, len(ends) // 2, [2] * (len(ends) // 2))
        elif name in ("SingularPoints", "SingularIndices"):
            coordinates, colours, points = self.points
            places, indices = getattr(obj, "SingularPoints", []), getattr(obj, "SingularIndices", [])
            if len(places) != len(indices):  # one of the two is still to come
                return
            _set_points(coordinates, [tuple(p) for p in places])
            colours.rgb.setNum(0)
            colours.rgb.setValues(0, len(indices), [point_colour(i) for i in indices])
            points.numPoints.setValue(len(places))

    def onChanged(self, vobj, name):
        if not hasattr(self, "switches"):
            return
        if name in self.switches:
            shown = coin.SO_SWITCH_ALL if getattr(vobj, name) else coin.SO_SWITCH_NONE
            self.switches[name].whichChild.setValue(shown)
        elif name == "PointSize":
            self.style.pointSize.setValue(vobj.PointSize)
        elif name == "Pattern":
            self._set_pattern(vobj.Pattern)

    def _set_pattern(self, path):
        """Put the picture on every quad; the checker, two quads wide, where there is none or it cannot be read."""
        width = height = CHECKER_PIXELS
        pixels, quads_wide = checker_pixels(CHECKER_PIXELS), 2
        if path:
            try:
                image = pattern_image(path)[::-1]  # the first row lies at the bottom
                height, width = image.shape[:2]
                pixels, quads_wide = numpy.round(255 * image).astype(numpy.uint8).tobytes(), 1
            except Error as error:
                FreeCAD.Console.PrintError(f"{error}\n")
        self.texture.image.setValue(coin.SbVec2s(width, height), 3, pixels)
        self.repeats.scaleFactor.setValue(1 / quads_wide, 1 / quads_wide)

    def getIcon(self):
        return icon_path("TrimQuad_GridMap")


def _drawn_nearer(part):
    """All that follows is drawn as if it were nearer to the eye, by that part of the depth of the scene."""
    buffer = coin.SoDepthBuffer()
    buffer.range.setValue(0, 1 - part)
    return buffer


def _set_points(coordinates, points):
    coordinates.point.setNum(0)
    coordinates.point.setValues(0, len(points), points)
