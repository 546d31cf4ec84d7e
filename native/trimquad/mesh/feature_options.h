#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace trimquad {

/// What sharp edges, boundaries and chosen elements of a model do to its regions.
struct FeatureOptions {
  enum class Sharp {
    Trim,   ///< they separate regions
    Align,  ///< they become aligned edges inside a region
    Ignore  ///< nothing
  } sharp = Sharp::Ignore;
  double angle = 30;           ///< degrees between two normals over which an edge is sharp
  bool alignBoundary = false;  ///< whether the boundaries of regions are aligned, unless chosen otherwise
  /// Chosen edges, aligned or free whatever the above says. CAD: "Edge3". Meshes: "loop:2", all pieces of a
  /// boundary loop, or "loop:2/1", the one from its corner 1 to corner 2; "feature:2" likewise for borders
  /// between regions; "angle:A-B", the edges where two triangles' normals turn by A to B degrees.
  std::vector<std::string> align = {}, free = {};
  std::vector<std::string> vertices = {};    ///< "Vertex5", of a CAD model: become feature points
  std::vector<Eigen::Vector3d> points = {};  ///< likewise, by position on the surface; model units
  double quadLength = 0;  ///< wanted edge length of the quads (model units), against which noise is measured
};

/// How far from the surface a point may be that is to become a feature point, in quad edges.
inline constexpr double kFeaturePointReach = 0.5;

}  // namespace trimquad
