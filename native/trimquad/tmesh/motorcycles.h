#pragma once

#include <optional>
#include <vector>

#include "trimquad/base/progress.h"
#include "trimquad/tmesh/seeds.h"

namespace trimquad {

struct TrailId {
  int index;
  friend auto operator<=>(TrailId, TrailId) = default;
};

/// What a motorcycle has driven, or an aligned curve from node to node.
struct Trail {
  /// Iso-lines are straight, so the distance travelled since the start is the coordinate along the line plus
  /// or minus a whole number of quanta, in every chart: at each point where two trails meet it is an exact
  /// number.
  struct Leg {
    IsolineLeg line;
    Quanta offset = 0;
    SurfacePoint from, to;

    Quanta distance(Quanta along) const { return (line.direction < 2 ? along : -along) + offset; }
  };
  /// A node on the trail.
  struct Stop {
    Quanta distance;  ///< since the start; rounded only at an end on a free boundary
    int leg;
    bool end;
    NodeId node;
  };
  enum class State {
    Growing,
    Ended,   ///< in the node of the stop that is the end
    HeadOn,  ///< at the tip of `partner`, which ended the same way: together they are one straight curve
    Dropped  ///< its line had been driven already; it has no legs
  };

  IsolineLeg first;
  State state = State::Growing;
  bool aligned = false;
  std::vector<Leg> legs;
  std::vector<Stop> stops;  ///< the start first, then in no order
  std::optional<Quanta> exactEnd;
  std::optional<TrailId> partner;
  Quanta wholeLength =
      0;  ///< with the partner: distances since its start are this minus those since the own start
};

/// Trails that meet in nodes only.
struct MotorcycleGraph {
  std::vector<Seeds::Node> nodes;
  std::vector<Trail> trails;
};

/// Drives all motorcycles until each has met a trail, a node or the boundary. They advance by the distance
/// they have travelled, leg by leg, so the result is a motorcycle graph up to the order within a triangle; it
/// is deterministic.
MotorcycleGraph driveMotorcycles(const Parametrization& map, const Seeds& seeds, const Progress& progress);

}  // namespace trimquad
