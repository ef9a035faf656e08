#include "support/atlas_check.h"
#include "support/data.h"
#include <gtest/gtest.h>

#include "normalshop/io/model.h"
#include "normalshop/surface/unwrap.h"

/// Scans as they come: without UVs, with noise and holes.
namespace normalshop {
namespace {

using test::data_file;

struct Scan {
  const char* file;
  std::size_t triangles;
  std::size_t most_charts;
};

class UnwrappedScan : public ::testing::TestWithParam<Scan> {};

TEST_P(UnwrappedScan, KeepsToTheGoals) {
  const auto path = data_file(GetParam().file);
  if (!path) GTEST_SKIP() << "the real data is not on this machine";
  ModelReadOptions reading;
  reading.keep_without_uvs = true;
  Mesh mesh = read_model(*path, reading).mesh;
  ASSERT_EQ(mesh.triangle_count(), GetParam().triangles);
  const UnwrapReport report = unwrap(mesh);
  EXPECT_LE(report.charts, GetParam().most_charts);
  EXPECT_GE(report.coverage, 0.65);
  EXPECT_LE(report.mean_stretch, 1.2);
  EXPECT_EQ(report.overlaps, 0U);
  EXPECT_EQ(report.turned_over, 0U);

  EXPECT_NEAR(test::mean_area_stretch(mesh), report.mean_stretch, 1e-3);
  std::size_t turned = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (test::atlas_area(mesh, t) < 0.0) ++turned;
  }
  EXPECT_EQ(turned, 0U);
  const test::AtlasPicture picture = test::picture_of_atlas(mesh, 4096);
  EXPECT_EQ(picture.overlapping, 0U);
  EXPECT_NEAR(static_cast<double>(picture.covered) / (4096.0 * 4096.0), report.coverage, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Files, UnwrappedScan,
                         ::testing::Values(Scan{"scan_skull/skull.obj", 100002, 130},
                                           Scan{"scan_scorpion/scorpion.obj", 99990, 300},
                                           Scan{"scan_boot/boot.obj", 39906, 400},
                                           Scan{"scan_demosthenes/demosthenes-low-res.obj", 16719,
                                                70}));

}  // namespace
}  // namespace normalshop
