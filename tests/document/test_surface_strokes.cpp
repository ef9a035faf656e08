#include <cmath>

#include "document/edit_fixture.h"

#include "normalshop/core/error.h"
#include "normalshop/rgbn/profile.h"

/// Strokes on the surface, which no single view shows.
namespace normalshop::test {
namespace {

constexpr int sphere_map_side = 512;

/// The unit sphere's own normal at a texel of uv_sphere's map.
Vec3f sphere_normal(int x, int y) {
  const float around = 6.2831853F * (static_cast<float>(x) + 0.5F) / sphere_map_side;
  const float down = 3.1415927F * (static_cast<float>(y) + 0.5F) / sphere_map_side;
  return {std::sin(down) * std::sin(around), std::cos(down), std::sin(down) * std::cos(around)};
}

Document bare_sphere() {
  RawImage codes(sphere_map_side, sphere_map_side, 3, CodeType::F32);
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f n = sphere_normal(x, y);
      std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return document(uv_sphere(192, 96), NormalMap(std::move(codes), {.space = NormalSpace::Object,
                                                                   .signed_float = true}));
}

std::string point_text(const Vec3f& p) {
  return "[" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) +
         "]";
}

/// Points on the great circle across `axis`, from angle a to b, a right angle or less apart.
std::string circle_text(const Vec3f& axis, float a, float b) {
  const Vec3f u = axis.unitOrthogonal();
  const Vec3f v = axis.normalized().cross(u);
  const int pieces = 1 + static_cast<int>(std::abs(b - a) / 1.58F);
  std::string text;
  for (int i = 0; i <= pieces; ++i) {
    const float t = a + (b - a) * static_cast<float>(i) / static_cast<float>(pieces);
    text += (i > 0 ? ", " : "") + point_text(std::cos(t) * u + std::sin(t) * v);
  }
  return "[" + text + "]";
}

struct Errors {
  float largest = 0.0F;
  double mean = 0.0;
  float outside = 0.0F;  ///< largest change away from the stroke
};

TEST(SurfaceStrokes, DrawOneProfileAllRoundASphere) {
  Document sphere = bare_sphere();
  const Vec3f axis = Vec3f(0.4F, 0.7F, -0.5F).normalized();
  const float half_width = 0.1F;
  const float height = 0.03F;
  const EditReport report = sphere.apply(
      edit(R"("operator": "pen", "view": "surface", "options": {"profile": "bump", "width": 0.2,
              "height": 0.03}, "strokes": [)" +
           circle_text(axis, 0.0F, 6.2831853F) + "]"));
  const Profile profile({.shape = ProfileShape::Bump, .closed = false, .curve = {}});
  Errors errors;
  int count = 0;
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f base = sphere_normal(x, y);
      const float beside = std::asin(base.dot(axis));
      const Vec3f normal = map_of(sphere).normal(x, y);
      if (std::abs(beside) > 1.05F * half_width) {
        errors.outside = std::max(errors.outside, degrees_between(normal, base));
        continue;
      }
      const float slope = height * profile.at(beside / half_width).slope / half_width;
      const Vec3f away = (axis - axis.dot(base) * base).normalized();
      const float error = degrees_between(normal, base - slope * away);
      errors.largest = std::max(errors.largest, error);
      errors.mean += static_cast<double>(error);
      ++count;
    }
  }
  errors.mean /= count;
  EXPECT_GE(report.views, 6);
  EXPECT_LT(errors.mean, 0.05);
  EXPECT_LT(errors.largest, 0.25F);
  EXPECT_LT(errors.outside, 1e-3F);
}

std::string pen_along(const std::string& strokes) {
  return R"("operator": "pen", "view": "surface", "options": {"width": 0.2, "height": 0.03},
            "strokes": )" +
         strokes;
}

std::string refused(const std::string& fields) {
  try {
    edit(fields);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no error";
}

TEST(SurfaceStrokes, ComeBackFromTheirJson) {
  const Recipe recipe = parse(R"({"version": 1, "edits": [{)" +
                              pen_along("[[[0, 0, 1], [0.5, 0.25, 1, 0.75]]]") + "}]}");
  ASSERT_EQ(recipe.edits[0].surface_strokes.size(), 1U);
  EXPECT_EQ(recipe.edits[0].surface_strokes[0][1].pressure, 0.75F);
  EXPECT_TRUE(recipe.edits[0].strokes.empty());
  EXPECT_EQ(recipe.edits[0].mode, EditMode::Base);
  const std::string text = to_json(to_value(recipe));
  EXPECT_EQ(to_json(to_value(parse(text))), text);
  EXPECT_NE(text.find("[0.5,0.25,1,0.75]"), std::string::npos) << text;
}

TEST(SurfaceStrokes, AreRefusedWhereTheyDoNotFit) {
  EXPECT_NE(refused(pen_along("[[[0, 0], [1, 1]]]")).find("strokes[0][0] must be [x, y, z] or"),
            std::string::npos);
  EXPECT_NE(refused(pen_along("[]")).find("edits[0].strokes must have at least one"),
            std::string::npos);
  EXPECT_NE(refused(pen_along("[[]]")).find("at least one point"), std::string::npos);
  EXPECT_NE(refused(pen_along("[[[0, 0, 1e300]]]")).find("strokes[0][0][2]"), std::string::npos);
  EXPECT_NE(refused(pen_along(R"([[[0, 0, 1]]], "mirror": "x")")).find("edits[0].mirror"),
            std::string::npos);
  EXPECT_NE(refused(R"("operator": "pen", "view": "surface", "options": {"width": 1, "height": 1,
                       "closed": true}, "strokes": [[[0, 0, 1], [1, 0, 0], [0, 1, 0]]])")
                .find("\"pen\""),
            std::string::npos);
}

TEST(SurfaceStrokes, MustLieNearTheSurfaceAndOnOnePartOfIt) {
  Document sphere = bare_sphere();
  const auto failure = [&](const std::string& strokes) -> std::string {
    try {
      sphere.apply(edit(pen_along(strokes)));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(
      failure("[[[0, 0, 1], [0, 0, 2]]]"),
      "r.json: edits[0].strokes[0][1] must lie within 0.1732 object units (a twentieth of the "
      "model's size) of the surface, not 1");
  EXPECT_FALSE(map_of(sphere).has_edits());
  MeshBuilder two;
  const auto corner = [](float x, float y) {
    return MeshBuilder::Corner{{x, y, 0.0F}, Vec3f::UnitZ(), {0.1F * x, 0.1F * y}};
  };
  two.triangle(corner(0.0F, 0.0F), corner(3.0F, 0.0F), corner(0.0F, 3.0F));
  two.triangle(corner(5.0F, 0.0F), corner(8.0F, 0.0F), corner(5.0F, 3.0F));
  Document islands = document(two.finish(), flat_normal_map(32, 32, CodeType::U16));
  try {
    islands.apply(edit(pen_along("[[[1, 1, 0], [6, 1, 0]]]")));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("edits[0].strokes[0]: no way on the surface leads"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace normalshop::test
