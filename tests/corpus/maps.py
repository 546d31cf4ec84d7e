"""A shape through field and map, and what must hold of both."""
import numpy

import trimquad

QUADS = 150


def mapped(name, mesh, options, table):
    """Convert to quads; adds a row on the seamless map to the table. Returns the Result."""
    result = trimquad.convert(mesh, trimquad.Options(quads=QUADS, write=["seamless", "quads"], **options))
    for index, item in enumerate(result.regions):
        label = name if len(result.regions) == 1 else f"{name} {index}"
        table((label, item.region.triangles, len(item.singularities), len(item.region.aligned),
               item.seconds.get("field", 0), item.seconds.get("seamless", 0), how(item)))
    return result


def how(item):
    """The rungs of the ladder to the map: every counter that is not zero, but the distortions."""
    if item.seamless is None:
        return f"FAILED {item.error.stage}: {item.error}"
    counters = {k: v for k, v in item.seamless.counters.items() if not k.startswith("distortion")}
    return ", ".join(k if v is True else f"{k} {v}" for k, v in counters.items() if v) or "at once"


def expect_valid_map(item):
    """No triangle turned over, indices that the surface demands, aligned edges on grid lines."""
    assert item.seamless is not None, str(item.error)
    points, triangles, uv = item.seamless.arrays
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0).all()
    if item.region.boundary_loops == 0:
        assert sum(s.index for s in item.singularities) == 4 * item.region.euler
    aligned = {frozenset(edge) for edge in item.region.aligned.tolist()}
    for triangle, corners in zip(triangles.tolist(), uv):
        for k in range(3):
            if frozenset((triangle[k], triangle[(k + 1) % 3])) in aligned:
                step = numpy.abs(corners[(k + 1) % 3] - corners[k])
                assert step.min() == 0, "an aligned edge is off the grid lines"
