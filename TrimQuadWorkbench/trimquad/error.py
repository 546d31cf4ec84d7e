"""The one exception of the package; the compiled stages raise it too."""


class Error(Exception):
    """A conversion that cannot go on. `str()` is one line for the user: what, and where.

    kind      'input' (the input or an option is unusable), 'stage' (a stage failed on a usable input), 'cancelled'
    stage     the stage's name as in report.json, 'options', 'read' or 'write'
    message   what is wrong and what the user can do
    where     the element it happened at, such as 'Face3' or 'line 12'; may be empty
    position  (x, y, z) in model units, or None
    coarse    whether shorter edges of the quads are the cure
    endless   whether OpenCASCADE's check of a surface does not end, rather than finds it at fault
    others    where several regions failed at once: an Error of each of the others
    """

    def __init__(self, kind, stage, message, where="", position=None, coarse=False, endless=False):
        text = message
        if where:
            text += f" ({where})"
        if position is not None:
            text += " at (%.6g, %.6g, %.6g)" % tuple(position)
        super().__init__(" ".join(text.split()))
        self.kind = kind
        self.stage = stage
        self.coarse = coarse
        self.endless = endless
        self.message = message
        self.where = where
        self.position = None if position is None else tuple(float(x) for x in position)
        self.others = []


def input_error(stage, message, where=""):
    return Error("input", stage, message, where)


def cancelled():
    return Error("cancelled", "cancelled", "cancelled")


def system_error(stage, error, path=""):
    """The Error for an operating system's or an allocation failure: full disk, no permission, out of memory."""
    if isinstance(error, MemoryError):
        return input_error(stage, "out of memory; use a larger edge length, or a smaller part of the model")
    reason = error.strerror or str(error)
    name = str(path or error.filename or "")
    advice = {28: "; free some space or choose another folder", 13: "; choose a folder that you may write to"}
    subject = f"{name}: " if name else ""
    return input_error(stage, f"{subject}{reason}{advice.get(error.errno, '')}")
