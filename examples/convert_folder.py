"""Convert every CAD and mesh file of a folder inside FreeCAD, without its window.

    freecadcmd examples/convert_folder.py FOLDER OUT [option=value ...]

for example  freecadcmd examples/convert_folder.py examples out/examples quads=500 relative_tolerance=1e-4
Options are those of trimquad.Options; each file's results go into OUT/its-name. Ends with a table of what went
through; the exit status is 0 where everything did, else 3, or 2 where the arguments are unusable.
"""
import os
import sys
import time
import traceback

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "TrimQuadWorkbench"))
KINDS = (".step", ".stp", ".iges", ".igs", ".brep", ".brp", ".fcstd", ".obj", ".off", ".ply", ".stl")


def main(arguments):
    import trimquad

    try:
        folder, out, *settings = arguments
        options = trimquad.Options(**dict(_setting(s) for s in settings))
        options.validate()
        names = sorted(n for n in os.listdir(folder) if os.path.splitext(n)[1].lower() in KINDS)
    except (ValueError, TypeError, OSError, trimquad.Error) as error:
        print(f"convert_folder: {error}\nusage: freecadcmd convert_folder.py FOLDER OUT [option=value ...]")
        return 2
    rows = [_convert(os.path.join(folder, name), os.path.join(out, name), options) for name in names]
    width = max((len(name) for name in names), default=4)
    print(f"{'file':{width}}  regions    quads  control points  deviation  seconds")
    for name, (text, _) in zip(names, rows):
        print(f"{name:{width}}  {text}")
    through = sum(ok for _, ok in rows)
    print(f"{through} of {len(rows)} went through")
    return 0 if through == len(rows) else 3


def _setting(text):
    name, _, value = text.partition("=")
    for kind in (int, float):
        try:
            return name, kind(value)
        except ValueError:
            pass
    return name, value.split(",") if name == "write" else value


def _convert(path, out, options):
    """One line of the table, and whether all regions went through."""
    import trimquad

    started = time.monotonic()
    try:
        result = trimquad.convert(path, options)
        result.write(out)
    except trimquad.Error as error:
        return f"failed: {error}", False
    seconds = time.monotonic() - started
    if result.failed:
        first = result.failed[0]
        return f"{len(result.failed)} of {len(result.regions)} regions failed: {first.name}: {first.error}", False
    regions = result.report["regions"]
    quads = sum(r["quads"]["quads"] for r in regions)
    points = sum(r["nurbs"]["control_points"] for r in regions)
    deviation = max(r["nurbs"]["max_deviation"] for r in regions)
    return f"{len(regions):7d}  {quads:7d}  {points:14d}  {deviation:9.2g}  {seconds:7.1f}", True


# freecadcmd runs a file a second time and exits with 0 where an exception leaves it: catch everything, exit at once.
try:
    status = main(sys.argv[sys.argv.index(next(a for a in sys.argv if a.endswith("convert_folder.py"))) + 1 :])
except BaseException:
    traceback.print_exc()
    status = 1
sys.stdout.flush()
sys.exit(status)
