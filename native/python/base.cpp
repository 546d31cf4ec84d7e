#include <pybind11/stl.h>

#include <Standard_Version.hxx>

#include "bindings.h"
#include "trimquad/base/error.h"
#include "trimquad/base/kept_memory.h"
#include "trimquad/base/progress.h"
#include "trimquad/spline/region_errors.h"

namespace py = pybind11;

namespace trimquad {
namespace {

const char* kindName(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::Input:
      return "input";
    case Error::Kind::Stage:
    case Error::Kind::Coarse:
      return "stage";
    case Error::Kind::Cancelled:
      return "cancelled";
  }
  return "stage";
}

py::object position(const Error& error) {
  if (!error.position()) return py::none();
  return py::make_tuple(error.position()->x(), error.position()->y(), error.position()->z());
}

py::object toPython(const Error& error) {
  const py::object type = py::module_::import("trimquad.error").attr("Error");
  const py::object value =
      type(kindName(error.kind()), error.stage(), error.message(), error.where(), position(error));
  value.attr("coarse") = error.kind() == Error::Kind::Coarse;
  return value;
}

void raise(const Error& error) {
  const py::object value = toPython(error);
  if (const auto* several = dynamic_cast<const RegionErrors*>(&error)) {
    py::list others;
    for (const Error& other : several->others()) others.append(toPython(other));
    value.attr("others") = others;
  }
  PyErr_SetObject(py::type::of(value).ptr(), value.ptr());
}

}  // namespace

void bindBase(py::module_& m) {
  m.attr("version") = TRIMQUAD_VERSION;
  m.attr("occ_version") = OCC_VERSION_COMPLETE;
  m.attr("Error") = py::module_::import("trimquad.error").attr("Error");
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const Error& error) {
      raise(error);
    }
  });

  py::class_<KeptMemory>(m, "KeptMemory",
                         "While one lives, freed memory stays with the process for further use.")
      .def(py::init<>());

  py::class_<Progress>(m, "Progress", "Watched from one thread, worked under in another.")
      .def(py::init<>())
      .def("cancel", &Progress::cancel)
      .def_property_readonly("cancelled", &Progress::cancelled)
      .def_property_readonly("work", &Progress::work)
      .def_property_readonly("fraction", &Progress::fraction);
}

}  // namespace trimquad
