#include "trimquad/mesh/write_obj.h"

#include <algorithm>
#include <charconv>

namespace trimquad {
namespace {

class ObjText {
 public:
  ObjText& operator<<(const char* word) {
    text_ += word;
    return *this;
  }
  ObjText& operator<<(double number) {
    char buffer[32];
    const auto end =
        std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::general, 17).ptr;
    text_.append(buffer, end);
    return *this;
  }
  ObjText& operator<<(int number) {
    text_ += std::to_string(number);
    return *this;
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// The distinct images of each vertex, numbered vertex by vertex.
class CornerImages {
 public:
  explicit CornerImages(const Parametrization& map) : number_(map.mesh.n_halfedges(), 0) {
    const auto& mesh = map.mesh;
    std::vector<std::pair<FixedVector, int>> here;
    for (const auto v : mesh.vertices()) {
      here.clear();
      for (const auto h : mesh.voh_range(v))
        if (!mesh.is_boundary(h)) here.emplace_back(map.from(h), h.idx());
      std::sort(here.begin(), here.end());
      for (std::size_t i = 0; i < here.size(); ++i) {
        if (i == 0 || here[i].first != here[i - 1].first) images_.push_back(here[i].first);
        number_[here[i].second] = int(images_.size());
      }
    }
  }
  const std::vector<FixedVector>& images() const { return images_; }
  /// Counted from 1, as OBJ does.
  int number(HalfedgeHandle h) const { return number_[h.idx()]; }

 private:
  std::vector<FixedVector> images_;
  std::vector<int> number_;
};

}  // namespace

std::string writeObj(const Parametrization& map) {
  const auto& mesh = map.mesh;
  ObjText text;
  for (const auto v : mesh.vertices()) {
    const Eigen::Vector3d& p = mesh.point(v);
    text << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
  }
  const CornerImages images(map);
  for (const FixedVector image : images.images()) {
    const Eigen::Vector2d x = map.scale.toQuads(image);
    text << "vt " << x.x() << " " << x.y() << "\n";
  }
  for (const auto f : mesh.faces()) {
    text << "f";
    for (const auto h : mesh.fh_range(f)) {
      text << " " << mesh.from_vertex_handle(h).idx() + 1 << "/" << images.number(h);
    }
    text << "\n";
  }
  if (!map.aligned.empty()) text << "g aligned\n";
  for (const EdgeHandle e : map.aligned) {
    const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    text << "l " << mesh.from_vertex_handle(h).idx() + 1 << " " << mesh.to_vertex_handle(h).idx() + 1 << "\n";
  }
  if (!map.featurePoints.empty()) text << "g feature\n";
  for (const VertexHandle v : map.featurePoints) text << "p " << v.idx() + 1 << "\n";
  return text.take();
}

}  // namespace trimquad
