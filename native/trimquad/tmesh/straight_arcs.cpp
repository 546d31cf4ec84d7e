#include "trimquad/tmesh/straight_arcs.h"

#include <algorithm>
#include <tuple>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

TMesh::Leg reversed(TMesh::Leg leg) {
  leg.direction = (leg.direction + 2) & 3;
  std::swap(leg.from, leg.to);
  return leg;
}

/// A whole straight curve from node to node.
struct Curve {
  std::vector<TMesh::Leg> legs;
  std::vector<Trail::Stop> stops;  ///< in order
};

void appendLegs(Curve& curve, const Trail& trail) {
  for (const auto& leg : trail.legs)
    curve.legs.push_back(
        {leg.line.side, leg.line.alongEdge, leg.line.direction, leg.line.constant, leg.from, leg.to});
}

Curve curveOf(const MotorcycleGraph& graph, const Trail& trail) {
  Curve curve;
  appendLegs(curve, trail);
  curve.stops = trail.stops;
  if (trail.partner) {
    const Trail& partner = graph.trails[trail.partner->index];
    Curve back;
    appendLegs(back, partner);
    for (auto leg = back.legs.rbegin(); leg != back.legs.rend(); ++leg) curve.legs.push_back(reversed(*leg));
    for (std::size_t k = 0; k < partner.stops.size(); ++k) {
      Trail::Stop stop = partner.stops[k];
      stop.distance = trail.wholeLength - stop.distance;
      stop.leg = int(curve.legs.size()) - 1 - stop.leg;
      stop.end = k == 0;
      curve.stops.push_back(stop);
    }
  }
  const auto place = [](const Trail::Stop& s) { return std::tuple(s.distance, s.end, s.leg); };
  std::sort(curve.stops.begin(), curve.stops.end(),
            [&](const Trail::Stop& a, const Trail::Stop& b) { return place(a) < place(b); });
  const auto same = [](const Trail::Stop& a, const Trail::Stop& b) {
    return a.node == b.node && a.distance == b.distance;
  };
  curve.stops.erase(std::unique(curve.stops.begin(), curve.stops.end(), same), curve.stops.end());
  return curve;
}

TMesh::Arc arcBetween(const MotorcycleGraph& graph, const Curve& curve, const Trail::Stop& a,
                      const Trail::Stop& b) {
  TMesh::Arc arc{a.node, b.node, b.distance - a.distance, false, false, false, {}};
  for (int k = a.leg; k <= b.leg; ++k) {
    TMesh::Leg leg = curve.legs[k];
    if (k == a.leg) leg.from = graph.nodes[a.node.index].place;
    if (k == b.leg) leg.to = graph.nodes[b.node.index].place;
    // A node on an edge may be noted with the leg on either side of it.
    if (leg.from != leg.to) arc.legs.push_back(leg);
  }
  TRIMQUAD_ASSERT(!arc.legs.empty() && arc.length >= 0);
  return arc;
}

}  // namespace

std::vector<TMesh::Arc> straightArcs(const Parametrization& map, const MotorcycleGraph& graph) {
  std::vector<TMesh::Arc> arcs;
  for (std::size_t t = 0; t < graph.trails.size(); ++t) {
    const Trail& trail = graph.trails[t];
    if (trail.state == Trail::State::Dropped || (trail.partner && trail.partner->index < int(t))) continue;
    const Curve curve = curveOf(graph, trail);
    for (std::size_t k = 0; k + 1 < curve.stops.size(); ++k) {
      TMesh::Arc arc = arcBetween(graph, curve, curve.stops[k], curve.stops[k + 1]);
      arc.critical = trail.aligned;
      arc.border = trail.aligned && map.mesh.is_boundary(map.mesh.edge_handle(arc.legs.front().side));
      arcs.push_back(std::move(arc));
    }
  }
  return arcs;
}

TMesh::Leg firstLeg(const TMesh::Arc& arc, bool forward) {
  return forward ? arc.legs.front() : reversed(arc.legs.back());
}

bool triangleOnLeft(const Parametrization& map, const TMesh::Leg& leg) {
  return dot(map.to(leg.side) - map.from(leg.side), rotated({1, 0}, leg.direction)) > 0;
}

}  // namespace trimquad
