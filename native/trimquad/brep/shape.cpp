#include "trimquad/brep/shape.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <BinTools_ShapeSet.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <set>
#include <sstream>

#include "trimquad/brep/occt_guard.h"
#include "trimquad/brep/occt_parts.h"

namespace trimquad {
Shape::Shape(const TopoDS_Shape& topology) : topology_(std::make_shared<TopoDS_Shape>(topology)) {
  if (topology.IsNull()) throw inputError("read", "the shape is empty");
  if (faceCount() == 0) throw inputError("read", "the shape has no faces; only faces can be converted");
  numbering_ = topology_;
}

Shape::Shape(std::shared_ptr<const TopoDS_Shape> topology, std::shared_ptr<const TopoDS_Shape> numbering)
    : topology_(std::move(topology)), numbering_(std::move(numbering)) {}

double Shape::area() const {
  return guarded(Error::Kind::Input, "read", "the area of the shape cannot be computed", [&] {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(*topology_, properties);
    return properties.Mass();
  });
}

double Shape::diagonal() const {
  return guarded(Error::Kind::Input, "read", "the bounding box of the shape cannot be computed", [&] {
    Bnd_Box box;
    BRepBndLib::AddOptimal(*topology_, box, false, false);
    if (box.IsVoid() || box.IsOpen())
      throw inputError("read", "the shape is not bounded; trim its faces first");
    return std::sqrt(box.SquareExtent());
  });
}

int Shape::faceCount() const {
  return elements(*topology_, TopAbs_FACE).Extent();
}
int Shape::edgeCount() const {
  return elements(*topology_, TopAbs_EDGE).Extent();
}
int Shape::solidCount() const {
  return elements(*topology_, TopAbs_SOLID).Extent();
}

Shape Shape::subShape(const std::vector<int>& faces) const {
  if (faces.empty()) throw inputError("read", "no face is selected");
  const auto all = elements(*numbering_, TopAbs_FACE);
  TopoDS_Compound selection;
  BRep_Builder builder;
  builder.MakeCompound(selection);
  for (const int face : std::set<int>(faces.begin(), faces.end())) {
    if (face < 1 || face > all.Extent())
      throw inputError("read", "there is no such face; the shape has " + std::to_string(all.Extent()),
                       "Face" + std::to_string(face));
    builder.Add(selection, all(face));
  }
  return Shape(std::make_shared<TopoDS_Shape>(selection), numbering_);
}

Shape shapeFromFreeCAD(const std::string& bytes) {
  const std::string complaint =
      "the bytes are not a FreeCAD binary shape; write them with Shape.exportBinary";
  return guarded(Error::Kind::Input, "read", complaint, [&] {
    // OpenCASCADE prints to the standard output when it meets anything else, so look first.
    if (bytes.substr(0, 64).find("Open CASCADE Topology V") == std::string::npos)
      throw inputError("read", complaint);
    std::istringstream stream(bytes, std::ios::binary);
    BinTools_ShapeSet set;
    set.Read(stream);
    int id = 0, location = 0, orientation = 0;
    if (stream.good()) {
      BinTools::GetInteger(stream, id);
      BinTools::GetInteger(stream, location);
      BinTools::GetInteger(stream, orientation);
    }
    if (!stream || id <= 0 || id > set.NbShapes() || location < 0 ||
        location > set.Locations().NbLocations() || orientation < TopAbs_FORWARD ||
        orientation > TopAbs_EXTERNAL)
      throw inputError("read", complaint);
    TopoDS_Shape shape = set.Shape(id);
    shape.Location(set.Locations().Location(location));
    shape.Orientation(TopAbs_Orientation(orientation));
    return Shape(shape);
  });
}

std::string shapeToFreeCAD(const Shape& shape) {
  return guarded(Error::Kind::Stage, "write", "the shape cannot be stored", [&] {
    std::ostringstream stream(std::ios::binary);
    BinTools_ShapeSet set;
    const int id = set.Add(shape.topology());
    const int location = set.Locations().Index(shape.topology().Location());
    set.Write(stream);
    BinTools::PutInteger(stream, id);
    BinTools::PutInteger(stream, location);
    BinTools::PutInteger(stream, int(shape.topology().Orientation()));
    return stream.str();
  });
}

}  // namespace trimquad
