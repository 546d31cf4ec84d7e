"""Times of the paper's four stages on its models or their nearest equivalents, as docs/table1.md.

    scripts/study table1 DATA [--cores TEXT]

DATA has the models of MODELS under the folders named there.
"""
import argparse
import math
import os

from stages import Error, Mapped, mesh_size, timed, write_page

# Model and the row of the paper's Table 1 that is nearest: name, triangles, singularities, arcs, seconds of partition,
# quantization, re-embedding and optimisation.
PAPER = {
    "Beetle": (38726, 9, 299, 0.0318, 0.0433, 0.0624, 7.94),
    "Hand": (3000, 36, 344, 0.0052, 0.0306, 0.0291, 1.83),
    "Face": (62467, 24, 432, 0.0474, 0.0784, 0.1491, 15.9),
    "Train Station": (2546, 8, 243, 0.0050, 0.0335, 0.0109, 0.94),
    "Flat Roof": (40000, 8, 88, 0.0102, 0.0019, 0.0389, 13.0),
    "Dome Roof": (10000, 5, 96, 0.0086, 0.0023, 0.0098, 1.35),
    "Wing Profile": (14463, 0, 25, 0.0021, 0.0006, 0.0005, 1.76),
}
# Model, its boundaries: words for them and what Mapped takes.
FREE, ALIGNED = ("free", ("free",)), ("aligned", ("aligned",))
BOTH = [FREE, ALIGNED]
MODELS = [
    ("mesh/mask.off", BOTH, "Face"),
    ("mesh/beetle.off", BOTH, "Beetle"),
    ("mesh/hand_rem.obj", [FREE], "Hand"),
    ("mesh/hand_lowres.obj", BOTH, "Hand"),
    ("arch/train-station.off", BOTH, "Train Station"),
    ("arch/aqua-center.off", BOTH, "Dome Roof"),
    ("mesh/Flat.off", BOTH, "Flat Roof"),
    ("mesh/nacaFlow_unstructured_medium.obj",
     [FREE, ("outer boundary aligned", ("free", ["loop:0"])), ("profile aligned", ("free", ["loop:1"])), ALIGNED],
     "Wing Profile"),
]
QUADS = 1000
HEADER = """# Times of the stages

Made by `scripts/study table1 DATA`. Every model with a free and with an aligned boundary (closed ones have none), sharp
edges not followed, about {quads} quads. Seconds of one processor of {cores}; the least of several runs where they are
short. Below a model's rows the nearest row of Table 1 in Lyon, Campen, Bommes and Kobbelt 2019, measured there "on a
desktop machine using a single-threaded implementation". Models of the same name are not always the same mesh, nor is
it always said which boundaries were aligned; so what they are comparable by is their number of triangles, and for
re-embedding that of arcs, since its work is where arcs run. The paper's wing is that of its Fig. 14, without
singularities: there, of the flow around a profile, either all boundaries are aligned or the profile alone; ours has
all four choices.

`re-embed` and `optimize` are the constructive route of the paper; `crossings` are those of arcs and mesh edges, which
re-embedding has to look at. `auto` is the grid map by default: by the direct route where that has one (without
singularities and aligned edges the seamless map itself), else (\\*) by the constructive one after it.

| model | triangles | singular | arcs | crossings | partition | quantize | re-embed | optimize | auto |
|---|---|---|---|---|---|---|---|---|---|"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    parser.add_argument("--cores", default="a virtual machine with 2 cores", help="the machine, in words")
    options = parser.parse_args()
    lines = [HEADER.format(quads=QUADS, cores=options.cores)]
    for name, boundaries, peer in MODELS:
        for words, boundary in boundaries:
            lines.append(row(os.path.join(options.data, name), f"{name}, {words}", boundary))
        triangles, singular, arcs, *seconds = PAPER[peer]
        partition, quantize, reembed, optimize = (f"*{s:.4g}*" for s in seconds)
        lines.append(f"| *paper: {peer}* | *{triangles}* | *{singular}* | *{arcs}* | | {partition} | {quantize} "
                     f"| {reembed} | {optimize} | |")
    write_page("table1.md", lines)


def row(path, name, boundary):
    area, _ = mesh_size(path)
    mapped = Mapped(path, math.sqrt(area / QUADS), *boundary)
    tmesh, partition = timed(mapped.partition)
    quantization, quantize = timed(mapped.quantize, tmesh)
    embedded, reembed = timed(mapped.embedded, tmesh, quantization)
    _, optimize = timed(mapped.optimized, embedded, prepare=mapped.fresh_model)
    grid, auto = timed(direct_or_none, mapped, tmesh, quantization)
    seconds = [partition, quantize, reembed, optimize, auto]
    if grid is None:
        seconds[-1] += reembed + optimize
    figures = [f"{s:.2g}" if s < 0.01 else f"{s:.3g}" for s in seconds]
    return (f"| {name} | {mapped.region.triangles} | {len(mapped.field.singular_vertices)} "
            f"| {len(tmesh.arcs)} | {embedded.crossings} | " + " | ".join(figures)
            + (" \\* |" if grid is None else " |"))


def direct_or_none(mapped, tmesh, quantization):
    """The grid map by the direct route; None where it gives up."""
    try:
        return mapped.direct(tmesh, quantization)
    except Error:
        return None


if __name__ == "__main__":
    main()
