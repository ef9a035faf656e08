#include <cmath>

#include "document/edit_fixture.h"
#include "document/picture_fixture.h"
#include "support/sanitized.h"

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

/// Points on the great circle across `axis`, from angle a to b from u on, a right angle or less
/// apart.
std::string circle_text(const Vec3f& axis, const Vec3f& u, float a, float b) {
  const Vec3f v = axis.normalized().cross(u);
  const int pieces = 1 + static_cast<int>(std::abs(b - a) / 1.58F);
  std::string text;
  for (int i = 0; i <= pieces; ++i) {
    const float t = a + (b - a) * static_cast<float>(i) / static_cast<float>(pieces);
    text += (i > 0 ? ", " : "") + point_text(std::cos(t) * u + std::sin(t) * v);
  }
  return "[" + text + "]";
}

std::string circle_text(const Vec3f& axis, float a, float b) {
  return circle_text(axis, axis.unitOrthogonal(), a, b);
}

/// Angles between a sphere's texels and what they should be, in degrees.
struct Errors {
  float largest = 0.0F;
  double mean = 0.0;
  int count = 0;

  void add(const Vec3f& is, const Vec3f& should) {
    const float error = degrees_between(is, should);
    largest = std::max(largest, error);
    mean += (static_cast<double>(error) - mean) / ++count;
  }
};

std::string pen_along(const std::string& strokes) {
  return R"("operator": "pen", "view": "surface",
            "options": {"profile": "bump", "width": 0.2, "height": 0.03}, "strokes": )" +
         strokes;
}

/// The normal that pen_along() makes of a sphere beside a great circle.
Vec3f beside_circle(const Vec3f& base, const Vec3f& axis) {
  static const Profile profile({.shape = ProfileShape::Bump, .closed = false, .curve = {}});
  const float slope = 0.03F * profile.at(std::asin(base.dot(axis)) / 0.1F).slope / 0.1F;
  return base - slope * (axis - axis.dot(base) * base).normalized();
}

TEST(SurfaceStrokes, DrawOneProfileAllRoundASphere) {
  NORMALSHOP_SKIP_FIGURES();
  Document sphere = bare_sphere();
  const Vec3f axis = Vec3f(0.4F, 0.7F, -0.5F).normalized();
  const EditReport report =
      sphere.apply(edit(pen_along("[" + circle_text(axis, 0.0F, 6.2831853F) + "]")));
  Errors inside;
  Errors outside;
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f base = sphere_normal(x, y);
      const bool on = std::abs(base.dot(axis)) < 0.105F;
      (on ? inside : outside).add(map_of(sphere).normal(x, y), beside_circle(base, axis));
    }
  }
  EXPECT_GE(report.views, 6);
  EXPECT_LT(inside.mean, 0.1);
  EXPECT_LT(inside.largest, 1.5F);
  EXPECT_LT(outside.largest, 1e-3F);
}

/// Each view of one stroke shows the other, too, and must not weaken it.
TEST(SurfaceStrokes, CrossEachOtherAtFullStrength) {
  Document sphere = bare_sphere();
  const Vec3f a = Vec3f(0.4F, 0.7F, -0.5F).normalized();
  const Vec3f b = Vec3f(0.6F, -0.5F, 0.3F).normalized();
  const Vec3f middle = a.cross(b).normalized();
  sphere.apply(edit(pen_along("[" + circle_text(a, middle, -1.2F, 1.2F) + ", " +
                              circle_text(b, middle, -1.2F, 1.2F) + "]")));
  Errors errors;
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f base = sphere_normal(x, y);
      const bool on_a = std::abs(base.dot(a)) < 0.105F;
      const bool on_b = std::abs(base.dot(b)) < 0.105F;
      if (on_a == on_b || base.dot(middle) < 0.5F) continue;
      errors.add(map_of(sphere).normal(x, y), beside_circle(base, on_a ? a : b));
    }
  }
  EXPECT_LT(errors.largest, 1.5F);
}

/// 16 repetitions of the wave, whose phase is that of the way and not of any view.
TEST(SurfaceStrokes, CarryPatternsOnFromViewToView) {
  NORMALSHOP_SKIP_FIGURES();
  Document sphere = bare_sphere();
  const Vec3f axis = Vec3f(0.4F, 0.7F, -0.5F).normalized();
  sphere.apply(edit(R"("operator": "trim", "view": "surface",
                       "options": {"pattern": "wave.png", "width": 0.2}, "strokes": [)" +
                    circle_text(axis, 0.0F, 6.2831853F) + "]"));
  const Vec3f start = axis.unitOrthogonal();
  Errors errors;
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f base = sphere_normal(x, y);
      if (std::abs(base.dot(axis)) > 0.09F) continue;
      const Vec3f along = axis.cross(base).normalized();
      const float angle = std::atan2(base.dot(axis.cross(start)), base.dot(start));
      const float slope = -0.5F * (0.4F * 16.0F / 6.2831853F) * std::cos(16.0F * angle);
      errors.add(map_of(sphere).normal(x, y), base - slope * along);
    }
  }
  EXPECT_LT(errors.mean, 0.1);
  EXPECT_LT(errors.largest, 0.5F);
}

/// Two sheets, the one behind the other.
TEST(SurfaceStrokes, ReachWhatIsHidden) {
  MeshBuilder two;
  for (const float z : {0.0F, 0.3F}) {
    const auto corner = [&](float x, float y) {
      return MeshBuilder::Corner{{x, y, z},
                                 Vec3f::UnitZ(),
                                 {0.05F + 0.4F * x + 0.5F * (z > 0.0F ? 1.0F : 0.0F), 0.4F * y}};
    };
    two.quad(corner(0.0F, 0.0F), corner(1.0F, 0.0F), corner(1.0F, 1.0F), corner(0.0F, 1.0F));
  }
  Document sheets = document(two.finish(), flat_normal_map(128, 128, CodeType::U16));
  sheets.apply(edit(pen_along("[[[0.2, 0.2, 0], [0.8, 0.8, 0]]]")));
  int behind = 0;
  int before = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      const bool changed = map_of(sheets).normal(x, y).z() < 0.999F;
      (x < 64 ? behind : before) += changed ? 1 : 0;
    }
  }
  EXPECT_GT(behind, 200);
  EXPECT_EQ(before, 0);
}

TEST(SurfaceStrokes, GuideBrushes) {
  Document sphere = bare_sphere();
  const Vec3f axis = Vec3f::UnitX();
  sphere.apply(edit(pen_along("[" + circle_text(axis, -1.3F, 1.5F) + "]")));
  const Document before = sphere;
  sphere.apply(edit(R"("operator": "flatten", "view": "surface",
                       "options": {"area": "brush", "brush": 0.5, "hardness": 0.6},
                       "strokes": [)" +
                    circle_text(axis, 0.0F, 1.2F) + "]"));
  Errors flat;
  Errors kept;
  const Vec3f u = axis.unitOrthogonal();
  const Vec3f v = axis.cross(u);
  for (int y = 0; y < sphere_map_side; ++y) {
    for (int x = 0; x < sphere_map_side; ++x) {
      const Vec3f base = sphere_normal(x, y);
      const float angle = std::atan2(base.dot(v), base.dot(u));
      if (angle > 0.1F && angle < 1.1F && std::abs(base.dot(axis)) < 0.12F) {
        flat.add(map_of(sphere).normal(x, y), base);
      } else if (angle < -0.5F && angle > -1.2F) {
        kept.add(map_of(sphere).normal(x, y), map_of(before).normal(x, y));
      }
    }
  }
  EXPECT_LT(flat.largest, 0.5F);
  EXPECT_EQ(kept.largest, 0.0F);
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
  EXPECT_NE(text.find("[0.5, 0.25, 1, 0.75]"), std::string::npos) << text;
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

TEST(SurfaceStrokes, AreNotForPictures) {
  ImageDocument flat = picture(waves(32, 32, 2, 0.3F));
  EXPECT_THROW(flat.apply(edit(pen_along("[[[0, 0, 0], [5, 0, 0]]]"))), InvalidInput);
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
