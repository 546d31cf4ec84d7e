"""The options of a conversion, the same for the command line, scripts and the GUI."""
import dataclasses
import math
import os
from typing import List, Optional

from .error import input_error

FILE_KINDS = ("seamless", "tmesh", "gridmap", "quads", "nurbs", "texture", "report", "fcstd", "pictures")
FIELDS = ("smooth", "curvature", "stress")
# The last stage that each kind of file needs. Reports and pictures are of what the other files need; alone, a report is
# of the quads, pictures are of everything.
LAST_STAGE = {"seamless": "seamless", "tmesh": "quantize", "gridmap": "optimize", "texture": "optimize", "quads": "extract",
              "nurbs": "fit", "fcstd": "fit"}
STAGES = ("seamless", "partition", "quantize", "optimize", "extract", "fit")
DEFAULT_QUADS = 1000
MOST_QUADS = 2_000_000


@dataclasses.dataclass
class Options:
    """Every option of a conversion with its default. Lengths are in the input's unit (mm for CAD).

    None means: `edge_length` from `quads`; `quads` 1000 where there is no edge length; `features` 'trim' for CAD and
    'align' for meshes; `tolerance` from `relative_tolerance`; `threads` as many as there are cores.

    align, free      names of edges: 'Edge3' of CAD; 'loop:2', 'loop:2/1', 'feature:0', 'angle:30-90' of meshes
    feature_points   names of CAD vertices, or points: 'Vertex5', '1.5,2,0', (1.5, 2, 0), or '1.5', '2', '0' in a row
    fill_holes       boundary loops shorter than this are bridged for the map and cut out again; 0: none
    merge_slivers    trimmed cells under this fraction of a whole cell's area merge with a neighbour; 0: none
    field            'curvature', 'smooth', or the path of a file of directions
    field_weight     how closely the field follows it, 0 to 1; None: 0.1 for 'curvature', 1 for a file
    pattern          path of the picture that the texture puts on every quad; None: grid lines round a diamond
    """

    edge_length: Optional[float] = None
    quads: Optional[int] = None
    boundary: str = "free"
    align: List[str] = dataclasses.field(default_factory=list)
    free: List[str] = dataclasses.field(default_factory=list)
    features: Optional[str] = None
    feature_angle: float = 30.0
    feature_points: List[str] = dataclasses.field(default_factory=list)
    field: str = "curvature"
    field_weight: Optional[float] = None
    fill_holes: float = 0.0
    merge_slivers: float = 0.0
    optimal: bool = False
    tolerance: Optional[float] = None
    relative_tolerance: Optional[float] = None
    route: str = "auto"
    degree: int = 3
    pattern: Optional[str] = None
    write: List[str] = dataclasses.field(default_factory=lambda: ["gridmap", "quads", "nurbs", "report"])
    threads: Optional[int] = None

    def validate(self):
        """Raises Error(input) with one line for the first option that is unusable or not in this version."""
        for name in ("edge_length", "tolerance", "relative_tolerance"):
            value = getattr(self, name)
            if value is not None and not (_is_number(value) and value > 0):
                raise _refused(name, f"must be a positive number, not {value}")
        if self.edge_length is not None and self.quads is not None:
            raise _refused("edge_length", "and --quads are two ways to say the same; give one of them")
        if self.tolerance is not None and self.relative_tolerance is not None:
            raise _refused("tolerance", "and --relative-tolerance are two ways to say the same; give one of them")
        if self.relative_tolerance is not None and self.relative_tolerance > 0.1:
            raise _refused("relative_tolerance", f"is a fraction of the diagonal, at most 0.1, not {self.relative_tolerance}")
        for name, least, most in (("quads", 1, MOST_QUADS), ("degree", 2, 5), ("threads", 1, 1024)):
            value = getattr(self, name)
            if value is not None and not (_is_whole(value) and least <= value <= most):
                raise _refused(name, f"must be a whole number from {least} to {most}, not {value}")
        if not (_is_number(self.feature_angle) and 0 < self.feature_angle < 180):
            raise _refused("feature_angle", f"must be between 0 and 180 degrees, not {self.feature_angle}")
        if not (_is_number(self.fill_holes) and self.fill_holes >= 0):
            raise _refused("fill_holes", f"must be a length of 0 or more, not {self.fill_holes}")
        if not (_is_number(self.merge_slivers) and 0 <= self.merge_slivers < 1):
            raise _refused("merge_slivers", f"is a fraction of a whole cell, from 0 to less than 1, not {self.merge_slivers}")
        for name, known in (
            ("boundary", ("free", "aligned")),
            ("features", (None, "trim", "align", "ignore")),
            ("route", ("auto", "direct", "reembed")),
        ):
            if getattr(self, name) not in known:
                names = ", ".join(x for x in known if x)
                raise _refused(name, f"must be one of {names}, not '{getattr(self, name)}'")
        if not isinstance(self.optimal, bool):
            raise _refused("optimal", f"is on or off, not {self.optimal}")
        for kind in self.write:
            if kind not in FILE_KINDS:
                raise _refused("write", f"knows {', '.join(FILE_KINDS)}, not '{kind}'")
        for name in ("align", "free"):
            if not all(isinstance(x, str) and x for x in getattr(self, name)):
                raise _refused(name, f"is a list of names of edges, not {getattr(self, name)}")
        self.feature_vertices_and_points()
        if not (isinstance(self.field, (str, os.PathLike)) and os.fspath(self.field)):
            raise _refused("field", f"must be one of {', '.join(FIELDS)} or a file, not {self.field}")
        if self.field_weight is not None:
            if not (_is_number(self.field_weight) and 0 <= self.field_weight <= 1):
                raise _refused("field_weight", f"must be between 0, smooth, and 1, aligned, not {self.field_weight}")
            if self.field == "smooth":
                raise _refused("field_weight", "says how closely to follow curvature or a file; --field smooth follows neither")
        if not self.write:
            raise _refused("write", f"needs at least one of {', '.join(FILE_KINDS)}")
        if self.pattern is not None:
            if not (isinstance(self.pattern, (str, os.PathLike)) and os.fspath(self.pattern)):
                raise _refused("pattern", f"is the path of a picture, not {self.pattern}")
            if "texture" not in self.write:
                raise _refused("pattern", "is what the texture puts on every quad; --write texture is missing")
        self._refuse_missing_stages()

    def _refuse_missing_stages(self):
        for given, what in (
            (self.field == "stress", "--field stress"),
        ):
            if given:
                raise input_error("options", f"{what} is not in this version yet; leave it out")

    @property
    def last_stage(self):
        """The last of STAGES that what is to be written needs; no later one is run."""
        alone = "fit" if "pictures" in self.write else "extract"
        return max((LAST_STAGE[kind] for kind in self.write if kind in LAST_STAGE), key=STAGES.index, default=alone)

    def wants(self, stage):
        """Whether a conversion goes as far as `stage`, one of STAGES."""
        return STAGES.index(stage) <= STAGES.index(self.last_stage)

    def feature_vertices_and_points(self):
        """`feature_points` as (names of vertices, [(x, y, z)]). Raises Error(input)."""
        vertices, words = [], []
        for item in self.feature_points:
            words += item.replace(";", ",").replace(",", " ").split() if isinstance(item, str) else list(item)
        numbers = []
        for word in words:
            if isinstance(word, str) and word.startswith("Vertex"):
                vertices.append(word)
                continue
            try:
                numbers.append(float(word))
            except (TypeError, ValueError):
                raise _refused("feature_points", f"knows names such as Vertex5 and points x,y,z, not '{word}'") from None
            if not math.isfinite(numbers[-1]):
                raise _refused("feature_points", f"needs finite coordinates, not {word}")
        if len(numbers) % 3:
            raise _refused("feature_points", f"needs three coordinates for each point; there are {len(numbers)} numbers")
        return vertices, [tuple(numbers[i : i + 3]) for i in range(0, len(numbers), 3)]

    def resolved(self, kind, area, diagonal, default_threads):
        """A copy with every None replaced, paths as text, for an input of `kind` ('cad' or 'mesh') of that area and diagonal.

        Raises Error(input) where the edge length does not fit the input.
        """
        options = dataclasses.replace(
            self, field=os.fspath(self.field), pattern=None if self.pattern is None else os.fspath(self.pattern)
        )
        if options.edge_length is None:
            options.quads = options.quads or DEFAULT_QUADS
            if not area > 0:
                raise input_error("read", "the faces have no area, or point against each other; repair the shape")
            options.edge_length = math.sqrt(area / options.quads)
        if options.edge_length > diagonal:
            raise _refused(
                "edge_length", f"{options.edge_length:.6g} is larger than the part, whose diagonal is {diagonal:.6g}"
            )
        count = area / options.edge_length**2
        if count > MOST_QUADS:
            least = math.sqrt(area / MOST_QUADS)
            raise _refused(
                "edge_length",
                f"{options.edge_length:.6g} would give about {count:.3g} quads, more than the limit of {MOST_QUADS}; "
                f"use {least:.3g} or more",
            )
        if count < 1:
            raise _refused(
                "edge_length",
                f"{options.edge_length:.6g} would give no whole quad (about {count:.2g}); "
                f"use {math.sqrt(area):.3g} or less",
            )
        if options.quads is None:
            options.quads = max(1, round(count))
        options.features = options.features or ("trim" if kind == "cad" else "align")
        if options.tolerance is None:
            options.relative_tolerance = options.relative_tolerance or 1e-3
            options.tolerance = options.relative_tolerance * diagonal
        else:
            options.relative_tolerance = options.tolerance / diagonal
        options.threads = options.threads or default_threads
        return options


def _is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _is_whole(value):
    return isinstance(value, int) and not isinstance(value, bool)


def _refused(name, reason):
    return input_error("options", f"--{name.replace('_', '-')} {reason}")
