#pragma once

#include <limits>
#include <vector>

#include "trimquad/mesh/surface_mesh.h"

namespace trimquad {

struct SharpEdgeOptions {
  /// The normals of the two triangles turn by more than this (radians) and at most `most`.
  double angle;
  double most = std::numeric_limits<double>::infinity();
  /// Whether a curve may go on where it gets blunter: over edges of more than half the angle.
  bool follow = true;
  /// Wanted edge length of the quads, model units; 0 where nothing is noise.
  double quadLength = 0;
  /// A curve whose bounding box has a shorter diagonal is noise, in quad edges.
  double shortest = 0;
};

/// Radians by which the normals of the two triangles of an inner edge turn: positive over a ridge, negative
/// over a valley, 0 on the boundary.
double foldAngle(const SurfaceMesh& mesh, EdgeHandle e);

/// By edge: whether it belongs to a sharp curve of the surface. Never a boundary edge.
///
/// Angles alone find thousands of scattered edges on a scan or a coarse organic mesh, so, against the size of
/// the quads:
/// - a curve starts at edges over `angle` that stand out: twice as sharp as four in five of the edges around;
///   between facets half as wide as a quad, also eight times as sharp as two in three; over 60 degrees, and
///   between facets twice as wide as a quad, always;
/// - it follows its direction over blunter edges that stand out, and a few that do not on the way to others
///   (hysteresis);
/// - edges are one curve where they meet and bend to the same side, ridge or valley, without a kink of more
///   than 60 degrees or where nothing else meets;
/// - a curve shorter than `shortest`, or twice that where it ends on the open surface, goes, unless all its
///   ends lie on longer ones.
/// Source: the hysteresis is J. Canny's, A Computational Approach to Edge Detection, 1986.
std::vector<bool> sharpEdges(const SurfaceMesh& mesh, const SharpEdgeOptions& options);

}  // namespace trimquad
