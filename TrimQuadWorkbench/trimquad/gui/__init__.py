"""The part of the add-on that needs FreeCAD's GUI."""
import os


def icon_path(name):
    """Path of an icon of this add-on."""
    return os.path.join(os.path.dirname(os.path.dirname(__file__)), "resources", "icons", name + ".svg")
