#pragma once

#include <vector>

#include "trimquad/seamless/map_energy.h"

namespace trimquad {

/// A part of a map that can be solved for by itself: unknowns that no triangle but these depends on, and the
/// triangles that depend on them. Both ascending.
struct Neighbourhood {
  std::vector<int> faces, unknowns;
};

/// Finds neighbourhoods in a map. They cross seams: what is near is decided by the unknowns that triangles
/// share. Unknowns that many triangles share (translations of seams, coordinates of aligned lines) belong to
/// none.
class Neighbourhoods {
 public:
  explicit Neighbourhoods(const MapEnergy& energy);

  /// The connected neighbourhoods of all that is within so many rings of triangles around these faces. No two
  /// of them share a face.
  std::vector<Neighbourhood> around(const std::vector<FaceHandle>& faces, int rings) const;

 private:
  /// Lists one after another: the i-th is from start[i] to start[i + 1].
  struct Lists {
    std::vector<int> start{0}, element;
    struct Range {
      const int *first, *last;
      const int* begin() const { return first; }
      const int* end() const { return last; }
      int size() const { return int(last - first); }
    };
    Range operator[](int i) const { return {element.data() + start[i], element.data() + start[i + 1]}; }
  };
  Lists unknownsOf_;  // by face: those that few faces depend on
  Lists facesOf_;     // by unknown; none where many depend on it
};

}  // namespace trimquad
