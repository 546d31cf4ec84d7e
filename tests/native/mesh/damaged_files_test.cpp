#include <chrono>

#include "mesh_file_samples.h"
#include "support/error_of.h"
#include "support/mesh_samples.h"
#include "trimquad/mesh/check_mesh.h"

namespace trimquad {
namespace {

/// Reads and repairs; both end in a valid mesh or in one Error of the input.
void expectMeshOrError(const SampleFile& file) {
  try {
    TriangleSoup soup = readMesh(fileWith(file.name, file.bytes)).soup;
    ASSERT_FALSE(soup.triangles.empty());
    for (const auto& t : soup.triangles)
      for (const int v : t) ASSERT_TRUE(v >= 0 && v < int(soup.points.size()));
    for (const auto& p : soup.points) ASSERT_TRUE(p.allFinite());
    const RepairReport report = repair(soup);
    EXPECT_EQ(report.triangle.size(), soup.triangles.size());
    const SurfaceMesh mesh = buildSurfaceMesh(soup);
    EXPECT_EQ(mesh.n_faces(), soup.triangles.size());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Input) << error.what();
    EXPECT_FALSE(std::string(error.what()).empty());
  }
}

const TriangleSoup kSample = sphere(3, 1);

TEST(DamagedFiles, everyTruncationIsAMeshOrAnError) {
  for (const auto& file : sampleFiles(kSample))
    for (std::size_t size = 0; size < file.bytes.size(); size += 1 + file.bytes.size() / 60)
      expectMeshOrError({file.name, file.bytes.substr(0, size)});
}

TEST(DamagedFiles, binaryFormatsNoticeEveryTruncation) {
  for (const auto& file : sampleFiles(kSample)) {
    if (file.name != "little.ply" && file.name != "big.ply" && file.name != "binary.stl") continue;
    for (std::size_t size = 0; size < file.bytes.size(); size += 1 + file.bytes.size() / 60)
      EXPECT_TRUE(errorOf([&] { readText(file.name, file.bytes.substr(0, size)); }))
          << file.name << " " << size;
  }
}

TEST(DamagedFiles, everyCorruptionIsAMeshOrAnError) {
  const unsigned seed = unsigned(std::chrono::system_clock::now().time_since_epoch().count());
  std::mt19937 random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  RecordProperty("seed", std::to_string(seed));
  for (const auto& file : sampleFiles(kSample))
    for (int round = 0; round < 80; ++round) {
      SampleFile damaged = file;
      const int damages = 1 + int(random() % 4);
      for (int i = 0; i < damages; ++i) {
        const std::size_t at = random() % damaged.bytes.size();
        switch (random() % 4) {
          case 0:
            damaged.bytes[at] = char(random() % 256);
            break;
          case 1:
            damaged.bytes[at] = "0123456789-+.eE \n#/"[random() % 19];
            break;
          case 2:
            damaged.bytes.erase(at, 1 + random() % 8);
            break;
          default:
            damaged.bytes.insert(at,
                                 damaged.bytes.substr(random() % damaged.bytes.size(), 1 + random() % 40));
        }
        if (damaged.bytes.empty()) break;
      }
      expectMeshOrError(damaged);
    }
}

}  // namespace
}  // namespace trimquad
