#include "document/picture_fixture.h"
#include "support/relief.h"

#include "normalshop/core/error.h"
#include "normalshop/rgbn/curl.h"

/// Operators that rewrite slopes in an area, on pictures: there an edit is nothing but the
/// operator.
namespace normalshop::test {
namespace {

SlopeImage constant(const Vec2f& slope) { return {48, 40, slope}; }

/// Slopes of a dome and, on top, a rotation that no surface has.
SlopeImage swirl(float strength) {
  SlopeImage slopes(48, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) {
      const Vec2f p(0.02F * (static_cast<float>(x) - 23.5F),
                    0.02F * (19.5F - static_cast<float>(y)));
      slopes(x, y) = Vec2f(-p.x(), -0.5F * p.y()) + strength * Vec2f(-p.y(), p.x());
    }
  }
  return slopes;
}

TEST(AreaOperators, FlattenGivesThePlane) {
  ImageDocument document = picture(swirl(0.3F));
  document.apply(edit(R"("operator": "flatten", "view": "front",
                         "options": {"slope_x": 0.5, "slope_y": -0.25})"));
  const PictureSlopes after = slopes_of(document);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) {
      EXPECT_LT((after.slopes(x, y) - Vec2f(0.5F, -0.25F)).norm(), 1e-6F);
    }
  }
}

TEST(AreaOperators, FlattenInsideAStrokeLeavesTheRest) {
  const SlopeImage slopes = swirl(0.3F);
  ImageDocument document = picture(slopes);
  document.apply(edit(R"("operator": "flatten", "view": "front", "options": {"area": "inside"},
                         "strokes": [[[-10, -10], [10, -10], [10, 10], [-10, 10]]])"));
  const PictureSlopes after = slopes_of(document);
  EXPECT_LT(after.slopes(24, 20).norm(), 1e-6F);
  EXPECT_FALSE(document.normals().edited(2, 2));
  EXPECT_FALSE(document.normals().edited(45, 20));
}

TEST(AreaOperators, PaintTurnsNormalsToADirection) {
  ImageDocument document = picture(swirl(0.3F));
  document.apply(
      edit(R"("operator": "paint", "view": "front", "options": {"azimuth": 90, "tilt": 30})"));
  const Vec3f up(0.0F, 0.5F, std::sqrt(0.75F));
  for (int x = 0; x < 48; ++x) {
    EXPECT_LT(angle_degrees(document.normals().normal(x, 7), up), 1e-3);
  }
}

TEST(AreaOperators, HalfTheStrengthTurnsLess) {
  ImageDocument document = picture(constant({0.0F, 0.0F}));
  document.apply(edit(R"("operator": "paint", "view": "front", "strength": 0.5,
                         "options": {"azimuth": 0, "tilt": 45})"));
  // Strength scales the change of slopes: half of -1.
  EXPECT_NEAR(slopes_of(document).slopes(3, 3).x(), -0.5F, 1e-6F);
}

TEST(AreaOperators, RotateTurnsNormalsInThePicture) {
  ImageDocument document = picture(constant({0.3F, 0.0F}));
  document.apply(edit(R"("operator": "rotate", "view": "front", "options": {"angle": 90})"));
  EXPECT_LT((slopes_of(document).slopes(20, 20) - Vec2f(0.0F, 0.3F)).norm(), 1e-5F);
}

TEST(AreaOperators, BalanceTakesTheMeanAway) {
  SlopeImage slopes = swirl(0.0F);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) slopes(x, y) += Vec2f(0.4F, -0.2F);
  }
  ImageDocument document = picture(slopes);
  document.apply(edit(R"("operator": "balance", "view": "front")"));
  const PictureSlopes after = slopes_of(document);
  Vec2d sum(0.0, 0.0);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) sum += after.slopes(x, y).cast<double>();
  }
  EXPECT_LT(sum.norm() / (48 * 40), 1e-6);
  // Only the mean: differences stay.
  const Vec2f before = slopes(30, 9) - slopes(10, 30);
  EXPECT_LT((after.slopes(30, 9) - after.slopes(10, 30) - before).norm(), 1e-5F);
}

TEST(AreaOperators, ProjectTakesTheCurlAway) {
  for (const Border border : {Border::Clamp, Border::Wrap}) {
    ImageDocument document = picture(swirl(0.5F), border);
    const PictureSlopes before = slopes_of(document);
    EXPECT_GT(curl_share(before.slopes, {}, {border}), 0.05);
    document.apply(edit(R"("operator": "project", "view": "front")"));
    const PictureSlopes after = slopes_of(document);
    EXPECT_LT(curl_share(after.slopes, {}, {border}), 1e-8);
    const std::size_t edited = document.normals().edited_count();
    EXPECT_GT(edited, 1000U);
  }
}

TEST(AreaOperators, ProjectLeavesASurfaceAsItIs) {
  const SlopeImage dome = swirl(0.0F);
  ImageDocument document = picture(dome);
  document.apply(edit(R"("operator": "project", "view": "front")"));
  const PictureSlopes after = slopes_of(document);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 48; ++x) {
      EXPECT_LT((after.slopes(x, y) - dome(x, y)).norm(), 1e-5F) << x << " " << y;
    }
  }
}

/// Models of `combine` on a picture: on the plane they show the image alone. (UDN does not: it
/// keeps the z of what is below.)
TEST(AreaOperators, CombineByEveryModel) {
  for (const std::string model : {"linear", "rotation", "reoriented", "whiteout"}) {
    ImageDocument document = picture(constant({0.0F, 0.0F}));
    document.apply(edit(R"("operator": "combine", "view": "front",
        "options": {"image": "wave.png", "size": 64, "model": ")" +
                        model + "\"}"));
    const PictureSlopes after = slopes_of(document);
    EXPECT_NEAR(after.slopes(24, 20).x(), 0.5F, 0.02F) << model;
    EXPECT_NEAR(after.slopes(24, 20).y(), 0.0F, 1e-4F) << model;
  }
}

/// The edge of a roof across the middle, with noise of 5 degrees.
SlopeImage noisy_roof(int size) {
  SlopeImage slopes(size, size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) slopes(x, y) = {x < size / 2 ? 0.4F : -0.4F, 0.1F};
  }
  return with_noise(slopes, 5.0F, 3);
}

/// Mean degrees between the roof and the normals in columns [x0, x1), rows away from the border.
double roof_error(const NormalMap& map, int x0, int x1) {
  double sum = 0.0;
  for (int y = 16; y < map.height() - 16; ++y) {
    for (int x = x0; x < x1; ++x) {
      const Vec2f roof(x < map.width() / 2 ? 0.4F : -0.4F, 0.1F);
      sum += angle_degrees(map.normal(x, y), normal_from_slope(roof));
    }
  }
  return sum / ((map.height() - 32) * (x1 - x0));
}

NormalMap float_map(SlopeView slopes) { return picture(slopes).normals(); }

const std::vector<std::string> denoise_methods{"bilateral", "rolling", "transform"};

TEST(AreaOperators, DenoiseCleansAMeshAndKeepsItsCrease) {
  const NormalMap noisy = float_map(noisy_roof(192));
  EXPECT_GT(roof_error(noisy, 16, 176), 5.0);
  for (const std::string& method : denoise_methods) {
    Document mesh = document(plane_grid(2), noisy);
    mesh.apply(edit(R"("operator": "denoise", "view": "front",
        "options": {"sigma": 0.02, "method": ")" +
                    method + "\"}"));
    EXPECT_LT(roof_error(map_of(mesh), 16, 176), 1.5) << method;
    EXPECT_LT(roof_error(map_of(mesh), 94, 98), 4.0) << method;  // two pixels on each side
  }
  Document blurred = document(plane_grid(2), noisy);
  blurred.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.02})"));
  EXPECT_GT(roof_error(map_of(blurred), 94, 98), 15.0);
}

TEST(AreaOperators, DenoiseOfAPartIsThatOfTheWhole) {
  const SlopeImage slopes = noisy_roof(96);
  for (const std::string& method : denoise_methods) {
    const std::string options = R"("sigma": 2, "method": ")" + method + "\"";
    ImageDocument whole = picture(slopes);
    ImageDocument part = picture(slopes);
    whole.apply(edit(R"("operator": "denoise", "view": "front", "options": {)" + options + "}"));
    const EditReport report = part.apply(edit(
        R"("operator": "denoise", "view": "front", "options": {"area": "inside", "feather": 1, )" +
        options + R"(}, "strokes": [[[-12, -12], [12, -12], [12, 12], [-12, 12]]])"));
    EXPECT_LT(report.chart_width, 96) << method;
    for (int y = 38; y < 58; ++y) {
      for (int x = 38; x < 58; ++x) {
        EXPECT_LT((whole.normals().normal(x, y) - part.normals().normal(x, y)).norm(), 2e-4F)
            << method << " " << x << " " << y;
      }
    }
    EXPECT_FALSE(part.normals().edited(33, 48));
  }
}

TEST(AreaOperators, DenoiseGivesBackWithAGainWhatItTakes) {
  const SlopeImage slopes = noisy_roof(48);
  const SlopeImage before = slopes_of(picture(slopes)).slopes;
  for (const std::string& method : denoise_methods) {
    const auto with_gain = [&](const std::string& gain) {
      ImageDocument document = picture(slopes);
      document.apply(edit(R"("operator": "denoise", "view": "front",
          "options": {"sigma": 2, "gain": )" +
                          gain + R"(, "method": ")" + method + "\"}"));
      return slopes_of(document).slopes;
    };
    const SlopeImage clean = with_gain("0");
    const SlopeImage same = with_gain("1");
    const SlopeImage enhanced = with_gain("2.5");
    double largest = 0.0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Vec2f b = before.data()[i];
      ASSERT_EQ(same.data()[i], b) << method;
      const Vec2f details = b - clean.data()[i];
      largest = std::max(largest, double(details.norm()));
      EXPECT_LT((enhanced.data()[i] - (b + 1.5F * details)).norm(), 1e-4F) << method;
    }
    EXPECT_GT(largest, 0.1) << method;
  }
}

TEST(AreaOperators, DenoiseHeedsColours) {
  for (const std::string& method : denoise_methods) {
    for (const bool heeds : {false, true}) {
      SlopeImage slopes(48, 40);
      ImageDocument::Images images;
      images.colors = ColorImage(48, 40);
      for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 48; ++x) {
          slopes(x, y) = {x < 24 ? 0.02F : -0.02F, 0.0F};
          images.colors(x, y) = Vec3f::Constant(x < 24 ? 0.2F : 0.8F);
        }
      }
      const ColorImage colors = images.colors;
      images.normals = float_map(slopes);
      ImageDocument document(std::move(images));
      document.apply(edit(R"("operator": "denoise", "view": "front", "options": {"sigma": 4,
          "guide_sigma": 0.1, "sigma_color": )" +
                          std::string(heeds ? "0.05" : "0") + R"(, "method": ")" + method + "\"}"));
      const float beside = slopes_of(document).slopes(24, 20).x();
      if (heeds) {
        EXPECT_NEAR(beside, -0.02F, 0.001F) << method;
      } else {
        EXPECT_GT(beside, -0.01F) << method;
      }
      EXPECT_EQ(document.colors()(24, 20), colors(24, 20));
    }
  }
}

TEST(AreaOperators, DenoiseRefusesWidthsThatOnlyTransformTakes) {
  const std::string fields = R"("operator": "denoise", "view": "front", "options": {"sigma": 101)";
  ImageDocument document = picture(swirl(0.3F));
  try {
    document.apply(edit(fields + "}"));
    ADD_FAILURE() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "r.json: edits[0]: denoise: sigma and guide_sigma must be at most 100 pixels for "
                 "the methods "
                 "\"bilateral\" and \"rolling\"; \"transform\" takes more");
  }
  EXPECT_FALSE(document.normals().has_edits());
  document.apply(edit(fields + R"(, "method": "transform"})"));
  EXPECT_TRUE(document.normals().has_edits());
}

/// The same edits in the chart of a mesh.
TEST(AreaOperators, WorkOnAMesh) {
  for (const std::string name : {"flatten", "paint", "rotate", "balance", "project", "denoise"}) {
    Document mesh = document(plane_grid(2), noise_map(64, CodeType::U16));
    const std::string options = name == "rotate"    ? R"({"angle": 90})"
                                : name == "paint"   ? R"({"tilt": 20})"
                                : name == "denoise" ? R"({"sigma": 0.05, "sigma_normal": 0.5})"
                                                    : "{}";
    const EditReport report = mesh.apply(
        edit(R"("operator": ")" + name + R"(", "view": "front", "options": )" + options));
    EXPECT_GT(report.pushed.changed, 2000U) << name;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        EXPECT_TRUE(map_of(mesh).normal(x, y).allFinite()) << name;
      }
    }
  }
}

}  // namespace
}  // namespace normalshop::test
