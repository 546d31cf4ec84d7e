"""The stages one by one, as the measurements of studies/ run them."""
import math
import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "studies"))
from stages import Mapped, mesh_size  # noqa: E402


def write_dome(path, parts=24):
    """The upper half of a unit sphere over a square grid of the plane."""
    lines = []
    for j in range(parts + 1):
        for i in range(parts + 1):
            x, y = 2 * i / parts - 1, 2 * j / parts - 1
            # Squares to discs, area by area.
            x, y = x * math.sqrt(1 - y * y / 2), y * math.sqrt(1 - x * x / 2)
            lines.append(f"v {x} {y} {math.sqrt(max(0.0, 1 - x * x - y * y))}")
    for j in range(parts):
        for i in range(parts):
            a = j * (parts + 1) + i + 1
            lines += [f"f {a} {a + 1} {a + parts + 2}", f"f {a} {a + parts + 2} {a + parts + 1}"]
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("boundary", ["free", "aligned"])
def test_all_stages_of_a_dome(tmp_path, boundary):
    path = tmp_path / "dome.obj"
    write_dome(path)
    mapped = Mapped(str(path), mesh_size(str(path))[1] / 20, boundary)
    tmesh = mapped.partition()
    quantization = mapped.quantize(tmesh)
    best = mapped.quantize(tmesh, optimal=True)
    assert best.objective <= quantization.objective * (1 + 1e-9)
    direct = mapped.grid_map(tmesh, quantization)
    constructive = mapped.reembedded(tmesh, quantization)
    faces = [mapped.quads(*grid).statistics["quads"] for grid in (direct, constructive)]
    assert faces[0] > 50
    if boundary == "aligned":  # otherwise the map's place is free
        assert faces[0] == faces[1]
