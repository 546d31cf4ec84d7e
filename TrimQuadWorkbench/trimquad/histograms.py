"""How far angles are from 90 degrees and edges from the length asked for (Lyon et al. 2019, Fig. 11)."""
import numpy

ANGLE_WIDTH, ANGLE_BINS = 1.0, 45  # degrees
LENGTH_WIDTH, LENGTH_BINS = 0.05, 40  # of the edge length asked for


def histograms(quads, edge_length):
    """The object `histograms` of a region in report.json: counts in bins of `width` from 0 on; the last one is open.

    angle_deviation  of the corners of whole quads at inner vertices from 90, in degrees
    edge_length      of the edges of whole quads, each once, in parts of `edge_length`
    """
    angles, lengths = quads.measures
    return {
        "angle_deviation": _histogram(angles, ANGLE_WIDTH, ANGLE_BINS),
        "edge_length": _histogram(numpy.array(lengths) / edge_length, LENGTH_WIDTH, LENGTH_BINS),
    }


def _histogram(values, width, bins):
    index = numpy.minimum((numpy.asarray(values) / width).astype(int), bins)
    return {"width": width, "counts": numpy.bincount(index, minlength=bins + 1).tolist()}


def sum_of(many):
    """One object like those of `histograms` with the counts of all."""
    return {
        key: {"width": many[0][key]["width"], "counts": [sum(c) for c in zip(*(h[key]["counts"] for h in many))]}
        for key in many[0]
    }


def write_histograms(named, path):
    """A picture of one or several of the objects of `histograms` over each other: `named` is a list of (name, object)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(8, 3), dpi=100, layout="constrained")
    FigureCanvasAgg(drawing)
    labels = {"angle_deviation": "deviation from 90 degrees", "edge_length": "edge length, 1 as asked for"}
    for axes, (key, label) in zip(drawing.subplots(1, 2), labels.items()):
        for name, item in named:
            counts, width = numpy.array(item[key]["counts"], dtype=float), item[key]["width"]
            axes.stairs(counts / max(1.0, counts.sum()), numpy.arange(len(counts) + 1) * width, fill=True, alpha=0.5,
                        label=name)
        axes.set_xlabel(label)
        axes.set_yticks([])
        if len(named) > 1:
            axes.legend(frameon=False)
    drawing.savefig(path, format="png", metadata={"Software": None})
