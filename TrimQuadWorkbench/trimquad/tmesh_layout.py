"""How pictures show a quantized T-mesh: its arcs in space, and its patches unfolded into the plane."""
import numpy

from .colours import point_colour
from .native import load

ARC_COLOUR, ZERO_COLOUR, FEATURE_COLOUR = "#1b2a41", "#d03020", "#209040"
ARC_WIDTH = 1.3


def arc_courses(item):
    """By arc, segments (n, 2, 3) on the surface; from node to node for a virtual arc, which has no course."""
    return [numpy.stack([c[:-1], c[1:]], axis=1) for c in load().arc_curves(item.tmesh, item.seamless)]


def arc_lines(item, segments):
    """(segments, width, colour, style) to draw: real arcs black, virtual ones dashed, those of no quads red."""
    styles = {}
    for arc, q, pieces in zip(item.tmesh.arcs, item.quantization.length, segments):
        styles.setdefault((arc[3], q == 0), []).append(pieces)
    return [
        (numpy.concatenate(p), ARC_WIDTH, ZERO_COLOUR if zero else ARC_COLOUR, "dashed" if virtual else "solid")
        for (virtual, zero), p in sorted(styles.items())
    ]


def critical_points(item, places):
    """(place, colour) of singularities and features at all their places."""
    valence = numpy.zeros(len(item.tmesh.nodes), int)
    for start, end, _, virtual, _, _ in item.tmesh.arcs:
        if not virtual:
            valence[start] += 1
            valence[end] += 1
    return [
        (place, point_colour(4 - arcs) if kind == "singular" else FEATURE_COLOUR)
        for (kind, critical, _, _), arcs, at in zip(item.tmesh.nodes, valence, places)
        if critical
        for place in at
    ]


def layout_of_patches(tmesh):
    """Every patch as its rectangle in the plane, laid beside one that it shares an arc with. Round a singularity
    rectangles overlap or gape. Returns, by arc, segments (n, 2, 2), and by node its places."""
    arcs, patches = tmesh.arcs, tmesh.patches
    place = {h: (p, s) for p, (_, sides) in enumerate(patches) for s, side in enumerate(sides) for h in side}
    turns = numpy.array([[1, 0], [0, 1], [-1, 0], [0, -1]], float)
    segments, nodes = [[] for _ in arcs], [[] for _ in tmesh.nodes]
    placed = [False] * len(patches)
    for first in range(len(patches)):
        # Patch, direction and start of the half-arc that it is laid at.
        waiting = [] if placed[first] else [(first, 0, patches[first][1][0][0], numpy.zeros(2))]
        placed[first] = True
        while waiting:
            p, turn, anchor, x = waiting.pop(0)
            loop = [(h, s) for s, side in enumerate(patches[p][1]) for h in side]
            begin = next(i for i, (h, _) in enumerate(loop) if h == anchor)
            turn -= loop[begin][1]
            for h, s in loop[begin:] + loop[:begin]:
                arc = arcs[abs(h) - 1]
                y = x + arc[2] * turns[(turn + s) % 4]
                segments[abs(h) - 1].append([x, y])
                nodes[arc[0] if h > 0 else arc[1]].append(x)
                beyond = place.get(-h)
                if beyond and not placed[beyond[0]]:
                    placed[beyond[0]] = True
                    waiting.append((beyond[0], (turn + s + 2) % 4, -h, y))
                x = y
    return [numpy.array(s).reshape(-1, 2, 2) for s in segments], nodes
