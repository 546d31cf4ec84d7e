"""Conversions off the GUI thread."""
import threading

from PySide import QtCore

try:
    from PySide import QtWidgets
except ImportError:  # FreeCAD 0.20
    from PySide import QtGui as QtWidgets

from ..convert import convert
from ..error import Error
from ..features import conversion
from ..progress import Progress


class ConversionThread(threading.Thread):
    """Converts a Source, which holds copies: the thread never touches FreeCAD's objects. `result` or `error` at the
    end."""

    def __init__(self, source, options):
        super().__init__(daemon=True)
        self.source = source
        self.options = options
        self.progress = Progress()
        self.result = None
        self.error = None

    def run(self):
        try:
            self.result = convert(self.source, self.options, self.progress)
        except Error as error:
            self.error = error
        except BaseException as error:
            self.error = Error("stage", "internal", f"internal error {type(error).__name__}: {error}")


def run_with_window(source, options):
    """Convert during a recompute: the views stay alive, and a window with a Cancel button comes up when it takes
    longer than half a second. Raises Error."""
    thread = ConversionThread(source, options)
    window = QtWidgets.QProgressDialog("", "Cancel", 0, 100)
    window.setWindowTitle("Trimmed quads and B-splines")
    window.setWindowModality(QtCore.Qt.ApplicationModal)
    window.setMinimumDuration(500)
    window.canceled.connect(thread.progress.cancel)
    thread.start()
    while thread.is_alive():
        thread.join(0.03)
        if not thread.progress.cancelled:
            window.setLabelText(thread.progress.description)
            # The last step would close the window.
            window.setValue(min(99, int(100 * thread.progress.fraction)))
        QtWidgets.QApplication.processEvents()
    window.canceled.disconnect()  # closing says so too
    window.close()
    window.deleteLater()
    if thread.error is not None:
        raise thread.error
    return thread.result


def install():
    """Let recomputed objects convert with a progress window."""
    conversion.runner = run_with_window
