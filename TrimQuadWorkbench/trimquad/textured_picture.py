"""A picture of surfaces with a pattern on every quad of their maps."""
import numpy

from .pictures import shade, view_axes
from .texture import write_image

WIDTH, HEIGHT, MARGIN = 900, 675, 15  # pixels
FINER = 2  # the picture is drawn so many times larger, and each pixel is the mean of what falls into it
SAMPLES_AT_ONCE = 4_000_000
STEP = 1.25  # triangles of nearly the same size are drawn together


def write_textured(surfaces, image, path):
    """Write a PNG of surfaces, given by the corners of their triangles, array (m, 3, 3), and these corners' places in the
    map, in quads, array (m, 3, 2).

    image: array (n, n, 3), put on each quad of the map with its first row along v = 1, as an OBJ's texture
    """
    corners, uv = (numpy.concatenate([s[k] for s in surfaces]) for k in (0, 1))
    view = view_axes()
    flat = _in_pixels(corners @ view[:, :2])
    depth, light = corners @ view[:, 2], shade(corners, view)
    height, width = HEIGHT * FINER, WIDTH * FINER
    picture, nearest = numpy.ones((height * width, 3), numpy.float32), numpy.full(height * width, -numpy.inf)
    for triangles, weights in _samples(flat):
        x, y = numpy.moveaxis(numpy.einsum("kw,mwx->mkx", weights, flat[triangles]).reshape(-1, 2).astype(int), 1, 0)
        pixel = y * width + x
        z = (depth[triangles] @ weights.T).ravel()
        order = numpy.argsort(z, kind="stable")  # of samples in one pixel the nearest is written last
        order = order[z[order] > nearest[pixel[order]]]
        colour = _looked_up(image, numpy.einsum("kw,mwx->mkx", weights, uv[triangles]).reshape(-1, 2)[order])
        nearest[pixel[order]] = z[order]
        picture[pixel[order]] = colour * numpy.repeat(light[triangles], len(weights))[order, None]
    parts = numpy.clip(picture, 0, 1).reshape(HEIGHT, FINER, WIDTH, FINER, 3)
    write_image(path, parts.mean(axis=(1, 3)))


def _in_pixels(flat):
    """Places in the view, (m, 3, 2), as columns and rows of the picture, in its middle."""
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    size = FINER * numpy.array([WIDTH, HEIGHT])
    scale = ((size - 2 * FINER * MARGIN) / numpy.maximum(high - low, 1e-300)).min()
    places = (flat - (low + high) / 2) * scale
    return places * (1, -1) + size / 2


def _samples(flat):
    """Batches (numbers of triangles, weights of their corners at samples), samples no further apart than pixels."""
    sides = numpy.linalg.norm(flat - numpy.roll(flat, -1, axis=1), axis=2).max(axis=1)
    steps = numpy.ceil(numpy.log(numpy.maximum(1.5 * sides, 1)) / numpy.log(STEP))
    divisions = numpy.ceil(STEP**steps).astype(int)
    for n in numpy.unique(divisions):
        i, j = numpy.meshgrid(numpy.arange(n + 1), numpy.arange(n + 1), indexing="ij")
        inside = i + j <= n
        weights = numpy.stack([n - i - j, i, j], axis=-1)[inside] / n
        members = numpy.flatnonzero(divisions == n)
        step = max(1, SAMPLES_AT_ONCE // len(weights))
        for first in range(0, len(members), step):
            yield members[first : first + step], weights


def _looked_up(image, uv):
    rows, columns = image.shape[:2]
    within = uv - numpy.floor(uv)
    column = numpy.minimum((within[:, 0] * columns).astype(int), columns - 1)
    row = numpy.minimum(((1 - within[:, 1]) * rows).astype(int), rows - 1)
    return image[row, column]
