#include "trimquad/tmesh/motorcycles.h"

#include <algorithm>
#include <map>
#include <queue>

#include "trimquad/base/error.h"

namespace trimquad {
namespace {

/// The part of a trail in one triangle, in its chart.
struct Track {
  TrailId trail;
  int leg;
  int direction;
  Quanta constant, offset;

  int constantAxis() const { return direction % 2 == 0 ? 1 : 0; }
  int sign() const { return direction < 2 ? 1 : -1; }
  Quanta distance(Quanta along) const { return sign() * along + offset; }
  Quanta along(Quanta distance) const { return sign() * (distance - offset); }
  FixedVector point(Quanta along) const {
    return constantAxis() == 0 ? FixedVector{constant, along} : FixedVector{along, constant};
  }
};

/// A trail that has passed through a vertex, or whose tip is there.
struct Passage {
  TrailId trail;
  Quanta distance;
  int leg;
};

struct Contact {
  Quanta distance;  ///< on the trail that grows
  FaceHandle face;
  FixedVector point;
  TrailId other;
  Quanta otherDistance;
  int otherLeg;
};

class Race {
 public:
  Race(const Parametrization& map, const Seeds& seeds)
      : map_(map), mesh_(map.mesh), tracks_(mesh_.n_faces()), passages_(mesh_.n_vertices()) {
    for (const auto& node : seeds.nodes) {
      nodeAt_[node.place] = NodeId{int(graph_.nodes.size())};
      graph_.nodes.push_back(node);
    }
  }

  MotorcycleGraph run(const Seeds& seeds, const Progress& progress) && {
    isAligned_ = &seeds.isAligned;
    std::vector<bool> driven(mesh_.n_edges(), false);
    for (const auto& start : seeds.alignedCurves)
      if (!driven[mesh_.edge_handle(start.leg.side).idx()]) driveAligned(start, driven);
    for (const auto& start : seeds.motorcycles) enqueue(addTrail(start));
    int steps = 0;
    while (!waiting_.empty()) {
      if (++steps % 4096 == 0) progress.check();
      const TrailId t = waiting_.top().second;
      waiting_.pop();
      if (trail(t).state == Trail::State::Growing) advance(t);
    }
    return std::move(graph_);
  }

 private:
  Trail& trail(TrailId t) { return graph_.trails[t.index]; }

  TrailId addTrail(const Seeds::Start& start) {
    Trail t;
    t.first = start.leg;
    t.stops.push_back({0, 0, false, start.node});
    graph_.trails.push_back(std::move(t));
    return {int(graph_.trails.size()) - 1};
  }

  void enqueue(TrailId t) { waiting_.push({tipDistance(trail(t)), t}); }

  /// Only an order in which to grow; any is valid.
  double tipDistance(const Trail& t) const {
    if (t.legs.empty()) return 0;
    const Trail::Leg& leg = t.legs.back();
    const FixedVector tip = positionInChart(map_, leg.line.side, leg.to);
    return double(leg.distance(tip[1 - leg.line.constantAxis()]));
  }

  Track trackOf(TrailId t, int leg) {
    const Trail::Leg& l = trail(t).legs[leg];
    return {t, leg, l.line.direction, l.line.constant, l.offset};
  }

  /// The same track in the chart beyond the edge of `h`.
  Track across(const Track& track, HalfedgeHandle h) const {
    const Transition t = map_.transition(h);
    const FixedVector origin = t(track.point(0));
    Track there = track;
    there.direction = (track.direction + t.rotation) & 3;
    there.constant = origin[there.constantAxis()];
    there.offset = track.offset - there.sign() * origin[1 - there.constantAxis()];
    return there;
  }

  /// The track in the triangles that the leg lies in: one, or those beside its edge.
  std::vector<std::pair<FaceHandle, Track>> tracksOf(const IsolineLeg& line, const Track& track) const {
    std::vector<std::pair<FaceHandle, Track>> all{{mesh_.face_handle(line.side), track}};
    const HalfedgeHandle other = mesh_.opposite_halfedge_handle(line.side);
    if (line.alongEdge && !mesh_.is_boundary(other))
      all.push_back({mesh_.face_handle(other), across(track, line.side)});
    return all;
  }

  void append(TrailId t, const Trail::Leg& leg) {
    trail(t).legs.push_back(leg);
    const int index = int(trail(t).legs.size()) - 1;
    for (const auto& [f, track] : tracksOf(leg.line, trackOf(t, index))) tracks_[f.idx()].push_back(track);
  }

  /// The leg's start and offset follow from the leg before it; where it ends is not known yet.
  Trail::Leg nextLeg(const Trail& t) const {
    Trail::Leg next;
    if (t.legs.empty()) {
      next.line = t.first;
      next.from = graph_.nodes[t.stops.front().node.index].place;
      const FixedVector x = positionInChart(map_, next.line.side, next.from);
      next.offset = -next.distance(x[1 - next.line.constantAxis()]);
      return next;
    }
    const Trail::Leg& last = t.legs.back();
    const auto line = continued(map_, last.line);
    TRIMQUAD_ASSERT(line);
    next.line = *line;
    next.from = last.to;
    follow(last, next);
    return next;
  }

  /// Sets the offset of `next` so that distances go on from those of `last`.
  void follow(const Trail::Leg& last, Trail::Leg& next) const {
    if (last.line.exit.is_valid()) {
      const Track track{{}, 0, last.line.direction, last.line.constant, last.offset};
      next.offset = across(track, last.line.exit).offset;
      return;
    }
    const SurfacePoint vertex = atVertex(last.line.toVertex);
    const Quanta before = positionInChart(map_, last.line.side, vertex)[1 - last.line.constantAxis()],
                 after = positionInChart(map_, next.line.side, vertex)[1 - next.line.constantAxis()];
    next.offset = last.distance(before) - next.distance(after);
  }

  void driveAligned(const Seeds::Start& start, std::vector<bool>& driven) {
    const TrailId t = addTrail(start);
    trail(t).aligned = true;
    Trail::Leg leg = nextLeg(trail(t));
    for (;;) {
      const VertexHandle v = leg.line.toVertex;
      leg.to = atVertex(v);
      driven[mesh_.edge_handle(leg.line.side).idx()] = true;
      append(t, leg);
      const Quanta distance =
          leg.distance(positionInChart(map_, leg.line.side, leg.to)[1 - leg.line.constantAxis()]);
      if (const auto node = nodeAt_.find(leg.to); node != nodeAt_.end())
        return end(t, distance, node->second);
      passages_[v.idx()] = Passage{t, distance, int(trail(t).legs.size()) - 1};
      Trail::Leg next;
      for (const auto& line : isolinesFromVertex(map_, v))
        if (line.alongEdge && (*isAligned_)[mesh_.edge_handle(line.side).idx()] &&
            mesh_.edge_handle(line.side) != mesh_.edge_handle(leg.line.side))
          next.line = line;
      next.from = leg.to;
      follow(leg, next);
      leg = next;
    }
  }

  void end(TrailId t, Quanta distance, NodeId node) {
    Trail& own = trail(t);
    own.state = Trail::State::Ended;
    own.exactEnd = distance;
    own.stops.push_back({distance, std::max(0, int(own.legs.size()) - 1), true, node});
  }

  NodeId nodeAt(const SurfacePoint& place, TMesh::NodeKind kind) {
    const auto [found, isNew] = nodeAt_.try_emplace(place, NodeId{int(graph_.nodes.size())});
    if (isNew) graph_.nodes.push_back({kind, place});
    return found->second;
  }

  /// One leg further.
  void advance(TrailId t) {
    Trail::Leg leg = nextLeg(trail(t));
    const Track own{t, int(trail(t).legs.size()), leg.line.direction, leg.line.constant, leg.offset};
    std::optional<Contact> first;
    for (const auto& [f, track] : tracksOf(leg.line, own))
      for (const Track& other : tracks_[f.idx()]) {
        const bool sameLine = track.constantAxis() == other.constantAxis();
        if (sameLine && track.constant != other.constant) continue;
        if (sameLine && meetsTip(t, leg.line, track, other))
          return joinHeadOn(t, other.trail, track.offset + other.offset);
        const auto contact =
            sameLine ? contactOnLine(f, leg, track, other) : contactAcross(f, leg, track, other);
        if (contact && (!first || contact->distance < first->distance)) first = contact;
      }
    if (first) return stopAt(t, leg, *first);
    if (leg.line.toVertex.is_valid()) {
      leg.to = atVertex(leg.line.toVertex);
      append(t, leg);
      return arriveAtVertex(t);
    }
    leg.to = crossingOfEdge(map_, leg.line.exit, leg.line.constantAxis(), leg.line.constant);
    append(t, leg);
    if (mesh_.is_boundary(mesh_.edge_handle(leg.line.exit))) return leaveSurface(t);
    enqueue(t);
  }

  /// Whether `other` comes the opposite way on the line of `own`, and its tip is where own's next leg starts.
  bool meetsTip(TrailId t, const IsolineLeg& line, const Track& own, const Track& other) {
    const Trail& o = trail(other.trail);
    return other.trail != t && line.entry.is_valid() && o.state == Trail::State::Growing &&
           other.leg == int(o.legs.size()) - 1 && other.direction == ((own.direction + 2) & 3);
  }

  void joinHeadOn(TrailId a, TrailId b, Quanta wholeLength) {
    for (const auto& [own, other] : {std::pair(a, b), std::pair(b, a)}) {
      trail(own).state = Trail::State::HeadOn;
      trail(own).partner = other;
      trail(own).wholeLength = wholeLength;
    }
  }

  /// Where the growing trail meets the end of a part of its own line that has been driven already.
  std::optional<Contact> contactOnLine(FaceHandle f, const Trail::Leg& leg, const Track& own,
                                       const Track& other) {
    const Trail& o = trail(other.trail);
    const bool same = own.direction == other.direction;
    if (!same && !o.exactEnd) return {};
    const Quanta at = same ? 0 : *o.exactEnd;
    const FixedVector x = other.point(other.along(at));
    if (!inside(f, x)) return {};
    const Quanta distance = own.distance(other.along(at));
    // The start of another trail of the same node is no contact.
    if (distance < 0 || (distance == 0 && same)) return {};
    // A trail that ends where this leg starts has driven the leg's line already; other meetings in vertices
    // are settled on arrival.
    if (isCorner(f, x) && pointInTriangle(map_, f, x) != leg.from) return {};
    return Contact{distance, f, x, other.trail, at, other.leg};
  }

  std::optional<Contact> contactAcross(FaceHandle f, const Trail::Leg& leg, const Track& own,
                                       const Track& other) {
    const FixedVector x = own.constantAxis() == 0 ? FixedVector{own.constant, other.constant}
                                                  : FixedVector{other.constant, own.constant};
    if (!inside(f, x) || isCorner(f, x)) return {};  // meetings in vertices are settled on arrival
    const Trail& o = trail(other.trail);
    const Quanta distance = own.distance(x[1 - own.constantAxis()]),
                 otherDistance = other.distance(x[1 - other.constantAxis()]);
    if (distance <= 0 || otherDistance < 0 || (o.exactEnd && otherDistance > *o.exactEnd)) return {};
    // Another trail may have stopped at this one's tip, on the edge that this leg comes through.
    if (leg.line.entry.is_valid() && onEntry(leg, own, x)) {
      const auto node = nodeAt_.find(pointInTriangle(map_, f, x));
      const auto& stops = trail(own.trail).stops;
      if (node != nodeAt_.end() && std::any_of(stops.begin(), stops.end(), [&](const Trail::Stop& s) {
            return s.node == node->second && s.distance == distance;
          }))
        return {};
    }
    return Contact{distance, f, x, other.trail, otherDistance, other.leg};
  }

  bool onEntry(const Trail::Leg& leg, const Track& own, FixedVector x) const {
    return own.direction == leg.line.direction && own.constant == leg.line.constant &&
           orientation(map_.from(leg.line.entry), map_.to(leg.line.entry), x) == 0;
  }

  bool inside(FaceHandle f, FixedVector x) const {
    for (const auto h : mesh_.fh_range(f))
      if (orientation(map_.from(h), map_.to(h), x) < 0) return false;
    return true;
  }

  bool isCorner(FaceHandle f, FixedVector x) const {
    for (const auto h : mesh_.fh_range(f))
      if (map_.from(h) == x) return true;
    return false;
  }

  void stopAt(TrailId t, Trail::Leg leg, const Contact& contact) {
    if (contact.distance == 0) {
      trail(t).state = Trail::State::Dropped;
      return;
    }
    const SurfacePoint place = pointInTriangle(map_, contact.face, contact.point);
    const auto* edge = std::get_if<EdgeHandle>(&place.element);
    const NodeId node = nodeAt(
        place, edge && mesh_.is_boundary(*edge) ? TMesh::NodeKind::Boundary : TMesh::NodeKind::TJunction);
    trail(contact.other).stops.push_back({contact.otherDistance, contact.otherLeg, false, node});
    if (place != leg.from) {
      leg.to = place;
      append(t, leg);
    }
    end(t, contact.distance, node);
  }

  void leaveSurface(TrailId t) {
    Trail& own = trail(t);
    const Trail::Leg& leg = own.legs.back();
    const Quanta along = positionInChart(map_, leg.line.side, leg.to)[1 - leg.line.constantAxis()];
    const NodeId node = nodeAt(leg.to, TMesh::NodeKind::Boundary);
    own.state = Trail::State::Ended;
    if (leg.to.exact == SurfacePoint::Exact::Both) own.exactEnd = leg.distance(along);
    own.stops.push_back({leg.distance(along), int(own.legs.size()) - 1, true, node});
  }

  void arriveAtVertex(TrailId t) {
    const int last = int(trail(t).legs.size()) - 1;
    const Trail::Leg& leg = trail(t).legs[last];
    const VertexHandle v = leg.line.toVertex;
    const Quanta distance =
        leg.distance(positionInChart(map_, leg.line.side, leg.to)[1 - leg.line.constantAxis()]);
    if (const auto node = nodeAt_.find(leg.to); node != nodeAt_.end()) return end(t, distance, node->second);
    auto& passage = passages_[v.idx()];
    if (passage) {
      const Trail& other = trail(passage->trail);
      const bool tip = other.state == Trail::State::Growing && passage->leg == int(other.legs.size()) - 1;
      if (tip && passage->trail != t && facing(leg.line, other.legs.back().line))
        return joinHeadOn(t, passage->trail, distance + passage->distance);
      const NodeId node =
          nodeAt(leg.to, mesh_.is_boundary(v) ? TMesh::NodeKind::Boundary : TMesh::NodeKind::TJunction);
      trail(passage->trail).stops.push_back({passage->distance, passage->leg, false, node});
      return end(t, distance, node);
    }
    if (mesh_.is_boundary(v)) return end(t, distance, nodeAt(leg.to, TMesh::NodeKind::Boundary));
    passage = Passage{t, distance, last};
    enqueue(t);
  }

  /// Whether two legs that end in one regular vertex come from opposite directions.
  bool facing(const IsolineLeg& a, const IsolineLeg& b) const {
    const auto onward = continued(map_, a);
    if (!onward || onward->alongEdge != b.alongEdge) return false;
    if (b.alongEdge) return mesh_.edge_handle(onward->side) == mesh_.edge_handle(b.side);
    return mesh_.face_handle(onward->side) == mesh_.face_handle(b.side) &&
           onward->direction == ((b.direction + 2) & 3);
  }

  using Waiting = std::pair<double, TrailId>;

  const Parametrization& map_;
  const SurfaceMesh& mesh_;
  const std::vector<bool>* isAligned_ = nullptr;
  MotorcycleGraph graph_;
  std::vector<std::vector<Track>> tracks_;        ///< by triangle
  std::vector<std::optional<Passage>> passages_;  ///< by vertex, until it becomes a node
  std::map<SurfacePoint, NodeId> nodeAt_;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;
};

}  // namespace

MotorcycleGraph driveMotorcycles(const Parametrization& map, const Seeds& seeds, const Progress& progress) {
  return Race(map, seeds).run(seeds, progress);
}

}  // namespace trimquad
