#include "document/operator_cases.h"
#include "document/picture_fixture.h"

/// A picture that is a tile has no side where it begins: turned round and then edited, or edited
/// and then turned round, it is the same.
namespace normalshop::test {
namespace {

constexpr int tile_width = 128;
constexpr int tile_height = 96;
constexpr int turn_x = 37;
constexpr int turn_y = 11;  // rows down

SlopeImage turned(SlopeView image) {
  SlopeImage out(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      out((x + turn_x) % image.width(), (y + turn_y) % image.height()) = image(x, y);
    }
  }
  return out;
}

/// Random slopes that tile, some of them on a scale of several pixels.
SlopeImage tile() {
  SlopeImage slopes =
      sum_of(waves(tile_width, tile_height, 2, 0.2F), waves(tile_width, tile_height, 7, 0.1F));
  for (int y = 0; y < tile_height; ++y) {
    for (int x = 0; x < tile_width; ++x) {
      const auto part = [&](std::uint32_t seed) {
        const std::uint32_t bits =
            hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), seed);
        return static_cast<float>(bits >> 16U) / 65535.0F - 0.5F;
      };
      slopes(x, y) += 0.2F * Vec2f(part(1), part(2));
    }
  }
  return slopes;
}

/// A view whose centre lies there, in pixels down and right of the tile's middle: strokes and
/// images count from it.
std::string view_at(int x, int y) {
  return R"({"facing": [)" + std::to_string(x) + ", " + std::to_string(-y) +
         R"(, 0], "width": 128, "height": 96})";
}

class Tileability : public testing::TestWithParam<OperatorCase> {};

INSTANTIATE_TEST_SUITE_P(Operators, Tileability, testing::ValuesIn(operator_cases(tile_width)),
                         [](const auto& tried) { return tried.param.name; });

TEST_P(Tileability, AnEditOfATileKnowsNoSides) {
  const bool everywhere = GetParam().strokes.empty();
  ImageDocument plain = picture(tile(), Border::Wrap);
  ImageDocument moved = picture(turned(tile()), Border::Wrap);
  plain.apply(edit_of(GetParam(), everywhere ? "\"front\"" : view_at(0, 0)));
  moved.apply(edit_of(GetParam(), everywhere ? "\"front\"" : view_at(turn_x, turn_y)));
  EXPECT_GT(plain.normals().edited_count(), 200U);
  // Points of strokes are as exact as single precision is at 100 pixels, 8e-6, and a few of them
  // make a distance; slopes change by up to 1 from pixel to pixel.
  EXPECT_LT(farthest(moved, turned(slopes_of(plain).slopes)), everywhere ? 1e-6F : 1e-4F);
}

/// Wide Gaussians see points at fixed places: what differs is their error, 1e-4 of a wave.
TEST(TileabilityOfWideFilters, HoldsAsFarAsAGaussianIsExact) {
  const std::vector<OperatorCase> cases{
      {"smooth", R"("sigma": 12)", ""},
      {"filter", R"("kind": "laplacian_of_gaussian", "sigma": 9)", ""},
      {"equalize", R"("sigma": 5, "gains": [1.2, 0.7, 1.5])", ""}};
  for (const OperatorCase& one : cases) {
    ImageDocument plain = picture(tile(), Border::Wrap);
    ImageDocument moved = picture(turned(tile()), Border::Wrap);
    plain.apply(edit_of(one));
    moved.apply(edit_of(one));
    EXPECT_GT(plain.normals().edited_count(), 10000U) << one.name;
    EXPECT_LT(farthest(moved, turned(slopes_of(plain).slopes)), 1e-4F) << one.name;
  }
}

/// Turned round, most of the strokes cross a side: at one that is none they would end.
TEST(TileabilityOfStrokes, SidesAreCrossed) {
  int crossed = 0;
  for (const OperatorCase& one : operator_cases(tile_width)) {
    if (one.strokes.empty()) continue;
    ImageDocument moved = picture(turned(tile()), Border::Wrap);
    moved.apply(edit_of(one, view_at(turn_x, turn_y)));
    bool right = false;
    bool left = false;
    for (int y = 0; y < tile_height; ++y) {
      right = right || moved.normals().edited(tile_width - 1, y);
      left = left || moved.normals().edited(0, y);
    }
    if (right && left) ++crossed;
  }
  EXPECT_GE(crossed, 8);
}

}  // namespace
}  // namespace normalshop::test
