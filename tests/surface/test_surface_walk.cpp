#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/surface/surface_walk.h"

namespace normalshop {
namespace {

/// A strip of quads of width 1 and height 2 along x, two triangles each.
Mesh strip(int count) {
  test::MeshBuilder builder;
  const auto corner = [&](int i, float y) {
    const auto x = static_cast<float>(i);
    return test::MeshBuilder::Corner{
        {x, y, 0.0F}, {0.0F, 0.0F, 1.0F}, {x / static_cast<float>(count), y / 4.0F}};
  };
  for (int i = 0; i < count; ++i) {
    builder.quad(corner(i, 0.0F), corner(i + 1, 0.0F), corner(i + 1, 2.0F), corner(i, 2.0F));
  }
  return builder.finish();
}

/// From the middle of the first quad's right side straight on.
Vec3f end_of_walk(const Mesh& mesh, double distance) {
  const Topology topology = make_topology(mesh);
  return position_at(mesh, walk(mesh, topology, {1, 0.5, {1.0, distance}}));
}

TEST(SurfaceWalk, GoesStraightOn) {
  const Mesh mesh = strip(40);
  for (const double distance : {0.25, 0.75, 5.3, 38.5}) {
    const Vec3f end = end_of_walk(mesh, distance);
    EXPECT_NEAR(end.x(), 1.0 + distance, 1e-4);
    EXPECT_NEAR(end.y(), 1.0, 1e-5);
  }
}

TEST(SurfaceWalk, StopsAtTheRim) {
  const Vec3f end = end_of_walk(strip(40), 200.0);
  EXPECT_NEAR(end.x(), 40.0, 1e-4);
  EXPECT_NEAR(end.y(), 1.0, 1e-4);
}

TEST(SurfaceWalk, StopsAfter256Triangles) {
  const Mesh mesh = strip(400);
  EXPECT_NEAR(end_of_walk(mesh, 100.5).x(), 101.5, 1e-3);
  const Vec3f end = end_of_walk(mesh, 300.0);
  EXPECT_NEAR(end.x(), 129.0, 1e-3) << "128 quads on";
  EXPECT_NEAR(end.y(), 1.0, 1e-3);
}

}  // namespace
}  // namespace normalshop
