"""report.json: one object about a conversion, built from the values of the stages."""
import os

from .deviation import face_deviations, worst_place
from .histograms import histograms
from .native import load
from .tmesh import tmesh_counts

STAGES = ("tessellate", "field", "seamless", "partition", "quantize", "reembed", "optimize", "extract", "fit", "write")


def report(result):
    """The object that report.json holds. Keys of stages that this version does not have are null."""
    triangles = sum(r.region.triangles for r in result.regions) or 1
    fitted = sum(r.fitted is not None for r in result.regions) or 1
    regions, deviations = [], face_deviations(result)
    for index, item in enumerate(result.regions):
        seconds = dict.fromkeys(STAGES)
        seconds.update({stage: round(value, 6) for stage, value in item.seconds.items()})
        share = item.region.triangles / triangles
        seconds["tessellate"] = round(share * result.seconds.get("tessellate", 0.0), 6)
        if item.fitted is not None:
            seconds["fit"] = round(seconds["fit"] + result.seconds.get("trim", 0.0) / fitted, 6)
        if "write" in result.seconds:
            seconds["write"] = round(share * result.seconds["write"], 6)
        regions.append(_region_report(result, index, item, deviations[index], seconds))
    return {
        "input": {"path": result.source.path, "kind": result.source.kind, **result.shape_counts,
                  "repairs": result.repairs},
        "warnings": result.warnings,
        "options": {k: v for k, v in sorted(vars(result.options).items())},
        "regions": regions,
        "cuts": [_cut_report(cut) for cut in result.cuts],
        "curves": result.model.curves,
        "faults": result.faults,
        "loose_edges": result.spline and result.spline.loose_edges,
        "seconds_total": round(sum(sum(v or 0 for v in r["seconds"].values()) for r in regions)
                               + sum(cut.seconds for cut in result.cuts), 6),
        "peak_memory_mb": _peak_memory_mb(),
        "version": load().version,
        "opencascade": load().occ_version,
    }


def _region_report(result, index, item, deviations, seconds):
    error = item.error
    return {
        "name": item.name,
        "status": "ok" if error is None else "failed",
        "error": error and _error_report(error),
        "cut_from": item.cut_from,
        "mesh": {
            "triangles": item.region.triangles,
            "vertices": item.region.vertices,
            "boundary_loops": item.region.boundary_loops,
            "euler": item.region.euler,
        },
        "features": {**item.region.features, "followed_edges": item.field and item.field.aligned_edges,
                     "creases": item.has_creases},
        "holes": item.holes and {**item.holes, "singularities": item.bridged_singularities},
        "singularities": item.field and _singularities(item),
        "seamless": item.seamless and {"flipped": 0, "field_edits": item.field_edits, **item.seamless.counters},
        "tmesh": item.quantization and tmesh_counts(item.tmesh, item.quantization),
        "quantization": item.quantization and _quantization_report(item.quantization),
        "embedding": item.embedding,
        "gridmap": item.grid and {"flipped": 0, **item.grid.counters},
        "quads": item.quads and item.quads.statistics,
        "histograms": item.quads and histograms(item.quads, item.edge_length),
        "nurbs": item.fitted and result.spline and _nurbs_report(result, index, item, deviations),
        "seconds": seconds,
    }


def _error_report(error):
    return {"stage": error.stage, "message": error.message, "where": error.where, "position": error.position}


def _cut_report(cut):
    return {
        "region": cut.region,
        "error": _error_report(cut.error),
        "edges": cut.edges,
        "parts": cut.parts,
        "seconds": round(cut.seconds, 6),
    }


def _quantization_report(quantization):
    return {
        "method": quantization.method,
        "objective": quantization.objective,
        "lower_bound": quantization.lower_bound,
        "steps": quantization.steps,
        "widened": quantization.widened,
    }


def _singularities(item):
    indices = [s.index for s in item.singularities]
    return {
        "count": len(indices),
        "indices": {str(k): indices.count(k) for k in sorted(set(indices))},
        "loop_turns": item.field.loop_turns,
    }


def _nurbs_report(result, index, item, deviations):
    faces = [f for f in result.spline.faces if f["region"] == index]
    return {
        "faces": len(faces),
        "control_points": sum(f["control_points"] for f in faces),
        "degree": result.options.degree,
        "max_deviation": item.fitted.max_deviation,
        "rms_deviation": item.fitted.rms_deviation,
        "folds": len(item.fitted.folded),
        "bridged_holes": item.holes_bridged_to_fit,
        "without_singularities": item.fitted_without_singularities,
        "max_deviation_at": worst_place(item),
        "face_deviations": [
            {"face": f"Face{d.face}", "max": d.max, "rms": d.rms, "at": d.where} for d in deviations
        ],
        "max_gap": max((f["edge_tolerance"] for f in faces), default=0.0),
        "tolerance": result.options.tolerance,
    }


def _peak_memory_mb():
    try:
        import resource
    except ImportError:  # not a Unix
        return None
    unit = 1 if os.uname().sysname == "Darwin" else 1024
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e6, 1)
