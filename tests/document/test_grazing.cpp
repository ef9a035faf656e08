#include <array>

#include "document/edit_fixture.h"

#include "normalshop/document/grazing.h"

namespace normalshop::test {
namespace {

/// A map of slopes along x.
template <class SlopeAt>
NormalMap slope_map(int size, const SlopeAt& slope_at) {
  RawImage codes(size, size, 3, CodeType::F32);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const Vec3f n = normal_from_slope({slope_at(x, y), 0.0F});
      std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return {std::move(codes), {.signed_float = true}};
}

float tilt(const NormalMap& map, int x, int y) {
  return degrees_between(map.normal(x, y), Vec3f::UnitZ());
}

TEST(Grazing, SlopesAreLimitedSmoothlyAndKeepTheirDirection) {
  SlopeImage slopes(5, 1);
  const std::array<float, 5> steepness{0.0F, 2.9F, 3.1F, 6.0F, 49.0F};
  const Vec2f direction(0.6F, -0.8F);
  for (int x = 0; x < 5; ++x) slopes(x, 0) = steepness[static_cast<std::size_t>(x)] * direction;
  const MaskImage grazing = limit_grazing(slopes);
  EXPECT_EQ(slopes(1, 0), Vec2f(2.9F * direction));
  EXPECT_NEAR(slopes(2, 0).norm(), 3.1F, 1e-3F);
  for (int x = 1; x < 5; ++x) {
    EXPECT_LE(slopes(x, 0).norm(), steepest_slope + 1e-4F);
    EXPECT_GT(slopes(x, 0).norm(), slopes(x - 1, 0).norm());
    EXPECT_LT((slopes(x, 0).normalized() - direction).norm(), 1e-6F);
  }
  EXPECT_EQ(grazing(1, 0), 0.0F);
  EXPECT_LT(grazing(2, 0), 0.01F);
  EXPECT_EQ(grazing(4, 0), 1.0F);
}

TEST(Grazing, ThereIsNoneWhereNothingIsSteep) {
  SlopeImage slopes(8, 8, Vec2f(2.0F, -2.0F));
  EXPECT_TRUE(limit_grazing(slopes).empty());
  SlopeImage none;
  EXPECT_TRUE(limit_grazing(none).empty());
}

TEST(Grazing, SmoothingLonelySteepTexelsTurnsNoneBesideThem) {
  // Walls of one texel, seen by pixels that lie across them.
  const auto spikes = [](int x, int y) { return x % 16 == 8 && y % 16 == 8 ? 40.0F : 0.0F; };
  Document d = document(plane_grid(2), slope_map(128, spikes));
  d.apply(edit(R"("operator": "smooth", "options": {"sigma": 0.03},
                  "view": {"direction": [0, 0, 1], "up": [0.6, 0.8, 0]})"));
  float most = 0.0F;
  for (int y = 16; y < 112; ++y) {
    for (int x = 16; x < 112; ++x) {
      if (spikes(x, y) == 0.0F) most = std::max(most, tilt(map_of(d), x, y));
    }
  }
  // The mean slope is 6 / 256; a change of 40 would tip over the texels beside a spike.
  EXPECT_LT(most, 25.0F);
  EXPECT_LT(tilt(map_of(d), 56, 56), 45.0F);
}

TEST(Grazing, EvenSlopesStayAsSteepAsTheyWere) {
  Document d = document(plane_grid(2), slope_map(64, [](int, int) { return 10.0F; }));
  const float before = tilt(map_of(d), 32, 32);
  d.apply(edit(R"("operator": "smooth", "options": {"sigma": 0.05}, "view": "front")"));
  EXPECT_NEAR(tilt(map_of(d), 32, 32), before, 0.05F);
}

}  // namespace
}  // namespace normalshop::test
