#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>
#include <string>

namespace trimquad {

/// The one exception of the library. `what()` is one line: message and place, for the user.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    Input,     ///< the input or an option is unusable (exit status 2)
    Stage,     ///< a stage failed on a usable input (exit status 3)
    Coarse,    ///< a stage failed because the quads are too large for the region (exit status 3)
    Cancelled  ///< the user asked to stop (exit status 130)
  };

  /// \param stage    name of the stage as in report.json ("tessellate", "field", ...)
  /// \param message  what is wrong and what the user can do
  /// \param where    the element it happened at ("line 12", "Face3", "triangle 17"); may be empty
  /// \param position a point in model units
  Error(Kind kind, std::string stage, std::string message, std::string where = {},
        std::optional<Eigen::Vector3d> position = {});

  Kind kind() const { return kind_; }
  const std::string& stage() const { return stage_; }
  const std::string& message() const { return message_; }
  const std::string& where() const { return where_; }
  const std::optional<Eigen::Vector3d>& position() const { return position_; }

 private:
  Kind kind_;
  std::string stage_, message_, where_;
  std::optional<Eigen::Vector3d> position_;
};

inline Error inputError(std::string stage, std::string message, std::string where = {},
                        std::optional<Eigen::Vector3d> position = {}) {
  return {Error::Kind::Input, std::move(stage), std::move(message), std::move(where), position};
}

inline Error stageError(std::string stage, std::string message, std::string where = {},
                        std::optional<Eigen::Vector3d> position = {}) {
  return {Error::Kind::Stage, std::move(stage), std::move(message), std::move(where), position};
}

inline Error coarseError(std::string stage, std::string message, std::string where = {},
                         std::optional<Eigen::Vector3d> position = {}) {
  return {Error::Kind::Coarse, std::move(stage), std::move(message), std::move(where), position};
}

/// An invariant that the mathematics promises, checked in release builds too. Never for input.
#define TRIMQUAD_ASSERT(condition) \
  ((condition) ? void(0) : ::trimquad::invariantBroken(#condition, __FILE__, __LINE__))

[[noreturn]] void invariantBroken(const char* condition, const char* file, int line);

}  // namespace trimquad
