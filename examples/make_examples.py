#!/usr/bin/python3
"""Makes the example parts with FreeCAD's own modelling and writes them as STEP beside this script.

    freecadcmd examples/make_examples.py        or        python3 examples/make_examples.py
    (with FreeCAD's modules on the path; a folder as the last argument writes there instead)

hood.step              freeform panel of 1.2 m, trimmed outline with rounded corners, two cut-outs
tube.step              bent open tube, one smooth surface
sheet.step             wavy sheet cut by an ellipse
box_with_fillets.step  solid box, its vertical edges filleted, with a through hole
closed/tee.step        pipe tee, a closed surface with two handles, its joint and its mouths rounded
flow/wing.step         the plane around a wing profile, out to a circle
roof/station.step      roof of a station, 90 m long, along winding tracks: its boundary bends strongly
pattern/lattice.png    pattern for every quad, as with --pattern: round holes in a lattice of bands
"""
import math
import os
import re
import sys
import traceback

import FreeCAD
import numpy
import Part
from PIL import Image

V = FreeCAD.Vector


def graph_surface(height, width, depth, nodes_x, nodes_y):
    """A B-spline face through z = height(x, y) over a rectangle around the origin, mm."""
    points = []
    for i in range(nodes_x):
        x = width * (i / (nodes_x - 1) - 0.5)
        ys = (depth * (j / (nodes_y - 1) - 0.5) for j in range(nodes_y))
        points.append([V(x, y, height(x, y)) for y in ys])
    surface = Part.BSplineSurface()
    surface.interpolate(points)
    return surface.toShape()


def prism(wire, low, high):
    """The solid over a plane outline at z = 0, from `low` to `high`."""
    outline = Part.Face(wire)
    outline.translate(V(0, 0, low))
    return outline.extrude(V(0, 0, high - low))


def rounded_polygon(corners, radius):
    """A closed wire through plane corners, each rounded with the same radius."""
    edges, count = [], len(corners)
    arcs = []
    for i, corner in enumerate(corners):
        before = (corners[i - 1] - corner).normalize()
        after = (corners[(i + 1) % count] - corner).normalize()
        half = before.getAngle(after) / 2
        reach = radius / math.tan(half)
        middle = corner + (before + after).normalize() * (radius / math.sin(half) - radius)
        arcs.append((corner + before * reach, middle, corner + after * reach))
    for i, (start, middle, end) in enumerate(arcs):
        edges.append(Part.Arc(start, middle, end).toShape())
        edges.append(Part.makeLine(end, arcs[(i + 1) % count][0]))
    return Part.Wire(edges)


def hood():
    def height(x, y):
        return 90 * math.cos(1.1 * x / 600) * math.cos(0.9 * y / 450) + 14 * math.sin(x / 260) * math.sin(y / 330)

    face = graph_surface(height, 1300, 1000, 27, 21)
    outline = rounded_polygon(
        [V(-600, -330, 0), V(560, -430, 0), V(600, 0, 0), V(560, 430, 0), V(-600, 330, 0)], 70
    )
    panel = face.common(prism(outline, -300, 300))
    vent = rounded_polygon([V(-420, -190, 0), V(-140, -215, 0), V(-140, -90, 0), V(-420, -90, 0)], 25)
    panel = panel.cut(prism(vent, -300, 300))
    badge = Part.Wire(Part.makeCircle(75, V(330, 120, 0)))
    return panel.cut(prism(badge, -300, 300)).Faces[0]


def tube():
    """Poles on circles around a smooth spine: closed and curvature continuous around, unlike a swept circle."""
    spine = Part.BSplineCurve()
    spine.interpolate([V(0, 0, 0), V(0, 0, 120), V(30, 20, 230), V(110, 60, 300), V(220, 80, 320)])
    around, along, radius = 16, 24, 36
    poles = []
    for j in range(along):
        t = spine.FirstParameter + (spine.LastParameter - spine.FirstParameter) * j / (along - 1)
        axis = spine.tangent(t)[0]
        side = V(0, 1, 0).cross(axis).normalize()
        turns = (2 * math.pi * i / around for i in range(around))
        up = axis.cross(side)
        poles.append([spine.value(t) + (side * math.cos(a) + up * math.sin(a)) * radius for a in turns])
    poles = [list(row) for row in zip(*poles)]  # around first
    surface = Part.BSplineSurface()
    ends = [4] + [1] * (along - 4) + [4]
    surface.buildFromPolesMultsKnots(
        poles, [1] * (around + 1), ends, list(range(around + 1)), list(range(along - 2)), True, False, 3, 3
    )
    return surface.toShape()


def sheet():
    def height(x, y):
        return 18 * math.sin(x / 55) * math.cos(y / 48)

    face = graph_surface(height, 420, 320, 43, 33)
    ellipse = Part.Wire(Part.Ellipse(V(0, 0, 0), 185, 130).toShape())
    return face.common(prism(ellipse, -80, 80)).Faces[0]


def box_with_fillets():
    box = Part.makeBox(120, 80, 40)
    upright = [e for e in box.Edges if abs(e.tangentAt(e.FirstParameter).z) > 0.9]
    return box.makeFillet(14, upright).cut(Part.makeCylinder(16, 60, V(60, 40, -10))).Solids[0]


def tee():
    def pipes(run, branch):
        return Part.makeCylinder(run, 200, V(-100, 0, 0), V(1, 0, 0)).fuse(Part.makeCylinder(branch, 95)).removeSplitter()

    def joint(solid):
        return [e for e in solid.Edges if not isinstance(e.Curve, (Part.Circle, Part.Line))]

    outside, inside = pipes(32, 24), pipes(24, 16)
    solid = outside.makeFillet(10, joint(outside)).cut(inside.makeFillet(6, joint(inside)))
    mouths = [e for e in solid.Edges if isinstance(e.Curve, Part.Circle) and _at_mouth(e.CenterOfMass)]
    return solid.makeFillet(2.5, mouths).Solids[0]


def _at_mouth(point):
    return abs(abs(point.x) - 100) < 1e-3 or abs(point.z - 95) < 1e-3


def wing():
    """The plane around a wing profile (NACA 0012, six degrees against the stream), out to a circle."""
    def point(x, side):
        y = side * 0.6 * (0.2969 * math.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
        turn = math.radians(-6)
        return V(100 * (x * math.cos(turn) - y * math.sin(turn)), 100 * (x * math.sin(turn) + y * math.cos(turn)), 0)

    places = [0.5 * (1 - math.cos(math.pi * k / 40)) for k in range(41)]
    above, below = Part.BSplineCurve(), Part.BSplineCurve()
    above.interpolate([point(x, 1) for x in places])
    below.interpolate([point(x, -1) for x in reversed(places)])
    circle = Part.Wire(Part.Circle(V(50, 0, 0), V(0, 0, 1), 220).toShape())
    face = Part.Face([circle, Part.Wire([above.toShape(), below.toShape()])])
    face.validate()
    return face


def station():
    """A roof in metres whose eaves wind in plan, high in the middle and drawn down to both ends."""
    def middle(x):
        return 9 * math.sin(x / 18)

    def half_width(x):
        return 9 + 4.5 * math.cos(x / 11)

    def height(x, y):
        away = (y - middle(x)) / 16
        return 13 * math.cos(x / 40) * (1 - 0.45 * away**2) + 1.2 * math.sin(x / 7)

    roof = graph_surface(height, 110, 70, 45, 27)
    places = [90 * (k / 40 - 0.5) for k in range(41)]
    eaves = [[V(x, middle(x) + side * half_width(x), 0) for x in places] for side in (-1, 1)]
    left, right = Part.BSplineCurve(), Part.BSplineCurve()
    left.interpolate(eaves[0])
    right.interpolate(eaves[1][::-1])
    ends = [Part.Arc(a, (a + b) / 2 + V(out, 0, 0), b).toShape()
            for a, b, out in ((eaves[0][-1], eaves[1][-1], 5), (eaves[1][0], eaves[0][0], -5))]
    outline = Part.Wire([left.toShape(), ends[0], right.toShape(), ends[1]])
    return roof.common(prism(outline, -40, 40)).Faces[0]


def lattice(pixels=256):
    """Array (n, n, 3) of bytes: bands that cross in the quad's corners, between them a ring. Quarter turns, as where seams
    of a map turn it, and its repetition leave no joint."""
    x, y = numpy.abs(numpy.meshgrid(*2 * [(numpy.arange(pixels) + 0.5) / pixels - 0.5]))
    ring, across = numpy.hypot(x, y), numpy.abs(x - y)
    image = numpy.empty((pixels, pixels, 3), numpy.uint8)
    image[:] = (246, 239, 222)
    image[across < 0.1] = (38, 70, 83)
    image[across < 0.07] = (42, 157, 143)
    image[ring < 0.3] = (38, 70, 83)
    image[ring < 0.27] = (233, 196, 106)
    image[ring < 0.15] = (38, 70, 83)
    image[ring < 0.12] = (246, 239, 222)
    return image


def write_step(shape, path):
    """STEP with a constant date in its header, so that the same shape gives the same bytes."""
    shape.exportStep(path)
    with open(path, encoding="utf-8") as stream:
        text = stream.read()
    text = re.sub(r"'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d'", "'2000-01-01T00:00:00'", text)
    with open(path, "w", encoding="utf-8", newline="\n") as stream:
        stream.write(text)


def main():
    folder = sys.argv[-1] if os.path.isdir(sys.argv[-1]) else os.path.dirname(os.path.abspath(__file__))
    for name in ("closed", "flow", "roof", "pattern"):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    for make, name in ((hood, "hood"), (tube, "tube"), (sheet, "sheet"), (box_with_fillets, "box_with_fillets"),
                       (tee, "closed/tee"), (wing, "flow/wing"), (station, "roof/station")):
        shape = make()
        assert shape.isValid(), name
        write_step(shape, os.path.join(folder, name + ".step"))
        print(f"{name}: {shape.ShapeType}, {len(shape.Faces)} faces, area {shape.Area:.6g}")
    Image.fromarray(lattice()).save(os.path.join(folder, "pattern", "lattice.png"), optimize=True)
    return 0


# freecadcmd runs a file a second time and exits with 0 where an exception leaves it: catch everything, exit at once.
try:
    status = main()
except BaseException:
    traceback.print_exc()
    status = 1
sys.stdout.flush()
sys.exit(status)
