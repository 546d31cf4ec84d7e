# FreeCAD executes this file, so what methods need is imported inside them.
import FreeCADGui


class TrimQuadWorkbench(FreeCADGui.Workbench):
    def __init__(self):
        from trimquad.gui import icon_path

        self.__class__.MenuText = "TrimQuad"
        self.__class__.ToolTip = "Trimmed quad meshes and trimmed B-spline faces"
        self.__class__.Icon = icon_path("TrimQuad")

    def Initialize(self):
        from trimquad.gui import command

        names = command.register()
        self.appendToolbar("TrimQuad", names)
        self.appendMenu("TrimQuad", names)

    def GetClassName(self):
        return "Gui::PythonWorkbench"


FreeCADGui.addWorkbench(TrimQuadWorkbench())
