#include "document/picture_fixture.h"

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

/// The same edits in the chart of a mesh.
TEST(AreaOperators, WorkOnAMesh) {
  for (const std::string name : {"flatten", "paint", "rotate", "balance", "project"}) {
    Document mesh = document(plane_grid(2), noise_map(64, CodeType::U16));
    const std::string options = name == "rotate"  ? R"({"angle": 90})"
                                : name == "paint" ? R"({"tilt": 20})"
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
