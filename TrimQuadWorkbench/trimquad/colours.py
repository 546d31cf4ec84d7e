"""Colours that pictures and the 3D view share."""

# The squares of the plane in turn.
CHECKS = ((0.93, 0.93, 0.90), (0.33, 0.52, 0.74))

# Singular vertices by their index in quarter turns; a darker red or blue beyond.
_POINTS = {1: (0.84, 0.15, 0.16), -1: (0.12, 0.31, 0.84), 2: (0.50, 0.06, 0.06), -2: (0.04, 0.12, 0.40)}


def point_colour(index):
    """Red, green, blue of a singular vertex of that index: reds where fewer than four quads meet, blues where more do."""
    return _POINTS.get(index, _POINTS[2 if index > 0 else -2])


def checker_pixels(size):
    """Bytes (red, green, blue, row by row) of a picture of two by two squares in the checker's two colours."""
    light, dark = (bytes(round(255 * c) for c in colour) for colour in CHECKS)
    half = size // 2
    even, odd = light * half + dark * (size - half), dark * half + light * (size - half)
    return even * half + odd * (size - half)


# Deviations as parts of the tolerance, from 0 to 1: dark blue, green, yellow. Beyond, where the tolerance is not kept, red.
_DEVIATIONS = ((0.16, 0.23, 0.55), (0.13, 0.47, 0.62), (0.21, 0.68, 0.51), (0.66, 0.84, 0.26), (0.99, 0.91, 0.15))
BEYOND_TOLERANCE = (0.84, 0.15, 0.16)


def deviation_colour(part):
    """Red, green, blue of a deviation of that part of the tolerance."""
    if not part <= 1:
        return BEYOND_TOLERANCE
    step = max(part, 0.0) * (len(_DEVIATIONS) - 1)
    first = min(int(step), len(_DEVIATIONS) - 2)
    share = step - first
    return tuple((1 - share) * a + share * b for a, b in zip(_DEVIATIONS[first], _DEVIATIONS[first + 1]))
