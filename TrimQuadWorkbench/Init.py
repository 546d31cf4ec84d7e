# FreeCAD executes this file when it starts, without and with a GUI. Importing `trimquad` needs nothing more: FreeCAD
# has put this folder on the path.
