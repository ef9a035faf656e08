#include "document/picture_fixture.h"

#include "normalshop/core/error.h"

/// `equalize` and `transplant`: against what Gaussians leave of a wave.
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

/// "wave.png" laid on the middle of a picture as wide as itself, pixel on pixel.
SlopeImage laid_wave(int height, float factor) {
  SlopeImage slopes(64, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float phase = 6.2831853F * (static_cast<float>(x) - 31.5F) / 64.0F;
      slopes(x, y) = {0.5F * factor * std::cos(phase), 0.0F};
    }
  }
  return slopes;
}

TEST(TransplantOperator, KeepsTheShapeAndTakesTheDetailsOfTheImage) {
  const SlopeImage source = sum_of(waves(64, 64, 1, 0.2F), waves(64, 64, 9, 0.1F));
  ImageDocument document = picture(source, Border::Wrap);
  document.apply(edit(R"("operator": "transplant", "view": "front",
      "options": {"image": "wave.png", "repeat": true, "relief": 2, "sigma": 8})"));
  const SlopeImage shape = sum_of(waves(64, 64, 1, 0.2F * passed(8.0F, 1, 64)),
                                  waves(64, 64, 9, 0.1F * passed(8.0F, 9, 64)));
  const SlopeImage details = laid_wave(64, 2.0F * (1.0F - passed(8.0F, 1, 64)));
  EXPECT_LT(farthest(document, sum_of(shape, details)), 3e-4F);
}

TEST(TransplantOperator, ItsOwnDetailsChangeNothing) {
  const SlopeImage source = laid_wave(32, 1.0F);
  ImageDocument document = picture(source, Border::Wrap);
  document.apply(edit(R"("operator": "transplant", "view": "front",
      "options": {"image": "wave.png", "repeat": true, "sigma": 5})"));
  EXPECT_LT(farthest(document, source), 1e-6F);
}

TEST(TransplantOperator, NothingIsFinerThanASigmaOfNothing) {
  ImageDocument document = picture(waves(48, 40, 5, 0.3F));
  document.apply(edit(R"("operator": "transplant", "view": "front",
      "options": {"image": "wave.png", "repeat": true, "sigma": 0})"));
  EXPECT_EQ(document.normals().edited_count(), 0U);
}

/// The opacity of "cone.png" ends at 14 of its 32 pixels.
TEST(TransplantOperator, ArrivesAsFarAsTheImageIsOpaque) {
  ImageDocument document = picture(waves(64, 64, 16, 0.3F), Border::Wrap);
  document.apply(edit(R"("operator": "transplant", "view": "front",
      "options": {"image": "cone.png", "size": 32, "border": 0, "sigma": 1e6})"));
  const PictureSlopes after = slopes_of(document);
  int inside = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec2f p(static_cast<float>(x) - 31.5F, 31.5F - static_cast<float>(y));
      if (p.norm() > 14.5F) {
        ASSERT_FALSE(document.normals().edited(x, y)) << x << ", " << y;
      } else if (p.norm() < 11.0F) {
        // Neither the tile's waves nor the cone have a mean: the cone's details are all there is.
        ASSERT_LT((after.slopes(x, y) + 0.5F * p.normalized()).norm(), 2e-3F) << x << ", " << y;
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 300);
}

TEST(TransplantOperator, HalfTheStrengthGoesHalfTheWay) {
  const SlopeImage source = waves(64, 64, 9, 0.1F);
  ImageDocument whole = picture(source);
  ImageDocument half = picture(source);
  const std::string options =
      R"("operator": "transplant", "view": "front",
         "options": {"image": "wave.png", "repeat": true, "sigma": 3})";
  whole.apply(edit(options));
  half.apply(edit(options + R"(, "strength": 0.5)"));
  const PictureSlopes w = slopes_of(whole);
  SlopeImage middle(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) middle(x, y) = 0.5F * (w.slopes(x, y) + source(x, y));
  }
  EXPECT_LT(farthest(half, middle), 1e-6F);
}

/// The part of a picture that an edit looks at is as wide as it reads.
TEST(BandOperators, APartIsThatOfTheWhole) {
  const SlopeImage source = sum_of(waves(160, 160, 3, 0.2F), waves(160, 160, 33, 0.2F));
  const auto difference = [&](const std::string& one) {
    ImageDocument whole = picture(source);
    ImageDocument part = picture(source);
    whole.apply(edit(one + "}"));
    part.apply(edit(one + R"(, "area": "inside", "feather": 1},
        "strokes": [[[-8, -8], [8, -8], [8, 8], [-8, 8]]])"));
    EXPECT_FALSE(part.normals().edited(20, 20));
    float most = 0.0F;
    for (int y = 76; y < 84; ++y) {
      for (int x = 76; x < 84; ++x) {
        most = std::max(most, (part.normals().normal(x, y) - whole.normals().normal(x, y)).norm());
      }
    }
    return most;
  };
  const std::string equalize = R"("operator": "equalize", "view": "front", "options": {)";
  const std::string transplant = R"("operator": "transplant", "view": "front",
      "options": {"image": "wave.png", "repeat": true, "size": 32, )";
  EXPECT_EQ(difference(equalize + R"("sigma": 1.5, "gains": [0, 3])"), 0.0F);
  EXPECT_EQ(difference(transplant + R"("sigma": 3)"), 0.0F);
  // Wide Gaussians see points that are counted from the part's corner: their error is 1e-4 of a
  // wave.
  EXPECT_LT(difference(equalize + R"("sigma": 3, "gains": [0, 1, 2])"), 4e-5F);
  EXPECT_LT(difference(transplant + R"("sigma": 9)"), 4e-5F);
}

/// On a mesh sizes are lengths. Waves of 0.16 hardly pass a Gaussian of 0.1.
TEST(TransplantOperator, ReplacesTheDetailsOfAMesh) {
  for (const std::string details : {"keep", "ignore"}) {
    Document mesh = document(plane_grid(2), noise_map(256, CodeType::U16));
    mesh.apply(edit(R"("operator": "transplant", "view": "front", "details": ")" + details +
                    R"(", "options": {"image": "wave.png", "size": 0.16, "repeat": true,
                        "sigma": 0.1})"));
    // The noise is less than 0.01 after such a Gaussian, but for its mean.
    Vec2f mean(0.0F, 0.0F);
    const NormalMap before = noise_map(256, CodeType::U16);
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        if (details == "keep") mean += slope_from_normal(before.normal(x, y)) / 65536.0F;
      }
    }
    for (int y = 48; y < 208; ++y) {
      for (int x = 48; x < 208; ++x) {
        const float u = plane_point(map_of(mesh), x, y).x() / 0.16F;
        const Vec2f expected = mean + Vec2f(0.5F * std::cos(6.2831853F * u), 0.0F);
        ASSERT_LT((slope_from_normal(map_of(mesh).normal(x, y)) - expected).norm(), 0.02F)
            << details << " " << x << ", " << y;
      }
    }
  }
}

}  // namespace
}  // namespace normalshop::test
