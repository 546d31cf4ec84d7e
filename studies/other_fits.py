"""B-spline fits beside those that FreeCAD and OpenCASCADE have, as docs/other-fits.md.

    scripts/study other_fits DATA [--longest-re SECONDS]

DATA has mesh/mask3kf.obj; the other inputs are made here or are examples. Needs FreeCAD's Part and ReverseEngineering.
"""
import argparse
import math
import os
import sys
import time

import numpy
from stages import ROOT, Error, load, write_page

if not any(os.path.exists(os.path.join(p, "FreeCAD.so")) for p in sys.path):
    sys.path.append("/usr/lib/freecad-python3/lib")
import FreeCAD  # noqa: E402
import Part  # noqa: E402
import ReverseEngineering  # noqa: E402

import trimquad  # noqa: E402

GRID = 100  # points a side that the other fits are given
PROBES = 4000  # points of the input at which every result is measured
SEEDS = 80  # places a side of a surface where the search for a probe's foot may begin
NEWTON_STEPS = 12
OURS = (1e-3, 1e-4, 1e-5)  # tolerances, as parts of the diagonal
OURS_MASK = (5e-3, 2e-3, 1e-3)
APPROXIMATE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # the same for GeomAPI_PointsToBSplineSurface
INTERPOLATE = (5, 7, 10, 14, 20, 28, 40, 56, 80, 100)  # points a side
APPROX_SURFACE = (6, 10, 14, 20, 28, 40)  # poles a side

HEADER = """# Other fits

Made by `scripts/study other_fits DATA`, FreeCAD {freecad}, OpenCASCADE {occ}. B-splines through the same inputs by TrimQuad
(a whole conversion with the default options: map, fit, trim, checks), by FreeCAD's `ReverseEngineering.approxSurface` (RE, default settings), and by
OpenCASCADE's `GeomAPI_PointsToBSplineSurface`, through FreeCAD's `Part.BSplineSurface().approximate` (degree 3 to 8, C2)
and `.interpolate` (degree 3).

Inputs: *wavy*, z = sin x cos y on [-3, 3]^2, a CAD face; *dome*, a sphere of radius 5 down to 75 degrees, a CAD face; *hood*,
the example, a CAD face with two cut-outs; *mask*, `mesh/mask3kf.obj`, 3000 triangles. TrimQuad gets the face or the mesh
itself and trims; the others cannot trim and get {grid} x {grid} points: of wavy and hood in the face's own parameters (of hood
from the whole surface, cut-outs filled); of the dome in an azimuthal chart that goes on over its rim; of the mask seen along
its flattest direction, the nearest height where there is none. `interpolate` with n x n poles gets n x n of such points. RE
gets {grid} x {grid} points of wavy and hood, those within the rim of the dome, the vertices of the mask.

Deviation: {probes} points of the input (for CAD of the exact face, inside its trim; for the mask half vertices, half points
inside triangles), none of them given to a fit but the mask's vertices, and their distances from the result's surfaces, from
Newton's method started at the nearest of {seeds} x {seeds} places of each surface. All results are measured like this, by this
page's own code. Parts of the diagonal. Seconds are of the processor, on one thread.

*At equal poles*: the other method's result with the fewest poles that are no fewer than TrimQuad's; where it has none, its
closest, which says something only where it is the closer one all the same. RE takes seconds that grow with the fourth power
of the poles a side; more poles than would take {longest:g} seconds were not tried. *At equal deviation*: its quickest result that
comes as close as TrimQuad's; where none does, its closest. *Ahead*: whether TrimQuad's largest deviation is the smaller
one, and whether it took less time; making the points that the others are given is not counted.

Two things to bear in mind. The parameters of wavy, dome and hood that the others get are the best there are, which a user
with a mesh or a trimmed face would not have; TrimQuad finds its own. And of the mask the others only see heights over a plane,
with steep sides and what overhangs left to chance: this, not their number of poles, bounds their deviation there.
"""


class Input:
    """thing: what TrimQuad converts; probes (n, 3); cloud (n, 3), points for RE; grid(n): (n, n, 3) points."""

    def __init__(self, name, thing, probes, cloud, grid, tolerances=OURS):
        self.name, self.thing, self.probes, self.cloud, self.grid = name, thing, probes, cloud, grid
        self.tolerances = tolerances
        self.diagonal = float(numpy.linalg.norm(probes.max(axis=0) - probes.min(axis=0)))


class Fit:
    """A result: its label, poles, largest and rms deviation (parts of the diagonal), seconds."""

    def __init__(self, label, poles, deviations, diagonal, seconds):
        self.label, self.poles, self.seconds = label, poles, seconds
        self.max = float(deviations.max()) / diagonal
        self.rms = float(numpy.sqrt(numpy.mean(deviations**2))) / diagonal

    @property
    def text(self):
        return f"{self.poles} | {self.max:.1e} | {self.rms:.1e} | {self.seconds:.2f}"


def wavy():
    def at(x, y):
        return numpy.stack([x, y, numpy.sin(x) * numpy.cos(y)], axis=-1)

    def grid(n):
        steps = numpy.linspace(-3, 3, n)
        return at(*numpy.meshgrid(steps, steps, indexing="ij"))

    places = numpy.random.default_rng(1).uniform(-3, 3, (PROBES, 2))
    return Input("wavy", wavy_surface().toShape(), at(*places.T), grid(GRID).reshape(-1, 3), grid)


def wavy_surface(degree=5, spans=24):
    """Within 3e-8: a product of splines in x and in y. (`interpolate` is off by 2e-2 along the border.)"""
    knots = numpy.concatenate([[-3.0] * degree, numpy.linspace(-3, 3, spans + 1), [3.0] * degree])
    greville = numpy.array([knots[i + 1 : i + 1 + degree].mean() for i in range(spans + degree)])
    basis = numpy.array([basis_functions(knots, degree, t) for t in greville])
    heights = numpy.outer(numpy.linalg.solve(basis, numpy.sin(greville)), numpy.linalg.solve(basis, numpy.cos(greville)))
    poles = [[FreeCAD.Vector(x, y, z) for y, z in zip(greville, row)] for x, row in zip(greville, heights)]
    inner = list(knots[degree : degree + spans + 1])
    times = [degree + 1] + [1] * (spans - 1) + [degree + 1]
    surface = Part.BSplineSurface()
    surface.buildFromPolesMultsKnots(poles, times, times, inner, inner, False, False, degree, degree)
    return surface


def basis_functions(knots, degree, t):
    """All of them at t. (Cox, de Boor)"""
    last = len(knots) - degree - 2
    values = ((knots[:-1] <= t) & (t < knots[1:])).astype(float)
    if t >= knots[-1]:
        values[last] = 1.0
    for p in range(1, degree + 1):
        left, right = knots[p:-1] - knots[: -p - 1], knots[p + 1 :] - knots[1:-p]
        rising = numpy.divide(t - knots[: -p - 1], left, out=numpy.zeros_like(left), where=left > 0)
        falling = numpy.divide(knots[p + 1 :] - t, right, out=numpy.zeros_like(right), where=right > 0)
        values = rising * values[:-1] + falling * values[1:]
    return values


def dome(radius=5.0, half_angle=math.radians(75)):
    def at(x, y):
        arc, azimuth = numpy.hypot(x, y), numpy.arctan2(y, x)
        side = radius * numpy.sin(arc)
        return numpy.stack([side * numpy.cos(azimuth), side * numpy.sin(azimuth), radius * numpy.cos(arc)], axis=-1)

    def grid(n):
        steps = numpy.linspace(-half_angle, half_angle, n)
        return at(*numpy.meshgrid(steps, steps, indexing="ij"))

    sphere = Part.makeSphere(radius, FreeCAD.Vector(), FreeCAD.Vector(0, 0, 1), 90 - math.degrees(half_angle), 90, 360)
    face = next(f for f in sphere.Faces if f.Surface.TypeId == "Part::GeomSphere")
    places = numpy.random.default_rng(2).uniform(-half_angle, half_angle, (2 * PROBES, 2))
    places = places[numpy.hypot(*places.T) < half_angle][:PROBES]
    cloud = grid(GRID).reshape(-1, 3)
    return Input("dome", face, at(*places.T), cloud[cloud[:, 2] >= radius * math.cos(half_angle)], grid)


def hood():
    face = Part.read(os.path.join(ROOT, "examples", "hood.step")).Faces[0]
    u0, u1, v0, v1 = face.ParameterRange

    def at(u, v):
        return tuple(face.Surface.value(u, v))

    def grid(n):
        return numpy.array([[at(u, v) for v in numpy.linspace(v0, v1, n)] for u in numpy.linspace(u0, u1, n)])

    generator, probes = numpy.random.default_rng(3), []
    while len(probes) < PROBES:
        u, v = generator.uniform((u0, v0), (u1, v1))
        if face.isPartOfDomain(u, v):
            probes.append(at(u, v))
    return Input("hood", face, numpy.array(probes), grid(GRID).reshape(-1, 3), grid)


def mask(path):
    lines = [line.split() for line in open(path, encoding="utf-8")]
    points = numpy.array([[float(w) for w in line[1:4]] for line in lines if line and line[0] == "v"])
    triangles = numpy.array([[int(w.split("/")[0]) - 1 for w in line[1:]] for line in lines if line and line[0] == "f"])
    generator = numpy.random.default_rng(4)
    weights = generator.dirichlet((1, 1, 1), PROBES // 2)
    inside = numpy.einsum("nk,nkx->nx", weights, points[triangles[generator.integers(len(triangles), size=len(weights))]])
    vertices = points[generator.permutation(len(points))[: PROBES // 2]]
    return Input("mask", path, numpy.concatenate([vertices, inside]), points, heights_over_plane(points), OURS_MASK)


def heights_over_plane(points):
    """grid(n) of points seen along the direction in which they spread least."""
    from matplotlib.tri import LinearTriInterpolator, Triangulation

    middle = points.mean(axis=0)
    axes = numpy.linalg.svd(points - middle, full_matrices=False)[2]
    seen = (points - middle) @ axes.T
    height = LinearTriInterpolator(Triangulation(seen[:, 0], seen[:, 1]), seen[:, 2])
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)

    def grid(n):
        x, y = numpy.meshgrid(*(numpy.linspace(low[k], high[k], n) for k in (0, 1)), indexing="ij")
        z = height(x, y)
        missing = numpy.ma.getmaskarray(z)
        z = z.filled(0.0)
        for i, j in numpy.argwhere(missing):
            z[i, j] = seen[numpy.argmin((seen[:, 0] - x[i, j]) ** 2 + (seen[:, 1] - y[i, j]) ** 2), 2]
        return numpy.stack([x, y, z], axis=-1) @ axes + middle

    return grid


def vectors(grid):
    return [[FreeCAD.Vector(*p) for p in row] for row in grid.tolist()]


def distances(surfaces, probes):
    """Of each probe from the nearest of the (surface, its part (u0, u1, v0, v1)), array (n,)."""
    return numpy.min([_distances(surface, part, probes) for surface, part in surfaces], axis=0)


def _distances(surface, part, probes):
    u0, u1, v0, v1 = part
    us, vs = numpy.linspace(u0, u1, SEEDS), numpy.linspace(v0, v1, SEEDS)
    seeds = numpy.array([tuple(surface.value(u, v)) for u in us for v in vs])
    squares = (seeds**2).sum(axis=1)
    nearest = numpy.concatenate([
        (squares - 2 * part_of @ seeds.T).argmin(axis=1) for part_of in numpy.array_split(probes, len(probes) // 500 + 1)
    ])
    return numpy.array([_foot_distance(surface, part, p, us[k // SEEDS], vs[k % SEEDS]) for p, k in zip(probes, nearest)])


def _foot_distance(surface, part, p, u, v):
    """By Gauss-Newton steps, halved where they lead away."""
    u0, u1, v0, v1 = part
    target = FreeCAD.Vector(*p)
    at = surface.value(u, v)
    best = (target - at).Length
    for _ in range(NEWTON_STEPS):
        du, dv, d = surface.getDN(u, v, 1, 0), surface.getDN(u, v, 0, 1), target - at
        a, b, c = du.dot(du), du.dot(dv), dv.dot(dv)
        determinant = a * c - b * b
        if determinant <= 1e-14 * a * c:
            break
        r, s = d.dot(du), d.dot(dv)
        step_u, step_v = (c * r - b * s) / determinant, (a * s - b * r) / determinant
        factor = 1.0
        while factor > 0.05:
            x, y = min(max(u + factor * step_u, u0), u1), min(max(v + factor * step_v, v0), v1)
            at_next = surface.value(x, y)
            length = (target - at_next).Length
            if length < best:
                break
            factor /= 2
        else:
            break
        gain, best, u, v, at = best - length, length, x, y, at_next
        if gain < 1e-9 * (best + 1e-12):
            break
    return best


def whole(surface):
    return [(surface, surface.bounds())]


def ours(given, tolerance):
    options = trimquad.Options(relative_tolerance=tolerance, threads=1, features="ignore" if given.name == "mask" else None,
                               write=["nurbs", "report"])
    started = time.process_time()
    result = trimquad.convert(given.thing, options)
    seconds = time.process_time() - started
    if result.failed:
        raise result.failed[0].error
    surfaces = [(f.Surface, f.ParameterRange) for f in result.shape.Faces]
    poles = sum(s.NbUPoles * s.NbVPoles for s, _ in surfaces)
    found = Fit(f"{tolerance:g}", poles, distances(surfaces, given.probes), given.diagonal, seconds)
    found.faces = len(surfaces)
    return found


def fitted(given, label, make):
    """The Fit of a surface that `make()` returns, or None where it fails."""
    started = time.process_time()
    try:
        surface = make()
    except Exception as error:  # FreeCAD has no common class of them
        print(f"{given.name} {label}: {' '.join(str(error).split())}", flush=True)
        return None
    seconds = time.process_time() - started
    found = Fit(label, surface.NbUPoles * surface.NbVPoles, distances(whole(surface), given.probes), given.diagonal, seconds)
    print(given.name, label, found.text, flush=True)
    return found


def approximated(given):
    points = vectors(given.grid(GRID))

    def make(tolerance):
        surface = Part.BSplineSurface()
        surface.approximate(Points=points, DegMin=3, DegMax=8, Continuity=2, Tolerance=tolerance * given.diagonal)
        return surface

    return [fitted(given, f"approximate {t:g}", lambda t=t: make(t)) for t in APPROXIMATE]


def interpolated(given, sides):
    def make(points):
        surface = Part.BSplineSurface()
        surface.interpolate(points)
        return surface

    grids = [(n, vectors(given.grid(n))) for n in sides]
    return [fitted(given, f"interpolate {n}", lambda p=p: make(p)) for n, p in grids]


def reverse_engineered(given, longest):
    """With more and more poles, until the next ones would take longer than `longest` seconds."""
    points = [tuple(p) for p in given.cloud.tolist()]

    def make(n):
        return ReverseEngineering.approxSurface(Points=points, NbUPoles=n, NbVPoles=n)

    found = []
    for n in APPROX_SURFACE:
        last = next((f for f in reversed(found) if f is not None), None)
        if last is not None and last.seconds * (n**2 / last.poles) ** 2 > longest:
            break
        found.append(fitted(given, f"approxSurface {n}", lambda n=n: make(n)))
    return found


class Comparison:
    """Of one result of TrimQuad, `mine`, with all that another method makes of the same input."""

    def __init__(self, mine, method, others):
        self.method, self.mine = method, mine
        enough = [f for f in others if f.poles >= mine.poles]
        self.poles = min(enough, key=lambda f: (f.poles, f.max)) if enough else min(others, key=lambda f: f.max)
        # A result with fewer poles that is not as close says nothing.
        self.closer = (mine.max < self.poles.max) if enough else (False if self.poles.max <= mine.max else None)
        close = [f for f in others if f.max <= mine.max]
        self.reached = bool(close)
        self.close = min(close, key=lambda f: f.seconds) if close else min(others, key=lambda f: f.max)
        self.quicker = self.reached and mine.seconds < self.close.seconds

    @property
    def lines(self):
        closer = {True: "yes", False: "**no**", None: "not comparable"}[self.closer]
        fewer = "" if self.poles.poles >= self.mine.poles else ", has fewer only"
        quicker = ("yes" if self.quicker else "**no**") if self.reached else "not reached"
        return [
            f"| {self.method}, equal poles{fewer} | {self.poles.text} | {closer} |",
            f"| {self.method}, equal deviation{'' if self.reached else ', its closest'} | {self.close.text} | {quicker} |",
        ]


def tally(name, method, found):
    """A line of the last table."""
    comparable = [c for c in found if c.closer is not None]
    reached = [c for c in found if c.reached]
    return (f"| {name} | {method} | {sum(c.closer for c in comparable)} of {len(comparable)} | {len(reached)} of {len(found)} | "
            f"{sum(c.quicker for c in reached)} of {len(reached)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--longest-re", type=float, default=12,
                        help="seconds that a run of approxSurface may take; they grow with the fourth power of its poles a side")
    options = parser.parse_args()
    version = FreeCAD.Version()
    lines = [HEADER.format(freecad=".".join(version[:2]), occ=load().occ_version, grid=GRID, probes=PROBES, seeds=SEEDS,
                           longest=options.longest_re)]
    tallies = []
    for given in (wavy(), dome(), hood(), mask(os.path.join(options.data, "mesh", "mask3kf.obj"))):
        fits = []
        for tolerance in given.tolerances:
            try:
                fits.append(ours(given, tolerance))
                print(given.name, "ours", tolerance, fits[-1].text, flush=True)
            except Error as error:
                lines.append(f"{given.name}, tolerance {tolerance:g}: {error}\n")
                print(lines[-1], flush=True)
        sides = sorted({*INTERPOLATE, *(math.ceil(math.sqrt(f.poles)) for f in fits)})
        methods = {
            "approximate": approximated(given),
            "interpolate": interpolated(given, sides),
            "RE": reverse_engineered(given, options.longest_re),
        }
        methods = {method: [f for f in found if f is not None] for method, found in methods.items()}
        compared = [Comparison(mine, m, others) for mine in fits for m, others in methods.items() if others]
        lines += [f"## {given.name}", "", "| | poles | largest deviation | rms | seconds | TrimQuad ahead |", "|---|---|---|---|---|---|"]
        for mine in fits:
            faces = "1 face" if mine.faces == 1 else f"{mine.faces} faces"
            lines.append(f"| **TrimQuad, tolerance {mine.label}**, {faces} | {mine.text} | |")
            lines += [line for c in compared if c.mine is mine for line in c.lines]
        lines += [f"{method} fails at every setting." for method, others in methods.items() if not others] + [""]
        tallies += [tally(given.name, method, [c for c in compared if c.method == method]) for method in methods]
    lines += ["## In all", "", "| | | TrimQuad closer at equal poles | the other as close at all | TrimQuad quicker then |",
              "|---|---|---|---|---|", *tallies]
    write_page("other-fits.md", lines)


if __name__ == "__main__":
    main()
