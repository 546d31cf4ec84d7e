#include "trimquad/quantize/quantize.h"

#include <pybind11/stl.h>

#include "bindings.h"
#include "trimquad/quantize/objective.h"

namespace py = pybind11;

namespace trimquad {
namespace {

std::vector<int> numbersOf(const std::vector<ArcId>& arcs) {
  std::vector<int> numbers;
  for (const ArcId a : arcs) numbers.push_back(a.index);
  return numbers;
}

}  // namespace

void bindQuantize(py::module_& m) {
  py::class_<Quantization>(m, "Quantization")
      .def_readonly("length", &Quantization::length, "whole quads, by arc")
      .def_readonly("method", &Quantization::method)
      .def_readonly("objective", &Quantization::objective)
      .def_readonly("lower_bound", &Quantization::lowerBound)
      .def_readonly("steps", &Quantization::steps)
      .def_readonly("widened", &Quantization::widened)
      .def_readonly("zero_arcs", &Quantization::zeroArcs)
      .def_readonly("zero_patches", &Quantization::zeroPatches);
  m.def(
      "collapses",
      [](const TMesh& tmesh, const ArcLengths& length) {
        const Dual dual(tmesh);
        py::list all;
        for (const Collapse& c : SeparationTest(dual, Separation::Free).faults(length))
          all.append(py::make_tuple(numbersOf(c.zeroArcs), numbersOf(c.mightVanish), numbersOf(c.others)));
        return all;
      },
      py::arg("tmesh"), py::arg("length"),
      "Why consistent lengths do not separate; empty where they do. (zero arcs, arcs that might vanish, "
      "others) each: it "
      "stays so while these keep their lengths, and the second do not become zero.");
  m.def(
      "arc_weights",
      [](const TMesh& tmesh) { return Objective(tmesh, QuantizationOptions{}.virtualWeight).weight; },
      py::arg("tmesh"), "Weights of the squared differences in the objective, by arc.");
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
