"""The compiled stages one by one, timed, on the triangle meshes of a folder."""
import os
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
DOCS = os.path.join(ROOT, "docs")
sys.path.insert(0, os.path.join(ROOT, "TrimQuadWorkbench"))

from trimquad import Error  # noqa: E402
from trimquad.native import load  # noqa: E402

# Timed again until this many seconds have passed, and the least time counts. Seconds are those of the processor: the
# stages run in one thread, and other programs do not count.
ENOUGH_SECONDS = 0.5
MOST_REPEATS = 20


class Mapped:
    """The one region of a mesh file and its seamless map.

    edge_length in model units; boundary 'free' or 'aligned'; align: names of edges, such as 'loop:1', that are aligned
    besides. Sharp edges are not followed. Raises Error.
    """

    def __init__(self, path, edge_length, boundary="free", align=()):
        self.path, self.edge_length, self.boundary, self.align = path, edge_length, boundary, list(align)
        self.progress = load().Progress()
        self.model = self.fresh_model()
        if len(self.model.regions) != 1:
            raise Error("input", "read", f"{path}: {len(self.model.regions)} components; one is wanted")
        seed = load().seed(self.model.regions[0], "curvature", None, None, edge_length, "weighed", self.progress)
        self.field, self.map = seed.field, seed.map
        if seed.refined:
            load().place_refined(self.model, 0, self.model.regions[0], seed, None)
        self.region = self.model.regions[0]

    def fresh_model(self):
        native = load()
        features = native.FeatureOptions(
            features="ignore", angle=30, align_boundary=self.boundary == "aligned", align=self.align, free=[],
            vertices=[], points=[], quad_length=self.edge_length,
        )
        return native.mesh_model(native.repair(native.read_mesh(self.path)), features, self.progress)

    def partition(self):
        return load().partition(self.map, self.progress)

    def quantize(self, tmesh, optimal=False):
        return load().quantize(tmesh, optimal, self.progress)

    def direct(self, tmesh, quantization):
        """The grid map by the direct route. Raises Error(stage) where it has none."""
        return load().grid_map(self.region, self.map, tmesh, quantization, False, self.progress)

    def reembedded(self, tmesh, quantization):
        """(grid map by the constructive route, its region)."""
        model = self.fresh_model()
        return self.optimized(model, self.embedded(tmesh, quantization)), model.regions[0]

    def embedded(self, tmesh, quantization):
        """The T-mesh on edges of a refined mesh, its zero arcs collapsed."""
        return load().embed(self.map, tmesh, quantization, self.progress)

    def optimized(self, model, embedded):
        """The grid map of an embedded T-mesh; the model's region gets the refined mesh."""
        return load().embedded_grid_map(model, 0, self.region, self.map, embedded, self.progress)[0]

    def grid_map(self, tmesh, quantization):
        """(grid map, its region): by the direct route, else by the constructive one."""
        try:
            return self.direct(tmesh, quantization), self.region
        except Error as error:
            if error.kind != "stage":
                raise
        return self.reembedded(tmesh, quantization)

    def quads(self, grid, region):
        return load().extract_quads(grid, region, self.progress)


def mesh_size(path):
    """(area, diagonal) of a mesh file."""
    mesh = load().repair(load().read_mesh(path))
    return mesh.area, mesh.diagonal


def timed(function, *arguments, prepare=None):
    """(its result, the least seconds it takes). What `prepare` returns is the first argument, made anew each time."""
    best, spent, repeats = None, 0.0, 0
    while repeats == 0 or (spent < ENOUGH_SECONDS and repeats < MOST_REPEATS):
        first = [] if prepare is None else [prepare()]
        started = time.process_time()
        result = function(*first, *arguments)
        seconds = time.process_time() - started
        best = seconds if best is None else min(best, seconds)
        spent, repeats = spent + seconds, repeats + 1
    return result, best


def write_page(name, lines):
    """Replace docs/NAME whole."""
    path = os.path.join(DOCS, name)
    with open(path + ".new", "w", encoding="utf-8") as page:
        page.write("\n".join(lines) + "\n")
    os.replace(path + ".new", path)
    print(path)
