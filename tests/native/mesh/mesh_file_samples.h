#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "trimquad/mesh/read_mesh.h"

namespace trimquad {

/// Writes `bytes` to a file of this name in a folder of the running test, and returns its path.
inline std::filesystem::path fileWith(const std::string& name, const std::string& bytes) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) /
                                       ("trimquad_" + std::string(test->test_suite_name()) + test->name());
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return folder / name;
}

inline MeshFile readText(const std::string& name, const std::string& bytes) {
  return readMesh(fileWith(name, bytes));
}

inline std::string objText(const TriangleSoup& soup) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& p : soup.points) text << "v " << p.x() << " " << p.y() << " " << p.z() << "\n";
  for (const auto& t : soup.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}

inline std::string offText(const TriangleSoup& soup) {
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << soup.points.size() << " " << soup.triangles.size() << " 0\n";
  for (const auto& p : soup.points) text << p.x() << " " << p.y() << " " << p.z() << "\n";
  for (const auto& t : soup.triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  return text.str();
}

inline std::string plyHeader(const TriangleSoup& soup, const std::string& encoding) {
  return "ply\nformat " + encoding + " 1.0\ncomment a sample\nelement vertex " +
         std::to_string(soup.points.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(soup.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string plyText(const TriangleSoup& soup) {
  std::ostringstream text;
  text.precision(17);
  text << plyHeader(soup, "ascii");
  for (const auto& p : soup.points) text << p.x() << " " << p.y() << " " << p.z() << "\n";
  for (const auto& t : soup.triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  return text.str();
}

/// The bytes of an unsigned number of the given size in the given order.
inline std::string bytesOf(std::uint64_t bits, int size, bool big) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += char(bits >> 8 * (big ? size - 1 - i : i) & 255);
  return bytes;
}

inline std::string plyBinary(const TriangleSoup& soup, bool big) {
  std::string bytes = plyHeader(soup, big ? "binary_big_endian" : "binary_little_endian");
  for (const auto& p : soup.points)
    for (const double x : p) bytes += bytesOf(std::bit_cast<std::uint64_t>(x), 8, big);
  for (const auto& t : soup.triangles) {
    bytes += char(3);
    for (const int v : t) bytes += bytesOf(std::uint32_t(v), 4, big);
  }
  return bytes;
}

inline std::string stlText(const TriangleSoup& soup) {
  std::ostringstream text;
  text.precision(17);
  text << "solid a sample\n";
  for (const auto& t : soup.triangles) {
    text << "facet normal 0 0 0\n outer loop\n";
    for (const int v : t)
      text << "  vertex " << soup.points[v].x() << " " << soup.points[v].y() << " " << soup.points[v].z()
           << "\n";
    text << " endloop\nendfacet\n";
  }
  text << "endsolid a sample\n";
  return text.str();
}

/// Begins with "solid", as many exporters do.
inline std::string stlBinary(const TriangleSoup& soup) {
  std::string bytes = "solid that is binary";
  bytes.resize(80, ' ');
  bytes += bytesOf(soup.triangles.size(), 4, false);
  for (const auto& t : soup.triangles) {
    bytes += std::string(12, '\0');
    for (const int v : t)
      for (const double x : soup.points[v])
        bytes += bytesOf(std::bit_cast<std::uint32_t>(float(x)), 4, false);
    bytes += std::string(2, '\0');
  }
  return bytes;
}

struct SampleFile {
  std::string name, bytes;
};

/// `soup` in every format and encoding.
inline std::vector<SampleFile> sampleFiles(const TriangleSoup& soup) {
  return {{"sample.obj", objText(soup)},      {"sample.off", offText(soup)},
          {"sample.ply", plyText(soup)},      {"little.ply", plyBinary(soup, false)},
          {"big.ply", plyBinary(soup, true)}, {"sample.stl", stlText(soup)},
          {"binary.stl", stlBinary(soup)}};
}

}  // namespace trimquad
