// The vertices of a trimmed model: ModelTrimmer's part that places them.

#include <algorithm>
#include <map>
#include <set>

#include "trimquad/base/error.h"
#include "trimquad/spline/model_trimmer.h"

namespace trimquad {

void ModelTrimmer::placeCorners() {
  const auto addUse = [&](const BoundaryRun& run, const RunEnd& end, std::size_t at) {
    uses_.push_back({cornerOf(end), sheetOf(run), end.vertex, end.point, run.points[at], run.uv[at], {}});
  };
  for (const auto& run : runs_) {
    addUse(run, run.start, 0);
    addUse(run, run.end, run.points.size() - 1);
  }
  std::sort(uses_.begin(), uses_.end(),
            [](const CornerUse& x, const CornerUse& y) { return key(x) < key(y); });
  uses_.erase(std::unique(uses_.begin(), uses_.end(),
                          [](const CornerUse& x, const CornerUse& y) { return key(x) == key(y); }),
              uses_.end());

  // What meets in one corner is one vertex where a shared curve or a shell holds it together.
  DisjointSets together(uses_.size());
  for (const auto& [id, curve] : curves_)
    if (curve.sides.size() == 2) {
      const auto &a = *curve.sides[0].run, &b = *curve.sides[1].run;
      together.unite(cornerUse(a, a.start), cornerUse(b, b.start));
      together.unite(cornerUse(a, a.end), cornerUse(b, b.end));
    }
  std::vector<int> shellOf(model_.regions.size(), -1);
  for (int s = 0; s < int(model_.shells.size()); ++s)
    for (const int r : model_.shells[s].regions) shellOf[r] = s;
  const auto shellOfUse = [&](std::size_t i) { return shellOf[sheetRegion_[uses_[i].sheet]]; };
  for (std::size_t i = 0; i < uses_.size(); ++i)
    for (std::size_t j = i + 1; j < uses_.size() && uses_[j].corner == uses_[i].corner; ++j)
      if (shellOfUse(i) == shellOfUse(j)) together.unite(int(i), int(j));

  std::map<int, std::vector<int>> groups;
  for (int i = 0; i < int(uses_.size()); ++i) groups[together.root(i)].push_back(i);
  for (const auto& [first, members] : groups) {
    vertices_.push_back(cornerOnBorders(members));
    for (std::size_t k = 0; k < members.size(); ++k) {
      auto& use = uses_[members[k]];
      use.group = int(vertices_.size()) - 1;
      use.at = vertices_.back().at[k];
      if (borders_[sheetRegion_[use.sheet]])
        if (const int point = layoutPoint(use); point >= 0)
          vertexOfPoint_[{sheetRegion_[use.sheet], point}] = use.group;
    }
  }
  for (auto& [id, curve] : curves_)
    for (auto& side : curve.sides) {
      const auto unwrapped = [&](const RunEnd& end, const Eigen::Vector2d& near) {
        Eigen::Vector2d x = uses_[cornerUse(*side.run, end)].at;
        if (const auto& period = side.sheet->period) x[0] += *period * std::round((near[0] - x[0]) / *period);
        return x;
      };
      side.start = unwrapped(side.run->start, side.run->uv.front());
      side.end = unwrapped(side.run->end, side.run->uv.back());
    }
  placeInnerPoints();
}

/// Whether the intersection of sheets that have been given a slight edge ends in a corner.
bool ModelTrimmer::endsFold(int corner) const {
  return std::any_of(curves_.begin(), curves_.end(), [&](const auto& item) {
    const CurveWithSides& curve = item.second;
    if (!curve.folded || !curve.intersection) return false;
    const BoundaryRun& run = *curve.sides[0].run;
    return cornerOf(run.start) == corner || cornerOf(run.end) == corner;
  });
}

/// The point of its region's layout that a corner is, or -1.
int ModelTrimmer::layoutPoint(const CornerUse& use) const {
  if (use.layoutPoint || use.vertex < 0) return use.layoutPoint.value_or(-1);
  const auto& points = fitted_[sheetRegion_[use.sheet]]->layout->points;
  for (int p = 0; p < int(points.size()); ++p)
    if (points[p].vertex.is_valid() && points[p].vertex.idx() == use.vertex) return p;
  return -1;
}

/// The vertex for uses of one corner. Where one border between charts ends in it, on the border's curve;
/// where several do, at their common end in the grid.
CornerPoint ModelTrimmer::cornerOnBorders(const std::vector<int>& members) {
  const Eigen::Vector3d p = uses_[members.front()].point;
  std::vector<const Sheet*> sheets;
  std::vector<Eigen::Vector2d> guess;
  std::set<std::pair<int, int>> points;  // region, point of its layout
  for (const int i : members) {
    sheets.push_back(&sheets_[uses_[i].sheet]);
    guess.push_back(uses_[i].guess);
    const int region = sheetRegion_[uses_[i].sheet];
    if (!borders_[region]) continue;
    if (const int point = layoutPoint(uses_[i]); point >= 0 && !borders_[region]->endsAt(point).empty())
      points.insert({region, point});
  }
  if (points.empty())
    return cornerPoint(
        p, sheets, guess, reach_,
        members.size() == 2 && endsFold(uses_[members.front()].corner) ? kSmallestFold : kSmallestCrossing);
  CornerPoint corner{Eigen::Vector3d::Zero(), guess};
  bool placed = false;
  for (const auto& [region, point] : points) {
    auto& lines = *borders_[region];
    const auto& ends = lines.endsAt(point);
    const SheetLine line = lines.line(ends[0].border, 0);
    if (ends.size() == 1) {
      // Sheets that were moved to meet in the border's end all pass through it.
      int other = -1;
      double steepest = -1;
      const auto along = line.sheet->jet(line.at(lines.endOf(ends[0])));
      const Eigen::Vector3d tangent = along.su * line.along[0] + along.sv * line.along[1];
      for (int k = 0; k < int(members.size()) && !placed; ++k) {
        if (sheetRegion_[uses_[members[k]].sheet] == region) continue;
        const double steep = std::abs(tangent.dot(normal(sheets[k]->jet(sheets[k]->footPoint(p, guess[k])))));
        if (steep > steepest) steepest = steep, other = k;
      }
      lines.setEnd(ends[0], placeOnLine(placed ? corner.point : p, line, lines.endOf(ends[0]),
                                        other < 0 ? nullptr : sheets[other],
                                        other < 0 ? Eigen::Vector2d(0, 0) : guess[other], reach_));
    }
    if (!placed) corner.point = line.sheet->jet(line.at(lines.endOf(ends[0]))).s;
    placed = true;
    if (ends.size() == 1)
      for (std::size_t k = 0; k < members.size(); ++k)
        for (const int side : {0, 1}) {
          const SheetLine own = lines.line(ends[0].border, side);
          if (sheets[k] == own.sheet) corner.at[k] = own.at(lines.endOf(ends[0]));
        }
  }
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto first = points.lower_bound({sheetRegion_[uses_[members[k]].sheet], 0});
    if (first == points.end() || first->first != sheetRegion_[uses_[members[k]].sheet])
      corner.at[k] = sheets[k]->footPoint(corner.point, corner.at[k]);
  }
  return corner;
}

/// Vertices inside regions, where borders meet, and the borders' edges.
void ModelTrimmer::placeInnerPoints() {
  borderEdges_.resize(model_.regions.size());
  RegionErrorList errors;
  for (int r = 0; r < int(model_.regions.size()); ++r) {
    if (!borders_[r]) continue;
    const auto& layout = *fitted_[r]->layout;
    for (int p = 0; p < int(layout.points.size()); ++p) {
      const auto& ends = borders_[r]->endsAt(p);
      if (ends.empty() || vertexOfPoint_.count({r, p})) continue;
      const SheetLine line = borders_[r]->line(ends[0].border, 0);
      vertexOfPoint_[{r, p}] = int(vertices_.size());
      vertices_.push_back({line.sheet->jet(line.at(borders_[r]->endOf(ends[0]))).s, {}});
    }
    for (int b = 0; b < int(layout.borders.size()); ++b) {
      if (!borders_[r]->staysOnSurfaces(b)) {
        const SheetLine line = borders_[r]->line(b, 0);
        errors.add(stageError("fit",
                              "a border between charts leaves the fitted surfaces; use a smaller tolerance",
                              model_.regions[r].name, line.sheet->jet(line.start).s));
        break;
      }
      auto edge = borders_[r]->edge(b);
      edge.edge.start = {vertexOfPoint_.at({r, layout.borders[b].startPoint})};
      edge.edge.end = {vertexOfPoint_.at({r, layout.borders[b].endPoint})};
      if (edge.reversed) std::swap(edge.edge.start, edge.edge.end);
      borderEdges_[r].push_back(std::move(edge));
    }
  }
  errors.raise();
}

}  // namespace trimquad
