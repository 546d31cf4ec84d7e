"""The quads as a mesh of FreeCAD's Fem workbench."""


def fem_mesh(parts):
    """A Fem.FemMesh of shell elements from the Polygons of each region: whole quads as they are, trimmed cells as triangles
    and convex quads. Regions share no nodes. Needs FreeCAD's modules.
    """
    import Fem

    mesh, first = Fem.FemMesh(), 1
    for part in parts:
        for i, point in enumerate(part.points.tolist()):
            mesh.addNode(*point, first + i)
        for element in part.elements():
            mesh.addFace([first + i for i in element])
        first += len(part.points)
    return mesh
