#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trimquad {

/// The bytes of a mesh file, and its name for messages.
struct MeshSource {
  std::string name;
  std::string bytes;

  /// Throws Error(Input) with the file's name and `place` ("line 12", "byte 84"; may be empty).
  [[noreturn]] void fail(const std::string& message, const std::string& place = {}) const;
};

/// Faces with any number of corners, as a file lists them.
struct PolygonFile {
  std::vector<Eigen::Vector3d> points;
  std::vector<long long>
      corners;  ///< of all faces, one after the other, counted from 0; not yet range-checked
  std::vector<std::size_t> faceStart;  ///< by face: where its corners begin
  std::vector<std::size_t> facePlace;  ///< by face: line, or byte in binary files, for messages
  bool binary = false;                 ///< whether facePlace counts bytes

  void beginFace(std::size_t place) {
    faceStart.push_back(corners.size());
    facePlace.push_back(place);
  }
  /// Appends a point. A coordinate must be finite and so small that squared areas do not overflow.
  void addPoint(const Eigen::Vector3d& point, const MeshSource& source, const std::string& place);
};

PolygonFile readObj(const MeshSource& source);
PolygonFile readOff(const MeshSource& source);
PolygonFile readPly(const MeshSource& source);
PolygonFile readStl(const MeshSource& source);

/// Walks a text file line by line and token by token, and knows where it is. Lines end in LF, CR LF or CR.
class LineScanner {
 public:
  explicit LineScanner(const MeshSource& source, std::size_t begin = 0, std::size_t firstLine = 1);

  /// Goes to the next line that holds more than blanks and a comment; false at the end of the file.
  bool nextLine();
  /// The next token of the line; empty at its end.
  std::string_view token();
  /// Everything that is left of the line, without blanks around it.
  std::string_view rest();
  /// Whether the line has another token.
  bool more();

  /// The next token as a number; may be infinite or nan where the text says so.
  double number(const char* what);
  long long integer(const char* what);
  double toNumber(std::string_view text, const char* what) const;
  long long toInteger(std::string_view text, const char* what) const;

  std::size_t line() const { return line_; }
  std::string place() const { return "line " + std::to_string(line_); }
  /// Offset of the first byte after the current line.
  std::size_t end() const { return next_; }
  [[noreturn]] void fail(const std::string& message) const { source_.fail(message, place()); }

 private:
  const MeshSource& source_;
  std::string_view text_;        ///< what is left of the current line
  std::size_t next_;             ///< where the next line begins
  std::size_t line_, nextLine_;  ///< number of the current and of the next line
};

/// A token in quotes for a message, shortened, with unprintable bytes as dots.
std::string inQuotes(std::string_view token);

}  // namespace trimquad
