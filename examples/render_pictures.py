#!/usr/bin/python3
"""Convert the examples and keep their pictures in docs/ (map, quads, B-spline faces), as the README shows them.

    PYTHONPATH=TrimQuadWorkbench:/usr/lib/freecad-python3/lib python3 examples/render_pictures.py [NAME ...]

Names are those of EXAMPLES; all where there is none. Every picture comes from the program's own output. Needs matplotlib and PIL.
"""
import os
import sys
import tempfile

from PIL import Image, ImageChops

import trimquad

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Of the closed surface the stages before the B-splines are shown.
OPEN, CLOSED = ("map", "quads", "nurbs"), ("tmesh", "tmesh_unfolded", "quads")
# pictures' name: (file, options, pictures)
EXAMPLES = {
    "hood": ("hood", {"quads": 500}, OPEN),
    "tube": ("tube", {"quads": 550}, (*OPEN, "nurbs-deviation")),
    "sheet": ("sheet", {"quads": 450}, OPEN),
    "box_with_fillets": ("box_with_fillets", {"quads": 600}, (*OPEN, "nurbs-deviation")),
    "tee": ("closed/tee", {"quads": 1500}, CLOSED),
    "wing": ("flow/wing", {"quads": 1500, "align": ["Edge2", "Edge3"]}, ("quads",)),
    "wing-aligned": ("flow/wing", {"quads": 1500, "boundary": "aligned"}, ("quads",)),
    "station": ("roof/station", {"edge_length": 3.0, "pattern": os.path.join(ROOT, "examples", "pattern", "lattice.png")},
                ("textured",)),
    **{f"station-{boundary}-{length:g}": ("roof/station", {"edge_length": length, "boundary": boundary}, ("quads",))
       for boundary in ("free", "aligned") for length in (5.0, 3.0, 1.5)},
}
MARGIN = 12  # pixels of white that stay around the drawing
COLOURS = 96
WIDTH = 640  # pixels, at most
LARGEST = 150_000  # bytes


def trimmed(picture):
    """The picture without the white around its drawing, in a small palette."""
    white = Image.new("RGB", picture.size, "white")
    left, top, right, bottom = ImageChops.difference(picture, white).getbbox()
    box = max(left - MARGIN, 0), max(top - MARGIN, 0), right + MARGIN, bottom + MARGIN
    picture = picture.crop(box)
    picture.thumbnail((WIDTH, WIDTH))
    return picture.quantize(COLOURS, dither=Image.Dither.NONE)


def files_for(kinds):
    """What `--write` needs for these pictures."""
    needed = {"textured": "texture", "quads": "quads", "map": "gridmap", "nurbs": "nurbs", "nurbs-deviation": "nurbs"}
    return sorted({"pictures", *(needed.get(kind, "tmesh") for kind in kinds)})


def main():
    docs = os.path.join(ROOT, "docs")
    os.makedirs(docs, exist_ok=True)
    for name in sys.argv[1:] or EXAMPLES:
        file, settings, kinds = EXAMPLES[name]
        result = trimquad.convert(
            os.path.join(ROOT, "examples", file + ".step"), trimquad.Options(write=files_for(kinds), **settings)
        )
        if any(item.error for item in result.regions):
            raise result.failed[0].error
        with tempfile.TemporaryDirectory() as folder:
            result.write(folder)
            for kind in kinds:
                picture = Image.open(os.path.join(folder, kind + ".png")).convert("RGB")
                path = os.path.join(docs, f"{name}-{kind}.png")
                trimmed(picture).save(path, optimize=True)
                assert os.path.getsize(path) < LARGEST, path
        print(f"{name}: {', '.join(kinds)}")


if __name__ == "__main__":
    sys.exit(main())
