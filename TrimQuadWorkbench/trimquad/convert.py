"""From a shape or a mesh to quads and B-spline faces: the one function behind the command line, scripts and the GUI."""
import os
import time
from concurrent.futures import ThreadPoolExecutor

from .error import Error, cancelled, system_error
from .freecad_shape import shape_from_bytes
from .native import load
from .options import Options
from .polygons import Polygons
from .progress import Progress
from .report import report
from .source import Source

# Stages keep to this part of the tolerance, so that what they add up to stays under it; by kind of input. Between curved
# surfaces, deviations can only be measured up to the chord errors of both.
FIT_MARGIN = {"cad": 0.55, "mesh": 0.75}
# A face that crosses itself beyond its trim, or in a bend that the tolerance left loose, is fitted again this many times,
# each time to this part of the tolerance before.
REFITS = 3
REFIT_PART = 0.4
# Triangles per quad edge of the tessellation.
TRIANGLES_PER_EDGE = 3


class RegionResult:
    """What became of one region. Stages that were not reached are None; `error` says why.

    name, region (its triangles), field, seamless, tmesh, quantization, grid, quads, fitted: values of the compiled stages;
    seconds: stage name -> seconds.
    """

    def __init__(self, region):
        self.name = region.name
        self.region = region
        self.field = self.seamless = self.tmesh = self.quantization = self.grid = self.quads = self.fitted = self.error = None
        self.refits = 0
        self.seconds = {}

    @property
    def polygons(self):
        """The quads as Polygons, or None."""
        return None if self.quads is None else Polygons.from_obj(self.quads.to_obj())


class Result:
    """A finished conversion.

    source, options (resolved), model, regions (RegionResult each), spline (the B-spline faces and their shared edges,
    or None where no region got that far), native_shape (the same assembled), seconds (of stages of the whole model).
    """

    def __init__(self, source, options, model):
        self.source = source
        self.options = options
        self.fit_tolerance = FIT_MARGIN[source.kind] * options.tolerance
        self.model = model
        self.regions = [RegionResult(region) for region in model.regions]
        self.spline = self.native_shape = None
        self.repairs = {}
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
    result.started = started
    result.seconds["tessellate"] = time.monotonic() - started
    _map_regions(result, progress)
    _trim(result, progress)
    return result


def _cad_model(source, shape, options, native_progress):
    options = options.resolved("cad", shape.area, shape.diagonal, os.cpu_count() or 1)
    model = load().tessellate(
        shape,
        edge_length=options.edge_length / TRIANGLES_PER_EDGE,
        tolerance=FIT_MARGIN["cad"] * options.tolerance,
        feature_angle=options.feature_angle,
        features=options.features,
        progress=native_progress,
    )
    result = Result(source, options, model)
    result.shape_counts = {"faces": shape.faces, "edges": shape.edges}
    return result


def _mesh_model(source, soup, options, native_progress):
    trim_angle = options.feature_angle if options.features == "trim" else None
    model, repairs = load().mesh_model(soup, trim_angle, native_progress)
    area = sum(region.area for region in model.regions)
    result = Result(source, options.resolved("mesh", area, model.diagonal, os.cpu_count() or 1), model)
    result.shape_counts = {"faces": soup.triangles, "edges": model.curves}
    result.repairs = repairs
    return result


def _map_regions(result, progress):
    progress.region_count = max(1, len(result.regions))
    with ThreadPoolExecutor(max_workers=result.options.threads) as pool:
        for done in [pool.submit(_map_region, r, result, progress) for r in result.regions]:
            done.result()


def _map_region(item, result, progress):
    """The stages of one region in their order; the first Error ends it and is kept in the region."""
    native = load()
    options = result.options

    def run(stage, function, *arguments):
        with progress.stage(stage, item.name) as native_progress:
            started = time.monotonic()
            try:
                return function(*arguments, native_progress)
            finally:
                item.seconds[stage] = time.monotonic() - started

    try:
        item.field = run("field", native.cross_field, item.region)
        item.seamless = run("seamless", native.seamless_map, item.region, item.field, options.edge_length)
        item.tmesh = run("partition", native.partition, item.seamless)
        item.quantization = run("quantize", native.quantize, item.tmesh, options.optimal)
        item.grid = run("optimize", native.grid_map, item.seamless)
        item.quads = run("extract", native.extract_quads, item.grid, item.region)
        if "nurbs" in options.write or "fcstd" in options.write or "pictures" in options.write:
            item.fitted = run(
                "fit", native.fit_surface, item.region, item.grid, result.fit_tolerance, options.degree
            )
    except Error as error:
        if error.kind == "cancelled":
            raise
        item.error = error
    except MemoryError as error:
        item.error = system_error("memory", error)


def _refit_faulty(result, progress):
    """Fits regions again, more closely, whose faces OpenCASCADE finds at fault. Whether the model must be trimmed again."""
    native = load()
    changed = False
    for face, faults in zip(result.spline.faces, native.face_faults(result.spline)):
        item = result.regions[face["region"]]
        if not faults or item.fitted is None:
            continue
        changed = True
        item.refits += 1
        tolerance = result.fit_tolerance * REFIT_PART**item.refits
        try:
            if item.refits > REFITS:
                advice = f"OpenCASCADE finds the fitted surface at fault ({faults[0]}); use a smaller tolerance"
                raise Error("stage", "fit", advice, item.name)
            with progress.stage("fit", item.name) as native_progress:
                item.fitted = native.fit_surface(
                    item.region, item.grid, tolerance, result.options.degree, native_progress
                )
        except Error as error:
            if error.kind == "cancelled":
                raise
            item.fitted = None
            item.error = error
    return changed


def _trim(result, progress):
    """Trims and joins the fitted surfaces. A region that cannot be trimmed is left out and the others tried again."""
    native = load()
    started = time.monotonic()
    while any(r.fitted is not None for r in result.regions):
        try:
            with progress.stage("trim") as native_progress:
                result.spline = native.trim_model(
                    result.model,
                    [r.grid if r.fitted is not None else None for r in result.regions],
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
            for item in guilty or [r for r in result.regions if r.fitted is not None]:
                item.fitted = None
                item.error = error
    if result.spline is None:
        result.native_shape = None
    result.seconds["trim"] = time.monotonic() - started
    if progress.cancelled:
        raise cancelled()
