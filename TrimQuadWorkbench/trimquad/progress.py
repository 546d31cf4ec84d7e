"""Progress of a whole conversion, shared between the thread that works and the one that watches."""
import threading
from contextlib import contextmanager

from .error import cancelled

# Parts of the whole, by measured time on typical models.
WEIGHTS = {"read": 0.02, "tessellate": 0.18, "regions": 0.5, "trim": 0.15, "check": 0.05, "write": 0.1}
# Bridging holes and cutting regions take next to no time. The grid map is made by one of two stages, rarely by both: then the whole is
# reached a little early.
STAGE_SHARES = {"bridge": 0.0, "cut": 0.0, "seamless": 0.37, "partition": 0.01, "quantize": 0.02, "optimize": 0.1, "reembed": 0.1, "extract": 0.05, "fit": 0.45}


class Progress:
    """`cancel()`, `fraction` and `description` may be used from any thread."""

    def __init__(self):
        # Reentrant: a signal's handler may cancel while the same thread reads the description.
        self._lock = threading.RLock()
        self._cancelled = False
        self._running = {}  # native progress -> (share of the whole, text)
        self._finished = 0.0
        self._last = ""
        self.region_count = 1

    def cancel(self):
        """Stop soon: `convert` raises Error of kind 'cancelled'."""
        with self._lock:
            self._cancelled = True
            for native_progress in self._running:
                native_progress.cancel()

    @property
    def cancelled(self):
        return self._cancelled

    def check(self):
        if self._cancelled:
            raise cancelled()

    @property
    def fraction(self):
        """Part of the conversion that is done, in [0, 1]."""
        with self._lock:
            running = sum(share * native_progress.fraction for native_progress, (share, _) in self._running.items())
            return min(1.0, self._finished + running)

    @property
    def description(self):
        """What is being worked on, for people."""
        with self._lock:
            if self._running:
                self._last = next(iter(self._running.values()))[1]
            return self._last

    @contextmanager
    def stage(self, name, region=None):
        """A native Progress for one stage, counted as its part of the whole once it is done."""
        from .native import load

        share = WEIGHTS.get(name)
        if share is None:
            share = WEIGHTS["regions"] * STAGE_SHARES[name] / self.region_count
        native_progress = load().Progress()
        text = name if region is None else f"{name}, {region}"
        with self._lock:
            if self._cancelled:
                raise cancelled()
            self._running[native_progress] = (share, text)
        try:
            yield native_progress
        finally:
            with self._lock:
                del self._running[native_progress]
                self._finished += share
