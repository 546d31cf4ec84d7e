"""T-meshes of the examples and their quantization; the least objective is found once more as an integer program."""
import json

import numpy
import pytest
from conftest import EXAMPLES

from trimquad.native import load
from trimquad.tmesh import tmesh_json

scipy_optimize = pytest.importorskip("scipy.optimize")
scipy_sparse = pytest.importorskip("scipy.sparse")


def scaled_map(path, factor):
    """The map in another unit; powers of two keep it exact."""
    lines = []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "vt":
            line = f"vt {float(words[1]) * factor!r} {float(words[2]) * factor!r}"
        lines.append(line)
    return load().read_map(path.name, "\n".join(lines))


class IntegerProgram:
    """Least sum of weight * (q - length)^2 over consistent lengths, as increments with rising slopes; lengths that do not
    separate are cut off as they come up."""

    def __init__(self, tmesh, reach):
        self.tmesh = tmesh
        self.weights = numpy.array(load().arc_weights(tmesh))
        self.targets = numpy.array([a[2] for a in tmesh.arcs])
        self.most = numpy.ceil(self.targets).astype(int) + reach
        self.arcs = len(self.most)
        self.increments = int(self.most.sum())  # their columns follow those of the lengths, then the binaries
        self.binaries = 0
        self.rows, self.low, self.high = [], [], []
        for _, sides in tmesh.patches:
            for side, opposite in ((0, 2), (1, 3)):
                row = {}
                for arcs, sign in ((sides[side], 1), (sides[opposite], -1)):
                    for h in arcs:
                        self._add(row, abs(h) - 1, sign)
                self._constrain(row, 0, 0)
        column = self.arcs
        for arc, most in enumerate(self.most):
            self._constrain({arc: -1, **dict.fromkeys(range(column, column + most), 1)}, 0, 0)
            column += most

    def _add(self, row, arc, factor):
        row[arc] = row.get(arc, 0) + factor

    def _constrain(self, row, low, high):
        self.rows.append(row), self.low.append(low), self.high.append(high)

    def _binary(self):
        self.binaries += 1
        return self.arcs + self.increments + self.binaries - 1

    def objective(self, q):
        return float((self.weights * (numpy.array(q) - self.targets) ** 2).sum())

    def solve(self):
        slopes = numpy.concatenate(
            [w * (2 * (numpy.arange(m) - t) + 1) for w, t, m in zip(self.weights, self.targets, self.most)]
        )
        columns = self.arcs + self.increments + self.binaries
        entries = [(r, c, f) for r, row in enumerate(self.rows) for c, f in row.items()]
        r, c, f = zip(*entries)
        matrix = scipy_sparse.csc_matrix((f, (r, c)), shape=(len(self.rows), columns))
        whole = numpy.ones(columns)
        whole[self.arcs : self.arcs + self.increments] = 0
        highest = numpy.concatenate([self.most, numpy.ones(columns - self.arcs)])
        found = scipy_optimize.milp(
            numpy.concatenate([numpy.zeros(self.arcs), slopes, numpy.zeros(self.binaries)]),
            constraints=scipy_optimize.LinearConstraint(matrix, self.low, self.high),
            integrality=whole,
            bounds=scipy_optimize.Bounds(0, highest),
            options={"mip_rel_gap": 1e-9, "time_limit": 30},
        )
        assert found.status == 0, found.message
        return [int(x) for x in numpy.rint(found.x[: self.arcs])]

    def cut_off(self, q, collapse):
        """One of the arcs of the collapse must change."""
        zero, might_vanish, others = collapse
        one_of = {}
        for arc in zero:
            self._add(one_of, arc, 1)
        for arc in might_vanish:
            chosen = self._binary()
            one_of[chosen] = 1
            row = {chosen: self.most[arc]}
            self._add(row, arc, 1)
            self._constrain(row, -numpy.inf, self.most[arc])
        for arc in others:
            more, less = self._binary(), self._binary()
            one_of[more] = one_of[less] = 1
            row = {more: -(q[arc] + 1)}
            self._add(row, arc, 1)
            self._constrain(row, 0, numpy.inf)
            room = self.most[arc] - q[arc] + 1
            row = {less: room}
            self._add(row, arc, 1)
            self._constrain(row, -numpy.inf, q[arc] - 1 + room)
        self._constrain(one_of, 1, numpy.inf)

    def least(self):
        for _ in range(200):
            q = self.solve()
            collapses = load().collapses(self.tmesh, q)
            if not collapses:
                return q
            for collapse in collapses:
                self.cut_off(q, collapse)
        raise AssertionError("no end of cuts")


@pytest.mark.parametrize("factor", [1.0, 0.25])
@pytest.mark.parametrize("name", EXAMPLES)
def test_greedy_lengths_are_near_the_integer_programs_optimum(converted, name, factor):
    native = load()
    progress = native.Progress()
    for path in sorted(converted(name)[1].glob("seamless*.obj")):
        tmesh = native.partition(scaled_map(path, factor), progress)
        program = IntegerProgram(tmesh, reach=3)
        least = program.objective(program.least())
        greedy = native.quantize(tmesh, False, progress)
        optimal = native.quantize(tmesh, True, progress)
        assert greedy.objective == pytest.approx(program.objective(greedy.length))
        assert greedy.objective <= 1.1 * least + 1e-6
        assert optimal.lower_bound <= least + 1e-4
        if optimal.method == "optimal":
            assert optimal.objective == pytest.approx(least, abs=1e-4)


@pytest.mark.parametrize("name", EXAMPLES)
def test_tmesh_json_lists_closed_rectangles(converted, name):
    result, _ = converted(name)
    for region in result.regions:
        data = json.loads(tmesh_json(region.tmesh, region.quantization))
        uses = dict.fromkeys((a["id"] for a in data["arcs"]), 0)
        for patch in data["patches"]:
            loop = [h for side in patch["sides"] for h in side]
            ends = []
            for h in loop:
                arc = data["arcs"][abs(h) - 1]
                uses[arc["id"]] += 1
                ends.append((arc["from"], arc["to"]) if h > 0 else (arc["to"], arc["from"]))
            assert len(patch["sides"]) == 4 and 1 <= patch["type"] <= 13
            assert all(a[1] == b[0] for a, b in zip(ends, ends[1:] + ends[:1]))
            for key in ("q", "length"):
                total = [sum(data["arcs"][abs(h) - 1][key] for h in side) for side in patch["sides"]]
                assert total[0] == pytest.approx(total[2]) and total[1] == pytest.approx(total[3])
        assert all(uses[a["id"]] == (1 if a["border"] else 2) for a in data["arcs"])
        counts = result.report["regions"][result.regions.index(region)]["tmesh"]
        assert counts["arcs"] == len(data["arcs"]) and counts["zero_arcs"] == sum(a["q"] == 0 for a in data["arcs"])
