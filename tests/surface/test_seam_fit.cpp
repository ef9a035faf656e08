#include <array>

#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/surface/seam_fit.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {
namespace {

constexpr int size = 128;

/// Gives the texels of the triangles from `first` to `last`, with the gutter beside them, the
/// object-space normal n.
void set_normals(const Mesh& mesh, const TexelMap& texels, std::uint32_t first, std::uint32_t last,
                 const Vec3f& n, NormalMap& map) {
  const auto set = [&](int x, int y, const SurfacePoint& p) {
    if (p.triangle < first || p.triangle >= last) return;
    map.set_normal(x, y, frame_at(mesh, p, NormalSpace::Tangent).map_normal(n));
  };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const std::uint32_t owner = texels.owner()(x, y);
      if (owner != no_triangle) set(x, y, texels.surface_point(owner, x, y));
    }
  }
  for (const GutterTexel& g : texels.gutter()) {
    const auto [x, y] = texel_place(g.texel, size);
    set(x, y, {g.owner, g.owner_b1, g.owner_b2});
  }
}

/// A flat plane in two charts whose sides an edit turned differently.
class TurnedApart {
 public:
  TurnedApart(const Vec3f& left, const Vec3f& right)
      : mesh_(test::plane_two_charts(4)),
        seams_(find_seams(mesh_)),
        map_(flat_normal_map(size, size, CodeType::U8)) {
    const TexelMap texels(mesh_, 0, size, size);
    const SeamFit fit(mesh_, seams_.edges, std::array<const NormalMap*, 1>{&map_});
    if (!left.isZero()) set_normals(mesh_, texels, 0, 32, left, map_);
    if (!right.isZero()) set_normals(mesh_, texels, 32, 64, right, map_);
    edited_ = map_;
    moved_ = fit.apply(std::array<NormalMap*, 1>{&map_});
  }
  double mismatch(const NormalMap& map) const {
    return measure_seams(mesh_, seams_.edges, std::array<const NormalMap*, 1>{&map}).max;
  }
  const NormalMap& edited() const { return edited_; }
  const NormalMap& fitted() const { return map_; }
  std::size_t moved() const { return moved_; }

 private:
  Mesh mesh_;
  Seams seams_;
  NormalMap map_;
  NormalMap edited_;
  std::size_t moved_ = 0;
};

const Vec3f tilted = Vec3f(0.3F, 0.1F, 1.0F).normalized();

TEST(SeamFit, BringsBothSidesTogether) {
  const TurnedApart scene(tilted, Vec3f(0.36F, 0.1F, 1.0F).normalized());
  EXPECT_GT(scene.mismatch(scene.edited()), 2.0);
  EXPECT_LT(scene.mismatch(scene.fitted()), 0.2);
  EXPECT_GT(scene.moved(), 100U);
  // By little, and only beside the seam.
  int far = 0;
  double most = 0.0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double turn = angle_degrees(scene.edited().normal(x, y), scene.fitted().normal(x, y));
      most = std::max(most, turn);
      // The seam is at x = 64 of the left chart and at y = 25.6 of the right one.
      if (std::abs(x - 63.5) > 2.0 && std::abs(y - 25.1) > 2.0 && turn > 0.0) ++far;
    }
  }
  EXPECT_EQ(far, 0);
  EXPECT_LT(most, 6.0);
}

TEST(SeamFit, LeavesAgreementAlone) {
  const TurnedApart scene(tilted, tilted);
  EXPECT_LT(scene.mismatch(scene.fitted()), 0.01);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      ASSERT_LT(angle_degrees(scene.edited().normal(x, y), scene.fitted().normal(x, y)), 1e-2);
    }
  }
}

TEST(SeamFit, MovesOnlyWhatTheEditChanged) {
  const TurnedApart nothing(Vec3f::Zero(), Vec3f::Zero());
  EXPECT_EQ(nothing.moved(), 0U);
  EXPECT_FALSE(nothing.fitted().has_edits());
  const TurnedApart left(Vec3f(0.05F, 0.0F, 1.0F).normalized(), Vec3f::Zero());
  EXPECT_GT(left.moved(), 0U);
  EXPECT_EQ(left.fitted().edited_count(), left.edited().edited_count());
  EXPECT_LT(left.mismatch(left.fitted()), 0.2);
}

/// What was apart before may stay so, or close as far as it is told.
TEST(SeamFit, KeepsOrClosesWhatWasApart) {
  const Mesh mesh = test::plane_two_charts(4);
  const Seams seams = find_seams(mesh);
  const TexelMap texels(mesh, 0, size, size);
  const Vec3f apart = Vec3f(0.36F, 0.1F, 1.0F).normalized();
  for (const float kept : {1.0F, 0.5F, 0.0F}) {
    NormalMap map = flat_normal_map(size, size, CodeType::F32);
    set_normals(mesh, texels, 0, 32, tilted, map);
    set_normals(mesh, texels, 32, 64, apart, map);
    const SeamFit fit(mesh, seams.edges, std::array<const NormalMap*, 1>{&map}, kept);
    set_normals(mesh, texels, 0, 32, Vec3f(-0.1F, 0.2F, 1.0F).normalized(), map);
    set_normals(mesh, texels, 32, 64, Vec3f(-0.04F, 0.2F, 1.0F).normalized(), map);
    fit.apply(std::array<NormalMap*, 1>{&map});
    const double after =
        measure_seams(mesh, seams.edges, std::array<const NormalMap*, 1>{&map}).mean;
    EXPECT_NEAR(after, static_cast<double>(kept) * angle_degrees(tilted, apart), 0.2) << kept;
  }
}

TEST(SeamFit, KeepsHardEdges) {
  const Mesh mesh = test::cube(2);
  const Seams seams = find_seams(mesh);
  const TexelMap texels(mesh, 0, size, size);
  NormalMap map = flat_normal_map(size, size, CodeType::U8);
  const SeamFit fit(mesh, seams.edges, std::array<const NormalMap*, 1>{&map});
  set_normals(mesh, texels, 0, 8, tilted, map);
  const NormalMap edited = map;
  EXPECT_EQ(fit.apply(std::array<NormalMap*, 1>{&map}), 0U);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) ASSERT_EQ(map.normal(x, y), edited.normal(x, y));
  }
}

TEST(SeamFit, DoesNotDependOnThreads) {
  const Vec3f other = Vec3f(0.36F, 0.1F, 1.0F).normalized();
  const TurnedApart many(tilted, other);
  const ThreadLimit limit(1);
  const TurnedApart one(tilted, other);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      ASSERT_EQ(many.fitted().normal(x, y), one.fitted().normal(x, y));
    }
  }
}

}  // namespace
}  // namespace normalshop
