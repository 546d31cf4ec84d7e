#include <BOPAlgo_ArgumentAnalyzer.hxx>
#include <BOPAlgo_CheckerSI.hxx>
#include <BOPDS_DS.hxx>
#include <BOPDS_MapOfPair.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListIteratorOfListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <optional>

#include "trimquad/brep/assemble.h"
#include "trimquad/brep/occt_guard.h"

namespace trimquad {
namespace {

const char* name(BRepCheck_Status status) {
  switch (status) {
    case BRepCheck_InvalidPointOnCurve:
      return "InvalidPointOnCurve";
    case BRepCheck_InvalidPointOnCurveOnSurface:
      return "InvalidPointOnCurveOnSurface";
    case BRepCheck_InvalidPointOnSurface:
      return "InvalidPointOnSurface";
    case BRepCheck_No3DCurve:
      return "No3DCurve";
    case BRepCheck_Multiple3DCurve:
      return "Multiple3DCurve";
    case BRepCheck_Invalid3DCurve:
      return "Invalid3DCurve";
    case BRepCheck_NoCurveOnSurface:
      return "NoCurveOnSurface";
    case BRepCheck_InvalidCurveOnSurface:
      return "InvalidCurveOnSurface";
    case BRepCheck_InvalidCurveOnClosedSurface:
      return "InvalidCurveOnClosedSurface";
    case BRepCheck_InvalidSameRangeFlag:
      return "InvalidSameRangeFlag";
    case BRepCheck_InvalidSameParameterFlag:
      return "InvalidSameParameterFlag";
    case BRepCheck_FreeEdge:
      return "FreeEdge";
    case BRepCheck_InvalidMultiConnexity:
      return "InvalidMultiConnexity";
    case BRepCheck_InvalidRange:
      return "InvalidRange";
    case BRepCheck_EmptyWire:
      return "EmptyWire";
    case BRepCheck_RedundantEdge:
      return "RedundantEdge";
    case BRepCheck_SelfIntersectingWire:
      return "SelfIntersectingWire";
    case BRepCheck_NoSurface:
      return "NoSurface";
    case BRepCheck_InvalidWire:
      return "InvalidWire";
    case BRepCheck_RedundantWire:
      return "RedundantWire";
    case BRepCheck_IntersectingWires:
      return "IntersectingWires";
    case BRepCheck_InvalidImbricationOfWires:
      return "InvalidImbricationOfWires";
    case BRepCheck_EmptyShell:
      return "EmptyShell";
    case BRepCheck_RedundantFace:
      return "RedundantFace";
    case BRepCheck_UnorientableShape:
      return "UnorientableShape";
    case BRepCheck_NotClosed:
      return "NotClosed";
    case BRepCheck_NotConnected:
      return "NotConnected";
    case BRepCheck_BadOrientation:
      return "BadOrientation";
    case BRepCheck_BadOrientationOfSubshape:
      return "BadOrientationOfSubshape";
    case BRepCheck_InvalidPolygonOnTriangulation:
      return "InvalidPolygonOnTriangulation";
    case BRepCheck_InvalidToleranceValue:
      return "InvalidToleranceValue";
    case BRepCheck_EnclosedRegion:
      return "EnclosedRegion";
    case BRepCheck_InvalidImbricationOfShells:
      return "InvalidImbricationOfShells";
    default:
      return "CheckFailed";
  }
}

const char* name(BOPAlgo_CheckStatus status) {
  switch (status) {
    case BOPAlgo_BadType:
      return "BadType";
    case BOPAlgo_SelfIntersect:
      return "SelfIntersect";
    case BOPAlgo_TooSmallEdge:
      return "TooSmallEdge";
    case BOPAlgo_NonRecoverableFace:
      return "NonRecoverableFace";
    case BOPAlgo_IncompatibilityOfVertex:
      return "IncompatibilityOfVertex";
    case BOPAlgo_IncompatibilityOfEdge:
      return "IncompatibilityOfEdge";
    case BOPAlgo_IncompatibilityOfFace:
      return "IncompatibilityOfFace";
    case BOPAlgo_GeomAbs_C0:
      return "GeomAbs_C0";
    case BOPAlgo_InvalidCurveOnSurface:
      return "InvalidCurveOnSurface";
    case BOPAlgo_NotValid:
      return "NotValid";
    default:
      return "CheckFailed";
  }
}

/// "Face3": numbered as FreeCAD does.
class Names {
 public:
  explicit Names(const TopoDS_Shape& shape) {
    for (int type = TopAbs_COMPOUND; type < TopAbs_SHAPE; ++type)
      TopExp::MapShapes(shape, TopAbs_ShapeEnum(type), maps_[type]);
  }
  std::string operator()(const TopoDS_Shape& part) const {
    static constexpr const char* types[] = {"Compound", "CompSolid", "Solid", "Shell",
                                            "Face",     "Wire",      "Edge",  "Vertex"};
    return types[part.ShapeType()] + std::to_string(maps_[part.ShapeType()].FindIndex(part));
  }
  const TopTools_IndexedMapOfShape& of(TopAbs_ShapeEnum type) const { return maps_[type]; }

 private:
  TopTools_IndexedMapOfShape maps_[TopAbs_SHAPE];
};

void appendStatus(const BRepCheck_ListOfStatus& statuses, const std::string& where,
                  std::vector<std::string>& found) {
  for (BRepCheck_ListIteratorOfListOfStatus it(statuses); it.More(); it.Next())
    if (it.Value() != BRepCheck_NoError) found.push_back(where + ": " + name(it.Value()));
}

/// Looks for crossings between elements as BOPAlgo_ArgumentAnalyzer does, but for those of a surface with
/// itself, which take most of the time.
class Crossings : public BOPAlgo_CheckerSI {
 public:
  explicit Crossings(const TopoDS_Shape& shape) { AddArgument(shape); }

  void Perform(const Message_ProgressRange& range = Message_ProgressRange()) override {
    BOPAlgo_PaveFiller::Perform(range);
    if (HasErrors()) return;
    // Candidates so far.
    const_cast<BOPDS_MapOfPair&>(myDS->Interferences()).Clear();
    PostTreat();
  }

  void appendFaults(const Names& names, std::vector<std::string>& found) const {
    if (HasErrors()) {
      found.push_back("CheckFailed");
      return;
    }
    for (BOPDS_MapOfPair::Iterator it(myDS->Interferences()); it.More(); it.Next()) {
      int a = 0, b = 0;
      it.Value().Indices(a, b);
      if (myDS->IsNewShape(a) || myDS->IsNewShape(b)) continue;
      found.push_back(names(myDS->Shape(a)) + ", " + names(myDS->Shape(b)) + ": " +
                      name(BOPAlgo_SelfIntersect));
    }
  }
};

}  // namespace

std::vector<std::string> faults(const Shape& shape, FaultKinds kinds) {
  return guarded(Error::Kind::Stage, "write", "the shape cannot be checked", [&] {
    std::vector<std::string> found;
    // The analysers may change tolerances of what they check.
    const TopoDS_Shape copy = BRepBuilderAPI_Copy(shape.topology()).Shape();
    const Names names(copy);
    std::optional<BRepCheck_Analyzer> check;
    if (kinds.elements) check.emplace(copy);
    if (check && !check->IsValid()) {
      for (int type = TopAbs_COMPOUND; type < TopAbs_SHAPE; ++type)
        for (int i = 1; i <= names.of(TopAbs_ShapeEnum(type)).Extent(); ++i) {
          const TopoDS_Shape& part = names.of(TopAbs_ShapeEnum(type))(i);
          const Handle(BRepCheck_Result) result = check->Result(part);
          if (result.IsNull()) continue;
          appendStatus(result->Status(), names(part), found);
          for (result->InitContextIterator(); result->MoreShapeInContext(); result->NextShapeInContext())
            appendStatus(result->StatusOnShape(), names(part) + " in " + names(result->ContextualShape()),
                         found);
        }
      if (found.empty()) found.push_back(names(copy) + ": CheckFailed");
    }
    if (found.empty() && kinds.crossings && !kinds.selfCrossings) {
      Crossings crossings(copy);
      crossings.Perform();
      crossings.appendFaults(names, found);
    }
    const bool analyzes = kinds.elements || (kinds.crossings && kinds.selfCrossings);
    // Crashes on edges without curves, which the first analyser names.
    if (found.empty() && analyzes) {
      BOPAlgo_ArgumentAnalyzer analyzer;
      analyzer.SetShape1(copy);
      analyzer.ArgumentTypeMode() = kinds.elements;
      analyzer.SelfInterMode() = kinds.crossings && kinds.selfCrossings;
      analyzer.SmallEdgeMode() = kinds.elements;
      analyzer.RebuildFaceMode() = kinds.elements;
      analyzer.ContinuityMode() = kinds.elements;
      analyzer.CurveOnSurfaceMode() = kinds.elements;
      analyzer.Perform();
      for (const auto& result : analyzer.GetCheckResult()) {
        std::string where;
        for (const auto& part : result.GetFaultyShapes1()) where += (where.empty() ? "" : ", ") + names(part);
        found.push_back(where + ": " + name(result.GetCheckStatus()));
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  });
}

}  // namespace trimquad
