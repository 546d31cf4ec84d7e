#include <pybind11/stl.h>

#include <algorithm>
#include <set>

#include "bindings.h"
#include "trimquad/spline/fit_surface.h"
#include "trimquad/spline/trim_model.h"

namespace py = pybind11;

namespace trimquad {
namespace {

double edgeTolerance(const SplineModel& model, const SplineFace& face) {
  double largest = 0;
  for (const auto& loop : face.loops)
    for (const SplineCoedge& coedge : loop)
      largest = std::max(largest, model.edges[coedge.edge.index].tolerance);
  return largest;
}

py::list foldedOf(const FittedSurface& fit) {
  py::list places;
  for (const auto& [p, chart] : fit.folded) places.append(py::make_tuple(p[0], p[1], p[2]));
  return places;
}

std::size_t controlPointsOf(const FittedSurface& fit) {
  std::size_t sum = fit.surface.poles.size();
  for (const SplineSurface& surface : fit.surfaces) sum += surface.poles.size();
  return sum;
}

std::vector<int> movedRegions(const SplineModel& model) {
  std::vector<int> regions;
  for (const auto& [region, deviation] : model.moved) regions.push_back(region);
  return regions;
}

std::set<int> foldedChartsOf(const FittedSurface& fit) {
  std::set<int> charts;
  for (const auto& fold : fit.folded) charts.insert(fold.chart);
  return charts;
}

py::list deviationsOf(const FittedSurface& fit) {
  py::list charts;
  for (const ChartDeviation& d : fit.deviations)
    charts.append(py::make_tuple(d.max, d.rms, py::make_tuple(d.where.x(), d.where.y(), d.where.z())));
  return charts;
}

}  // namespace

void bindSpline(py::module_& m) {
  py::class_<FittedSurface>(m, "FittedSurface")
      .def_readonly("max_deviation", &FittedSurface::maxDeviation)
      .def_readonly("rms_deviation", &FittedSurface::rmsDeviation)
      .def_property_readonly("deviations", &deviationsOf, "by chart: largest, rms, place of the largest")
      .def_property_readonly("folded", &foldedOf)
      .def_property_readonly("folded_charts", &foldedChartsOf)
      .def_readonly("samples", &FittedSurface::samples)
      .def_property_readonly("control_points", &controlPointsOf,
                             "of all its surfaces, before they are trimmed")
      .def_readonly("rounds", &FittedSurface::rounds)
      .def_property_readonly("several", [](const FittedSurface& fit) { return fit.layout.has_value(); });
  py::class_<FitOptions>(m, "FitOptions")
      .def(py::init([](double tolerance, double enough, bool smallestRectangle,
                       std::vector<std::vector<int>> bisections, int degree, bool slides, bool holdsCorners,
                       int threads, std::optional<int> maxPoles, std::optional<long> maxWork) {
             FitOptions options{tolerance, enough, smallestRectangle, std::move(bisections),
                                degree,    slides, holdsCorners,      threads};
             if (maxPoles) options.maxPoles = *maxPoles;
             if (maxWork) options.maxWork = *maxWork;
             return options;
           }),
           py::kw_only(), py::arg("tolerance"), py::arg("enough"), py::arg("smallest_rectangle"),
           py::arg("bisections"), py::arg("degree"), py::arg("slides"), py::arg("holds_corners"),
           py::arg("threads"), py::arg("max_poles"), py::arg("max_work"));
  m.def("fit_surface", &fitSurface, py::arg("region"), py::arg("grid"), py::arg("options"),
        py::arg("progress"), Released());
  m.def("closer_charts", &closerCharts, py::arg("fitted"), py::arg("charts"), py::arg("region"),
        py::arg("grid"), py::arg("options"), py::arg("progress"), Released());
  m.def("smoothed_charts", &smoothedCharts, py::arg("fitted"), py::arg("steps"), py::arg("region"),
        py::arg("grid"), py::arg("options"), py::arg("progress"), Released());

  py::class_<SplineModel>(m, "SplineModel")
      .def_readonly("loose_edges", &SplineModel::looseEdges)
      .def_readonly("loose_regions", &SplineModel::looseRegions, "regions with loose edges")
      .def_readonly("stray_regions", &SplineModel::strayRegions, "regions whose edges stray from the model's")
      .def_property_readonly("moved_regions", &movedRegions,
                             "regions whose surface was moved to agree with others that it touches")
      .def_property_readonly("faces", [](const SplineModel& model) {
        py::list faces;
        for (const SplineFace& face : model.faces) {
          py::dict entry;
          entry["region"] = face.region;
          entry["chart"] = face.chart;
          entry["control_points"] = face.surface.poles.size();
          entry["edge_tolerance"] = edgeTolerance(model, face);
          faces.append(entry);
        }
        return faces;
      });
  py::class_<TrimMemory>(
      m, "TrimMemory",
      "What the steps of trims gave, so that a trim repeats only what changed since the last.")
      .def(py::init<>());
  m.def(
      "trim_model",
      [](const Model& model, const std::vector<const GridMap*>& grids,
         const std::vector<const FittedSurface*>& fitted, double tolerance, double enough,
         const Progress& progress, int threads, TrimMemory* memory) {
        return trimModel(model, grids, fitted, {tolerance, enough, threads, memory}, progress);
      },
      py::arg("model"), py::arg("grids"), py::arg("fitted"), py::arg("tolerance"), py::arg("enough"),
      py::arg("progress"), py::arg("threads"), py::arg("memory") = nullptr, Released());
  m.def("fitted_as_moved", &fittedAsMoved, py::arg("fitted"), py::arg("model"), py::arg("region"),
        "the fit of one of the moved regions, with the surface and the deviations that it has in the model");
}

}  // namespace trimquad
