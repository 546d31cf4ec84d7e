"""The task panel of a conversion: options, progress, Cancel."""
import dataclasses

import FreeCAD
import FreeCADGui
from PySide import QtCore

try:
    from PySide import QtWidgets
except ImportError:  # FreeCAD 0.20
    from PySide import QtGui as QtWidgets

from ..error import Error
from ..features import conversion
from ..features.spline_shell import options_of
from ..options import Options
from .worker import ConversionThread

TITLE = "Trimmed quads and B-splines"


class ConvertPanel:
    """Converts `item` (its `faces`, names, or all where empty) into new objects, or `shell` anew with other options."""

    def __init__(self, item, faces, shell=None):
        self.item = item
        self.faces = faces
        self.shell = shell
        self.thread = None
        self.form = QtWidgets.QWidget()
        self.form.setWindowTitle(TITLE)
        self._build(options_of(shell) if shell else Options())
        self.timer = QtCore.QTimer(self.form)
        self.timer.timeout.connect(self._poll)

    def _build(self, options):
        layout = QtWidgets.QFormLayout(self.form)
        chosen = f"{len(self.faces)} faces of " if self.faces else ""
        layout.addRow(QtWidgets.QLabel(f"Convert {chosen}{self.item.Label}"))
        self.by_count = QtWidgets.QRadioButton("Number of quads")
        self.by_length = QtWidgets.QRadioButton("Edge length")
        self.count = QtWidgets.QSpinBox()
        self.count.setRange(1, 2_000_000)
        self.count.setValue(options.quads or 1000)
        self.length = _length_box(options.edge_length or 10.0)
        layout.addRow(self.by_count, self.count)
        layout.addRow(self.by_length, self.length)
        self.relative = QtWidgets.QRadioButton("Tolerance / diagonal")
        self.absolute = QtWidgets.QRadioButton("Tolerance")
        group = QtWidgets.QButtonGroup(self.form)
        group.addButton(self.relative)
        group.addButton(self.absolute)
        self.relative_tolerance = _length_box(options.relative_tolerance or 1e-3)
        self.tolerance = _length_box(options.tolerance or 0.1)
        layout.addRow(self.relative, self.relative_tolerance)
        layout.addRow(self.absolute, self.tolerance)
        self.degree = QtWidgets.QSpinBox()
        self.degree.setRange(2, 5)
        self.degree.setValue(options.degree)
        layout.addRow("Degree", self.degree)
        self.angle = QtWidgets.QDoubleSpinBox()
        self.angle.setRange(1, 179)
        self.angle.setSuffix("°")
        self.angle.setValue(options.feature_angle)
        layout.addRow("Sharp edges from", self.angle)
        self.bar = QtWidgets.QProgressBar()
        self.bar.setRange(0, 100)
        self.bar.hide()
        layout.addRow(self.bar)
        self.message = QtWidgets.QLabel()
        self.message.setWordWrap(True)
        layout.addRow(self.message)
        for button, box in (
            (self.by_count, self.count),
            (self.by_length, self.length),
            (self.relative, self.relative_tolerance),
            (self.absolute, self.tolerance),
        ):
            button.toggled.connect(box.setEnabled)
            box.setEnabled(False)
        (self.by_length if options.edge_length else self.by_count).setChecked(True)
        (self.absolute if options.tolerance else self.relative).setChecked(True)

    def getStandardButtons(self):
        return int(QtWidgets.QDialogButtonBox.Ok | QtWidgets.QDialogButtonBox.Cancel)

    def properties(self):
        """The panel's values as properties of a SplineShell."""
        return {
            "EdgeLength": self.length.value() if self.by_length.isChecked() else 0.0,
            "Quads": self.count.value(),
            "Tolerance": self.tolerance.value() if self.absolute.isChecked() else 0.0,
            "RelativeTolerance": self.relative_tolerance.value(),
            "Degree": self.degree.value(),
            "FeatureAngle": self.angle.value(),
        }

    def accept(self):
        """Start converting; the panel closes itself when the result is there."""
        if self.thread is not None:
            return False
        try:
            source = conversion.source_of((self.item, self.faces))
            options = self._options()
            options.validate()
        except Error as error:
            self._say(str(error))
            return False
        self.thread = ConversionThread(source, options)
        self.message.clear()
        self.bar.show()
        self.thread.start()
        self.timer.start(50)
        return False

    def reject(self):
        """Cancel the running conversion; close the panel where none runs."""
        if self.thread is not None:
            self.thread.progress.cancel()
            self._say("cancelling ...")
            return False
        self._close()
        return True

    def _options(self):
        p = self.properties()
        return dataclasses.replace(
            # What the panel does not show stays as it is.
            options_of(self.shell) if self.shell else Options(),
            edge_length=p["EdgeLength"] or None,
            quads=None if p["EdgeLength"] else p["Quads"],
            feature_angle=p["FeatureAngle"],
            tolerance=p["Tolerance"] or None,
            relative_tolerance=None if p["Tolerance"] else p["RelativeTolerance"],
            degree=p["Degree"],
        )

    def _poll(self):
        progress = self.thread.progress
        self.bar.setValue(int(100 * progress.fraction))
        if not progress.cancelled:
            self.message.setText(progress.description)
        if self.thread.is_alive():
            return
        self.timer.stop()
        self.bar.hide()
        thread, self.thread = self.thread, None
        if thread.error is not None:
            self._say(str(thread.error))
            return
        conversion.keep(thread.source, thread.options, thread.result)
        self._finish(thread.result)

    def _finish(self, result):
        """Make or change the document objects, as one step that can be undone."""
        if result.native_shape is None:
            self._say(str(result.failed[0].error))
            return
        document = self.item.Document
        document.openTransaction(TITLE)
        try:
            if self.shell is None:
                given = ", ".join(f"{name}={value!r}" for name, value in self.properties().items())
                FreeCADGui.addModule("trimquad.features")
                FreeCADGui.doCommand(
                    f"trimquad.features.make(FreeCAD.getDocument({document.Name!r}), "
                    f"FreeCAD.getDocument({document.Name!r}).getObject({self.item.Name!r}), {self.faces!r}, {given})"
                )
            else:
                for name, value in self.properties().items():
                    setattr(self.shell, name, value)
                document.recompute()
        except Exception as error:
            document.abortTransaction()
            self._say(" ".join(str(error).split()))
            return
        document.commitTransaction()
        for item in result.failed:
            FreeCAD.Console.PrintWarning(f"TrimQuad: {item.name}: {item.error}\n")
        self._close()

    def _say(self, text):
        self.message.setText(text)

    def _close(self):
        FreeCADGui.Control.closeDialog()
        FreeCADGui.ActiveDocument.resetEdit()


def _length_box(value):
    box = QtWidgets.QDoubleSpinBox()
    box.setDecimals(6)
    box.setRange(1e-6, 1e6)
    box.setValue(value)
    return box
