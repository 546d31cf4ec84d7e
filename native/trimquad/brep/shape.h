#pragma once

#include <memory>
#include <string>
#include <vector>

class TopoDS_Shape;

namespace trimquad {

/// A CAD shape with at least one face. Lengths in millimetres. Immutable; copies share the topology.
class Shape {
 public:
  /// Throws Error(Input, "read") for a null shape or one without faces.
  explicit Shape(const TopoDS_Shape& topology);

  const TopoDS_Shape& topology() const { return *topology_; }
  /// The shape in which names like "Edge3" are counted: the one that this shape was selected from, or itself.
  const TopoDS_Shape& numbering() const { return *numbering_; }

  double area() const;      ///< of all faces, model units squared
  double diagonal() const;  ///< of the bounding box, model units
  int faceCount() const;
  int edgeCount() const;
  int solidCount() const;

  /// The faces with these numbers, counted from 1 as FreeCAD does ("Face1"); they still share their edges.
  /// Throws Error(Input) for a number that there is not, or none at all.
  Shape subShape(const std::vector<int>& faces) const;

 private:
  Shape(std::shared_ptr<const TopoDS_Shape> topology, std::shared_ptr<const TopoDS_Shape> numbering);

  std::shared_ptr<const TopoDS_Shape> topology_, numbering_;
};

/// Reads .step, .stp, .iges, .igs, .brep or .brp (by extension, in any case of letters); files in other units
/// are converted to millimetres. Throws Error(Input, "read") where the file is missing, empty, truncated,
/// malformed or holds no face.
Shape readShape(const std::string& path);

/// The shape in the text of a STEP file. Throws Error(Input, "read") as readShape() does, with `name` as place.
Shape shapeFromStep(const std::string& text, const std::string& name);

/// The shape in the bytes that FreeCAD's `Part.Shape.exportBinary` writes; exact. Throws Error(Input,
/// "read").
Shape shapeFromFreeCAD(const std::string& bytes);

/// The bytes that FreeCAD's `Part.Shape.importBinary` reads; exact.
std::string shapeToFreeCAD(const Shape& shape);

}  // namespace trimquad
