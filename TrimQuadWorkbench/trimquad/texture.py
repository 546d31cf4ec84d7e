"""A map as a textured model: OBJ files whose texture coordinates are the map's, their material and its picture."""
import numpy

from .error import input_error, system_error

MATERIAL = "texture.mtl"
IMAGE = "texture.png"
PIXELS = 256  # a side; the picture is one quad
LINE = 0.05  # half width of the grid lines, in quads
FACE, DIAMOND, LINES = (0.93, 0.93, 0.90), (0.33, 0.52, 0.74), (0.11, 0.16, 0.25)


def textured_obj(map_obj):
    """Text of an OBJ file: the triangles of a gridmap.obj, wrapped in the material. One unit of `vt` is one picture."""
    triangles = [line for line in map_obj.splitlines() if line.split(" ", 1)[0] in ("v", "vt", "f")]
    first = next((k for k, line in enumerate(triangles) if line.startswith("f ")), len(triangles))
    lines = [f"mtllib {MATERIAL}", *triangles[:first], "usemtl quad", *triangles[first:]]
    return "\n".join(lines) + "\n"


def material():
    """Text of the material file."""
    return f"newmtl quad\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {IMAGE}\n"


def quad_image():
    """Array (n, n, 3): grid lines round a diamond. Unchanged by quarter turns, as seams of a grid map turn it, and it
    continues itself over its sides."""
    centres = (numpy.arange(PIXELS) + 0.5) / PIXELS - 0.5
    x, y = numpy.abs(numpy.meshgrid(centres, centres))
    image = numpy.empty((PIXELS, PIXELS, 3))
    image[:] = FACE
    image[x + y < 0.25] = DIAMOND
    image[numpy.maximum(x, y) > 0.5 - LINE] = LINES
    return image


def pattern_image(path):
    """Array (n, m, 3), 0 to 1, of a picture file, what is transparent on white. Raises Error(input)."""
    read = _matplotlib_image().imread
    try:
        pixels = read(path)
    except FileNotFoundError as error:
        raise system_error("options", error, path) from None
    except (OSError, ValueError, SyntaxError) as error:
        raise input_error("options", f"--pattern {path} cannot be read as a picture ({error}); give a PNG file") from None
    if pixels.dtype != numpy.float32:
        pixels = pixels / numpy.iinfo(pixels.dtype).max
    if pixels.ndim == 2:
        pixels = pixels[:, :, None]
    opaque = pixels[:, :, -1:] if pixels.shape[2] in (2, 4) else 1.0
    colours = pixels[:, :, :3] if pixels.shape[2] >= 3 else numpy.repeat(pixels[:, :, :1], 3, axis=2)
    return colours * opaque + (1 - opaque)


def write_image(path, image):
    """Raises Error(input) where matplotlib is missing."""
    _matplotlib_image().imsave(path, image, format="png", metadata={"Software": None})


def _matplotlib_image():
    try:
        from matplotlib import image
    except ImportError as error:
        raise input_error("write", f"--write texture needs matplotlib ({error})") from None
    return image
