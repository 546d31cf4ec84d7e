"""Writing a result's files: all into a hidden folder first, then renamed one by one, so that none is ever half there."""
import json
import os
import re
import shutil
import tempfile
import time

from .error import input_error, system_error
from .native import load
from .tmesh import tmesh_json

OWN_NAMES = re.compile(
    r"(seamless|gridmap|quads|texture)(-\d+)?\.obj|tmesh(-\d+)?\.json|texture\.(mtl|png)|nurbs\.(step|brep)"
    r"|report\.json|trimquad\.FCStd|(map|quads|textured|histograms|nurbs|nurbs-deviation|tmesh|tmesh_unfolded)\.png"
)


class OutputFolder:
    """The folder that results go into; made if missing, and taken away again if nothing came to be written.

    Used as a context: leaving it by an exception removes all that is not finished.
    """

    def __init__(self, path):
        self.path = os.path.abspath(path)
        self._made = []
        self._scratch = None

    def __enter__(self):
        try:
            self._make()
            self._scratch = tempfile.mkdtemp(prefix=".trimquad-", dir=self.path)
        except OSError as error:
            self.discard()
            raise system_error("write", error, self.path) from None
        return self

    def __exit__(self, *_):
        self.discard()

    def _make(self):
        missing, path = [], self.path
        while not os.path.lexists(path):
            missing.append(path)
            path = os.path.dirname(path)
        if not os.path.isdir(path):
            raise input_error("write", f"{path} is not a folder; choose another --out")
        for path in reversed(missing):
            os.mkdir(path)
            self._made.append(path)

    def discard(self):
        """Remove what is not finished. May be called twice, and from a thread that ends the program."""
        if self._scratch:
            shutil.rmtree(self._scratch, ignore_errors=True)
            self._scratch = None
        for path in reversed(self._made):
            try:
                os.rmdir(path)
            except OSError:
                break
        self._made = []

    def scratch(self, name):
        """Where file `name` is made before it is moved to its place."""
        return os.path.join(self._scratch, name)

    def write_text(self, name, text):
        with open(self.scratch(name), "w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)

    def commit(self, stale=()):
        """Move all files to their places; then remove `stale` ones of an earlier result. Returns the names."""
        names = sorted(os.listdir(self._scratch))
        for name in names:
            os.replace(self.scratch(name), os.path.join(self.path, name))
        for name in stale:
            if name not in names:
                os.unlink(os.path.join(self.path, name))
        return names


def write_result(result, folder, progress):
    """Write what `result.options.write` names; returns the names of the files. Raises Error(input)."""
    try:
        return _write_result(result, folder, progress)
    except (OSError, MemoryError) as error:
        raise system_error("write", error, folder.path) from None


def _write_result(result, folder, progress):
    started = time.monotonic()
    native, kinds = load(), result.options.write
    with progress.stage("write") as native_progress:
        for kind, attribute in (("seamless", "seamless_map"), ("gridmap", "grid"), ("quads", "quads")):
            if kind in kinds:
                for index, item in enumerate(result.regions):
                    value = getattr(item, attribute)
                    if value is not None:
                        progress.check()
                        folder.write_text(_numbered(kind, index, result), value.to_obj())
        if "tmesh" in kinds:
            for index, item in enumerate(result.regions):
                if item.quantization is not None:
                    progress.check()
                    text = tmesh_json(item.tmesh, item.quantization)
                    folder.write_text(_numbered("tmesh", index, result, "json"), text)
        if "texture" in kinds:
            _write_texture(result, folder, progress)
        if "nurbs" in kinds and result.native_shape is not None:
            native.write_step(result.native_shape, folder.scratch("nurbs.step"))
            progress.check()
            native.write_brep(result.native_shape, folder.scratch("nurbs.brep"))
        progress.check()
        if "fcstd" in kinds:
            from .document import write_document

            write_document(result, folder.scratch("trimquad.FCStd"))
        if "pictures" in kinds:
            from .pictures import write_pictures

            write_pictures(result, folder.scratch, progress, native_progress)
        result.seconds["write"] = time.monotonic() - started
        if "report" in kinds:
            folder.write_text("report.json", json.dumps(result.report, indent=1) + "\n")
        progress.check()
        return folder.commit(_stale(folder.path))


def _write_texture(result, folder, progress):
    from .texture import IMAGE, MATERIAL, material, quad_image, textured_obj, write_image

    mapped = [(index, item.grid) for index, item in enumerate(result.regions) if item.grid is not None]
    for index, grid in mapped:
        progress.check()
        folder.write_text(_numbered("texture", index, result), textured_obj(grid.to_obj()))
    if mapped:
        folder.write_text(MATERIAL, material())
        image = quad_image() if result.pattern is None else result.pattern
        write_image(folder.scratch(IMAGE), image)
        if "pictures" in result.options.write:
            from .textured_picture import write_textured

            grids = [grid.arrays for _, grid in mapped]
            write_textured([(points[triangles], uv) for points, triangles, uv in grids], image, folder.scratch("textured.png"))


def _numbered(kind, index, result, extension="obj"):
    return f"{kind}.{extension}" if len(result.regions) == 1 else f"{kind}-{index}.{extension}"


def _stale(path):
    """Files of ours beside an earlier report.json: they belong to the result that is being replaced."""
    if not os.path.isfile(os.path.join(path, "report.json")):
        return []
    return [name for name in sorted(os.listdir(path)) if OWN_NAMES.fullmatch(name)]
