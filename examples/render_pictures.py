#!/usr/bin/python3
"""Convert the four examples and keep their pictures in docs/ (map, quads, B-spline faces), as the README shows them.

    PYTHONPATH=TrimQuadWorkbench:/usr/lib/freecad-python3/lib python3 examples/render_pictures.py

Every picture comes from the program's own output. Needs matplotlib.
"""
import os
import sys
import tempfile

import matplotlib.image

import trimquad

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
QUADS = {"hood": 500, "tube": 500, "sheet": 450, "box_with_fillets": 600}
KINDS = ("map", "quads", "nurbs")
MARGIN = 12  # pixels of white that stay around the drawing
LARGEST = 150_000  # bytes


def trimmed(picture):
    """The picture without the white around its drawing."""
    rows = (picture < 0.999).any(axis=(1, 2)).nonzero()[0]
    columns = (picture < 0.999).any(axis=(0, 2)).nonzero()[0]
    top, left = max(rows[0] - MARGIN, 0), max(columns[0] - MARGIN, 0)
    return picture[top : rows[-1] + MARGIN, left : columns[-1] + MARGIN]


def main():
    docs = os.path.join(ROOT, "docs")
    os.makedirs(docs, exist_ok=True)
    for name, quads in QUADS.items():
        options = trimquad.Options(quads=quads, write=["pictures"])
        result = trimquad.convert(os.path.join(ROOT, "examples", name + ".step"), options)
        if result.failed:
            raise result.failed[0].error
        with tempfile.TemporaryDirectory() as folder:
            result.write(folder)
            for kind in KINDS:
                picture = matplotlib.image.imread(os.path.join(folder, kind + ".png"))[:, :, :3]
                path = os.path.join(docs, f"{name}-{kind}.png")
                matplotlib.image.imsave(path, trimmed(picture), metadata={"Software": None})
                assert os.path.getsize(path) < LARGEST, path
        print(f"{name}: {[r.quads.statistics['quads'] for r in result.regions]} quads")


if __name__ == "__main__":
    sys.exit(main())
