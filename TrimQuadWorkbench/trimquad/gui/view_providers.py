"""How SplineShell and QuadMesh look in the tree and in the 3D view."""
import FreeCADGui
from pivy import coin

from ..features.quad_mesh import polygons_of
from . import icon_path

# Line colour and width of the quads' edges.
LINE_COLOUR = (0.05, 0.15, 0.35)
LINE_WIDTH = 1.5
# The triangles of the quads lie in the B-spline faces: pushed back a little, they do not flicker through them, and
# the lines stand out of both.
PUSHED_BACK = 2.0


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
    def attach(self, vobj):
        self.Object = vobj.Object

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
