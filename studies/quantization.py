"""How far the lengths of the fast quantization are from the best ones, as docs/quantization.md.

    scripts/study quantization DATA

DATA has the models of MODELS under the folders named there.
"""
import argparse
import os
import time

from free_and_aligned import MODELS as OPEN
from stages import Error, Mapped, mesh_size, write_page

CLOSED = ["mesh/bumpy.off", "mesh/torus.obj", "mesh/rocker-arm2500.obj", "mesh/hand_rem.obj", "mesh/kitten_rem.obj",
          "mesh/bunny.off", "mesh/joint_rem.obj", "mesh/fandisk.off", "mesh/BracketInches_rem_rem.obj"]
LARGE = {"mesh/beetle.off", "mesh/plane_holes.obj", "mesh/demosthenes-low-res.obj"}  # left out: maps of many seconds
MODELS = [name for name in OPEN if name not in LARGE] + CLOSED
LENGTHS = (20, 50, 150)
HEADER = """# Quantization: fast and best

Made by `scripts/study quantization DATA`. Every model free and with its boundary aligned, at edge lengths of 1/20, 1/50 and
1/150 of its diagonal. Objective: see `native/trimquad/quantize/objective.h`. Best: the least objective that `--optimal`
finds; bound: what no valid lengths can be under, equal to the best where that is proven. Rows where the fast quantization
finds the proven best are only counted.

| model | arcs | fast | best | bound | seconds, fast | best |
|---|---|---|---|---|---|---|"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data")
    options = parser.parse_args()
    lines, gaps, unproven = [HEADER], [], 0
    for name in MODELS:
        path = os.path.join(options.data, name)
        for boundary in ("free", "aligned")[: 1 if name in CLOSED else 2]:
            for parts in LENGTHS:
                try:
                    mapped = Mapped(path, mesh_size(path)[1] / parts, boundary)
                except Error as error:
                    print(f"{name}, {boundary}, 1/{parts}: {error}", flush=True)
                    continue
                tmesh = mapped.partition()
                started = time.process_time()
                fast = mapped.quantize(tmesh)
                between = time.process_time()
                best = mapped.quantize(tmesh, optimal=True)
                seconds = between - started, time.process_time() - between
                if best.method == "optimal":
                    gaps.append(fast.objective / best.objective - 1 if best.objective > 0 else 0.0)
                    if gaps[-1] < 1e-6:
                        continue
                else:
                    unproven += 1
                lines.append(f"| {name}, {boundary}, 1/{parts} | {len(tmesh.arcs)} | {fast.objective:.5g} | {best.objective:.5g} | "
                             f"{best.lower_bound:.5g} | {seconds[0]:.2g} | {seconds[1]:.2g} |")
                print(lines[-1], flush=True)
    lines += ["", f"Of {len(gaps) + unproven} T-meshes the best lengths are proven for {len(gaps)}; there the fast objective is "
              f"{100 * sum(gaps) / max(1, len(gaps)):.2f} % over the best on average, {100 * max(gaps, default=0):.1f} % at most, and "
              f"equal for {sum(g < 1e-6 for g in gaps)}."]
    write_page("quantization.md", lines)


if __name__ == "__main__":
    main()
