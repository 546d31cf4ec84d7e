"""Regions of a CAD model that cannot be converted as a whole, cut along smooth edges inside them."""
from typing import List, NamedTuple, Tuple

from .error import Error
from .native import load

# Times that a region and its parts are cut: around the CAD faces where it fails, then between all faces.
MOST_CUTS = 2


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
    if result.source.kind != "cad" or result.options.features != "trim":
        return []
    parts = {}
    for index, item in enumerate(result.regions):
        if item.error is not None and item.error.kind == "stage" and item.cuts_left:
            found = _parts(item, index, result, progress)
            item.cuts_left -= 1
            if found is None:
                item.cuts_left = 0
            else:
                parts[index] = found
    return result.replace_by_parts(parts) if parts else []


def _parts(item, index, result, progress):
    """Those of the next cut, or None where there is none."""
    places = [None]
    if item.cuts_left == MOST_CUTS and item.error.position is not None:
        places.insert(0, item.error.position)
    for place in places:
        try:
            with progress.stage("cut", item.name) as native_progress:
                return load().region_parts(result.model, index, place, native_progress)
        except Error as error:
            if error.kind == "cancelled":
                raise
    return None
