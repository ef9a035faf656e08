#include <array>

#include "document/edit_fixture.h"
#include "support/sanitized.h"

#include "normalshop/core/error.h"
#include "normalshop/surface/shapes.h"

/// Edits of the surface that masks in the atlas's layout limit.
namespace normalshop::test {
namespace {

constexpr int plane_texels = 128;

std::string masked(const std::string& part) {
  return R"("operator": "paint", "view": "surface", "options": {"azimuth": 0, "tilt": 20},
            "part": )" +
         part;
}

/// How far the plane's texels are tilted, as a part of 20 degrees' slope, along its middle row.
std::vector<float> tilts(const std::string& part) {
  Document plane = flat_plane(plane_texels);
  plane.apply(edit(masked(part)));
  std::vector<float> out;
  for (int x = 0; x < plane_texels; ++x) {
    const Vec3f n = map_of(plane).normal(x, plane_texels / 2);
    out.push_back(n.x() / n.z() / 0.36397F);
  }
  return out;
}

TEST(PartMask, LimitsAnEditToWhereItIsWhite) {
  Document plane = document(plane_grid(2), noise_map(plane_texels, CodeType::U16));
  const NormalMap before = map_of(plane);
  plane.apply(edit(R"("operator": "flatten", "view": "surface", "part": {"mask": "left.png"})"));
  const NormalMap& after = map_of(plane);
  for (int y = 0; y < plane_texels; ++y) {
    for (int x = 0; x < plane_texels; ++x) {
      if (x > 0 && x < 60) {
        ASSERT_LT(degrees_between(after.normal(x, y), Vec3f::UnitZ()), 0.05F) << x << ", " << y;
      }
      // The mask repeats as the map does.
      if (x < 70 || x > 124) continue;
      ASSERT_FALSE(after.edited(x, y)) << x << ", " << y;
      ASSERT_EQ(after.vector(x, y), before.vector(x, y));
    }
  }
}

TEST(PartMask, WeighsAsStrengthDoes) {
  Document plane = document(plane_grid(2), noise_map(plane_texels, CodeType::U16));
  Document half = plane;
  const std::string smooth = R"("operator": "smooth", "view": "surface",
      "options": {"sigma": 0.03})";
  plane.apply(edit(smooth + R"(, "part": {"mask": {"map": "grey.png"}})"));
  half.apply(edit(smooth + R"(, "strength": 0.5)"));
  for (int y = 0; y < plane_texels; ++y) {
    for (int x = 0; x < plane_texels; ++x) {
      ASSERT_LT(degrees_between(map_of(plane).normal(x, y), map_of(half).normal(x, y)), 0.01F);
    }
  }
}

TEST(PartMask, FadesOverItsFeather) {
  const std::vector<float> sharp = tilts(R"({"mask": "left.png"})");
  EXPECT_NEAR(sharp[61], 1.0F, 0.01F);
  EXPECT_EQ(sharp[67], 0.0F);
  const std::vector<float> soft = tilts(R"({"mask": "left.png", "feather": 0.25})");
  EXPECT_NEAR(0.5F * (soft[63] + soft[64]), 0.5F, 0.01F);
  EXPECT_NEAR(soft[63 - 16], 0.976F, 0.01F) << "two standard deviations from the border";
  EXPECT_NEAR(soft[64 + 16], 0.024F, 0.01F);
  EXPECT_NEAR(soft[63 - 8], 0.84F, 0.02F);
  for (std::size_t x = 40; x < 90; ++x) EXPECT_LE(soft[x + 1], soft[x] + 1e-4F) << x;
  const std::vector<float> texels = tilts(R"({"mask": "left.png", "feather_texels": 32})");
  for (std::size_t x = 20; x < 110; ++x) EXPECT_NEAR(texels[x], soft[x], 1e-3F) << x;
}

// Six charts, and weights that are the same on both sides of their seams.
TEST(PartMask, LeavesNoSeam) {
  NORMALSHOP_SKIP_FIGURES();
  std::array<ChartSquare, 6> charts;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    charts[i].center = {0.18F + 0.32F * static_cast<float>(i % 3), i < 3 ? 0.25F : 0.72F};
    charts[i].side = 0.26F;
  }
  Document masked_globe = document(cube_sphere(8, charts, "map"), noise_map(64, CodeType::U16));
  Document half = masked_globe;
  const std::string smooth = R"("operator": "smooth", "view": "surface",
      "options": {"sigma": 0.05})";
  masked_globe.apply(edit(smooth + R"(, "part": {"mask": "grey.png", "feather": 0.1})"));
  half.apply(edit(smooth + R"(, "strength": 0.5)"));
  double apart = 0.0;
  int count = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (!map_of(half).edited(x, y)) continue;
      ++count;
      apart += static_cast<double>(
          degrees_between(map_of(masked_globe).normal(x, y), map_of(half).normal(x, y)));
    }
  }
  EXPECT_GT(count, 1000);
  EXPECT_LT(apart / count, 1.0);
}

/// The plane with a texture set for each half, as a UDIM model has tiles.
Document two_sets() {
  Mesh mesh = plane_two_charts(2);
  mesh.texture_set_names = {"left", "right"};
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const float x =
        mesh.position(3 * t).x() + mesh.position(3 * t + 1).x() + mesh.position(3 * t + 2).x();
    mesh.texture_sets[t] = x < 1.5F ? 0 : 1;
  }
  std::vector<Document::Maps> maps;
  for (int i = 0; i < 2; ++i) {
    maps.push_back({flat_normal_map(plane_texels, plane_texels, CodeType::U16), {}});
  }
  return {std::move(mesh), std::move(maps)};
}

TEST(PartMask, OfOneTextureSetFadesIntoTheOther) {
  const auto tilted = [](const std::string& part) {
    Document d = two_sets();
    d.apply(edit(masked(part)));
    EXPECT_TRUE(d.storage().sets[1].normals.has_edits());
    return d;
  };
  const auto tilt = [](const Document& d, float x) {  // in the left half
    const auto texel = static_cast<int>(std::lround((0.1F + 0.8F * x) * plane_texels - 0.5F));
    const Vec3f n = d.storage().sets[0].normals.normal(texel, plane_texels / 2);
    return n.head<2>().norm() / n.z() / 0.36397F;
  };
  const Document sharp = tilted(R"({"mask": {"right": "grey.png"}})");
  EXPECT_EQ(tilt(sharp, 0.46F), 0.0F);
  const Document soft = tilted(R"({"mask": {"right": "grey.png"}, "feather": 0.2})");
  EXPECT_NEAR(tilt(soft, 0.49F), 0.21F, 0.02F);
  EXPECT_NEAR(tilt(soft, 0.45F), 0.08F, 0.01F);
  EXPECT_NEAR(tilt(soft, 0.4F), 0.011F, 0.005F);
  EXPECT_EQ(tilt(soft, 0.2F), 0.0F);
}

std::string mask_refusal(const std::string& part) {
  Document d = flat_plane(32);
  try {
    d.apply(edit(masked(part)));
  } catch (const InvalidInput& error) {
    EXPECT_FALSE(map_of(d).has_edits());
    return error.what();
  }
  return "no error";
}

TEST(PartMask, SaysWhatDoesNotFit) {
  EXPECT_EQ(mask_refusal(R"({"mask": "black.png"})"),
            "r.json: edits[0].part.mask must be above 0 on some of the edited surface");
  EXPECT_EQ(mask_refusal(R"({"mask": "none.png"})"),
            "r.json: edits[0].part.mask: none.png: cannot be read: there is no such file");
  EXPECT_EQ(mask_refusal(R"({"mask": {"nose": "grey.png"}})"),
            "r.json: edits[0].part.mask names the texture set 'nose', which the model does not "
            "have; it has 'map'");
  EXPECT_EQ(mask_refusal(R"({"mask": 3})"),
            "r.json: edits[0].part.mask must be the name of a file, or an object with one for each "
            "of some texture sets, not the number 3");
  EXPECT_EQ(mask_refusal(R"({"charts_at": [[0.5, 0.5, 0]], "feather": 0.1})"),
            "r.json: edits[0].part.feather must be left out where there is no \"mask\", not the "
            "number 0.1");
  EXPECT_EQ(
      mask_refusal(R"({"mask": "grey.png", "feather": 0.1, "feather_texels": 2})"),
      "r.json: edits[0].part.feather_texels must be left out beside \"feather\", not the number 2");
  EXPECT_EQ(mask_refusal(R"({"feather": 0.1})").substr(0, 71),
            "r.json: edits[0].part must be an object with \"charts_at\" or \"mask\", not");
}

TEST(PartMask, ComesBackFromItsJson) {
  for (const std::string& part :
       {std::string(R"({"mask": "left.png", "feather": 0.25})"),
        std::string(R"({"charts_at": [[0, 0, 1]], "mask": {"a": "left.png", "b": "grey.png"},
                        "feather_texels": 3})")}) {
    const Recipe recipe = parse(R"({"version": 1, "edits": [{)" + masked(part) + "}]}");
    const std::string text = to_json(to_value(recipe));
    EXPECT_EQ(to_json(to_value(parse(text))), text);
    EXPECT_NE(text.find("left.png"), std::string::npos);
    EXPECT_NE(text.find("feather"), std::string::npos);
  }
}

}  // namespace
}  // namespace normalshop::test
