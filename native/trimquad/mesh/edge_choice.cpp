#include "trimquad/mesh/edge_choice.h"

#include <charconv>
#include <map>
#include <numbers>

#include "trimquad/base/error.h"
#include "trimquad/mesh/sharp_edges.h"

namespace trimquad {
namespace {

constexpr std::string_view kAngle = "angle:";

/// The degrees of "angle:A-B".
std::pair<double, double> angleRange(const std::string& name) {
  const std::string text = name.substr(kAngle.size());
  double from = 0, to = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, from);
  const bool dash = first.ec == std::errc{} && first.ptr != end && *first.ptr == '-';
  const auto last = dash ? std::from_chars(first.ptr + 1, end, to) : first;
  if (!dash || last.ec != std::errc{} || last.ptr != end || !(0 <= from && from < to && to <= 180))
    throw inputError(
        "options", "an angle between faces is written angle:A-B with 0 <= A < B <= 180 degrees, not " + name);
  return {from, to};
}

std::string known(const std::vector<std::string>& names) {
  constexpr std::size_t kListed = 12;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kListed); ++i) text += (i ? ", " : "") + names[i];
  if (names.size() > kListed) text += ", ... (" + std::to_string(names.size()) + " in all)";
  return text.empty() ? "it has none" : "it has " + text;
}

}  // namespace

std::vector<std::string> pieceNames(const std::vector<ModelCurve>& curves) {
  std::map<std::string, int> pieces, next;
  for (const auto& curve : curves) ++pieces[curve.name];
  std::vector<std::string> names;
  for (const auto& curve : curves)
    names.push_back(pieces[curve.name] == 1 ? curve.name
                                            : curve.name + "/" + std::to_string(next[curve.name]++));
  return names;
}

std::vector<bool> chosenEdges(const SurfaceMesh& mesh, const std::vector<ModelCurve>& curves,
                              const std::vector<std::optional<CurveId>>& curve,
                              const std::vector<std::string>& names) {
  std::vector<bool> chosen(mesh.n_edges(), false);
  const std::vector<std::string> pieces = pieceNames(curves);
  for (const std::string& name : names) {
    if (name.starts_with(kAngle)) {
      const auto [from, to] = angleRange(name);
      const double degree = std::numbers::pi / 180;
      const auto sharp = sharpEdges(mesh, {.angle = from * degree, .most = to * degree, .follow = false});
      for (const auto e : mesh.edges())
        if (sharp[e.idx()]) chosen[e.idx()] = true;
      continue;
    }
    bool found = false;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      if (curves[c].name != name && pieces[c] != name) continue;
      found = true;
      for (const auto e : mesh.edges())
        if (curve[e.idx()] == CurveId{int(c)}) chosen[e.idx()] = true;
    }
    if (!found)
      throw inputError("options", "the mesh has no boundary or border called " + name + "; " + known(pieces));
  }
  return chosen;
}

}  // namespace trimquad
