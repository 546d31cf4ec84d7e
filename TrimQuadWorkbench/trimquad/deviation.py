"""How far the B-spline faces of a Result lie from its input, and where.

Two measures, in opposite directions. The fit's own: dense samples of the input (vertices, points inside the triangles and
on the boundary, moved onto the CAD surface where there is one) and their feet on the untrimmed surfaces, which the
compiled fit finds; it costs nothing more and is what report.json and the colours of faces in FreeCAD have. The picture's:
points of the trimmed faces and the nearest of the input's that face the same way (`deviation_maps`).
"""
from typing import NamedTuple, Tuple

import numpy

from .native import load

# Sides of the triangles of a map, and their distance from the face, as parts of the model's diagonal.
MAP_SIZE, MAP_CHORD = 1 / 120, 1 / 1500


class FaceDeviation(NamedTuple):
    """Of the part of the input that a face stands for, samples of the fit."""

    face: int  # number among the faces of the result's shape, from 1: FreeCAD's Face1 and so on
    max: float  # largest distance from the face's surface, model units
    rms: float  # model units
    where: Tuple[float, float, float]  # the input's point that lies farthest away


class DeviationMap(NamedTuple):
    """A trimmed face in small triangles, and how far its points lie from the input."""

    points: numpy.ndarray  # (n, 3), on the face
    distances: numpy.ndarray  # (n,), model units
    triangles: numpy.ndarray  # point numbers, (m, 3), counter-clockwise seen from outside


def face_deviations(result):
    """By region, a list of FaceDeviation; empty where a region has no faces. Faces of one surface share its figures."""
    regions = [[] for _ in result.regions]
    if result.spline is None:
        return regions
    faces = result.spline.faces
    for number, index in enumerate(load().face_order(result.spline), 1):
        region, chart = faces[index]["region"], faces[index]["chart"]
        regions[region].append(FaceDeviation(number, *result.regions[region].fitted.deviations[chart]))
    return regions


def worst_place(item):
    """The point of a fitted region's input that lies farthest from its B-spline faces."""
    return max(item.fitted.deviations)[2]


def deviation_maps(result, native_progress):
    """A DeviationMap of each face, in the order of `result.spline.faces`."""
    diagonal = result.model.diagonal
    regions = [r.fitted_from.mapped_region if r.fitted is not None else None for r in result.regions]
    maps = load().deviation_maps(
        result.spline, regions, chord=MAP_CHORD * diagonal, size=MAP_SIZE * diagonal, threads=result.options.threads,
        progress=native_progress,
    )
    return [DeviationMap(*m) for m in maps]
