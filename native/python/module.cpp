#include <pybind11/numpy.h>

#include "bindings.h"

PYBIND11_MODULE(_native, m) {
  // The first NumPy array loads NumPy behind a static guard; two worker threads doing that at once lock each
  // other out.
  pybind11::array_t<double> warmUp(0);

  m.doc() = "The compiled stages of TrimQuad. Values are opaque; every stage releases Python's lock.";
  trimquad::bindBase(m);
  trimquad::bindMesh(m);
  trimquad::bindBrep(m);
  trimquad::bindField(m);
  trimquad::bindSeamless(m);
  trimquad::bindTMesh(m);
  trimquad::bindQuantize(m);
  trimquad::bindGridMap(m);
  trimquad::bindQuads(m);
  trimquad::bindSpline(m);
}
