#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/render.h"
#include "normalshop/core/error.h"

namespace normalshop {
namespace {

using namespace test;

/// The unit square, and 0.1 above its lower half another: a depth step along y = 0.5.
Mesh terrace() {
  MeshBuilder builder;
  const auto plate = [&](float top, float z, float u) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{{x, y, z}, {0, 0, 1}, {u + 0.45F * x, 0.95F - 0.9F * y}};
    };
    builder.quad(corner(0, 0), corner(1, 0), corner(1, top), corner(0, top));
  };
  plate(1.0F, 0.0F, 0.02F);
  plate(0.5F, 0.1F, 0.52F);
  return builder.finish();
}

/// How green the picture is on the rows around the step, which lies at the top of `step_row`.
std::vector<float> greens(const Mesh& mesh, const StorageAtlas& storage, int step_row) {
  constexpr int height = 300;
  constexpr float pixel = 0.001F;
  RenderOptions options;
  options.width = 40;
  options.height = height;
  options.style = RenderStyle::Weight;
  const float center = 0.5F + pixel * static_cast<float>(step_row - height / 2);
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, center, 0}, 0.04F, 0.3F);
  const ColorImage picture = render(mesh, storage, view, options);
  std::vector<float> out;
  for (int y = step_row - 12; y < step_row + 12; ++y) {
    out.push_back(picture(20, y).y() / picture(20, y).x());
  }
  return out;
}

/// The weight falls on both sides of a step, wherever the bands meet in which a picture is drawn.
TEST(Render, weights_do_not_depend_on_bands) {
  const Mesh mesh = terrace();
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  const std::vector<float> truth = greens(mesh, storage, 200);
  EXPECT_GT(truth.front(), 2.0F * truth[12]);
  EXPECT_GT(truth.back(), 2.0F * truth[12]);
  for (const int row : {121, 125, 127, 128, 129, 131, 136}) {
    const std::vector<float> found = greens(mesh, storage, row);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_NEAR(found[i], truth[i], 0.05F * truth[i]) << row << ": " << i;
    }
  }
}

/// The mean colour of a part of the terrace, seen from `direction`.
Vec3f mean_color(const Vec3f& direction, const Vec3f& center, const RenderOptions& options) {
  const Mesh mesh = terrace();
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(64, 64, CodeType::U8));
  const View view = make_view(direction, {0, 1, 0}, center, 0.004F, 0.004F);
  const ColorImage picture = render(mesh, storage, view, options);
  Vec3f sum = Vec3f::Zero();
  for (std::size_t i = 0; i < picture.size(); ++i) sum += picture.data()[i];
  return sum / static_cast<float>(picture.size());
}

TEST(Render, tints_what_an_edit_reaches_and_what_keeps_it_from_the_rest) {
  RenderOptions options;
  options.width = options.height = 8;
  options.style = RenderStyle::Effective;
  const Vec3f acts = mean_color({0, 0, 1}, {0.5F, 0.8F, 0.0F}, options);
  EXPECT_GT(acts.y(), 1.5F * std::max(acts.x(), acts.z()));
  const Vec3f step = mean_color({0, 0, 1}, {0.5F, 0.501F, 0.0F}, options);
  EXPECT_GT(step.z(), 1.5F * std::max(step.x(), step.y()));
  const Vec3f tilted(0.0F, std::sin(1.4F), std::cos(1.4F));  // 80 degrees
  const Vec3f averted = mean_color(tilted, {0.5F, 0.8F, 0.0F}, options);
  EXPECT_GT(averted.x(), 1.5F * std::max(averted.y(), averted.z()));
  options.full_angle = 85.0F;
  options.zero_angle = 90.0F;
  const Vec3f allowed = mean_color(tilted, {0.5F, 0.8F, 0.0F}, options);
  EXPECT_GT(allowed.y(), 1.5F * std::max(allowed.x(), allowed.z()));
}

TEST(Render, refuses_angles_that_are_no_range) {
  const Mesh mesh = terrace();
  const StorageAtlas storage = storage_of(mesh, flat_normal_map(8, 8, CodeType::U8));
  const View view = make_view({0, 0, 1}, {0, 1, 0}, {0.5F, 0.5F, 0}, 1.0F, 1.0F);
  for (const auto& [full, zero] : {std::pair{70.0F, 70.0F}, {-1.0F, 20.0F}, {60.0F, 91.0F}}) {
    RenderOptions options;
    options.full_angle = full;
    options.zero_angle = zero;
    EXPECT_THROW(render(mesh, storage, view, options), InvalidInput) << full;
  }
}

}  // namespace
}  // namespace normalshop
