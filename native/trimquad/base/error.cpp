#include "trimquad/base/error.h"

#include <cstdio>

namespace trimquad {
namespace {

std::string line(const std::string& message, const std::string& where,
                 const std::optional<Eigen::Vector3d>& position) {
  std::string text = message;
  if (!where.empty()) text += " (" + where + ")";
  if (position) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, " at (%.6g, %.6g, %.6g)", position->x(), position->y(),
                  position->z());
    text += buffer;
  }
  return text;
}

}  // namespace

Error::Error(Kind kind, std::string stage, std::string message, std::string where,
             std::optional<Eigen::Vector3d> position)
    : std::runtime_error(line(message, where, position)),
      kind_(kind),
      stage_(std::move(stage)),
      message_(std::move(message)),
      where_(std::move(where)),
      position_(position) {}

void invariantBroken(const char* condition, const char* file, int line) {
  std::string name(file);
  name = name.substr(name.rfind('/') + 1);
  throw stageError("internal",
                   std::string("broken invariant: ") + condition + "; please report this with the input",
                   name + ":" + std::to_string(line));
}

}  // namespace trimquad
