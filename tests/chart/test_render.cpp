#include <cmath>

#include "chart_fixtures.h"
#include "support/meshes.h"
#include <gtest/gtest.h>

#include "normalshop/chart/render.h"

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

}  // namespace
}  // namespace normalshop
