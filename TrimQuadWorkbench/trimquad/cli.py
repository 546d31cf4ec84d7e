"""The command line: trimquad convert INPUT --out DIR."""
import argparse
import os
import signal
import sys
import threading
import time
import traceback

from . import __version__
from .error import Error, input_error, system_error
from .options import FILE_KINDS, Options
from .progress import Progress

DONE, UNUSABLE, FAILED, CANCELLED = 0, 2, 3, 130
STATUS = {"input": UNUSABLE, "stage": FAILED, "cancelled": CANCELLED}
# A native step that does not look at its Progress is not waited for longer than this once the user asked to stop.
PATIENCE = 2.0


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise input_error("options", f"{' '.join(message.split())}; see trimquad convert --help")


def main(arguments=None):
    """Run the command line; returns the exit status: 0 done, 2 unusable input or option, 3 a stage failed, 130."""
    verbose = False
    try:
        parsed = _parser().parse_args(arguments)
        verbose = parsed.verbose
        return _Conversion(parsed).run()
    except SystemExit as exit_:  # --help and --version
        return exit_.code or DONE
    except KeyboardInterrupt:
        return _say_failure(Error("cancelled", "cancelled", "cancelled"), False)
    except BaseException as error:
        return _say_failure(error, verbose)


def _parser():
    parser = _Parser(prog="trimquad", description="CAD faces and meshes to trimmed quads and B-spline faces.",
                     allow_abbrev=False)
    parser.add_argument("--version", action="version", version=f"trimquad {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND", parser_class=_Parser)
    p = commands.add_parser("convert", help="convert a file", allow_abbrev=False,
                            description="Convert INPUT: .step .stp .iges .igs .brep .brp .FCStd .obj .off .ply .stl")
    p.add_argument("input", metavar="INPUT")
    p.add_argument("--out", required=True, metavar="DIR", help="folder for the results, made if missing")
    p.add_argument("--edge-length", type=float, metavar="L", help="quad edge length in the input's unit")
    p.add_argument("--quads", type=int, metavar="N", help="about how many quads (default 1000)")
    p.add_argument("--boundary", metavar="free|aligned", help="what the boundary is by default (default free)")
    p.add_argument("--align", type=_names, metavar="LIST", help="edges that grid lines follow: Edge3; of meshes loop:2, loop:2/1, angle:30-90")
    p.add_argument("--free", type=_names, metavar="LIST", help="edges that grid lines need not follow")
    p.add_argument("--features", metavar="trim|align|ignore",
                   help="sharp edges: separate trimmed surfaces, or aligned curves, or nothing "
                        "(default trim for CAD, align for meshes)")
    p.add_argument("--feature-angle", type=float, metavar="DEG", help="what counts as sharp (default 30)")
    p.add_argument("--feature-points", type=_names, metavar="LIST", help="points that become quad vertices: Vertex5 or x,y,z")
    p.add_argument("--field", metavar="smooth|curvature|FILE",
                   help="what the cross field follows (default curvature)")
    p.add_argument("--field-weight", type=float, metavar="W",
                   help="how closely, from 0, smooth, to 1, aligned (default 0.1 for curvature, 1 for a file)")
    p.add_argument("--fill-holes", type=float, metavar="L",
                   help="bridge holes whose boundary is shorter than L for the map, and cut them out again (default 0: none)")
    p.add_argument("--merge-slivers", type=float, metavar="FRACTION",
                   help="trimmed cells under this fraction of a whole cell merge with a neighbour (default 0: none)")
    p.add_argument("--optimal", action="store_true", default=None, help="quantize to proven optimality")
    p.add_argument("--tolerance", type=float, metavar="T", help="largest deviation, in the input's unit")
    p.add_argument("--relative-tolerance", type=float, metavar="R",
                   help="the same as a fraction of the bounding box's diagonal (default 1e-3)")
    p.add_argument("--route", metavar="auto|direct|reembed", help="how the grid map is made (default auto)")
    p.add_argument("--degree", type=int, metavar="P", help="B-spline degree, 2 to 5 (default 3)")
    p.add_argument("--pattern", metavar="PICTURE", help="what the texture puts on every quad (default: a diamond in grid lines)")
    p.add_argument("--write", type=_names, metavar="LIST",
                   help=f"of {','.join(FILE_KINDS)} (default gridmap,quads,nurbs,report)")
    p.add_argument("--threads", type=int, metavar="N", help="regions worked on at once (default: cores)")
    loudness = p.add_mutually_exclusive_group()
    loudness.add_argument("--quiet", action="store_true", help="no progress on stderr")
    loudness.add_argument("--verbose", action="store_true", help="a line per region and file; tracebacks")
    return parser


def _names(text):
    return [name.strip() for name in text.split(",") if name.strip()]


def _options(parsed):
    names = Options.__dataclass_fields__
    return Options(**{k: v for k, v in vars(parsed).items() if k in names and v is not None})


class _Conversion:
    """Converts in a worker thread, so that the main thread is free to draw progress and to be interrupted."""

    def __init__(self, parsed):
        self.parsed = parsed
        self.progress = Progress()
        self.folder = self.error = self.result = None
        self.names = []
        self.screen = _Screen(parsed.quiet)

    def run(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: self.progress.cancel())
        worker = threading.Thread(target=self._work, daemon=True)
        worker.start()
        asked = None
        while worker.is_alive():
            worker.join(0.05)
            self.screen.show(self.progress)
            if self.progress.cancelled:
                asked = asked or time.monotonic()
                if time.monotonic() - asked > PATIENCE:
                    return self._abandon()
        self.screen.clear()
        if self.error is not None:
            return _say_failure(self.error, self.parsed.verbose)
        return self._conclude()

    def _work(self):
        from .convert import convert
        from .output import OutputFolder, write_result

        try:
            options = _options(self.parsed)
            options.validate()
            with OutputFolder(self.parsed.out) as self.folder:
                self.result = convert(self.parsed.input, options, self.progress)
                self.names = write_result(self.result, self.folder, self.progress)
        except BaseException as error:
            self.error = error

    def _abandon(self):
        """End without waiting for a native step that does not return; nothing unfinished stays behind."""
        if self.folder is not None:
            self.folder.discard()
        self.screen.clear()
        _say_failure(Error("cancelled", "cancelled", "cancelled"), False)
        os._exit(CANCELLED)

    def _conclude(self):
        result, failed = self.result, self.result.failed
        if not self.parsed.quiet:
            for line in result.warnings:
                _say(f"trimquad: {line}")
        if self.parsed.verbose:
            for item in result.regions:
                counts = item.quads.statistics if item.quads else {"quads": 0, "trimmed": 0}
                quads = f"{counts['quads']} quads, {counts['trimmed']} trimmed"
                _say(f"{item.name}: {item.error or quads}")
            for name in self.names:
                _say(os.path.join(self.parsed.out, name))
        if not failed:
            return DONE
        first = failed[0]
        text = f"region '{first.name}', stage {first.error.stage}: {first.error}"
        if len(result.regions) > 1:
            text = f"{len(failed)} of {len(result.regions)} regions failed; {text}"
        if "report" in result.options.write and len(result.regions) > 1:
            text += f"; report.json in {self.parsed.out} lists all regions"
        _say(f"trimquad: {text}")
        return FAILED


class _Screen:
    """Progress on stderr: a bar on a terminal, a line per stage elsewhere."""

    WIDTH = 30

    def __init__(self, quiet):
        self.quiet = quiet
        self.terminal = sys.stderr.isatty()
        self.last = ""

    def show(self, progress):
        if self.quiet:
            return
        text = progress.description
        if self.terminal:
            done = int(progress.fraction * self.WIDTH)
            _say(f"\r[{'#' * done}{'.' * (self.WIDTH - done)}] {text:40.40s}", end="")
            self.last = text
        elif text and text.split(",")[0] != self.last:
            self.last = text.split(",")[0]
            _say(f"{int(100 * progress.fraction):3d} % {self.last}")

    def clear(self):
        if self.terminal and self.last:
            _say("\r" + " " * (self.WIDTH + 44) + "\r", end="")


def _say_failure(error, verbose):
    """One line on stderr; returns the exit status."""
    if verbose and not isinstance(error, Error):
        traceback.print_exception(type(error), error, error.__traceback__)
    if isinstance(error, (OSError, MemoryError)):
        error = system_error("system", error)
    if isinstance(error, Error):
        place = f"stage {error.stage}: " if error.kind == "stage" else ""
        _say(f"trimquad: {place}{error}")
        return STATUS[error.kind]
    text = " ".join(str(error).split())
    _say(f"trimquad: internal error {type(error).__name__}: {text}; please report it with the input")
    return FAILED


def _say(text, end="\n"):
    try:
        print(text, end=end, file=sys.stderr, flush=True)
    except OSError:  # nobody reads stderr any more
        pass


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.exit(status)
