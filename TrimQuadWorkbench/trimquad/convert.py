"""From a shape or a mesh to quads and B-spline faces: the one function behind the command line, scripts and the GUI."""
import os
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, Tuple

import numpy

from .cuts import MOST_CUTS, Cut, cut_failed
from .error import Error, cancelled, input_error, system_error
from .freecad_shape import shape_from_bytes
from .native import load
from .options import FIELDS, Options
from .polygons import Polygons
from .progress import Progress
from .report import report
from .source import Source

# Stages keep to this part of the tolerance, so that what they add up to stays under it; by kind of input. Between curved
# surfaces, deviations can only be measured up to the chord errors of both.
FIT_MARGIN = {"cad": 0.55, "mesh": 0.75}
# A fit that cannot come that close is taken at this part of the tolerance.
ENOUGH = 0.95
# A surface that crosses itself beyond its trim, or whose trims cross, or in a bend that the tolerance left loose, is fitted
# again in these ways, one after the other: in a rectangle that fits the region more closely (one surface only), cut in
# two where it bends most, to this part of the tolerance.
REFITS = (
    {"smallest_rectangle": True},
    {"cut": True},
    {"cut": True},
    {"part": 0.4},
    {"part": 0.16},
)
# The parts of a region that was cut are tangent to each other, so that their common edge is where their deviations happen to
# have it. Where trims cross or faces are at fault, the parts around are fitted to this part of the tolerance first.
CLOSER = 0.1
# Times that the edges of a region's quads are halved where it is too narrow for them.
HALVINGS = 3
# Where surfaces cannot be fitted, holes so many quads around at most are bridged for them.
SMALL_HOLE = 8
# Triangles per quad edge of the tessellation.
TRIANGLES_PER_EDGE = 3


class RegionResult:
    """What became of one region. Stages that were not reached are None; `error` says why.

    name, region (its triangles), guidance (directions from a file), field, seamless, tmesh, quantization, grid, quads,
    fitted: values of the compiled stages; field_edits: fields tried in vain; seconds: stage name -> seconds;
    cut_from: name of the region that it is a part of, None for a whole; cuts_left: how often it may be cut if it fails;
    holes: what became of boundary loops shorter than `fill_holes`; bridged: the region with its holes bridged, which
    field, seamless and tmesh are of (the region itself where no hole is).
    """

    def __init__(self, region):
        self.name = region.name
        self.region = self.mapped_region = self.bridged = region
        self.holes = None
        self.guidance = self.field = self.seamless = self.tmesh = self.quantization = None
        self.embedding = self.grid = self.quads = self.fitted = self.error = None
        self.edge_length = None  # of its quads
        self.fill_holes = 0.0  # holes shorter than this are bridged
        self.refits = self.field_edits = 0
        self.fitted_from = self  # whose map the B-spline surfaces are of: another one where none fits over its own
        self.bisections = []  # by round: charts cut in two because their faces were at fault
        self.seconds = {}
        self.cut_from = None
        self.fitted_closer = False
        self.cuts_left = MOST_CUTS

    @property
    def has_creases(self):
        """Whether the B-spline surfaces follow the sharp edges inside the region that its quads follow."""
        aligned = (r.region.features["aligned_edges"] for r in (self.fitted_from, self))
        return next(aligned) == next(aligned)

    @property
    def holes_bridged_to_fit(self):
        """How many holes the map of the B-spline surfaces goes on behind, though that of the quads does not."""
        return 0 if self.fitted_from is self or not self.fitted_from.holes else self.fitted_from.holes["bridged"]

    @property
    def polygons(self):
        """The quads as Polygons, or None."""
        return None if self.quads is None else Polygons.from_obj(self.quads.to_obj())

    @property
    def directions(self):
        """The cross field, or None: by triangle of the region one of its four unit directions, array (m, 3)."""
        return None if self.field is None else self.field.directions[: self.region.triangles]

    @property
    def singularities(self):
        """Singular vertices of the cross field: a list of Singularity, empty before the field is there. Those in holes
        that were bridged are not on the surface and not in the list."""
        if self.field is None:
            return []
        points, bridges = self.region.points, self._vertices_of_bridges()
        singular = [(v, index) for v, index in self.field.singular_vertices if v not in bridges]
        return [Singularity(v, index, tuple(points[v])) for v, index in singular]

    @property
    def bridged_singularities(self):
        """How many singular vertices of the cross field lie in holes that were bridged."""
        return 0 if self.field is None else len(self.field.singular_vertices) - len(self.singularities)

    def _vertices_of_bridges(self):
        if not self.bridged.bridge:
            return set()
        return set(self.bridged.corners[numpy.array(self.bridged.bridge, dtype=bool)].ravel().tolist())

    @property
    def seamless_map(self):
        """The seamless map of the region, without what bridges its holes; or None."""
        if self.seamless is None or not self.bridged.bridge:
            return self.seamless
        return load().without_bridges(self.seamless, self.bridged)

    @property
    def map(self):
        """The finest map that was reached (the grid map, else the seamless one) as a SurfaceMap, or None."""
        found = self.grid or self.seamless_map
        return None if found is None else SurfaceMap(*found.arrays)


class Singularity(NamedTuple):
    """A vertex where a cross field has no direction."""

    vertex: int  # of the region
    index: int  # in quarter turns: 1 where three quads meet, -1 where five do
    position: Tuple[float, float, float]


class SurfaceMap(NamedTuple):
    """A map of triangles into the plane."""

    points: object  # vertices, array (n, 3); the first are the region's own
    triangles: object  # vertex numbers, array (m, 3)
    uv: object  # by triangle and corner, in quads, array (m, 3, 2)


class Result:
    """A finished conversion.

    source, options (resolved), model, regions (RegionResult each), spline (the B-spline faces and their shared edges,
    or None where no region got that far), native_shape (the same assembled), faults (what OpenCASCADE finds wrong with
    it, "Edge7, Face2: SelfIntersect"), cuts (a Cut for each region that was replaced by its parts), warnings (lines for the
    user), seconds (of stages of the whole model).
    """

    def __init__(self, source, options, model):
        self.source = source
        self.options = options
        self.fit_tolerance = FIT_MARGIN[source.kind] * options.tolerance
        self.model = model
        self.regions = [RegionResult(region) for region in model.regions]
        self.spline = self.native_shape = None
        self.repairs = {}
        self.faults = []
        self.cuts = []
        self.guidance = None  # by region: its directions from a file
        self.warnings = []
        self.shape_counts = {}
        self.seconds = {}
        self.started = time.monotonic()

    @property
    def shape(self):
        """The B-spline model as Part.Shape (needs FreeCAD's modules), or None."""
        if self.native_shape is None:
            return None
        return shape_from_bytes(load().shape_to_freecad(self.native_shape))

    @property
    def failed(self):
        """The regions that failed."""
        return [r for r in self.regions if r.error is not None]

    def replace_by_parts(self, parts):
        """Replaces regions that failed by their parts (number of the region: RegionParts). Returns the numbers and the
        RegionResults of these."""
        before, self.model = self.model.regions, load().with_parts(self.model, parts)
        places, wholes, added = iter(enumerate(self.model.regions)), self.regions, []
        self.regions = []
        for number, whole in enumerate(wholes):
            if number not in parts:
                region = next(places)[1]
                for name in ("region", "mapped_region", "bridged"):
                    if getattr(whole, name) is before[number]:
                        setattr(whole, name, region)
                self.regions.append(whole)
                continue
            for index, region in (next(places) for _ in range(parts[number].count)):
                part = RegionResult(region)
                part.cut_from, part.cuts_left = whole.name, whole.cuts_left
                part.guidance = self.guidance and self.guidance(region)
                self.regions.append(part)
                added.append((index, part))
            names = tuple(part.name for _, part in added[-parts[number].count :])
            self.cuts.append(
                Cut(whole.name, whole.error, tuple(parts[number].edges), names, sum(whole.seconds.values()))
            )
            self.warnings.append(self.cuts[-1].warning)
        return added

    @property
    def report(self):
        """What report.json holds."""
        return report(self)

    def write(self, out, progress=None):
        """Write what `options.write` names into folder `out`; returns the names of the files.

        Every file is replaced whole, and none is replaced if one cannot be written. Raises Error(input).
        """
        from .output import OutputFolder, write_result

        with OutputFolder(out) as folder:
            return write_result(self, folder, progress or Progress())


def convert(thing, options=None, progress=None):
    """Convert a file, a Part.Shape, a list of faces, a Mesh.Mesh, (points, triangles) arrays or a Source.

    options   Options; the defaults where None
    progress  Progress, to watch and to cancel

    Returns a Result. A region that fails does not stop the others: see `Result.failed`. Results do not depend on the
    number of threads. Raises Error: 'input' where the input or an option is unusable, 'stage' where the whole model
    fails, 'cancelled'.
    """
    options = options or Options()
    progress = progress or Progress()
    options.validate()
    source = thing if isinstance(thing, Source) else Source(thing)
    try:
        return _convert(source, options, progress)
    except MemoryError as error:
        raise system_error("convert", error) from None


def _convert(source, options, progress):
    started = time.monotonic()
    with progress.stage("read"):
        thing = source.read()
    with progress.stage("tessellate") as native_progress:
        build = _cad_model if source.kind == "cad" else _mesh_model
        result = build(source, thing, options, native_progress)
        result.guidance = _read_field(result, thing)
    if result.guidance is not None:
        for item in result.regions:
            item.guidance = result.guidance(item.region)
    result.started = started
    result.seconds["tessellate"] = time.monotonic() - started
    _map_regions(list(enumerate(result.regions)), result, progress)
    _trim(result, progress)
    _warn_of_regions(result)
    _warn_of_holes(result)
    _check(result, progress)
    return result


def _cad_model(source, shape, options, native_progress):
    options = options.resolved("cad", shape.area, shape.diagonal, os.cpu_count() or 1)
    model = load().tessellate(
        shape,
        edge_length=options.edge_length / TRIANGLES_PER_EDGE,
        tolerance=FIT_MARGIN["cad"] * options.tolerance,
        features=_feature_options(options),
        progress=native_progress,
    )
    result = Result(source, options, model)
    result.shape_counts = {"faces": shape.faces, "edges": shape.edges}
    if model.kept_apart:
        result.warnings.append("the loose faces make up no surface when they are joined along their edges; they stay apart")
    return result


def _mesh_model(source, mesh, options, native_progress):
    native = load()
    repaired = native.repair(mesh)
    options = options.resolved("mesh", repaired.area, repaired.diagonal, os.cpu_count() or 1)
    model = native.mesh_model(repaired, _feature_options(options), native_progress)
    result = Result(source, options, model)
    result.shape_counts = {"faces": mesh.triangles, "edges": len(model.curves)}
    result.repairs = repaired.repairs
    if repaired.summary:
        result.warnings.append(f"the mesh was repaired: {repaired.summary}")
    return result


def _feature_options(options):
    vertices, points = options.feature_vertices_and_points()
    return load().FeatureOptions(
        features=options.features,
        angle=options.feature_angle,
        align_boundary=options.boundary == "aligned",
        align=options.align,
        free=options.free,
        vertices=vertices,
        points=points,
        quad_length=options.edge_length,
    )


def _read_field(result, thing):
    """For a field from a file: the function that gives a region its FieldGuidance. Otherwise None. Raises Error(input)."""
    if result.options.field in FIELDS:
        return None
    native = load()
    field = native.read_field(os.fspath(result.options.field))
    if field.placed:
        return lambda region: native.guidance_of_points(region, field)
    if result.source.kind == "cad":
        raise input_error(
            "options",
            f"--field {result.options.field}: a CAD shape has no faces or vertices of a mesh that directions could be "
            "given for; give a point before each direction",
        )
    directions = native.triangle_directions(field, thing)
    return lambda region: native.guidance_of_triangles(region, directions)


def _map_regions(waiting, result, progress):
    """The stages of regions (number, RegionResult), then of the parts of those that failed."""
    while waiting:
        progress.region_count = len(result.regions)
        with ThreadPoolExecutor(max_workers=result.options.threads) as pool:
            for done in [pool.submit(_map_region, r, k, result, progress) for k, r in waiting]:
                done.result()
        waiting = cut_failed(result, progress)


def _warn_of_regions(result):
    for item in result.regions:
        if item.error is None and item.edge_length != result.options.edge_length:
            result.warnings.append(
                f"region '{item.name}' is too narrow for the quads; its edge length is {item.edge_length:.6g}"
            )
        if not item.has_creases:
            result.warnings.append(
                f"region '{item.name}': the B-spline surfaces cannot follow its sharp edges as creases and round them within "
                "the tolerance"
            )
        if item.holes_bridged_to_fit:
            result.warnings.append(
                f"region '{item.name}': the B-spline surfaces go on behind {item.holes_bridged_to_fit} small holes, which the "
                "quads do not"
            )
        if item.fitted is not None and item.fitted.folded:
            place = ", ".join(f"{x:.6g}" for x in item.fitted.folded[0])
            result.warnings.append(
                f"region '{item.name}': the B-spline surfaces have small folds within the tolerance, at "
                f"{len(item.fitted.folded)} of {item.fitted.samples} places that were looked at (the first at {place}); use a "
                "smaller edge length"
            )
        given_up = item.field and item.region.features["aligned_edges"] - item.field.aligned_edges
        if given_up:
            result.warnings.append(
                f"region '{item.name}': {given_up} aligned edges meet others at too sharp an angle to be followed as well"
            )


def _warn_of_holes(result):
    """Where holes were to be bridged, but none was."""
    counts = [item.holes for item in result.regions if item.holes is not None]
    if not counts or any(c["bridged"] for c in counts):
        return
    aligned, ends = (sum(c[kind] for c in counts) for kind in ("aligned", "ends"))
    reasons = [f"{aligned} are aligned (--free sets them free)"] if aligned else []
    reasons += [f"{ends} are ends of surfaces, not holes in them"] if ends else []
    which = f": of the shorter boundary loops {', '.join(reasons)}" if reasons else "; no boundary loop is shorter"
    result.warnings.append(f"--fill-holes {result.options.fill_holes:.6g} bridges no hole{which}")


def _grid_map(item, index, result, run):
    """By the direct route, the constructive one, or the first and where it fails the other."""
    native = load()
    route = result.options.route
    if route != "reembed":
        try:
            item.grid = run("optimize", native.grid_map, item.bridged, item.seamless, item.tmesh, item.quantization,
                            route == "direct")
            item.embedding = {"route": "direct", "inserted_vertices": 0, "collapses": 0, "splits": 0}
            return
        except Error as error:
            if route == "direct" or error.kind != "stage":
                raise
    # The model's region gets the refined mesh; field and seamless map are of the one before.
    before = native.copy_region(item.region)
    if item.bridged is item.region:
        item.bridged = before
    item.region = before
    embedded = run("reembed", native.embed, item.seamless, item.tmesh, item.quantization)
    item.grid, counters = run("optimize", native.embedded_grid_map, result.model, index, item.bridged, item.seamless,
                                   embedded)
    item.mapped_region = result.model.regions[index]
    item.embedding = {"route": "reembedded", **counters}


def _polygonal(quads, item, options):
    """The quads. Raises Error where they were asked for and their polygons are no manifold."""
    place = quads.doubled_side
    if place is not None and "quads" in options.write:
        raise Error(
            "stage", "extract", "two quads would share more than one side, the surface is less than three quads around "
            "there; use a shorter edge length", item.name, place, coarse=True,
        )
    return quads


def _fit(item, result, progress, smallest_rectangle=False, part=1.0, only=True):
    """Surfaces of a region within this part of the tolerance; within all of it where that cannot be reached and is not asked
    for `only`."""
    options = result.options
    native = load()
    tolerance = part * result.fit_tolerance
    return native.fit_surface(
        item.fitted_from.mapped_region,
        item.fitted_from.grid,
        native.FitOptions(
            tolerance=tolerance,
            enough=tolerance if only and part != 1 else ENOUGH * options.tolerance,
            smallest_rectangle=smallest_rectangle,
            bisections=item.bisections,
            degree=options.degree,
            threads=max(1, options.threads // len(result.regions)),
        ),
        progress,
    )


def _map_region(item, index, result, progress):
    """The stages of one region, with shorter edges where it is too narrow for quads as large as they are wanted. The
    first Error that these do not cure ends it and is kept in the region."""
    item.edge_length, item.fill_holes = result.options.edge_length, result.options.fill_holes
    for halving in range(HALVINGS + 1):
        try:
            return _try_region(item, index, result, progress)
        except Error as error:
            if error.kind == "cancelled":
                raise
            refined = item.mapped_region is not item.region
            if error.coarse and halving < HALVINGS and not (refined and item.guidance is not None):
                item.edge_length /= 2
                item.region = item.mapped_region
                item.grid = item.quads = item.fitted = None
                continue
            if not (error.stage == "fit" and _fit_another_way(item, index, result, progress)):
                item.error = error
        except MemoryError as error:
            item.error = system_error("memory", error)
        return


def _fit_another_way(item, index, result, progress):
    """Surfaces over another map of the region, where none fits over its own: one that goes on behind small holes, and of a
    mesh one that does not follow its sharp edges. The region's quads stay as they are. Whether they could be fitted."""
    if item.quads is None:
        return False
    native = load()
    if item.mapped_region is item.region:
        item.region = item.mapped_region = native.copy_region(item.region)
    else:
        item.mapped_region = native.copy_region(item.mapped_region)
    small = SMALL_HOLE * item.edge_length
    regions = [(item.region, small)]
    if result.source.kind == "mesh" and not result.options.align and item.region.features["aligned_edges"]:
        smooth = native.without_creases(item.region)
        if smooth.features["aligned_edges"] < item.region.features["aligned_edges"]:
            regions += [(smooth, item.fill_holes), (smooth, small)]
    for region, fill_holes in regions:
        native.place_region(result.model, index, region)
        other = RegionResult(result.model.regions[index])
        other.edge_length, other.guidance, other.fill_holes = item.edge_length, item.guidance, fill_holes
        if fill_holes > item.fill_holes and not _has_holes(other, index, result, progress):
            continue
        try:
            _try_region(other, index, result, progress)
            item.fitted, item.fitted_from = other.fitted, other
            return True
        except Error as error:
            if error.kind == "cancelled":
                raise
        finally:
            for stage, seconds in other.seconds.items():
                item.seconds[stage] = item.seconds.get(stage, 0.0) + seconds
    native.place_region(result.model, index, item.mapped_region)
    return False


def _has_holes(item, index, result, progress):
    """Whether bridging would close a hole of a region."""
    with progress.stage("bridge", item.name) as native_progress:
        return load().bridge_holes(result.model, index, item.fill_holes, native_progress)[1]["bridged"] > 0


def _try_region(item, index, result, progress):
    """The stages of one region in their order, as far as what is to be written needs them."""
    native = load()
    options = result.options

    def run(stage, function, *arguments):
        with progress.stage(stage, item.name) as native_progress:
            started = time.monotonic()
            try:
                return function(*arguments, native_progress)
            finally:
                item.seconds[stage] = time.monotonic() - started

    item.bridged = item.region
    if item.fill_holes > 0:
        item.bridged, item.holes = run("bridge", native.bridge_holes, result.model, index, item.fill_holes)
    seed = run("seamless", native.seed, item.bridged, str(options.field), item.guidance, options.field_weight,
               item.edge_length)
    item.field, item.seamless, item.field_edits = seed.field, seed.map, seed.field_edits
    if seed.refined:
        # The model's region gets halved edges; the field and all maps are of these.
        whole, item.guidance = native.place_refined(result.model, index, item.bridged, seed, item.guidance)
        region = result.model.regions[index]
        item.bridged = region if item.bridged is item.region else whole
        item.region = item.mapped_region = region
    item.seconds.update(field=seed.field_seconds, seamless=seed.seamless_seconds)
    if options.wants("partition"):
        item.tmesh = run("partition", native.partition, item.seamless)
    if options.wants("quantize"):
        item.quantization = run("quantize", native.quantize, item.tmesh, options.optimal)
    if options.wants("optimize"):
        _grid_map(item, index, result, run)
    if options.wants("extract"):
        item.quads = _polygonal(run("extract", native.extract_quads, item.grid, item.mapped_region), item, options)
        if options.merge_slivers > 0:
            native.merge_slivers(item.quads, options.merge_slivers)
    if options.wants("fit"):
        item.fitted = run("fit", _fit, item, result)


def _refit(item, charts, error, result, progress):
    """Fits a region again in the next of the ways there are. Where there is none left, its error is kept instead.

    charts: those whose faces are at fault; empty where the region's edges are
    """
    try:
        item.refits += 1
        while item.refits <= len(REFITS) and not _applies(REFITS[item.refits - 1], item, charts):
            item.refits += 1
        if item.refits > len(REFITS):
            raise error
        way = dict(REFITS[item.refits - 1])
        if way.pop("cut", False):
            item.bisections = [*item.bisections, sorted(charts)]
        with progress.stage("fit", item.name) as native_progress:
            item.fitted = _fit(item, result, native_progress, **way)
    except Error as failure:
        if failure.kind == "cancelled":
            raise
        item.fitted = None
        item.error = failure


def _fit_parts_closer(item, result, progress):
    """Fits the parts of cut regions around a region more closely, once. Whether there are any that could be."""
    closer = False
    for index in load().touching_regions(result.model, result.regions.index(item)):
        part = result.regions[index]
        if part.cut_from is None or part.fitted is None or part.fitted_closer:
            continue
        part.fitted_closer = True
        try:
            with progress.stage("fit", part.name) as native_progress:
                part.fitted = _fit(part, result, native_progress, part=CLOSER, only=False)
            closer = True
        except Error as error:
            if error.kind == "cancelled":
                raise
    return closer


def _applies(way, item, charts):
    if "smallest_rectangle" in way:
        return bool(charts) and not item.fitted.several
    return bool(charts) or "cut" not in way


def _refit_faulty(result, progress):
    """Fits regions again whose faces OpenCASCADE finds at fault. Whether there were any."""
    faulty = {}  # index of the region: charts and a fault
    for face, faults in zip(result.spline.faces, load().face_faults(result.spline)):
        if faults:
            faulty.setdefault(face["region"], []).append((face["chart"], faults[0]))
    if any([_fit_parts_closer(result.regions[index], result, progress) for index in faulty]):
        return True
    for index, found in faulty.items():
        item = result.regions[index]
        advice = f"OpenCASCADE finds the fitted surface at fault ({found[0][1]}); use a smaller tolerance"
        _refit(item, {chart for chart, _ in found}, Error("stage", "fit", advice, item.name), result, progress)
    return bool(faulty)


def _trim(result, progress):
    """Trims and joins the fitted surfaces. A region that cannot be trimmed is fitted again, then cut; where that does not
    help it is left out and the others tried again."""
    native = load()
    started = time.monotonic()
    elsewhere = 0.0
    while any(r.fitted is not None for r in result.regions):
        try:
            with progress.stage("trim") as native_progress:
                result.spline = native.trim_model(
                    result.model,
                    [r.fitted_from.grid if r.fitted is not None else None for r in result.regions],
                    [r.fitted for r in result.regions],
                    result.fit_tolerance,
                    native_progress,
                )
                result.native_shape = native.assemble(result.spline)
            if not _refit_faulty(result, progress):
                break
            result.spline = None  # its faces are at fault
        except Error as error:
            if error.kind == "cancelled":
                raise
            result.spline = None
            # `where` is the region's name, or the name and an edge of it.
            name = error.where.split(",")[0]
            guilty = [r for r in result.regions if r.fitted is not None and r.name == name]
            for item in guilty:
                if not _fit_parts_closer(item, result, progress):
                    _refit(item, set(), error, result, progress)
            if not guilty:
                for item in result.regions:
                    if item.fitted is not None:
                        item.fitted = None
                        item.error = error
                        item.cuts_left = 0  # none of them is to blame
        paused = time.monotonic()
        _map_regions(cut_failed(result, progress), result, progress)
        elsewhere += time.monotonic() - paused
    if result.spline is None:
        result.native_shape = None
    result.seconds["trim"] = time.monotonic() - started - elsewhere
    if progress.cancelled:
        raise cancelled()


def _check(result, progress):
    """OpenCASCADE's check of the whole model, but for faces that cross others: that can take longer than all the rest."""
    if result.native_shape is None:
        return
    started = time.monotonic()
    with progress.stage("check"):
        result.faults = load().shape_faults(result.native_shape, False)
    result.seconds["trim"] += time.monotonic() - started
    if result.faults:
        shown = "; ".join(result.faults[:3]) + ("; ..." if len(result.faults) > 3 else "")
        result.warnings.append(
            f"OpenCASCADE finds faults in the B-spline model ({len(result.faults)}: {shown}); use a smaller tolerance"
        )
