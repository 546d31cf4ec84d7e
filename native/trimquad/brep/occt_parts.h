#pragma once

#include <TopAbs_ShapeEnum.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Shape.hxx>
#include <gp_XYZ.hxx>

#include <Eigen/Core>

namespace trimquad {

inline Eigen::Vector3d vec(const gp_XYZ& x) {
  return {x.X(), x.Y(), x.Z()};
}

/// The faces, edges or others of a shape, each once, in the order in which OpenCASCADE and FreeCAD number them.
inline TopTools_IndexedMapOfShape elements(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape result;
  TopExp::MapShapes(shape, kind, result);
  return result;
}

}  // namespace trimquad
