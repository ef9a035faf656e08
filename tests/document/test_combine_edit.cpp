#include "document/edit_fixture.h"
#include "support/sanitized.h"

#include "normalshop/core/sample.h"
#include "normalshop/rgbn/combine.h"

namespace normalshop::test {
namespace {

/// Slope of "wave.png" so wide at x from the view's centre.
float wave_slope(float width, float x) { return 0.5F * std::cos(6.2831853F * x / width); }

TEST(CombineEdit, AnImageRepeatsOverTheWholeView) {
  Document d = flat_plane(256);
  d.apply(edit(R"("operator": "combine", "view": "front", "options": {"image": "wave.png",
                  "size": 0.23, "repeat": true, "relief": -2})"));
  float most = 0.0F;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float slope = -2.0F * wave_slope(0.23F, plane_point(map_of(d), x, y).x());
      most = std::max(most, degrees_between(map_of(d).normal(x, y), {-slope, 0.0F, 1.0F}));
    }
  }
  EXPECT_LT(most, 0.5F);
}

TEST(CombineEdit, AnImageLiesOnceInTheMiddleOfTheView) {
  Document d = flat_plane(256);
  d.apply(edit(R"("operator": "combine", "options": {"image": "wave.png", "rotation": 90,
                  "border": 0.1}, "view": {"direction": [0, 0, 1], "center": [0.6, 0.5, 0],
                  "width": 0.4})"));
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const Vec2f p = plane_point(map_of(d), x, y) - Vec2f(0.1F, 0.0F);
      // It is 0.4 wide and 0.2 high before it is turned; its border is a tenth of 0.2.
      if (std::abs(p.x()) > 0.11F || std::abs(p.y()) > 0.21F) {
        ASSERT_FALSE(map_of(d).edited(x, y)) << x << ", " << y;
      } else if (std::abs(p.x()) < 0.078F && std::abs(p.y()) < 0.178F) {
        const Vec3f expected(0.0F, -wave_slope(0.4F, p.y()), 1.0F);
        ASSERT_LT(degrees_between(map_of(d).normal(x, y), expected), 0.3F) << x << ", " << y;
      }
    }
  }
}

class CombineEditModels : public testing::TestWithParam<const char*> {};

// On a flat base these models agree.
INSTANTIATE_TEST_SUITE_P(Models, CombineEditModels,
                         testing::Values("linear", "rotation", "reoriented", "whiteout"));

TEST_P(CombineEditModels, LayTheImageAlongStrokesAndFillThem) {
  const std::string options =
      R"("operator": "combine", "view": "front", "options": {"image": "wave.png", "size": 0.2,
         "repeat": true, "model": ")" +
      std::string(GetParam()) + "\", ";
  Document brushed = flat_plane(256);
  brushed.apply(edit(options + R"("area": "brush", "brush": 0.2},
                                  "strokes": [[[-0.4, 0.25], [0.4, 0.25]]])"));
  Document filled = flat_plane(256);
  filled.apply(edit(options + R"("area": "inside", "feather": 0.02},
                                 "strokes": [[[-0.4, 0.15], [0.4, 0.15], [0.4, 0.35], [-0.4, 0.35]]])"));
  for (const Document* d : {&brushed, &filled}) {
    const NormalMap& map = map_of(*d);
    for (int x = 40; x < 216; ++x) {
      const float slope = wave_slope(0.2F, plane_point(map, x, 64).x());
      ASSERT_LT(degrees_between(map.normal(x, 64), {-slope, 0.0F, 1.0F}), 0.3F) << x;
      ASSERT_FALSE(map.edited(x, 93));
      ASSERT_FALSE(map.edited(x, 34));
    }
  }
}

TEST_P(CombineEditModels, FadeTheImageOutAtItsBorder) {
  Document d = flat_plane(256);
  d.apply(edit(R"("operator": "combine", "view": "front", "options": {"image": "wave.png",
                  "size": 0.8, "border": 0.3, "model": ")" +
               std::string(GetParam()) + "\"}"));
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      // 0.8 wide and 0.4 high; the border is 0.3 of the height.
      const Vec2f p = plane_point(map_of(d), x, y);
      const float inside = smoothstep(0.0F, 0.12F, 0.4F - std::abs(p.x())) *
                           smoothstep(0.0F, 0.12F, 0.2F - std::abs(p.y()));
      const Vec3f expected(-inside * wave_slope(0.8F, p.x()), 0.0F, 1.0F);
      ASSERT_LT(degrees_between(map_of(d).normal(x, y), expected), 0.5F) << x << ", " << y;
      const bool beyond = std::abs(p.x()) > 0.41F || std::abs(p.y()) > 0.21F;
      ASSERT_FALSE(beyond && map_of(d).edited(x, y)) << x << ", " << y;
    }
  }
}

TEST_P(CombineEditModels, ReplaceDetailsByItsOpacity) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U16));
  d.apply(edit(R"("operator": "combine", "view": "front", "details": "ignore",
                  "options": {"image": "cone.png", "size": 0.8, "border": 0, "model": ")" +
               std::string(GetParam()) + "\"}"));
  const NormalMap& map = map_of(d);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      // The cone ends at 12, its opacity at 14 of 32 pixels that are 0.8 wide together.
      const Vec2f p = plane_point(map, x, y);
      const float r = p.norm() / 0.025F;
      if (r > 15.5F) {
        ASSERT_FALSE(map.edited(x, y)) << x << ", " << y;
      } else if (r > 2.5F && r < 10.5F) {
        const Vec2f n = 0.5F * p.normalized();
        ASSERT_LT(degrees_between(map.normal(x, y), {n.x(), n.y(), 1.0F}), 1.5F) << x << ", " << y;
      }
    }
  }
}

/// The tilt from the base that an image of known tilt gets on a hemisphere: how far it differs.
float worst_tilt(const std::string& model, const std::string& details) {
  const Document before = hemisphere_document(256);
  Document after = hemisphere_document(256);
  after.apply(edit(R"("operator": "combine", "view": "front",
                      "details": ")" +
                   details + R"(", "options": {"image": "wave.png", "size": 0.5, "repeat": true,
                      "model": ")" +
                   model + "\"}"));
  float worst = 0.0F;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const Vec3f base = map_of(before).normal(x, y);
      if (base.z() < 0.643F) continue;
      const float slope = wave_slope(0.5F, base.x());
      const float tilt = degrees_between(map_of(after).normal(x, y), base);
      worst = std::max(worst, std::abs(tilt - std::atan(std::abs(slope)) * 57.29578F));
    }
  }
  return worst;
}

TEST(CombineEdit, AnImageThatTurnsNormalsKeepsItsTiltOnSlantedSurface) {
  NORMALSHOP_SKIP_FIGURES();
  for (const std::string details : {"keep", "ignore"}) {
    EXPECT_GT(worst_tilt("linear", details), 5.0F);
    EXPECT_LT(worst_tilt("rotation", details), 0.5F);
    EXPECT_LT(worst_tilt("reoriented", details), 0.5F);
  }
}

TEST(CombineEdit, TheModelDecidesHowAnImageMeetsDetails) {
  // Details of a constant tilt on a flat base.
  const Vec3f tilted = Vec3f(0.1F, -0.6F, 1.0F).normalized();
  RawImage codes(128, 128, 3, CodeType::F32);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      std::copy_n(tilted.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  for (const CombineModel model :
       {CombineModel::Linear, CombineModel::Rotation, CombineModel::Reoriented,
        CombineModel::Whiteout, CombineModel::Udn, CombineModel::Overlay}) {
    Document d = document(plane_grid(2), NormalMap(codes, {.signed_float = true}));
    d.apply(edit(R"("operator": "combine", "view": "front", "options": {"image": "wave.png",
                    "size": 0.5, "repeat": true, "model": ")" +
                 std::string(name_of(model)) + "\"}"));
    for (int x = 4; x < 124; ++x) {
      const SlopeImage base(1, 1, slope_from_normal(tilted));
      const SlopeImage flat(1, 1, Vec2f::Zero());
      const SlopeImage image(1, 1, Vec2f(wave_slope(0.5F, plane_point(map_of(d), x, 0).x()), 0.0F));
      SlopeImage expected(1, 1);
      if (model == CombineModel::Rotation) {
        combine_rotation(base, flat, image, {}, 1.0F, expected, expected.rect());
      } else {
        combine(base, image, {}, expected, expected.rect(), {.model = model});
      }
      ASSERT_LT(degrees_between(map_of(d).normal(x, 50), normal_from_slope(expected(0, 0))), 0.3F)
          << name_of(model) << x;
    }
  }
}

}  // namespace
}  // namespace normalshop::test
