"""Regions of a CAD model that cannot be converted as a whole, cut along smooth edges inside them."""
from typing import List, NamedTuple, Tuple

from .error import Error
from .native import load

# How a region is cut, then parts of it that fail: where it bends sharply, though at no edge, around the CAD faces at the
# place where it fails, between all faces.
CUTS = ("creases", "place", "faces")


class Cut(NamedTuple):
    """A region that was replaced by its parts."""

    region: str  # its name
    error: Error  # why it could not stay whole
    edges: Tuple[str, ...]  # CAD edges along which it was cut
    parts: Tuple[str, ...]  # names of the regions that it became
    seconds: float  # spent on the whole

    @property
    def warning(self):
        count, into = len(self.edges), "another surface" if len(self.parts) == 1 else f"{len(self.parts)} surfaces"
        return (
            f"region '{self.region}' could not be converted as a whole (stage {self.error.stage}: {self.error}); it was cut "
            f"along {count} of its inner edges into {into}, which touch each other there within the tolerance"
        )


def cut_failed(result, progress) -> List[Tuple[int, object]]:
    """Replaces the regions of a Result that failed by their parts, where they can be cut.

    Returns the numbers and the RegionResults of the parts, which are still to be converted. Only a CAD model with
    `features` trim is cut: otherwise its edges are to lie inside the surfaces.
    """
    if not may_cut(result):
        return []
    parts = {}
    for index, item in enumerate(result.regions):
        if item.error is not None and item.error.kind == "stage":
            while item.cuts_left and item.parts is None:
                item.parts = _next_parts(item, index, result, progress)
            if item.parts is not None:
                parts[index] = item.parts
    return result.replace_by_parts(parts) if parts else []


def bends_sharply(item, result, progress):
    """Whether a region can be cut where it bends sharply and that was not tried yet. If so, cut_failed() does it once the
    region has an error."""
    if not may_cut(result) or item.cuts_left < len(CUTS):
        return False
    item.parts = _next_parts(item, result.regions.index(item), result, progress)
    return item.parts is not None


def has_parts(item, result, progress):
    """Whether a region will be cut if it fails."""
    if not (may_cut(result) and item.cuts_left):
        return False
    if item.has_parts is None:
        item.has_parts = _parts(item, result.regions.index(item), None, False, result, progress) is not None
    return item.has_parts


def may_cut(result):
    """Whether regions of a conversion are cut where they fail."""
    return result.source.kind == "cad" and result.options.features == "trim"


def _next_parts(item, index, result, progress):
    """Those of the next way of cutting, or None where it gives none."""
    way = CUTS[-item.cuts_left]
    item.cuts_left -= 1
    place = item.error.position if way == "place" else None
    if way == "place" and place is None:
        return None
    return _parts(item, index, place, way == "creases", result, progress)


def _parts(item, index, place, creases, result, progress):
    try:
        with progress.stage("cut", item.name) as native_progress:
            return load().region_parts(result.model, index, place, creases, native_progress)
    except Error as error:
        if error.kind == "cancelled":
            raise
        return None
