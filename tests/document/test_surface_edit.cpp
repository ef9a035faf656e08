#include "document/edit_fixture.h"
#include "document/picture_fixture.h"
#include "support/sanitized.h"

#include "normalshop/core/error.h"
#include "normalshop/surface/seam_mismatch.h"

/// Edits of all of a surface, from as many views as it takes.
namespace normalshop::test {
namespace {

constexpr int atlas_size = 96;

/// Sphere whose map holds waves of a period of about 0.3, in object space, equal on both sides of
/// its seam.
Document wavy_sphere(float amplitude) {
  const Mesh mesh = uv_sphere(32, 16);
  RawImage codes(atlas_size, atlas_size, 3, CodeType::F32);
  for (int y = 0; y < atlas_size; ++y) {
    for (int x = 0; x < atlas_size; ++x) {
      const float around = 6.2831853F * (static_cast<float>(x) + 0.5F) / atlas_size;
      const float down = 3.1415927F * (static_cast<float>(y) + 0.5F) / atlas_size;
      const Vec3f base(std::sin(down) * std::sin(around), std::cos(down),
                       std::sin(down) * std::cos(around));
      const Vec3f wave(std::sin(20.0F * base.y()), std::sin(20.0F * base.z()),
                       std::sin(20.0F * base.x()));
      const Vec3f n = (base + amplitude * (wave - wave.dot(base) * base)).normalized();
      std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return document(
      mesh, NormalMap(std::move(codes), {.space = NormalSpace::Object, .signed_float = true}));
}

double mean_angle(const NormalMap& a, const NormalMap& b) {
  double sum = 0.0;
  for (int y = 0; y < atlas_size; ++y) {
    for (int x = 0; x < atlas_size; ++x) {
      sum += static_cast<double>(degrees_between(a.normal(x, y), b.normal(x, y)));
    }
  }
  return sum / (atlas_size * atlas_size);
}

std::string smooth_all(const std::string& view = R"("surface")") {
  return R"("operator": "smooth", "view": )" + view + R"(, "options": {"sigma": 0.04})";
}

/// Copies know the views that cover it already, which take long to find under sanitizers.
const Document& covered_sphere() {
  static const Document sphere = [] {
    Document d = wavy_sphere(0.3F);
    d.apply(edit(smooth_all() + R"(, "strength": 0)"));
    return d;
  }();
  return sphere;
}

TEST(SurfaceEdit, SmoothsAllOfASphereWhateverTheViews) {
  NORMALSHOP_SKIP_FIGURES();
  const Document& before = covered_sphere();
  Document once = before;
  Document twice = before;
  const EditReport report = once.apply(edit(smooth_all()));
  const EditReport more = twice.apply(
      edit(smooth_all(R"({"surface": {"views": )" + std::to_string(2 * report.views) + "}}")));
  EXPECT_GE(report.views, 8);
  EXPECT_EQ(more.views, 2 * report.views);
  EXPECT_GT(mean_angle(map_of(once), map_of(before)), 3.0);
  EXPECT_LT(mean_angle(map_of(once), map_of(twice)), 0.1);
  EXPECT_EQ(once.log().size(), before.log().size() + 1);
}

/// A Gaussian leaves exp(-(k sigma)^2 / 2) of a wave, wherever one looks. On the surface the waves
/// are slower the more it is turned towards their own direction: two thirds of k^2 in the mean.
TEST(SurfaceEdit, LeavesWhatTheFilterLeaves) {
  NORMALSHOP_SKIP_FIGURES();
  Document all = wavy_sphere(0.1F);
  const Document flat = wavy_sphere(0.0F);
  const double before = mean_angle(map_of(all), map_of(flat));
  all.apply(edit(R"("operator": "smooth", "view": "surface", "options": {"sigma": 0.03})"));
  const double after = mean_angle(map_of(all), map_of(flat));
  EXPECT_NEAR(after / before, std::exp(-0.5 * 0.36 * 2.0 / 3.0), 0.02);
}

TEST(SurfaceEdit, BothSidesOfASeamAgreeAfterwards) {
  Document all = document(uv_sphere(32, 16), noise_map(atlas_size, CodeType::U16));
  const std::vector<const NormalMap*> maps{&map_of(all)};
  const std::vector<SeamSample> samples = sample_seams(all.mesh(), all.seams(), maps);
  const double before = summarize(seam_angles(all.mesh(), samples, maps)).mean;
  all.apply(edit(smooth_all()));
  const double after = summarize(seam_angles(all.mesh(), samples, maps)).mean;
  EXPECT_GT(before, 5.0);
  EXPECT_LT(after, 0.2);
}

/// Low-pass filters replace what they smooth; a border of the surface must not show through.
TEST(SurfaceEdit, AFilterSeesNoBorderOfATiltedSurface) {
  for (const char* mode : {"view", "base"}) {
    Document plane = document(plane_grid(2), noise_map(atlas_size, CodeType::U16));
    plane.apply(edit(R"("operator": "smooth", "view": {"direction": [0.8, 0.3, 1]}, "mode": ")" +
                     std::string(mode) + R"(", "options": {"sigma": 0.04})"));
    float rim = 0.0F;
    for (int i = 0; i < atlas_size; ++i) {
      for (const Vec3f& n :
           {map_of(plane).normal(0, i), map_of(plane).normal(i, 0),
            map_of(plane).normal(atlas_size - 1, i), map_of(plane).normal(i, atlas_size - 1)}) {
        rim = std::max(rim, degrees_between(n, Vec3f::UnitZ()));
      }
    }
    EXPECT_LT(rim, 8.0F) << mode;  // what is left of the noise; the plane's slope is 40 degrees
  }
}

TEST(SurfaceEdit, NothingToFilterKeepsEveryCode) {
  Document flat =
      document(uv_sphere(32, 16), flat_normal_map(atlas_size, atlas_size, CodeType::U16));
  EXPECT_EQ(flat.apply(edit(smooth_all())).pushed.changed, 0U);
  EXPECT_EQ(flat.apply(edit(R"("operator": "filter", "view": "surface",
                               "options": {"kind": "scale", "amount": 2})"))
                .pushed.changed,
            0U);
  EXPECT_FALSE(map_of(flat).has_edits());
}

TEST(SurfaceEdit, StrengthIsAPartOfIt) {
  NORMALSHOP_SKIP_FIGURES();
  const Document& before = covered_sphere();
  EXPECT_FALSE(map_of(before).has_edits()) << "after an edit of strength 0";
  Document half = before;
  Document full = before;
  half.apply(edit(smooth_all() + R"(, "strength": 0.5)"));
  full.apply(edit(smooth_all()));
  EXPECT_NEAR(mean_angle(map_of(half), map_of(before)) / mean_angle(map_of(full), map_of(before)),
              0.5, 0.05);
}

TEST(SurfaceEdit, IsTheWholePictureOfAPicture) {
  ImageDocument surface = picture(waves(32, 32, 2, 0.3F));
  ImageDocument front = picture(waves(32, 32, 2, 0.3F));
  surface.apply(edit(R"("operator": "smooth", "view": "surface", "options": {"sigma": 3})"));
  front.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 3})"));
  EXPECT_EQ(farthest(surface, slopes_of(front).slopes), 0.0F);
}

std::string refusal(const std::string& fields) {
  try {
    edit(fields);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no error";
}

TEST(SurfaceEdit, SaysWhatDoesNotFit) {
  EXPECT_EQ(refusal(smooth_all() + R"(, "mirror": "x")"),
            "r.json: edits[0].mirror must be left out where the view is \"surface\", not the text "
            "\"x\"");
  EXPECT_NE(refusal(smooth_all() + R"(, "strokes": [[[0, 0]]])").find("edits[0].strokes"),
            std::string::npos);
  for (const char* strokes : {"", R"(, "strokes": [[[0, 0, 1], [1, 1, 1]]])"}) {
    EXPECT_EQ(refusal(R"("operator": "text", "view": "surface",
                         "options": {"text": "x", "size": 1, "height": 1, "bevel": 0.1})" +
                      std::string(strokes)),
              "r.json: edits[0].view must be front, back, left, right, top or bottom, or an object "
              "with \"direction\" or \"facing\", since \"text\" needs strokes here, not the text "
              "\"surface\"");
  }
  EXPECT_NE(refusal(smooth_all(R"({"surface": 3})")).find("\"views\""), std::string::npos);
  EXPECT_NE(refusal(smooth_all(R"({"surface": {"views": 0}})")).find("from 1 to 96"),
            std::string::npos);
  EXPECT_NE(refusal(smooth_all(R"({"surface": {"view": 3}})")).find("surface"), std::string::npos);
}

TEST(SurfaceEdit, ComesBackFromItsJson) {
  for (const char* view : {R"("surface")", R"({"surface":{"views":7}})"}) {
    const Recipe recipe = parse(R"({"version": 1, "edits": [{)" + smooth_all(view) + "}]}");
    const std::string text = to_json(to_value(recipe));
    EXPECT_EQ(to_json(to_value(parse(text))), text);
    EXPECT_EQ(recipe.edits[0].mode, EditMode::Base);
    EXPECT_NE(text.find("surface"), std::string::npos);
  }
}

}  // namespace
}  // namespace normalshop::test
