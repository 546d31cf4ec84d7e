#pragma once

#include <pybind11/pybind11.h>

namespace trimquad {

struct MapCounters;
struct Parametrization;

/// As report.json has them.
pybind11::dict countersOf(const MapCounters& counters);

/// Points (n, 3), triangles (m, 3) and the images of their corners in quads (m, 3, 2).
pybind11::tuple arraysOf(const Parametrization& map);

/// Runs a stage without Python's lock, so that regions are worked on at once.
using Released = pybind11::call_guard<pybind11::gil_scoped_release>;

void bindBase(pybind11::module_& m);
void bindMesh(pybind11::module_& m);
void bindBrep(pybind11::module_& m);
void bindField(pybind11::module_& m);
void bindSeamless(pybind11::module_& m);
void bindTMesh(pybind11::module_& m);
void bindQuantize(pybind11::module_& m);
void bindGridMap(pybind11::module_& m);
void bindQuads(pybind11::module_& m);
void bindSpline(pybind11::module_& m);

}  // namespace trimquad
