"""Fitted surfaces trimmed and joined to one model; what is at fault is fitted again, then cut."""
import time
from concurrent.futures import ThreadPoolExecutor

from . import regions
from .cuts import bends_sharply, cut_failed
from .error import Error, cancelled
from .native import CHECKER, load

# A surface that crosses itself beyond its trim, or whose trims cross, or in a bend that the tolerance left loose, is fitted
# again in these ways, one after the other: in a rectangle that fits the region more closely (one surface only), with the
# parameters closer to the map's, with both, smoother as far as the tolerance allows or closer, over more knots (one of several;
# the others stay as they are), cut in two where it bends most (all of the region's are fitted again), to this part of the
# tolerance.
REVISIONS = ({"smoother": True}, {"smoother": True}, {"smoother": False}, {"smoother": True}, {"smoother": True},
             {"smoother": False})
REFITS = (
    {"smallest_rectangle": True},
    {"slides": False},
    {"smallest_rectangle": True, "slides": False},
    *REVISIONS,
    {"cut": True},
    *REVISIONS,
    {"cut": True},
    *REVISIONS,
    {"part": 0.4},
    {"part": 0.16},
)
# Of more fairness, for charts whose faces are at fault.
STEPS = 2
# The parts of a region that was cut are tangent to each other, so that their common edge is where their deviations happen to
# have it. Where trims cross or faces are at fault, the parts around are fitted to this part of the tolerance first; as far as
# they come that close.
CLOSER = {"part": 0.1, "only": False, "holds_corners": False}
# First, where surfaces are nearly tangent to others and too far from these to be moved onto a common edge: they turn back in
# corners, where nothing holds them.
HELD = {"holds_corners": True}
# How often a region that was left out is tried again between others than before.
TAKEN_BACK = 2
# The part of the tolerance that a surface may come to be away when it is moved to agree with its neighbours; by kind of input.
MOVED = {"cad": 0.77, "mesh": 0.9}


def trim(result, progress):
    """Trims and joins the fitted surfaces. A region that cannot be trimmed is fitted again, then cut; where that does not
    help it is left out and the others tried again."""
    native = load()
    started = time.monotonic()
    elsewhere = 0.0
    checks, memory = native.FaceChecks(CHECKER), native.TrimMemory()
    while any(r.fitted is not None for r in result.regions):
        result.exhausted = result.work > regions.MOST_WORK_OF_MODEL
        try:
            with progress.stage("trim") as native_progress:
                result.spline = native.trim_model(
                    result.model,
                    [r.fitted_from.grid if r.fitted is not None else None for r in result.regions],
                    [r.fitted for r in result.regions],
                    result.fit_tolerance,
                    MOVED[result.source.kind] * result.options.tolerance,
                    native_progress,
                    result.options.threads,
                    memory,
                )
                result.native_shape = native.assemble(result.spline)
            again = (
                _fit_apart_again(result, checks, progress)
                or _refit_faulty(result, checks, checks.faults, progress)
                or _take_back(result)
            )
            if not again:
                break
            result.spline = None  # its faces are at fault, or others may join them
        except Error as error:
            if error.kind == "cancelled":
                raise
            result.spline = None
            # `where` is the region's name, or the name and an edge of it.
            errors = {e.where.split(",")[0]: e for e in [error, *error.others]}
            guilty = [r for r in result.regions if r.fitted is not None and r.name in errors]
            if not any([_fit_parts_closer(item, result, progress) for item in guilty]):
                _refit_all([(item, set(), errors[item.name]) for item in guilty], result, progress)
            if not guilty:
                for item in result.regions:
                    if item.fitted is not None:
                        item.fitted = None
                        item.error = error
                        item.cuts_left = 0  # none of them is to blame
        paused = time.monotonic()
        regions.map_regions(cut_failed(result, progress), result, progress)
        elsewhere += time.monotonic() - paused
    if result.spline is None:
        result.native_shape = None
    else:
        for index in result.spline.moved_regions:
            item = result.regions[index]
            item.fitted = native.fitted_as_moved(item.fitted, result.spline, index)
    result.seconds["trim"] = time.monotonic() - started - elsewhere
    if progress.cancelled:
        raise cancelled()


def _refit_faulty(result, checks, find, progress):
    """Fits regions again whose faces OpenCASCADE finds at fault. Whether there were any.

    find: of `checks`, the FaceChecks: faults or likely_faults
    """
    faulty = {}  # index of the region: charts and a fault
    faces = result.spline.faces
    folded = [r.fitted.folded_charts if r.fitted is not None else () for r in result.regions]
    folded_faces = [k for k, face in enumerate(faces) if face["chart"] in folded[face["region"]]]
    with progress.stage("check") as native_progress:
        found = find(result.spline, folded_faces, result.options.threads, native_progress)
        result.work_of_checks += native_progress.work
    for face, faults in zip(faces, found):
        if faults:
            faulty.setdefault(face["region"], []).append((face["chart"], faults[0]))
    if any([_fit_parts_closer(result.regions[index], result, progress) for index in faulty]):
        return True
    at_fault = []
    for index, found in faulty.items():
        item, fault = result.regions[index], found[0][1]
        crossed = None if fault.other is None else result.regions[faces[fault.other]["region"]]
        if crossed and crossed.fitted is None:
            continue  # left out just now
        met = _meeting(item, crossed, checks, result, progress)
        if met and met.cross:
            message = f"{met.first} crosses {met.second} in the input; trim them at each other, or convert them one by one"
            fitted, item.fitted, item.error = item.fitted, None, Error("stage", "fit", message, item.name)
            _leave_out(item, fitted, result)
            continue
        endless = all(fault.what == load().CHECK_DOES_NOT_END for _, fault in found)
        message = _said_of(fault, item, crossed, met)
        at_fault.append((item, {chart for chart, _ in found}, Error("stage", "fit", message, item.name, endless=endless)))
    _refit_all(at_fault, result, progress)
    return bool(faulty)


def _meeting(item, crossed, checks, result, progress):
    """Two CAD faces, of a region and of one that its surfaces cross, that meet where they have no common edge, or None."""
    if crossed in (None, item):
        return None
    if crossed not in item.meetings:
        indices = (result.regions.index(r) for r in (item, crossed))
        with progress.stage("check") as native_progress:
            item.meetings[crossed] = checks.meeting_cad_faces(result.model, *indices, native_progress)
    return item.meetings[crossed]


def _said_of(fault, item, crossed, met):
    if not crossed:
        return f"OpenCASCADE finds the fitted surface at fault ({fault.what}); use a smaller tolerance"
    name = "another part of the region" if crossed is item else crossed.name
    if fault.what == load().CHECK_DOES_NOT_END:
        return f"OpenCASCADE's check of the fitted surface with that of {name} does not end; use a smaller tolerance"
    if met:
        return (
            f"the fitted surface crosses that of {name}: {met.first} touches {met.second} in the input where they have no "
            "common edge; split or join them there, or convert them one by one"
        )
    return f"the fitted surface crosses that of {name}; use a smaller tolerance"


def _refit_all(at_fault, result, progress):
    """Fits regions (RegionResult, charts, error) again, several at once. Those that bend sharply inside keep their error
    instead, to be cut there."""
    again = []
    for item, charts, error in at_fault:
        if bends_sharply(item, result, progress):
            item.fitted = None
            item.error = error
        else:
            again.append((item, charts, error))
    before = [item.fitted for item, *_ in again]
    _at_once(_refit, again, result, progress)
    for (item, *_), fitted in zip(again, before):
        if item.error is None:
            continue
        if item.before_held:
            vars(item).update(item.before_held, before_held=None, error=None)
        elif _fit_around_closer(item, result, progress):
            item.fitted, item.error = fitted, None
        else:
            _leave_out(item, fitted, result)


def _leave_out(item, fitted, result):
    item.left_out = fitted
    item.left_out_between.append(_fits_around(item, result))


def _take_back(result):
    """Takes regions back that were left out, where those around are others by now, each a few times at most: regions at
    fault together could take turns. Whether there are any."""
    back = [
        r for r in result.failed
        if r.left_out and len(r.left_out_between) <= TAKEN_BACK and _fits_around(r, result) not in r.left_out_between
    ]
    for item in back:
        item.fitted, item.error, item.left_out = item.left_out, None, None
    return bool(back)


def _fits_around(item, result):
    return [other.fitted for other in _touching(item, result)]


def _at_once(function, arguments, result, progress):
    """What function(*one, result, progress) gives for each of the arguments."""
    with ThreadPoolExecutor(max_workers=result.options.threads) as pool:
        return [done.result() for done in [pool.submit(function, *one, result, progress) for one in arguments]]


def _refit(item, charts, error, result, progress):
    """Fits a region again in the next of the ways there are, then over another map. Where there is none left, or no surfaces
    are found, its error is kept instead.

    charts: those whose faces are at fault; empty where the region's edges are, many of which small holes have
    """
    if not charts and item.before_revision:
        # Revised, it cannot be trimmed.
        item.fitted, charts, error = item.before_revision
    item.before_revision = None
    if not charts and regions.fit_over_another_map(item, result, progress, [regions.BEHIND_HOLES]):
        return
    # Another surface over as distorted a map would take as long to be checked as the one that could not be.
    single = error.endless and item.fitted_without_singularities
    if single and regions.fit_over_another_map(item, result, progress, [regions.OWN_MAP]):
        return
    try:
        item.refits += 1
        while item.refits <= len(REFITS) and not _applies(REFITS[item.refits - 1], item, charts):
            item.refits += 1
        if item.refits > len(REFITS):
            raise error
        way = dict(REFITS[item.refits - 1])
        if result.exhausted or ("smoother" not in way and regions.exhausted(item, result, progress)):
            raise error
        if "smoother" in way:
            if way["smoother"]:
                for chart in charts:
                    item.smoothings[chart] = item.smoothings.get(chart, 0) + STEPS
            with progress.stage("fit", item.name) as native_progress:
                fitted = regions.revised(item, sorted(charts), result, native_progress, **way)
            if fitted is None:
                _refit(item, charts, error, result, progress)
            else:
                item.before_revision = item.fitted, charts, error
                item.fitted = fitted
            return
        if way.pop("cut", False):
            item.bisections = [*item.bisections, sorted(charts)]
            item.smoothings = {}
        with progress.stage("fit", item.name) as native_progress:
            item.fitted = regions.fit(item, result, native_progress, **way)
    except Error as failure:
        if failure.kind == "cancelled":
            raise
        if regions.fit_over_another_map(item, result, progress):
            return
        item.fitted = None
        item.error = error  # why it had to be fitted again


def _applies(way, item, charts):
    if "slides" in way and item.fitted.several:
        return False
    if "smallest_rectangle" in way:
        return bool(charts) and not item.fitted.several
    if "cut" in way:
        return bool(charts) and item.before_held is None
    return "smoother" not in way or (bool(charts) and item.fitted.several)


def _fit_parts_closer(item, result, progress):
    """Fits the parts of cut regions around a region more closely, once. Whether there are any that could be."""
    parts = [(part, CLOSER) for part in _touching(item, result) if part.cut_from is not None]
    return any(_at_once(_fit_again, parts, result, progress))


def _fit_apart_again(result, checks, progress):
    """Fits regions of a CAD model again, more closely in the end, whose surfaces are nearly tangent to others and too far
    from them to be moved onto a common edge, or make a sharp wedge with others and cut these too far from the edge; those
    first whose faces are likely to be at fault. Whether there are any that could be."""
    if result.source.kind != "cad" or result.exhausted:
        return False
    loose = [result.regions[k] for k in sorted(result.spline.loose_regions)]
    stray = [result.regions[k] for k in sorted(result.spline.stray_regions - result.spline.loose_regions)]
    held = [(item, HELD) for item in loose if item.cut_from is None and HELD not in item.fitted_in]
    closer = [(item, CLOSER) for item in loose + stray if CLOSER not in item.fitted_in]
    if not held and not closer:
        return False
    # All pairs of faces would be checked again afterwards.
    return (
        _refit_faulty(result, checks, checks.likely_faults, progress)
        or any(_at_once(_fit_again, held, result, progress))
        or any(_at_once(_fit_again, closer, result, progress))
    )


def _fit_around_closer(item, result, progress):
    """Fits all regions around a region more closely, once: what is narrow beside the tolerance vanishes between them
    otherwise. Whether there are any that could be."""
    around = [(other, CLOSER) for other in _touching(item, result) if other is not item]
    return any(_at_once(_fit_again, around, result, progress))


def _touching(item, result):
    return [result.regions[k] for k in load().touching_regions(result.model, result.regions.index(item))]


def _fit_again(item, way, result, progress):
    """Fits a region in another way, unless that was done before or cannot be. Whether it is."""
    if item.fitted is None or way in item.fitted_in:
        return False
    item.fitted_in = [*item.fitted_in, way]
    if way is HELD:
        before = {name: getattr(item, name) for name in ("fitted", "refits", "bisections", "fitted_in", "holds_corners")}
        item.before_held = {**before, "smoothings": dict(item.smoothings)}
    try:
        with progress.stage("fit", item.name) as native_progress:
            item.fitted = regions.fit(item, result, native_progress, **way)
        return True
    except Error as error:
        if error.kind == "cancelled":
            raise
        return False


def check(result, progress):
    """OpenCASCADE's check of the whole model, also as its STEP file holds it, but for faces that cross others: trim() looked
    for these."""
    if result.native_shape is None:
        return
    started = time.monotonic()
    with progress.stage("check") as native_progress:
        result.faults = load().FaceChecks(CHECKER).faults_of_whole(result.spline, native_progress)
    result.seconds["trim"] += time.monotonic() - started
    if result.faults:
        shown = "; ".join(result.faults[:3]) + ("; ..." if len(result.faults) > 3 else "")
        result.warnings.append(
            f"OpenCASCADE finds faults in the B-spline model ({len(result.faults)}: {shown}); use a smaller tolerance"
        )
