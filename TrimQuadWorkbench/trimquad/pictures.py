"""Pictures of a result: the map as a checker on the surface with its singular vertices, the quads, the B-spline faces."""
import numpy

from .colours import BEYOND_TOLERANCE, CHECKS, deviation_colour, point_colour
from .deviation import deviation_maps, worst_place
from .error import input_error
from .freecad_shape import shape_from_bytes
from .histograms import histograms, sum_of, write_histograms
from .native import load
from .polygons import Polygons
from .tmesh_layout import arc_courses, arc_lines, critical_points, layout_of_patches

SIZE = (9.0, 6.75)  # inches, at 100 dots an inch
QUAD_COLOUR = numpy.array([0.90, 0.91, 0.93])
TRIMMED_COLOUR = numpy.array([0.98, 0.84, 0.60])
FACE_COLOURS = numpy.array([[0.55, 0.68, 0.85], [0.93, 0.76, 0.52], [0.62, 0.80, 0.62], [0.85, 0.62, 0.66],
                            [0.74, 0.68, 0.86], [0.62, 0.80, 0.82]])
# Triangles are divided so that the checker's borders look straight: at most so many parts a side, or in all.
CHECKER_DIVISION, CHECKER_PARTS = 6, 250_000
LINE_COLOUR = "#1b2a41"
ALIGNED_COLOUR = "#0a7d3c"
LIGHT = numpy.array([0.35, -0.45, 0.82])


def write_pictures(result, path_of, progress, native_progress):
    """Write map.png, tmesh.png, tmesh_unfolded.png, quads.png, histograms.png, nurbs.png and nurbs-deviation.png where the stages got that far. `path_of(name)` says where."""
    try:
        import matplotlib

        matplotlib.use("Agg")
    except ImportError as error:
        raise input_error("write", f"--write pictures needs matplotlib ({error})") from None
    mapped = [r for r in result.regions if r.map is not None]
    if mapped:
        checkers = [_checker(r.map.points[r.map.triangles], r.map.uv) for r in mapped]
        aligned = [(r.region.points[r.region.aligned], 1.6, ALIGNED_COLOUR) for r in mapped]
        _save(path_of("map.png"), checkers, aligned, [s for r in mapped for s in r.singularities])
    progress.check()
    partitioned = [r for r in result.regions if r.quantization is not None]
    if partitioned:
        _save_tmeshes(partitioned, path_of)
    progress.check()
    polygons = [r.polygons for r in result.regions if r.quads is not None]
    if polygons:
        _save(path_of("quads.png"), [_quads(p) for p in polygons], [_lines(p) for p in polygons])
        counts = [histograms(r.quads, r.edge_length) for r in result.regions if r.quads is not None]
        write_histograms([("", sum_of(counts))], path_of("histograms.png"))
    progress.check()
    if result.native_shape is not None:
        faces, edges = _faces(result)
        _save(path_of("nurbs.png"), faces, [(edges, 1.1, LINE_COLOUR)])
        progress.check()
        _save_deviation(result, edges, path_of("nurbs-deviation.png"), native_progress)


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
    """Quads in four triangles around their middle each: halves of a bent quad would be shaded apart."""
    corners = polygons.points[numpy.array(polygons.full, int).reshape(-1, 4)]
    middles = numpy.broadcast_to(corners.mean(axis=1, keepdims=True), corners.shape)
    quads = numpy.stack([corners, numpy.roll(corners, -1, axis=1), middles], axis=2).reshape(-1, 3, 3)
    cells = Polygons(polygons.points, [], polygons.trimmed).triangles()
    cells = polygons.points[numpy.array(cells, int).reshape(-1, 3)]
    colours = numpy.repeat([QUAD_COLOUR, TRIMMED_COLOUR], [len(quads), len(cells)], axis=0)
    return numpy.concatenate([quads, cells]), colours


def _lines(polygons):
    return polygons.points[polygons.edges()], 0.5, LINE_COLOUR


def _faces(result):
    shape = shape_from_bytes(load().shape_to_freecad(result.native_shape))
    chord = result.model.diagonal / 1500
    faces, segments = [], []
    for index, face in enumerate(shape.Faces):
        points, triangles = face.tessellate(chord)
        points = numpy.array([tuple(p) for p in points])
        corners = points[numpy.array(triangles)]
        if face.Orientation == "Reversed":
            corners = corners[:, ::-1]
        faces.append((corners, numpy.tile(FACE_COLOURS[index % len(FACE_COLOURS)], (len(corners), 1))))
    for edge in shape.Edges:
        points = numpy.array([tuple(p) for p in edge.discretize(60)])
        segments.append(numpy.stack([points[:-1], points[1:]], axis=1))
    return faces, numpy.concatenate(segments)


def _save_deviation(result, edges, path, native_progress):
    """The faces coloured by their distance from the input, a circle around each region's place of largest deviation."""
    tolerance = result.options.tolerance
    surfaces, largest = [], 0.0
    for points, distances, triangles in deviation_maps(result, native_progress):
        parts = distances[triangles].mean(axis=1) / tolerance
        surfaces.append((points[triangles], numpy.array([deviation_colour(p) for p in parts])))
        largest = max(largest, distances.max() / tolerance)
    drawing, axes = _painted(surfaces, [(edges, 0.4, LINE_COLOUR)], evenly=True)
    view = view_axes()
    triangles = numpy.concatenate([s[0] for s in surfaces])
    places = numpy.array([worst_place(r) for r in result.regions if r.fitted is not None])
    seen = _visible(places, triangles, view)
    x, y = (places @ view[:, :2])[seen].T
    axes.scatter(x, y, s=60, facecolors="none", edgecolors="black", linewidths=1.0, zorder=3)
    _add_deviation_bar(drawing, tolerance, largest)
    _finish(drawing, axes, path)


def _add_deviation_bar(drawing, tolerance, largest):
    from matplotlib import cm, colors

    drawing.axes[0].set_position([0.02, 0.02, 0.84, 0.96])
    steps = colors.ListedColormap([deviation_colour(k / 255) for k in range(256)])
    steps.set_over(BEYOND_TOLERANCE)
    scale = cm.ScalarMappable(colors.Normalize(0, 1), steps)
    bar = drawing.colorbar(scale, cax=drawing.add_axes([0.88, 0.15, 0.02, 0.7]), extend="max")
    bar.set_label(f"distance from the input / tolerance ({tolerance:.3g}); largest {largest:.2f}")


def _save_tmeshes(items, path_of):
    """tmesh.png: arcs on the surfaces; tmesh_unfolded.png: completed patches as rectangles side by side."""
    surfaces, lines = [], []
    for item in items:
        points, triangles, _ = item.seamless.arrays
        surfaces.append((points[triangles], numpy.tile(QUAD_COLOUR, (len(triangles), 1))))
        lines += arc_lines(item, arc_courses(item))
    _save(path_of("tmesh.png"), surfaces, lines, [s for r in items for s in r.singularities])
    drawing, axes = _drawing()
    offset = 0.0
    for item in items:
        arcs, nodes = layout_of_patches(item.tmesh)
        corners = numpy.concatenate(arcs).reshape(-1, 2)
        shift = numpy.array([offset - corners[:, 0].min(), 0.0])
        offset += 1.1 * numpy.ptp(corners[:, 0]) + 1
        for line in arc_lines(item, [a + shift for a in arcs]):
            _add_line(axes, *line)
        for place, colour in critical_points(item, nodes):
            axes.plot(*(place + shift), "o", color=colour, markersize=5, zorder=3)
    _finish(drawing, axes, path_of("tmesh_unfolded.png"))


def _drawing():
    from matplotlib import figure
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    drawing = figure.Figure(figsize=SIZE, dpi=100)
    FigureCanvasAgg(drawing)
    axes = drawing.add_axes([0.02, 0.02, 0.96, 0.96])
    axes.set_aspect("equal")
    axes.axis("off")
    return drawing, axes


def _add_line(axes, segments, width, colour, style="solid"):
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(segments, colors=colour, linewidths=width, linestyles=style))


def _finish(drawing, axes, path):
    axes.autoscale_view()
    drawing.savefig(path, metadata={"Software": None})


def _save(path, surfaces, lines, singularities=()):
    """Paint triangles, and what they do not hide of the lines and points."""
    drawing, axes = _painted(surfaces, lines)
    if singularities:
        triangles, view = numpy.concatenate([s[0] for s in surfaces]), view_axes()
        places = numpy.array([s.position for s in singularities])
        colours = numpy.array([point_colour(s.index) for s in singularities])
        seen = _visible(places, triangles, view)
        x, y = (places @ view[:, :2])[seen].T
        axes.scatter(x, y, s=26, c=colours[seen], edgecolors="white", linewidths=0.6, zorder=3)
    _finish(drawing, axes, path)


def _painted(surfaces, lines, evenly=False):
    """A drawing of triangles from back to front in a fixed oblique view, and of what they do not hide of the lines.

    evenly: not shaded, so that the colours can be read by a scale
    """
    from matplotlib.collections import PolyCollection

    triangles = numpy.concatenate([s[0] for s in surfaces])
    colours = numpy.concatenate([s[1] for s in surfaces])
    # Large triangles have no one depth to be sorted by.
    triangles, colours = _divided(triangles, colours, _extent(triangles) / 60)
    view = view_axes()
    flat, depth = triangles @ view[:, :2], (triangles @ view[:, 2]).mean(axis=1)
    order = numpy.argsort(depth, kind="stable")
    shaded = colours if evenly else numpy.clip(colours * shade(triangles, view)[:, None], 0, 1)
    drawing, axes = _drawing()
    axes.add_collection(
        PolyCollection(flat[order], facecolors=shaded[order], edgecolors=shaded[order], linewidths=0.3)
    )
    for segments, *how in lines:
        seen = _visible(segments.mean(axis=1), triangles, view)
        _add_line(axes, (segments @ view[:, :2])[seen], *how)
    return drawing, axes


def view_axes():
    """Columns: right, up, towards the eye. The eye stands obliquely above."""
    towards = numpy.array([0.45, -0.72, 0.62])
    towards /= numpy.linalg.norm(towards)
    right = numpy.cross([0, 0, 1], towards)
    right /= numpy.linalg.norm(right)
    return numpy.stack([right, numpy.cross(towards, right), towards], axis=1)


def shade(triangles, view):
    normals = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = numpy.linalg.norm(normals, axis=1)
    normals /= numpy.where(lengths > 0, lengths, 1)[:, None]
    light = LIGHT / numpy.linalg.norm(LIGHT)
    # Both sides are lit: open surfaces show their inside.
    return 0.62 + 0.42 * numpy.abs(normals @ light) - 0.08 * ((normals @ view[:, 2]) < 0)


def _visible(places, triangles, view, cells=300):
    """Which points no triangle hides, by a depth raster of the triangles."""
    low = (triangles @ view[:, :2]).reshape(-1, 2).min(axis=0)
    extent = _extent(triangles)
    size = extent / cells
    small, _ = _divided(triangles, numpy.zeros((len(triangles), 0)), size)
    points = numpy.concatenate([small.reshape(-1, 3), small.mean(axis=1)])
    raster = numpy.full((cells + 2, cells + 2), -numpy.inf)
    index = ((points @ view[:, :2] - low) / size).astype(int)
    numpy.maximum.at(raster, (index[:, 0], index[:, 1]), points @ view[:, 2])
    index = numpy.clip(((places @ view[:, :2] - low) / size).astype(int), 0, cells + 1)
    return places @ view[:, 2] > raster[index[:, 0], index[:, 1]] - 0.015 * extent


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
