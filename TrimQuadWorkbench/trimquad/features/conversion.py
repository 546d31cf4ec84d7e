"""Conversions for document objects, kept by content: shell and quads share one, and undo or a second recompute of the
same input costs nothing."""
import dataclasses
import hashlib
import os
from collections import OrderedDict

from ..convert import convert
from ..error import input_error
from ..options import FIELDS, Options
from ..source import Source

KEPT = 8
_results = OrderedDict()


def run_here(source, options):
    """Convert on this thread."""
    return convert(source, options)


# How an object that is recomputed converts: the GUI puts its own in here, with a progress window and a worker thread.
runner = run_here


def source_of(link):
    """The Source of a link (object, names of faces). Raises Error(input)."""
    if link is None or link[0] is None:
        raise input_error("read", "the object has no source; set its Source to an object with faces")
    item, names = link
    faces = [name for name in names if name]
    if hasattr(item, "Mesh"):
        return Source(item.Mesh)
    if not hasattr(item, "Shape"):
        raise input_error("read", f"{item.Label} has neither a shape nor a mesh")
    wrong = [name for name in faces if not name.startswith("Face")]
    if wrong:
        raise input_error("read", f"{wrong[0]} of {item.Label} is not a face; select faces or the whole object")
    source = Source(item.Shape, faces)
    source.path = item.Label
    return source


def result_of(source, options):
    """The Result of a conversion, from memory where it was made before. Raises Error."""
    key = _key(source, options)
    if key not in _results:
        keep(source, options, runner(source, options))
    _results.move_to_end(key)
    return _results[key]


def keep(source, options, result):
    """Remember a finished conversion."""
    _results[_key(source, options)] = result
    while len(_results) > KEPT:
        _results.popitem(last=False)


def _key(source, options: Options):
    digest = hashlib.sha256(source.content())
    digest.update(repr((source.faces, dataclasses.astuple(options))).encode())
    if options.field not in FIELDS and os.path.isfile(options.field):
        with open(options.field, "rb") as stream:
            digest.update(stream.read())
    return digest.hexdigest()
