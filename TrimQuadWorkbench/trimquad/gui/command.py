"""The command 'Trimmed quads and B-splines'."""
import FreeCAD
import FreeCADGui

from . import icon_path

NAME = "TrimQuad_Convert"


class Convert:
    def GetResources(self):
        return {
            "Pixmap": icon_path("TrimQuad_Convert"),
            "MenuText": "Trimmed quads and B-splines",
            "ToolTip": "Converts the selected faces, shape or mesh into a trimmed quad mesh and trimmed B-spline faces",
        }

    def IsActive(self):
        return FreeCAD.ActiveDocument is not None and bool(FreeCADGui.Selection.getSelection())

    def Activated(self):
        from .task_panel import ConvertPanel

        if FreeCADGui.Control.activeDialog():
            return
        selected = FreeCADGui.Selection.getSelectionEx()
        item = selected[0].Object
        if len(selected) > 1 or not (hasattr(item, "Shape") or hasattr(item, "Mesh")):
            FreeCAD.Console.PrintError("TrimQuad: select one object with a shape or a mesh, or faces of one object\n")
            return
        faces = [name for name in selected[0].SubElementNames if name.startswith("Face")]
        FreeCADGui.Control.showDialog(ConvertPanel(item, faces))


def register():
    """Make the commands known to FreeCAD; returns their names."""
    from .worker import install

    install()
    FreeCADGui.addCommand(NAME, Convert())
    return [NAME]
