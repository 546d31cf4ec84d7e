"""Pictures of a result: the map as a checker on the surface, the T-mesh, the quads, the B-spline faces."""
import numpy

from .error import input_error
from .freecad_shape import shape_from_bytes
from .native import load

SIZE = (9.0, 6.75)  # inches, at 100 dots an inch
CHECKS = (numpy.array([0.93, 0.93, 0.90]), numpy.array([0.33, 0.52, 0.74]))
QUAD_COLOUR = numpy.array([0.90, 0.91, 0.93])
TRIMMED_COLOUR = numpy.array([0.98, 0.84, 0.60])
FACE_COLOURS = numpy.array([[0.55, 0.68, 0.85], [0.93, 0.76, 0.52], [0.62, 0.80, 0.62], [0.85, 0.62, 0.66],
                            [0.74, 0.68, 0.86], [0.62, 0.80, 0.82]])
ARC_COLOUR, ZERO_COLOUR = "#1b2a41", "#d03020"
FEW_COLOUR, MANY_COLOUR, FEATURE_COLOUR = "#d03020", "#2060c0", "#209040"
# Triangles are divided so that the checker's borders look straight: at most so many parts a side, or in all.
CHECKER_DIVISION, CHECKER_PARTS = 6, 250_000
LIGHT = numpy.array([0.35, -0.45, 0.82])


def write_pictures(result, path_of, progress):
    """Write map.png, tmesh.png, tmesh_unfolded.png, quads.png and nurbs.png where the stages got that far. `path_of(name)` says where."""
    try:
        import matplotlib

        matplotlib.use("Agg")
    except ImportError as error:
        raise input_error("write", f"--write pictures needs matplotlib ({error})") from None
    maps = [triangles_of_map(r.grid.to_obj()) for r in result.regions if r.grid is not None]
    if maps:
        _save(path_of("map.png"), [_checker(*m) for m in maps], [])
    progress.check()
    items = [r for r in result.regions if r.quantization is not None]
    if items:
        _tmesh_pictures(items, path_of)
    progress.check()
    polygons = [r.polygons for r in result.regions if r.quads is not None]
    if polygons:
        _save(path_of("quads.png"), [_quads(p) for p in polygons], [_lines(p) for p in polygons])
    progress.check()
    if result.native_shape is not None:
        faces, lines = _faces(result)
        _save(path_of("nurbs.png"), faces, lines)


def triangles_of_map(text):
    """Corners (m, 3, 3) and their images (m, 3, 2) of the triangles of a gridmap.obj or seamless.obj."""
    points, images, corners, places = [], [], [], []
    for line in text.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            points.append([float(w) for w in words[1:4]])
        elif words[0] == "vt":
            images.append([float(w) for w in words[1:3]])
        elif words[0] == "f":
            pairs = [w.split("/") for w in words[1:4]]
            corners.append([int(p[0]) - 1 for p in pairs])
            places.append([int(p[1]) - 1 for p in pairs])
    return numpy.array(points)[corners], numpy.array(images)[places]


def _checker(corners, images):
    """Small triangles and their colours: squares of the plane alternate."""
    n = max(1, min(CHECKER_DIVISION, int((CHECKER_PARTS / len(corners)) ** 0.5)))
    weights = []
    for i in range(n):
        for j in range(n - i):
            a, b, c = (i, j), (i + 1, j), (i, j + 1)
            weights.append([(n - x - y, x, y) for x, y in (a, b, c)])
            if i + j < n - 1:
                weights.append([(n - x - y, x, y) for x, y in (b, (i + 1, j + 1), c)])
    weights = numpy.array(weights) / n  # (parts, 3 corners, 3 weights)
    small = numpy.einsum("pkw,mwx->mpkx", weights, corners).reshape(-1, 3, 3)
    middles = numpy.einsum("pkw,mwx->mpkx", weights, images).mean(axis=2).reshape(-1, 2)
    odd = (numpy.floor(middles).sum(axis=1).astype(int) % 2).astype(bool)
    return small, numpy.where(odd[:, None], CHECKS[1], CHECKS[0])


def _quads(polygons):
    count = 2 * len(polygons.full)
    triangles = polygons.points[polygons.triangles()]
    colours = numpy.tile(TRIMMED_COLOUR, (len(triangles), 1))
    colours[:count] = QUAD_COLOUR
    return triangles, colours


def _lines(polygons):
    return polygons.points[polygons.edges()], 0.5


def _faces(result):
    shape = shape_from_bytes(load().shape_to_freecad(result.native_shape))
    chord = result.model.diagonal / 1500
    faces, lines = [], []
    for index, face in enumerate(shape.Faces):
        points, triangles = face.tessellate(chord)
        points = numpy.array([tuple(p) for p in points])
        corners = points[numpy.array(triangles)]
        if face.Orientation == "Reversed":
            corners = corners[:, ::-1]
        faces.append((corners, numpy.tile(FACE_COLOURS[index % len(FACE_COLOURS)], (len(corners), 1))))
    for edge in shape.Edges:
        points = numpy.array([tuple(p) for p in edge.discretize(60)])
        lines.append((numpy.stack([points[:-1], points[1:]], axis=1), 1.1))
    return faces, lines


def _tmesh_pictures(items, path_of):
    """The T-meshes over their surfaces, and as rectangles laid out side by side."""
    surfaces, lines, points, layouts = [], [], [], []
    for item in items:
        corners, _ = triangles_of_map(item.seamless.to_obj())
        surfaces.append((corners, numpy.tile(QUAD_COLOUR, (len(corners), 1))))
        curves = load().arc_curves(item.tmesh, item.seamless)
        lines += _arc_lines(item, [numpy.stack([c[:-1], c[1:]], axis=1) for c in curves])
        positions = numpy.array([n[3] for n in item.tmesh.nodes])
        points += _node_points(item, [[p] for p in positions])
        layouts.append(layout_of_patches(item.tmesh))
    _save(path_of("tmesh.png"), surfaces, lines, points)
    offset = 0.0
    flat_lines, flat_points = [], []
    for item, (arcs, nodes) in zip(items, layouts):
        low = min((a[..., 0].min() for a in arcs if len(a)), default=0.0)
        high = max((a[..., 0].max() for a in arcs if len(a)), default=0.0)
        shift = numpy.array([offset - low, 0.0])
        flat_lines += _arc_lines(item, [a + shift for a in arcs])
        flat_points += _node_points(item, [[p + shift for p in places] for places in nodes])
        offset += 1.1 * (high - low) + 1
    drawing, axes = _drawing()
    _add_lines(axes, flat_lines)
    _add_points(axes, flat_points)
    _finish(drawing, axes, path_of("tmesh_unfolded.png"))


def _arc_lines(item, segments):
    """Real arcs black, virtual ones dashed, those of length zero red."""
    styles = {}
    for arc, q, pieces in zip(item.tmesh.arcs, item.quantization.length, segments):
        styles.setdefault((arc[3], q == 0), []).append(pieces)
    return [
        (numpy.concatenate(pieces), 1.3, ZERO_COLOUR if zero else ARC_COLOUR, "dashed" if virtual else "solid")
        for (virtual, zero), pieces in sorted(styles.items())
    ]


def _node_points(item, places):
    """Critical nodes: singularities by their number of arcs, others in one colour."""
    valence = numpy.zeros(len(item.tmesh.nodes), int)
    for start, end, _, virtual, _, _ in item.tmesh.arcs:
        if not virtual:
            valence[start] += 1
            valence[end] += 1
    points = []
    for (kind, critical, _, _), arcs, at in zip(item.tmesh.nodes, valence, places):
        if critical and len(at):
            colour = FEATURE_COLOUR if kind != "singular" else FEW_COLOUR if arcs < 4 else MANY_COLOUR
            points.append((numpy.array(at), colour))
    return points


def layout_of_patches(tmesh):
    """Every patch as its rectangle in the plane, laid beside one that it shares an arc with. Round a singularity
    rectangles overlap or gape. Returns, by arc, segments (n, 2, 2), and by node its places."""
    arcs, patches = tmesh.arcs, tmesh.patches
    where = {}  # half-arc -> patch, side
    for p, (_, sides) in enumerate(patches):
        for s, side in enumerate(sides):
            for h in side:
                where[h] = (p, s)
    turns = numpy.array([[1, 0], [0, 1], [-1, 0], [0, -1]], float)
    segments, nodes = [[] for _ in arcs], [[] for _ in tmesh.nodes]
    placed = [False] * len(patches)
    for first in range(len(patches)):
        waiting = [] if placed[first] else [(first, 0, patches[first][1][0][0], numpy.zeros(2))]
        placed[first] = True
        while waiting:
            p, turn, anchor, x = waiting.pop(0)
            loop = [(h, s) for s, side in enumerate(patches[p][1]) for h in side]
            begin = next(i for i, (h, _) in enumerate(loop) if h == anchor)
            turn -= loop[begin][1]  # direction of side 0
            for h, s in loop[begin:] + loop[:begin]:
                arc = arcs[abs(h) - 1]
                y = x + arc[2] * turns[(turn + s) % 4]
                segments[abs(h) - 1].append([x, y])
                nodes[arc[0] if h > 0 else arc[1]].append(x)
                other = where.get(-h)
                if other and not placed[other[0]]:
                    placed[other[0]] = True
                    waiting.append((other[0], (turn + s + 2) % 4, -h, y))
                x = y
    return [numpy.array(s).reshape(-1, 2, 2) for s in segments], nodes


def _drawing():
    from matplotlib import figure
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    drawing = figure.Figure(figsize=SIZE, dpi=100)
    FigureCanvasAgg(drawing)
    axes = drawing.add_axes([0.02, 0.02, 0.96, 0.96])
    axes.set_aspect("equal")
    axes.axis("off")
    return drawing, axes


def _add_lines(axes, lines):
    from matplotlib.collections import LineCollection

    for segments, width, colour, style in lines:
        axes.add_collection(LineCollection(segments, colors=colour, linewidths=width, linestyles=style))


def _add_points(axes, points):
    for places, colour in points:
        axes.plot(places[:, 0], places[:, 1], "o", color=colour, markersize=5, zorder=3)


def _finish(drawing, axes, path):
    axes.autoscale_view()
    drawing.savefig(path, metadata={"Software": None})


def _save(path, surfaces, lines, points=()):
    """Paint triangles, lines and points from back to front, in a fixed oblique view.

    surfaces  (triangles, colours) each; lines (segments, width) or (segments, width, colour, style); points (places,
              colour)
    """
    from matplotlib.collections import PolyCollection

    triangles = numpy.concatenate([s[0] for s in surfaces])
    colours = numpy.concatenate([s[1] for s in surfaces])
    # Large triangles have no one depth to be sorted by.
    triangles, colours = _divided(triangles, colours, _extent(triangles) / 60)
    view = _view_axes(triangles)
    flat, depth = triangles @ view[:, :2], (triangles @ view[:, 2]).mean(axis=1)
    order = numpy.argsort(depth, kind="stable")
    shaded = numpy.clip(colours * _shade(triangles, view)[:, None], 0, 1)
    drawing, axes = _drawing()
    axes.add_collection(
        PolyCollection(flat[order], facecolors=shaded[order], edgecolors=shaded[order], linewidths=0.3)
    )
    for segments, width, *style in lines:
        seen = _visible(segments, triangles, view)
        _add_lines(axes, [((segments @ view[:, :2])[seen], width, *(style or (ARC_COLOUR, "solid")))])
    for places, colour in points:
        seen = _visible(numpy.stack([places, places], axis=1), triangles, view)
        _add_points(axes, [((places @ view[:, :2])[seen], colour)])
    _finish(drawing, axes, path)


def _view_axes(triangles):
    """Columns: right, up, towards the eye. The eye stands obliquely above."""
    towards = numpy.array([0.45, -0.72, 0.62])
    towards /= numpy.linalg.norm(towards)
    right = numpy.cross([0, 0, 1], towards)
    right /= numpy.linalg.norm(right)
    return numpy.stack([right, numpy.cross(towards, right), towards], axis=1)


def _shade(triangles, view):
    normals = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = numpy.linalg.norm(normals, axis=1)
    normals /= numpy.where(lengths > 0, lengths, 1)[:, None]
    light = LIGHT / numpy.linalg.norm(LIGHT)
    # Both sides are lit: open surfaces show their inside.
    return 0.62 + 0.42 * numpy.abs(normals @ light) - 0.08 * ((normals @ view[:, 2]) < 0)


def _visible(segments, triangles, view, cells=300):
    """Which segments no triangle hides: their middles against a depth raster of the triangles."""
    low = (triangles @ view[:, :2]).reshape(-1, 2).min(axis=0)
    extent = _extent(triangles)
    size = extent / cells
    small, _ = _divided(triangles, numpy.zeros((len(triangles), 0)), size)
    points = numpy.concatenate([small.reshape(-1, 3), small.mean(axis=1)])
    raster = numpy.full((cells + 2, cells + 2), -numpy.inf)
    index = ((points @ view[:, :2] - low) / size).astype(int)
    numpy.maximum.at(raster, (index[:, 0], index[:, 1]), points @ view[:, 2])
    middles = segments.mean(axis=1)
    index = numpy.clip(((middles @ view[:, :2] - low) / size).astype(int), 0, cells + 1)
    return middles @ view[:, 2] > raster[index[:, 0], index[:, 1]] - 0.015 * extent


def _extent(triangles):
    corners = triangles.reshape(-1, 3)
    return max(numpy.linalg.norm(corners.max(axis=0) - corners.min(axis=0)), 1e-300)


def _divided(triangles, colours, limit):
    """The triangles, those with an edge over `limit` halved at their longest edge until there is none."""
    done, done_colours = [], []
    while len(triangles):
        lengths = numpy.linalg.norm(triangles - numpy.roll(triangles, -1, axis=1), axis=2)
        large = lengths.max(axis=1) > limit
        done.append(triangles[~large])
        done_colours.append(colours[~large])
        first = lengths[large].argmax(axis=1)
        turned = (first[:, None] + numpy.arange(3)) % 3
        turned = numpy.take_along_axis(triangles[large], turned[:, :, None], axis=1)
        a, b, c = turned[:, 0], turned[:, 1], turned[:, 2]
        middle = (a + b) / 2
        triangles = numpy.concatenate([numpy.stack([a, middle, c], axis=1), numpy.stack([middle, b, c], axis=1)])
        colours = numpy.concatenate([colours[large], colours[large]])
    return numpy.concatenate(done), numpy.concatenate(done_colours)
