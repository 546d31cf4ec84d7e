"""From a shape or a mesh to quads and B-spline faces: the one function behind the command line, scripts and the GUI."""
import os
import time
from dataclasses import replace

from .cuts import Cut
from .deviation import worst_place
from .error import input_error, system_error
from .freecad_shape import shape_from_bytes
from .joining import check, trim
from .native import load
from .options import FIELDS, Options
from .progress import Progress
from .regions import MOST_WORK_BEFORE_CUT, RegionResult, fit_undivided, map_regions
from .report import report
from .source import Source
from .texture import pattern_image

# Stages keep to this part of the tolerance, so that what they add up to stays under it; by kind of input. Between curved
# surfaces, deviations can only be measured up to the chord errors of both.
FIT_MARGIN = {"cad": 0.55, "mesh": 0.75}
# Part of its area that a divided mesh has surfaces of at least, to be kept where the whole has none.
WORTH_DIVIDING = 0.25
# Triangles per quad edge of the tessellation.
TRIANGLES_PER_EDGE = 3


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
        self.pattern = None  # pixels of the texture, where they are from a file
        self.warnings = []
        self.shape_counts = {}
        self.seconds = {}
        self.work_of_checks = 0  # of faces, in steps as long as those of fits
        self.work_of_replaced = 0  # of the fits of regions that were replaced by their parts
        self.may_be_divided = False  # a mesh, along its sharp edges, if there are no surfaces of a region over its own map
        self.work_in_vain = 0  # of the fits of another Result, which this one replaces or which did not replace this one
        self.exhausted = False  # no other ways of fitting any region are tried
        self.started = time.monotonic()

    @property
    def shape(self):
        """The B-spline model as Part.Shape (needs FreeCAD's modules), or None."""
        if self.native_shape is None:
            return None
        return shape_from_bytes(load().shape_to_freecad(self.native_shape))

    @property
    def work(self):
        """Of all fits and checks, in steps (see RegionResult.work)."""
        return self.work_of_checks + self.work_of_replaced + sum(r.work for r in self.regions)

    @property
    def failed(self):
        """The regions that failed."""
        return [r for r in self.regions if r.error is not None]

    @property
    def undivided(self):
        """The regions that failed and may not if the mesh is divided along its sharp edges."""
        return [r for r in self.failed if r.may_be_divided]

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
                whole.put_aside.clear()  # of the regions of the model before
                self.regions.append(whole)
                continue
            for index, region in (next(places) for _ in range(parts[number].count)):
                part = RegionResult(region)
                part.cut_from, part.cuts_left = whole.name, whole.cuts_left
                part.guidance = self.guidance and self.guidance(region)
                self.regions.append(part)
                added.append((index, part))
            names = tuple(part.name for _, part in added[-parts[number].count :])
            self.work_of_replaced += whole.work
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
    pattern = None if options.pattern is None else pattern_image(options.pattern)
    source = thing if isinstance(thing, Source) else Source(thing)
    kept_memory = load().KeptMemory()
    try:
        result = _convert(source, options, progress)
        result.pattern = pattern
        return result
    except MemoryError as error:
        raise system_error("convert", error) from None
    finally:
        del kept_memory


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
    map_regions(list(enumerate(result.regions)), result, progress)
    if result.undivided:
        result = _divided_where_that_helps(result, thing, progress)
    else:
        trim(result, progress)
    _warn_of_regions(result)
    _warn_of_holes(result)
    check(result, progress)
    return result


def _divided_where_that_helps(whole, mesh, progress):
    """The Result of a mesh in which surfaces cannot follow sharp edges inside a region: divided along all of them, if all
    regions are converted then, or a good part of their area where nothing of the whole is. Else that of the whole, over
    other maps."""
    divided = _divided(whole, mesh, progress)
    if divided is not None:
        if _converted_part(divided) >= WORTH_DIVIDING:
            trim(divided, progress)
            if not divided.failed:
                return divided
        whole.work_in_vain = divided.work
        whole.exhausted = divided.work > MOST_WORK_BEFORE_CUT
    fit_undivided(whole, progress)
    trim(whole, progress)
    better = whole.spline is None and divided is not None and divided.spline is not None
    return divided if better and _converted_part(divided) >= WORTH_DIVIDING else whole


def _converted_part(result):
    """Of the area of all regions, that of those that have not failed."""
    converted = sum(item.region.area for item in result.regions if item.error is None)
    return converted / sum(item.region.area for item in result.regions)


def _divided(whole, mesh, progress):
    """The Result, up to the fit, of a mesh divided along its sharp edges; None where these divide nothing."""
    with progress.stage("cut") as native_progress:
        options = replace(whole.options, features="trim")
        result = _mesh_model(whole.source, mesh, options, native_progress)
    if len(result.regions) <= len(whole.regions):
        return None
    result.started, result.seconds = whole.started, dict(whole.seconds)
    result.work_in_vain = whole.work
    map_regions(list(enumerate(result.regions)), result, progress)
    failed = whole.undivided[0]
    result.warnings.append(
        f"region '{failed.name}' could not be converted as a whole (stage {failed.error.stage}: {failed.error}); the mesh was "
        f"divided along its sharp edges into {len(result.regions)} regions, as --features trim does"
    )
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
    by_default = options.features is None
    options = options.resolved("mesh", repaired.area, repaired.diagonal, os.cpu_count() or 1)
    model = native.mesh_model(repaired, _feature_options(options), native_progress)
    result = Result(source, options, model)
    # What is said of its edges and directions would mean nothing where it is divided.
    result.may_be_divided = (
        by_default and options.field in FIELDS and not (options.align or options.free or options.feature_points)
    )
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
        if item.fitted_around_singularities:
            result.warnings.append(
                f"region '{item.name}': no single B-spline surface fits, there are several around "
                f"{len(item.fitted_from.singularities)} irregular vertices, which the quads do not have"
            )
        if item.fitted is not None and item.fitted.folded:
            place = ", ".join(f"{x:.6g}" for x in item.fitted.folded[0])
            result.warnings.append(
                f"region '{item.name}': the B-spline surfaces have small folds within the tolerance, at "
                f"{len(item.fitted.folded)} of {item.fitted.samples} places that were looked at (the first at {place}); use a "
                "smaller edge length"
            )
        if item.fitted is not None and item.fitted.max_deviation > result.options.tolerance:
            place = ", ".join(f"{x:.6g}" for x in worst_place(item))
            result.warnings.append(
                f"region '{item.name}': the B-spline surfaces are up to {item.fitted.max_deviation:.3g} away, more than the "
                f"tolerance {result.options.tolerance:.3g}, in narrow bulges (the farthest at {place}); use a smaller edge length"
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
