#pragma once

#include <functional>
#include <optional>

#include "trimquad/quantize/dual.h"

namespace trimquad {

/// A change of lengths that keeps them consistent: an elementary circuit of the dual, closed or from border
/// to border.
struct Circuit {
  struct Step {
    ArcId arc;
    int change;
  };
  std::vector<Step> steps;  ///< each arc once, ascending
};

/// Cost of changing an arc by +1 or -1, when it has been changed by `already` on the way; at least 0;
/// infinite where it must not.
using ChangeCost = std::function<double(ArcId arc, int change, int already)>;

/// Shortest circuits by Dijkstra's search over the dual. Entering a patch through a side by +1, one leaves it
/// through an arc of the opposite side by +1, or through another arc of the same side by -1.
class CircuitSearch {
 public:
  explicit CircuitSearch(const Dual& dual);

  /// The cheapest circuit that changes `arc` by `change` (+1 or -1), or none. A circuit from border to border
  /// is found in two legs, the second one with what the first has changed.
  std::optional<Circuit> through(ArcId arc, int change, const ChangeCost& cost);

 private:
  struct Leg {
    std::vector<Circuit::Step> steps;
    bool closed;  ///< met the goal; otherwise it ended on the border
  };
  /// An equation that is out of balance by +1 or -1.
  struct Debt {
    EquationId equation;
    int sign;
    int index() const { return 2 * equation.index + (sign > 0); }
  };
  struct Arrival {
    double cost;
    Debt from;
    ArcId arc;
    int change;
    unsigned round = 0;
    bool settled = false;
  };

  std::optional<Leg> settle(Debt start, std::optional<Debt> goal, const ChangeCost& cost,
                            const std::vector<int>& already);

  const Dual& dual_;
  std::vector<Arrival> arrivals_;  ///< by debt
  std::vector<int> changed_;       ///< by arc
  unsigned round_ = 0;
};

}  // namespace trimquad
