"""The regions of a conversion: what becomes of each, and the stages from triangles to fitted surfaces."""
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple, Tuple

import numpy

from .cuts import CUTS, cut_failed, has_parts, may_cut
from .error import Error, system_error
from .native import load
from .polygons import Polygons

# A fit that cannot come that close is taken at this part of the tolerance.
ENOUGH = 0.95
# Poles that a fit to a part of the tolerance may take, by those that there are, and how many more in any case. The part 0.1
# takes three times as many of smooth surfaces; more are no help where these are not.
MORE_POLES, FEW_POLES = 5, 1000
# Work of a region's fits after which no other ways of fitting it are tried; less, and with that of its maps, where it can be
# cut instead. And the same for a whole model, with the checks of its faces. 1e6 steps take about half a second. Work rather
# than time, so that results do not depend on the machine.
MOST_WORK, MOST_WORK_BEFORE_CUT, MOST_WORK_OF_MODEL = 45e6, 10e6, 150e6
# Of one fit to such a region of several CAD faces.
MOST_WORK_OF_FIT = 30_000_000
# And to a mesh that may be divided along its sharp edges instead, in any case and for each of its triangles: about twice what
# fits take that follow these as creases.
MOST_WORK_BEFORE_DIVISION, MOST_WORK_BY_TRIANGLE = 8_000_000, 1000
# After so much, surfaces that have folds, which may do no harm, are not given up for those over another map; several only
# for a single one.
MOST_WORK_BEFORE_CHOICE = 8e6
# Poles that surfaces over a region of several CAD faces may take, for each of the faces' own and in any case, where the
# tolerance is 1e-4 of the diagonal; with others they grow like its inverse root, as those of smooth surfaces do. What takes
# more follows joints between the faces that are not smooth enough, and is simpler when cut along them.
MOST_POLES_OF_CAD, FEWEST_LIMIT = 25, 5000
# Times that the edges of a region's quads are halved where it is too narrow for them.
HALVINGS = 3
# Where surfaces cannot be fitted, holes so many quads around at most are bridged for them.
SMALL_HOLE = 8


class OtherMap(NamedTuple):
    """A map of a region that surfaces may be fitted over; with nothing special about it, that of its quads."""

    behind_small_holes: bool = False  # it goes on there
    creases_rounded: bool = False  # it does not follow the sharp edges of a mesh
    singularities: str = "weighed"  # against distortion; "none": one surface holds the region; or those "of field"


# The mean symmetric Dirichlet energy of a map without singularities up to which surfaces are fitted over it; 4 is an
# isometry.
MOST_DISTORTION = 10

OWN_MAP = OtherMap()
BEHIND_HOLES = OtherMap(behind_small_holes=True)
WITHOUT_SINGULARITIES = OtherMap(singularities="none")
WITH_SINGULARITIES = OtherMap(singularities="of field")
# In the order in which they are tried.
OTHER_MAPS = (
    OWN_MAP,
    BEHIND_HOLES,
    WITHOUT_SINGULARITIES,
    WITH_SINGULARITIES,
    OtherMap(creases_rounded=True),
    OtherMap(creases_rounded=True, singularities="none"),
    OtherMap(creases_rounded=True, behind_small_holes=True),
)

SINGLE_SURFACES = tuple(way for way in OTHER_MAPS if way.singularities == "none")


class RegionResult:
    """What became of one region. Stages that were not reached are None; `error` says why.

    name, region (its triangles), guidance (directions from a file), field, seamless, tmesh, quantization, grid, quads,
    fitted: values of the compiled stages; field_edits: fields tried in vain; seconds: stage name -> seconds, those of
    attempts that failed included;
    cut_from: name of the region that it is a part of, None for a whole; cuts_left: how many ways of cutting it are left if
    it fails;
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
        self.most_poles = self.most_work = None  # that its surfaces and the fit may take, where there are limits
        self.wanted_singularities = "weighed"  # which ones the map is to have, as OtherMap.singularities
        self.refits = self.field_edits = 0
        self.fitted_from = self  # whose map the B-spline surfaces are of: another one where none fits over its own
        self.other_maps = []  # those that were tried
        self.put_aside = {}  # surfaces over another map that may still be taken: by map, its RegionResult and mesh
        self.bisections = []  # by round: charts cut in two because their faces were at fault
        self.smoothings = {}  # by chart: in how many steps its surface is made smoother, for the same reason
        self.before_revision = None  # surfaces before some of them were, the charts and why
        self.seconds = {}
        self.work = 0  # of its fits: samples whose feet were looked for
        self.work_of_maps = 0
        self.may_be_divided = False  # along its sharp edges, as it failed
        self.cut_from = None
        self.holds_corners = False
        self.before_held = None  # attributes as they were before corners were held
        self.fitted_in = []  # ways, arguments of fit(), in which it was fitted once more to suit others
        self.meetings = {}  # by region that its surfaces cross: CAD faces of both that meet without a common edge, or None
        self.left_out = None  # surfaces that could not be trimmed
        self.left_out_between = []  # each time those around it then
        self.cuts_left = len(CUTS)
        self.parts = None  # of the cut that comes next, where it is known
        self.has_parts = None  # whether it consists of several, where that is known

    @property
    def has_creases(self):
        """Whether the B-spline surfaces follow the sharp edges inside the region that its quads follow."""
        aligned = (r.region.features["aligned_edges"] for r in (self.fitted_from, self))
        return next(aligned) == next(aligned)

    @property
    def holes_bridged_to_fit(self):
        """How many holes the map of the B-spline surfaces goes on behind, though that of the quads does not."""
        to_fit, own = (r.holes["bridged"] if r.holes else 0 for r in (self.fitted_from, self))
        return to_fit - own

    @property
    def fitted_without_singularities(self):
        """Whether the map of the B-spline surfaces has no singularities, though that of the quads has."""
        return self.fitted_from is not self and self.fitted_from.wanted_singularities == "none"

    @property
    def fitted_around_singularities(self):
        """Whether the map of the B-spline surfaces has singularities, though that of the quads has none."""
        return self.fitted_from is not self and self.fitted_from.wanted_singularities == "of field"

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


def map_regions(waiting, result, progress):
    """The stages of regions (number, RegionResult), then of the parts of those that failed."""
    while waiting:
        progress.region_count = len(result.regions)
        with ThreadPoolExecutor(max_workers=result.options.threads) as pool:
            for done in [pool.submit(_map_region, r, k, result, progress) for k, r in waiting]:
                done.result()
        waiting = cut_failed(result, progress)


def _map_region(item, index, result, progress):
    """The stages of one region, with shorter edges where it is too narrow for quads as large as they are wanted. The
    first Error that these do not cure ends it and is kept in the region."""
    item.edge_length, item.fill_holes = result.options.edge_length, result.options.fill_holes
    item.most_poles = _most_poles(index, result)
    item.most_work = _most_work(item, result)
    for halving in range(HALVINGS + 1):
        try:
            _try_region(item, index, result, progress)
            if item.fitted is not None and item.fitted.folded and item.work <= MOST_WORK_BEFORE_CHOICE:
                most = item.fitted.control_points
                ways = SINGLE_SURFACES if item.fitted.several else OTHER_MAPS
                fit_over_another_map(item, result, progress, ways,
                                     takes=lambda fitted: not fitted.folded and fitted.control_points <= most)
        except Error as error:
            if error.kind == "cancelled":
                raise
            refined = item.mapped_region is not item.region
            may_refine = error.coarse and not (refined and item.guidance is not None)
            if may_refine and halving < HALVINGS and not exhausted(item, result, progress):
                item.edge_length /= 2
                item.region = item.mapped_region
                item.grid = item.quads = item.fitted = None
                continue
            item.may_be_divided = error.stage == "fit" and _may_be_divided(item, result)
            if item.may_be_divided or not _fits_over_another_map(item, error, result, progress):
                item.error = error
        except MemoryError as error:
            item.error = system_error("memory", error)
        return


def _most_poles(index, result):
    """The limit for the surfaces over a region that can be cut between CAD faces, or None."""
    poles = load().cad_poles(result.model, index) if may_cut(result) else None
    if poles is None:
        return None
    finer = (1e-4 * result.model.diagonal / result.options.tolerance) ** 0.5
    return int(finer * max(FEWEST_LIMIT, MOST_POLES_OF_CAD * poles))


def _may_be_divided(item, result):
    return result.may_be_divided and item.region.features["aligned_edges"] > 0


def _most_work(item, result):
    """The limit for one fit to a region that can be cut or divided instead, or None."""
    if item.most_poles is not None:
        return MOST_WORK_OF_FIT
    if not _may_be_divided(item, result):
        return None
    return MOST_WORK_BEFORE_DIVISION + MOST_WORK_BY_TRIANGLE * item.region.triangles


def fit_undivided(result, progress):
    """What _map_region() puts off while a mesh may be divided: the rest of a fit that was given up for that, and surfaces
    over other maps of its regions."""
    for item in result.undivided:
        if item.most_work is not None and item.work > item.most_work:
            item.other_maps = [way for way in item.other_maps if way != OWN_MAP]
        item.most_work = None
        if _fits_over_another_map(item, item.error, result, progress):
            item.error = None


def _fits_over_another_map(item, error, result, progress):
    return error.stage == "fit" and fit_over_another_map(item, result, progress)


def _try_region(item, index, result, progress):
    """The stages of one region in their order, as far as what is to be written needs them."""
    _bridge(item, index, result, progress)
    _map(item, index, result, progress)
    options = result.options
    if options.wants("extract"):
        item.quads = _polygonal(_run(item, progress, "extract", load().extract_quads, item.grid, item.mapped_region),
                                item, options)
        if options.merge_slivers > 0:
            load().merge_slivers(item.quads, options.merge_slivers)
    if options.wants("fit") and not _fit_around_few_lines(item, result, progress):
        item.other_maps.append(OWN_MAP)
        item.fitted = _run(item, progress, "fit", fit, item, result)


def _fit_around_few_lines(item, result, progress):
    """Surfaces for a region whose own map has singularities, and so charts around them: a single one, if there is one that
    does not fold; else several that go on behind small holes, where lines between charts would end otherwise. Whether
    there are any."""
    if not item.singularities:
        return False
    single = fit_over_another_map(item, result, progress, [WITHOUT_SINGULARITIES], takes=lambda fitted: not fitted.folded)
    return single or fit_over_another_map(item, result, progress, [BEHIND_HOLES])


def fit_over_another_map(item, result, progress, ways=OTHER_MAPS, takes=lambda fitted: True):
    """Surfaces of a region over the next of other maps of it, where none can be fitted or trimmed over its own. The
    region's quads stay as they are, and so do the surfaces where no other map has any. Whether one has.

    takes: whether fitted surfaces are good enough to replace the region's own
    """
    if item.quads is None:
        return False
    native = load()
    index = result.regions.index(item)
    if item.mapped_region is item.region:
        copied = native.copy_region(item.region)
        if item.bridged is item.region:
            item.bridged = copied
        item.region = item.mapped_region = copied
    else:
        item.mapped_region = native.copy_region(item.mapped_region)
    # As is its own.
    item.other_maps.append(WITH_SINGULARITIES if item.singularities else WITHOUT_SINGULARITIES)
    for way in ways:
        if way in item.other_maps:
            continue
        if way in item.put_aside:
            other, refined = item.put_aside[way]
            if takes(other.fitted):
                native.place_region(result.model, index, refined)
                item.other_maps.append(way)
                _fit_from(item, other)
                return True
            continue
        if exhausted(item, result, progress):
            break
        item.other_maps.append(way)
        region = _without_creases(item, result) if way.creases_rounded else item.region
        if region is None:
            continue
        placed = native.copy_region(result.model.regions[index])
        native.place_region(result.model, index, region)
        other = RegionResult(result.model.regions[index])
        other.edge_length, other.guidance = item.edge_length, item.guidance
        other.most_poles, other.most_work = item.most_poles, item.most_work
        other.wanted_singularities = way.singularities
        other.fill_holes = max(item.fill_holes, SMALL_HOLE * item.edge_length if way.behind_small_holes else 0)
        try:
            _bridge(other, index, result, progress)
            if way.behind_small_holes and not _bridges_more(other, item):
                continue
            _map(other, index, result, progress)
            if not other.singularities:
                item.other_maps.append(way._replace(singularities="none"))
                if way.singularities == "of field":
                    continue
            if way.singularities == "none" and other.seamless.counters["distortion_end"] > MOST_DISTORTION:
                continue
            other.fitted = _run(other, progress, "fit", fit, other, result)
            if not takes(other.fitted):
                # They may be taken where the region's own turn out to be at fault.
                item.other_maps = [w for w in item.other_maps if w != way]
                item.put_aside[way] = other, native.copy_region(result.model.regions[index])
                continue
            _fit_from(item, other)
            return True
        except Error as error:
            if error.kind == "cancelled":
                raise
        finally:
            item.work += other.work
            item.work_of_maps += other.work_of_maps
            for stage, seconds in other.seconds.items():
                item.seconds[stage] = item.seconds.get(stage, 0.0) + seconds
            if item.fitted_from is not other:
                native.place_region(result.model, index, placed)
    return False


def _fit_from(item, other):
    """Takes the surfaces over another map as those of a region."""
    item.fitted, item.fitted_from = other.fitted, other
    item.refits, item.bisections, item.smoothings, item.before_revision = 0, [], {}, None


def exhausted(item, result, progress):
    """Whether fits took so much work that no other ways of fitting a region are to be tried."""
    if result.exhausted or item.work + result.work_in_vain > MOST_WORK:
        return True
    return item.work + item.work_of_maps > MOST_WORK_BEFORE_CUT and has_parts(item, result, progress)


def _without_creases(item, result):
    """A region of a mesh that does not follow its sharp edges, or None where it follows none that may be rounded."""
    if result.source.kind != "mesh" or result.options.align or not item.region.features["aligned_edges"]:
        return None
    smooth = load().without_creases(item.region)
    return smooth if smooth.features["aligned_edges"] < item.region.features["aligned_edges"] else None


def _bridges_more(item, other):
    """Whether more holes of a region are bridged than of another."""
    return item.holes["bridged"] > (other.holes["bridged"] if other.holes else 0)


def _run(item, progress, stage, function, *arguments):
    """What a stage gives; the seconds that it takes are the region's."""
    with progress.stage(stage, item.name) as native_progress:
        started = time.monotonic()
        try:
            return function(*arguments, native_progress)
        finally:
            item.seconds[stage] = item.seconds.get(stage, 0.0) + time.monotonic() - started


def _bridge(item, index, result, progress):
    item.bridged = item.region
    if item.fill_holes > 0:
        item.bridged, item.holes = _run(item, progress, "bridge", load().bridge_holes, result.model, index, item.fill_holes)


def _map(item, index, result, progress):
    """The stages up to the grid map."""
    native = load()
    options = result.options
    seed = _run(item, progress, "seamless", _seed, item, options)
    item.field, item.seamless, item.field_edits = seed.field, seed.map, seed.field_edits
    if seed.refined:
        # The model's region gets halved edges; the field and all maps are of these.
        whole, item.guidance = native.place_refined(result.model, index, item.bridged, seed, item.guidance)
        region = result.model.regions[index]
        item.bridged = region if item.bridged is item.region else whole
        item.region = item.mapped_region = region
    item.seconds["field"] = item.seconds.get("field", 0.0) + seed.field_seconds
    item.seconds["seamless"] -= seed.field_seconds
    if options.wants("partition"):
        item.tmesh = _run(item, progress, "partition", native.partition, item.seamless)
    if options.wants("quantize"):
        item.quantization = _run(item, progress, "quantize", native.quantize, item.tmesh, options.optimal)
    if options.wants("optimize"):
        _grid_map(item, index, result, progress)


def _seed(item, options, progress):
    try:
        return load().seed(item.bridged, str(options.field), item.guidance, options.field_weight, item.edge_length,
                           item.wanted_singularities, progress)
    finally:
        item.work_of_maps += progress.work


def _grid_map(item, index, result, progress):
    """By the direct route, the constructive one, or the first and where it fails the other."""
    native = load()
    route = result.options.route
    if route != "reembed":
        try:
            item.grid = _run(item, progress, "optimize", native.grid_map, item.bridged, item.seamless, item.tmesh,
                             item.quantization, route == "direct")
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
    embedded = _run(item, progress, "reembed", native.embed, item.seamless, item.tmesh, item.quantization)
    item.grid, counters = _run(item, progress, "optimize", native.embedded_grid_map, result.model, index, item.bridged,
                               item.seamless, embedded)
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


def fit(item, result, progress, smallest_rectangle=False, slides=True, holds_corners=None, part=1.0, only=True):
    """Surfaces of a region within this part of the tolerance; within all of it where that cannot be reached and is not asked
    for `only`. A part is given up where it takes many more poles than the surfaces have now. Whether corners are held stays as
    it is for later fits."""
    native = load()
    if holds_corners is not None:
        item.holds_corners = holds_corners
    tolerance = part * result.fit_tolerance
    fit_options = _fit_options(
        item,
        result,
        tolerance=tolerance,
        enough=tolerance if only and part != 1 else ENOUGH * result.options.tolerance,
        smallest_rectangle=smallest_rectangle,
        slides=slides,
        max_poles=item.most_poles if part == 1 else MORE_POLES * item.fitted.control_points + FEW_POLES,
    )
    try:
        return native.fit_surface(item.fitted_from.mapped_region, item.fitted_from.grid, fit_options, progress)
    finally:
        item.work += progress.work


def revised(item, charts, result, progress, smoother):
    """Surfaces of a region of which those of some charts are smoother, in item.smoothings' steps, or else closer; the others
    are the same. None where no such ones are within the tolerance."""
    native = load()
    fit_options = _fit_options(
        item,
        result,
        tolerance=result.fit_tolerance,
        enough=ENOUGH * result.options.tolerance,
    )
    source = item.fitted_from
    arguments = source.mapped_region, source.grid, fit_options, progress
    if smoother:
        return native.smoothed_charts(item.fitted, {chart: item.smoothings[chart] for chart in charts}, *arguments)
    return native.closer_charts(item.fitted, charts, *arguments)


def _fit_options(item, result, smallest_rectangle=False, slides=True, max_poles=None, **tolerances):
    return load().FitOptions(
        smallest_rectangle=smallest_rectangle,
        bisections=item.bisections,
        degree=result.options.degree,
        slides=slides,
        holds_corners=item.holds_corners,
        threads=max(1, result.options.threads // len(result.regions)),
        max_poles=max_poles,
        max_work=item.most_work,
        **tolerances,
    )
