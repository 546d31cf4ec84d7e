#include "trimquad/spline/curve_pieces.h"

#include <algorithm>

#include "trimquad/mesh/polyline_curve.h"

namespace trimquad {
namespace {

class PartOfCurve : public TrueCurve {
 public:
  PartOfCurve(std::shared_ptr<const TrueCurve> whole, double first, double last)
      : whole_(std::move(whole)), first_(first), last_(last) {}
  double first() const override { return first_; }
  double last() const override { return last_; }
  Eigen::Vector3d point(double t) const override { return whole_->point(t); }
  Eigen::Vector3d tangent(double t) const override { return whole_->tangent(t); }
  double closest(const Eigen::Vector3d& p, double guess) const override {
    return std::clamp(whole_->closest(p, guess), first_, last_);
  }

 private:
  std::shared_ptr<const TrueCurve> whole_;
  double first_, last_;
};

}  // namespace

CurvePieces::CurvePieces(const Model& model, std::vector<CurveSplit> splits) {
  std::sort(splits.begin(), splits.end(), [](const CurveSplit& a, const CurveSplit& b) {
    return std::tuple(a.curve, a.t, a.corner) < std::tuple(b.curve, b.t, b.corner);
  });
  auto next = splits.begin();
  for (int c = 0; c < int(model.curves.size()); ++c) {
    first_.push_back(int(pieces_.size()));
    const ModelCurve& whole = model.curves[c];
    isPolyline_.push_back(dynamic_cast<const PolylineCurve*>(whole.curve.get()) != nullptr);
    double from = whole.curve->first();
    CornerId start = whole.start;
    const auto append = [&](double to, CornerId end) {
      pieces_.push_back({std::make_shared<PartOfCurve>(whole.curve, from, to), start, end, whole.name});
      modelCurve_.push_back(c);
      from = to;
      start = end;
    };
    if (next == splits.end() || next->curve.index != c) {
      pieces_.push_back(whole);
      modelCurve_.push_back(c);
      continue;
    }
    for (; next != splits.end() && next->curve.index == c; ++next) append(next->t, {next->corner});
    append(whole.curve->last(), whole.end);
  }
  first_.push_back(int(pieces_.size()));
}

int CurvePieces::pieceOf(const BoundaryRun& run) const {
  const int c = run.curve.index;
  const double middle = (run.t.front() + run.t.back()) / 2;
  int piece = first_[c];
  while (piece + 1 < first_[c + 1] && pieces_[piece].curve->last() < middle) ++piece;
  return piece;
}

}  // namespace trimquad
