#include "trimquad/quantize/quantize.h"

#include <pybind11/stl.h>

#include "bindings.h"

namespace py = pybind11;

namespace trimquad {

void bindQuantize(py::module_& m) {
  py::class_<Quantization>(m, "Quantization")
      .def_readonly("length", &Quantization::length, "whole quads, by arc")
      .def_readonly("method", &Quantization::method)
      .def_readonly("objective", &Quantization::objective)
      .def_readonly("lower_bound", &Quantization::lowerBound)
      .def_readonly("steps", &Quantization::steps)
      .def_readonly("zero_arcs", &Quantization::zeroArcs)
      .def_readonly("zero_patches", &Quantization::zeroPatches);
  m.def(
      "quantize",
      [](const TMesh& tmesh, bool optimal, const Progress& progress) {
        QuantizationOptions options;
        options.optimal = optimal;
        return quantize(tmesh, options, progress);
      },
      py::arg("tmesh"), py::arg("optimal"), py::arg("progress"), Released());
}

}  // namespace trimquad
