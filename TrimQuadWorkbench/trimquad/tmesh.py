"""The quantized T-mesh of a region: tmesh.json, and its counts for report.json."""
import json
from collections import Counter


def tmesh_json(tmesh, quantization):
    """Text of tmesh.json: nodes, arcs with target length and quads `q`, patches with their four sides."""
    nodes = [
        {"id": i, "kind": kind, "critical": critical, "border": border, "xyz": xyz}
        for i, (kind, critical, border, xyz) in enumerate(tmesh.nodes)
    ]
    arcs = [
        {"id": i, "from": start, "to": end, "length": length, "q": q, "virtual": virtual, "border": border,
         "critical": critical}
        for i, ((start, end, length, virtual, border, critical), q) in enumerate(zip(tmesh.arcs, quantization.length))
    ]
    patches = [{"id": i, "type": kind, "sides": sides} for i, (kind, sides) in enumerate(tmesh.patches)]
    # A line for each entry, so that files can be compared.
    blocks = [
        f'"{name}": [\n' + ",\n".join(json.dumps(entry) for entry in entries) + "\n]"
        for name, entries in (("nodes", nodes), ("arcs", arcs), ("patches", patches))
    ]
    return "{" + ",\n".join(blocks) + "}\n"


def tmesh_counts(tmesh, quantization):
    """The object `tmesh` of report.json."""
    arcs, patches = tmesh.arcs, tmesh.patches
    types = Counter(kind for kind, _ in patches)
    return {
        "nodes": len(tmesh.nodes),
        "arcs": len(arcs),
        "virtual_arcs": sum(virtual for _, _, _, virtual, _, _ in arcs),
        "patches": len(patches),
        "zero_arcs": quantization.zero_arcs,
        "zero_patches": quantization.zero_patches,
        "types": {str(kind): types[kind] for kind in sorted(types)},
    }
