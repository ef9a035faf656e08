#include "document/picture_fixture.h"

#include "normalshop/core/error.h"

/// `equalize`: against what Gaussians leave of a wave.
namespace normalshop::test {
namespace {

/// What a Gaussian leaves of a wave with so many periods along so many pixels.
float passed(float sigma, int periods, int pixels) {
  const float w = 6.2831853F * static_cast<float>(periods) / static_cast<float>(pixels);
  return std::exp(-0.5F * sigma * sigma * w * w);
}

TEST(EqualizeOperator, GivesEveryBandItsGain) {
  for (const int periods : {1, 3, 8, 16}) {
    ImageDocument document = picture(waves(64, 64, periods, 0.2F), Border::Wrap);
    document.apply(edit(R"("operator": "equalize", "view": "front",
        "options": {"sigma": 1.5, "gains": [0, 3, -0.5], "base_gain": 0.25})"));
    const float g1 = passed(1.5F, periods, 64);
    const float g2 = passed(3.0F, periods, 64);
    const float g3 = passed(6.0F, periods, 64);
    const float gain = 3.0F * (g1 - g2) - 0.5F * (g2 - g3) + 0.25F * g3;
    EXPECT_LT(farthest(document, waves(64, 64, periods, 0.2F * gain)), 2e-4F) << periods;
  }
}

TEST(EqualizeOperator, GainsOfOneLeaveEveryPixel) {
  ImageDocument document = picture(waves(48, 40, 5, 0.3F));
  document.apply(edit(R"("operator": "equalize", "view": "front",
      "options": {"sigma": 2, "gains": [1, 1, 1, 1]})"));
  EXPECT_EQ(document.normals().edited_count(), 0U);
}

TEST(EqualizeOperator, WorksInsideStrokesAndMasks) {
  const SlopeImage slopes = waves(64, 64, 16, 0.3F);
  MaskImage mask(64, 64, 1.0F);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) mask(x, y) = 0.0F;
  }
  ImageDocument document = picture(slopes, Border::Clamp, mask);
  document.apply(edit(R"("operator": "equalize", "view": "front",
      "options": {"sigma": 3, "gains": [0], "area": "inside", "feather": 2},
      "strokes": [[[-20, -20], [20, -20], [20, 20], [-20, 20]]])"));
  const PictureSlopes after = slopes_of(document);
  EXPECT_LT(after.slopes(32, 44).norm(), 5e-3F);
  for (int x = 0; x < 64; ++x) {
    EXPECT_FALSE(document.normals().edited(x, 20)) << x;  // masked
    EXPECT_FALSE(document.normals().edited(x, 60)) << x;  // outside
  }
}

/// On a mesh sigma is a length: without the finest band what is left is the smoothed surface.
TEST(EqualizeOperator, WithoutTheFinestBandSmoothsAMesh) {
  Document smoothed = document(plane_grid(2), noise_map(128, CodeType::U16));
  Document equalized = document(plane_grid(2), noise_map(128, CodeType::U16));
  smoothed.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.02})"));
  equalized.apply(
      edit(R"("operator": "equalize", "view": "front", "options": {"sigma": 0.02, "gains": [0]})"));
  EXPECT_GT(map_of(equalized).edited_count(), 10000U);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      ASSERT_LT(degrees_between(map_of(smoothed).normal(x, y), map_of(equalized).normal(x, y)),
                0.01F);
    }
  }
}

TEST(EqualizeOperator, OnePixelHasNoDetails) {
  ImageDocument document = picture(SlopeImage(1, 1, Vec2f(0.3F, -0.1F)));
  document.apply(edit(R"("operator": "equalize", "view": "front",
      "options": {"sigma": 5, "gains": [0, 7, 0, -3], "base_gain": 2})"));
  EXPECT_LT(farthest(document, SlopeImage(1, 1, Vec2f(0.6F, -0.2F))), 1e-6F);
}

}  // namespace
}  // namespace normalshop::test
