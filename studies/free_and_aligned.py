"""Quads with free and with aligned boundaries at equal numbers of quads, as docs/free-and-aligned.md.

    scripts/study free_and_aligned DATA

DATA has the models of MODELS under the folders named there.
"""
import argparse
import math
import os

import numpy
from stages import DOCS, Error, Mapped, mesh_size, write_page
from trimquad.histograms import histograms, sum_of, write_histograms

QUADS = 1000
# Numbers of quads differ by less than this part.
EQUAL = 0.01
MOST_TRIES = 5
MODELS = [
    "arch/Blob.ply", "arch/BubbleShell.ply", "arch/Hall.ply", "arch/M2_eq_quad2.obj", "arch/Ruled.ply",
    "arch/Xochimilco.ply", "arch/aqua-center.off", "arch/botanic-garden-bubble.off", "arch/british_museum_map.obj",
    "arch/conical1.obj", "arch/mesh_freeform_1.obj", "arch/rolex_learning_centre.obj", "arch/train-station.off",
    "arch/Concerthall.off", "mesh/Flat.off", "mesh/aircraft.obj", "mesh/alligator.obj", "mesh/beetle.off",
    "mesh/bifurcation.stl", "mesh/bump-domain.obj", "mesh/bunny_cut.obj", "mesh/camelhead.off", "mesh/cube_no_bottom.obj",
    "mesh/demosthenes-low-res.obj", "mesh/flatmesh.off", "mesh/hand_lowres.obj", "mesh/inspired_mesh.obj",
    "mesh/lilium.obj", "mesh/mask3kf.obj", "mesh/nacaFlow_unstructured_medium.obj", "mesh/object.stl",
    "mesh/plane_holes.obj", "mesh/punctured-torus.obj", "mesh/reparam_input.obj", "mesh/spothead.obj",
    "mesh/terrain_stl_data.stl", "mesh/vase.off",
]
HEADER = """# Free and aligned boundaries

Made by `scripts/study free_and_aligned DATA`. Every model with a boundary twice, free and with all of its boundary aligned,
sharp edges not followed, at the same number of quads (about {quads}, trimmed ones counted by their part). Irregular: inner
vertices of other than four quads. Angle: mean deviation from 90 degrees of the corners of whole quads. Length: standard
deviation of the edge lengths of whole quads, as a part of their mean. The claim of Lyon, Campen, Bommes and Kobbelt 2019,
section 7, is that free boundaries are better in angles and lengths, and in some cases no worse.

![](free-and-aligned.png)

| model | quads | irregular, free | aligned | angle, free | aligned | length, free | aligned |
|---|---|---|---|---|---|---|---|"""


class Quads:
    """Figures of the quads of a mapped mesh: quads (trimmed ones by their part), irregular, angle, length."""

    def __init__(self, path, edge_length, boundary):
        mapped = Mapped(path, edge_length, boundary)
        tmesh = mapped.partition()
        grid, region = mapped.grid_map(tmesh, mapped.quantize(tmesh))
        uv = grid.arrays[2]
        sides = uv[:, 1:] - uv[:, :1]
        self.quads = 0.5 * float(numpy.sum(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]))
        quads = mapped.quads(grid, region)
        self.histograms = histograms(quads, edge_length)
        statistics = quads.statistics
        self.irregular = statistics["irregular_vertices"]
        self.angle = statistics["angle_deviation"]["mean"]
        edge = statistics["edge_length"]
        self.length = edge["std"] / edge["mean"] if edge["mean"] else 0.0

    def is_no_worse_than(self, other):
        """In irregular vertices and in angles, up to a hundredth of a degree."""
        return self.irregular <= other.irregular and self.angle <= other.angle + 0.01


def pair(path):
    """(free Quads, aligned Quads) of as good as the same number."""
    edge_length = math.sqrt(mesh_size(path)[0] / QUADS)
    free = Quads(path, edge_length, "free")
    best = None
    for _ in range(MOST_TRIES):
        aligned = Quads(path, edge_length, "aligned")
        if best is None or abs(aligned.quads - free.quads) < abs(best.quads - free.quads):
            best = aligned
        if abs(aligned.quads - free.quads) <= EQUAL * free.quads:
            break
        edge_length *= math.sqrt(aligned.quads / free.quads)
    return free, best


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    options = parser.parse_args()
    lines, pairs = [HEADER.format(quads=QUADS)], []
    for name in MODELS:
        try:
            free, aligned = pair(os.path.join(options.data, name))
        except Error as error:
            lines.append(f"| {name} | {error} | | | | | | |")
            continue
        pairs.append((free, aligned))
        mark = "" if free.is_no_worse_than(aligned) else " (*)"
        lines.append(f"| {name}{mark} | {free.quads:.0f}, {aligned.quads:.0f} | {free.irregular} | {aligned.irregular} | "
                     f"{free.angle:.2f} | {aligned.angle:.2f} | {free.length:.3f} | {aligned.length:.3f} |")
        print(lines[-1], flush=True)
    count = max(1, len(pairs))
    fewer = sum(free.irregular <= aligned.irregular for free, aligned in pairs)
    evener = sum(free.length <= aligned.length for free, aligned in pairs)
    straighter = sum(free.angle <= aligned.angle + 0.01 for free, aligned in pairs)
    better = sum(free.is_no_worse_than(aligned) for free, aligned in pairs)
    lines += ["", f"Of {count} models, free boundaries are no worse in irregular vertices on {100 * fewer / count:.0f} %, in edge "
              f"lengths on {100 * evener / count:.0f} %, in angles on {100 * straighter / count:.0f} %, in irregular vertices and "
              f"angles both on {100 * better / count:.0f} %; the others are marked (*)."]
    named = [(name, sum_of([p[k].histograms for p in pairs])) for k, name in enumerate(("free", "aligned"))]
    write_histograms(named, os.path.join(DOCS, "free-and-aligned.png"))
    write_page("free-and-aligned.md", lines)


if __name__ == "__main__":
    main()
