#include "document/picture_fixture.h"

#include "normalshop/rgbn/filter.h"

/// `stamp`'s high-pass: patches without their shape.
namespace normalshop::test {
namespace {

ImageDocument stamped(const std::string& patch, const std::string& high_pass) {
  ImageDocument document = picture(SlopeImage(64, 64, Vec2f(0.0F, 0.0F)));
  document.apply(edit(R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
      "options": {"size": 64, "border": 0, "patch": ")" +
                      patch + R"(", "high_pass": )" + high_pass + "}"));
  return document;
}

float radius(int x, int y) {
  return Vec2f(static_cast<float>(x) - 31.5F, static_cast<float>(y) - 31.5F).norm();
}

TEST(StampOperator, WithoutHighPassStampsAllOfThePatch) {
  const PictureSlopes all = slopes_of(stamped("slanted.png", "0"));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (radius(x, y) > 27.0F) continue;
      const Vec2f expected(x / 2 % 2 == 0 ? 0.9F : 0.7F, -0.3F);
      ASSERT_LT((all.slopes(x, y) - expected).norm(), 1e-5F) << x << ", " << y;
    }
  }
}

/// A tenth of the width is 6.4 pixels: the plane goes and the waves, 4 pixels long, stay; near the
/// patch's border only as far as a Gaussian of a part of them is their mean.
TEST(StampOperator, HighPassStampsTheDetailsAlone) {
  const PictureSlopes details = slopes_of(stamped("slanted.png", "0.1"));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec2f found = details.slopes(x, y);
      const Vec2f expected(x / 2 % 2 == 0 ? 0.1F : -0.1F, 0.0F);
      if (radius(x, y) > 29.0F) {
        ASSERT_EQ(found, Vec2f(0.0F, 0.0F)) << x << ", " << y;
      } else if (radius(x, y) < 27.0F) {
        ASSERT_NEAR(found.y(), 0.0F, 1e-5F) << x << ", " << y;
        ASSERT_NEAR(found.x(), expected.x(), radius(x, y) < 12.0F ? 1e-3F : 0.02F)
            << x << ", " << y;
      }
    }
  }
}

/// Slopes beside the opaque part are no part of the patch, however large.
TEST(StampOperator, HighPassReadsNothingThatIsNotOpaque) {
  Document mesh = flat_plane(256);
  mesh.apply(edit(R"("operator": "stamp", "view": "front", "strokes": [[[0, 0]]],
      "options": {"size": 0.8, "border": 0, "patch": "slanted.png", "high_pass": 0.1})"));
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const Vec2f slope = slope_from_normal(map_of(mesh).normal(x, y));
      ASSERT_LT(slope.norm(), 0.16F) << x << ", " << y;
    }
  }
}

TEST(StampOperator, HighPassOfAPatchWithoutOpacityIsTheFilter) {
  FakeAssets assets;
  const Patch wave = assets.patch("wave.png");
  SlopeImage expected(64, 32);
  FilterOptions options;
  options.kind = FilterKind::HighPass;
  options.sigma = 0.2F * 64.0F;
  filter(wave.slopes, {}, expected, expected.rect(), options);
  const PictureSlopes found = slopes_of(stamped("wave.png", "0.2"));
  for (int y = 1; y < 31; ++y) {
    for (int x = 1; x < 63; ++x) {
      ASSERT_LT((found.slopes(x, y + 16) - expected(x, y)).norm(), 1e-5F) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace normalshop::test
