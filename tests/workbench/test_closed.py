"""Closed surfaces with irregular vertices, from shape to quads; the grid map is checked in exact numbers, from its file."""
import json
from collections import Counter, defaultdict
from fractions import Fraction

import FreeCAD
import numpy
import Part
import pytest

import trimquad
from trimquad import cli


def boxes():
    """An L of two boxes: ten convex corners, two hollow ones."""
    return Part.makeBox(60, 40, 20).fuse(Part.makeBox(20, 40, 50)).removeSplitter()


def ball():
    return Part.makeSphere(20)


def torus():
    return Part.makeTorus(40, 14)


def tee():
    """Two pipes whose bores meet: three openings, so two handles."""
    V = FreeCAD.Vector
    outside = Part.makeCylinder(30, 200, V(-100, 0, 0), V(1, 0, 0)).fuse(Part.makeCylinder(22, 90))
    inside = Part.makeCylinder(24, 200, V(-100, 0, 0), V(1, 0, 0)).fuse(Part.makeCylinder(16, 90))
    return outside.cut(inside).removeSplitter()


# name: (shape, Euler characteristic)
CLOSED = {"boxes": (boxes, 2), "ball": (ball, 2), "torus": (torus, 0), "tee": (tee, -2)}


@pytest.fixture(scope="module", params=["auto", "reembed"])
def written(request, tmp_path_factory):
    """Output folder of a closed part's conversion by the command line, done once for either route of the grid map."""
    done = {}

    def write(name):
        if name not in done:
            folder = tmp_path_factory.mktemp(name)
            CLOSED[name][0]().exportBrep(str(folder / "part.brep"))
            out = folder / "out"
            status = cli.main(["convert", str(folder / "part.brep"), "--out", str(out), "--quads", "400", "--features",
                               "align", "--route", request.param, "--write", "seamless,tmesh,gridmap,quads,report", "--quiet"])
            assert status == 0
            done[name] = out
        return done[name]

    return write


def faces_of(path, group=None):
    """Polygons of an OBJ file, of one group or of all, as lists of vertex numbers."""
    faces, current = [], None
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "g":
            current = words[1]
        elif words[0] == "f" and group in (None, current):
            faces.append([int(w.split("/")[0]) for w in words[1:]])
    return faces


def half_edges(faces):
    return Counter((a, b) for face in faces for a, b in zip(face, face[1:] + face[:1]))


@pytest.mark.parametrize("name", CLOSED)
def test_a_closed_surface_becomes_a_closed_quad_mesh_of_its_kind(written, name):
    faces = faces_of(written(name) / "quads.obj")
    assert all(len(set(face)) == len(face) == 4 for face in faces)
    directed = half_edges(faces)
    assert set(directed.values()) == {1}
    assert all((b, a) in directed for a, b in directed)
    vertices = {v for face in faces for v in face}
    assert len(vertices) - len(directed) // 2 + len(faces) == CLOSED[name][1]
    assert faces_of(written(name) / "quads.obj", "trimmed") == []


@pytest.mark.parametrize("name", CLOSED)
def test_valences_are_those_of_the_cross_fields_singularities(written, name):
    valence = Counter(v for face in faces_of(written(name) / "quads.obj") for v in face)
    indices = Counter(4 - n for n in valence.values() if n != 4)
    (region,) = json.loads((written(name) / "report.json").read_text())["regions"]
    assert indices == {int(k): n for k, n in region["singularities"]["indices"].items()}
    assert sum(k * n for k, n in indices.items()) == 4 * CLOSED[name][1]
    assert region["quads"]["irregular_vertices"] == sum(indices.values())


class ExactMap:
    """A map's file in rational numbers: by triangle, three vertices and their images."""

    def __init__(self, path):
        images, self.triangles, self.aligned = [], [], []
        for line in path.read_text().splitlines():
            kind, *words = line.split()
            if kind == "vt":
                images.append(tuple(Fraction(float(w)) for w in words))
            elif kind == "f":
                pairs = [w.split("/") for w in words]
                self.triangles.append(([int(v) for v, _ in pairs], [images[int(t) - 1] for _, t in pairs]))
            elif kind == "l":
                self.aligned.append(frozenset(int(w) for w in words))
        self.side = {}  # from, to -> images of both, in the triangle to the left
        for corners, uv in self.triangles:
            for k in range(3):
                edge = corners[k], corners[(k + 1) % 3]
                assert edge not in self.side
                self.side[edge] = uv[k], uv[(k + 1) % 3]

    def transitions(self):
        """By directed edge (quarter turns, translation) that carries the images on its left onto those on its right."""
        found = {}
        for (a, b), (pa, pb) in self.side.items():
            if (b, a) not in self.side:
                continue
            qb, qa = self.side[b, a]
            step, wanted = (pb[0] - pa[0], pb[1] - pa[1]), (qb[0] - qa[0], qb[1] - qa[1])
            turns = [r for r in range(4) if turned(step, r) == wanted]
            assert turns, f"the seam at edge {a}-{b} is not turned by quarters"
            image = turned(pa, turns[0])
            found[a, b] = turns[0], (qa[0] - image[0], qa[1] - image[1])
        return found

    def turning(self):
        """By inner vertex the quarter turns that are left after going around it."""
        following = {}  # vertex -> far ends: next counter-clockwise
        for (a, b, c), _ in self.triangles:
            for v, x, y in ((a, b, c), (b, c, a), (c, a, b)):
                following.setdefault(v, {})[x] = y
        across, result = self.transitions(), {}
        for v, ring in following.items():
            if set(ring) != set(ring.values()):
                continue
            result[v] = sum(across[x, v][0] for x in ring) % 4
        return result


def turned(p, quarters):
    for _ in range(quarters):
        p = -p[1], p[0]
    return p


@pytest.mark.parametrize("kind", ["seamless", "gridmap"])
@pytest.mark.parametrize("name", CLOSED)
def test_the_map_is_one_to_one_on_triangles_and_seamless_in_exact_numbers(written, name, kind):
    exact = ExactMap(written(name) / f"{kind}.obj")
    for _, ((ax, ay), (bx, by), (cx, cy)) in exact.triangles:
        assert (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0
    across = exact.transitions()
    assert len(across) == len(exact.side)  # no boundary
    for edge in exact.aligned:
        a, b = edge
        (pu, pv), (qu, qv) = exact.side[a, b]
        assert pu == qu or pv == qv


@pytest.mark.parametrize("name", CLOSED)
def test_the_grid_map_is_integer_in_exact_numbers(written, name):
    exact = ExactMap(written(name) / "gridmap.obj")
    assert all(x.denominator == 1 for _, translation in exact.transitions().values() for x in translation)
    images = defaultdict(set)
    for corners, uv in exact.triangles:
        for v, p in zip(corners, uv):
            images[v].add(p)
    singular = [v for v, quarters in exact.turning().items() if quarters]
    (region,) = json.loads((written(name) / "report.json").read_text())["regions"]
    assert len(singular) == region["singularities"]["count"]
    for v in singular:
        assert all(x.denominator == 1 for p in images[v] for x in p)
    for edge in exact.aligned:
        (pu, pv), (qu, qv) = exact.side[tuple(edge)]
        assert (pu == qu and pu.denominator == 1) or (pv == qv and pv.denominator == 1)


@pytest.mark.parametrize("name", CLOSED)
def test_the_quantized_tmesh_covers_as_many_quads_as_there_are(written, name):
    tmesh = json.loads((written(name) / "tmesh.json").read_text())
    length = [arc["q"] for arc in tmesh["arcs"]]
    assert all(q >= 0 for q in length)
    area = 0
    for patch in tmesh["patches"]:
        sides = [sum(length[abs(h) - 1] for h in side) for side in patch["sides"]]
        assert sides[0] == sides[2] and sides[1] == sides[3]
        area += sides[0] * sides[1]
    assert area == len(faces_of(written(name) / "quads.obj"))


def test_the_optimal_quantization_is_proven_and_no_worse():
    greedy, optimal = (
        trimquad.convert(boxes(), trimquad.Options(quads=150, features="align", write=["quads"], optimal=on))
        for on in (False, True)
    )
    for result in (greedy, optimal):
        assert not result.failed
    worse, best = (r.report["regions"][0]["quantization"] for r in (greedy, optimal))
    assert best["method"] == "optimal"
    assert best["lower_bound"] == pytest.approx(best["objective"])
    assert best["objective"] <= worse["objective"] + 1e-9


@pytest.mark.parametrize("name", ["boxes", "ball", "torus"])
def test_the_constructive_route_gives_an_integer_grid_map_too(name, tmp_path):
    options = trimquad.Options(quads=150, features="align", route="reembed", write=["gridmap", "quads"])
    result = trimquad.convert(CLOSED[name][0](), options)
    assert [str(r.error) for r in result.failed] == []
    (region,) = result.report["regions"]
    assert region["embedding"]["route"] == "reembedded"
    result.write(str(tmp_path))
    exact = ExactMap(tmp_path / "gridmap.obj")
    for _, ((ax, ay), (bx, by), (cx, cy)) in exact.triangles:
        assert (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0
    assert all(x.denominator == 1 for _, translation in exact.transitions().values() for x in translation)
    assert sum(q != 0 for q in exact.turning().values()) == region["singularities"]["count"]
    faces = faces_of(tmp_path / "quads.obj")
    valence = Counter(v for face in faces for v in face)
    assert sum(4 - n for n in valence.values()) == 4 * CLOSED[name][1]


def thin_torus(radius, thickness, around=48, across=12):
    u, v = numpy.meshgrid(numpy.arange(around), numpy.arange(across), indexing="ij")
    a, b = 2 * numpy.pi * u / around, 2 * numpy.pi * v / across
    ring = radius + thickness * numpy.cos(b)
    points = numpy.stack([ring * numpy.cos(a), ring * numpy.sin(a), thickness * numpy.sin(b)], axis=-1).reshape(-1, 3)
    at = lambda i, j: (i % around) * across + j % across  # noqa: E731
    triangles = [t for i in range(around) for j in range(across)
                 for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    return points, numpy.array(triangles)


@pytest.mark.parametrize("route", ["auto", "reembed"])
def test_around_a_handle_narrower_than_a_quad_there_are_three(route):
    options = trimquad.Options(edge_length=20, features="ignore", route=route, write=["quads"])
    region = trimquad.convert(thin_torus(40, 3), options).regions[0]
    assert region.error is None
    assert region.edge_length == 20
    polygons = region.polygons
    sides = Counter()
    for quad in polygons.full:
        assert len(set(quad)) == 4
        sides.update(zip(quad, (*quad[1:], quad[0])))
    assert set(sides.values()) == {1}
    assert len(polygons.points) - len(sides) // 2 + len(polygons.full) == 0
    assert len(polygons.full) % 3 == 0
