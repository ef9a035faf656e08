#include "document/edit_fixture.h"
#include "support/same_codes.h"
#include "support/sanitized.h"

#include "normalshop/core/options.h"
#include "normalshop/core/parallel.h"

namespace normalshop::test {
namespace {

const std::string pen_line =
    R"("operator": "pen", "options": {"profile": "bump", "width": 0.2, "height": 0.01},
       "strokes": [[[-1.2, 0], [1.2, 0]]])";

struct Error {
  double mean = 0.0;
  float most = 0.0F;
};

/// Against the displaced hemisphere, where the base surface is within 50 degrees of the view.
template <class Truth>
Error hemisphere_error(const Document& before, const Document& after, const Truth& truth) {
  Error error;
  int count = 0;
  for (int y = 0; y < map_of(after).height(); ++y) {
    for (int x = 0; x < map_of(after).width(); ++x) {
      const Vec3f base = map_of(before).normal(x, y);
      if (base.z() < 0.643F) continue;
      const float off = degrees_between(map_of(after).normal(x, y), truth(base));
      error.mean += static_cast<double>(off);
      error.most = std::max(error.most, off);
      ++count;
    }
  }
  error.mean /= count;
  return error;
}

TEST(ApplyEdit, PenOnAPlaneGivesTheSlopesOfItsProfile) {
  Document d = flat_plane(512);
  const EditReport report = d.apply(edit(pen_line + R"(, "view": "front")"));
  const NormalMap& map = map_of(d);
  EXPECT_EQ(report.pushed.changed, map.edited_count());
  EXPECT_LE(report.pixel, 1.001F / 512.0F);
  float most = 0.0F;
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) {
      const float slope = bump_slope(0.01F, 0.1F, plane_point(map, x, y).y());
      most = std::max(most, degrees_between(map.normal(x, y), {0.0F, -slope, 1.0F}));
    }
  }
  EXPECT_LT(most, 0.1F);
}

TEST(ApplyEdit, PenInViewModeDisplacesAHemisphereTowardsTheViewer) {
  NORMALSHOP_SKIP_FIGURES();
  const Document before = hemisphere_document(512);
  Document after = hemisphere_document(512);
  after.apply(edit(pen_line + R"(, "view": "front")"));
  const Error error = hemisphere_error(before, after, [](const Vec3f& n) -> Vec3f {
    return {n.x() / n.z(), n.y() / n.z() - bump_slope(0.01F, 0.1F, n.y()), 1.0F};
  });
  EXPECT_LT(error.mean, 0.03);
  EXPECT_LT(error.most, 0.4F);
}

TEST(ApplyEdit, PenInBaseModeDisplacesAHemisphereAlongItsNormals) {
  const Document before = hemisphere_document(512);
  Document after = hemisphere_document(512);
  after.apply(edit(pen_line + R"(, "view": "front", "mode": "base")"));
  const Error error = hemisphere_error(before, after, [](const Vec3f& n) -> Vec3f {
    const Vec3f rise(0.0F, bump_slope(0.01F, 0.1F, n.y()), 0.0F);
    return n - (rise - rise.dot(n) * n);
  });
  EXPECT_LT(error.mean, 0.03);
  EXPECT_LT(error.most, 0.4F);
}

TEST(ApplyEdit, DetailsAreKeptOrReplaced) {
  // Both start from the slope (0, 0.2) and draw along the crest, where the pen's own slope is 0.
  for (const bool keep : {true, false}) {
    RawImage codes(256, 256, 3, CodeType::F32);
    const Vec3f tilted = Vec3f(0.0F, -0.2F, 1.0F).normalized();
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        std::copy_n(tilted.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
      }
    }
    Document d = document(plane_grid(2), NormalMap(std::move(codes), {.signed_float = true}));
    d.apply(
        edit(pen_line + R"(, "view": "front", "details": ")" + (keep ? "keep" : "ignore") + "\""));
    const int row = 127;
    const float slope = bump_slope(0.01F, 0.1F, plane_point(map_of(d), 0, row).y());
    const Vec3f expected(0.0F, -slope - (keep ? 0.2F : 0.0F), 1.0F);
    EXPECT_LT(degrees_between(map_of(d).normal(128, row), expected), 0.1F);
    EXPECT_LT(degrees_between(map_of(d).normal(128, 10), tilted), 1e-4F);
  }
}

TEST(ApplyEdit, StrengthScalesTheSlopes) {
  Document d = flat_plane(256);
  d.apply(edit(pen_line + R"(, "view": "front", "strength": 0.25)"));
  const float slope = bump_slope(0.01F, 0.1F, plane_point(map_of(d), 0, 115).y());
  EXPECT_GT(std::abs(slope), 0.1F);
  EXPECT_LT(degrees_between(map_of(d).normal(128, 115), {0.0F, -0.25F * slope, 1.0F}), 0.1F);
}

TEST(ApplyEdit, EditsThatChangeNothingLeaveEveryCode) {
  for (const CodeType type : {CodeType::U8, CodeType::U16}) {
    const NormalMap original = noise_map(192, type);
    Document d = document(cube(), original);
    for (const std::string fields :
         {R"("operator": "smooth", "options": {"sigma": 0.1}, "strength": 0)",
          R"("operator": "smooth", "options": {"sigma": 0})",
          R"("operator": "smooth", "options": {"sigma": 0}, "mode": "base")",
          R"("operator": "sharpen", "options": {"sigma": 0.1, "amount": 0})",
          R"("operator": "filter", "options": {"sigma": 0})",
          R"("operator": "filter", "options": {"kind": "scale"})",
          R"("operator": "denoise", "options": {"sigma": 0})",
          R"("operator": "denoise", "options": {"sigma": 0, "method": "bilateral"})",
          R"("operator": "denoise", "options": {"sigma": 0.1, "gain": 1})",
          R"("operator": "denoise", "options": {"sigma": 0, "method": "transform"})",
          R"("operator": "filter", "options": {"kind": "unsharp", "sigma": 0.1, "amount": 0})",
          R"("operator": "pen", "options": {"width": 0.2, "height": 0}, "strokes": [[[0, 0]]])",
          R"("operator": "pen", "options": {"width": 0, "height": 1}, "strokes": [[[0, 0]]])",
          R"("operator": "combine", "options": {"image": "cone.png", "relief": 0})",
          R"("operator": "combine", "options": {"image": "cone.png", "relief": 0,
             "model": "rotation"}, "mode": "base")",
          R"("operator": "combine", "options": {"image": "cone.png", "relief": 0,
             "model": "reoriented"})",
          R"("operator": "combine", "options": {"image": "cone.png", "model": "overlay"},
             "strength": 0)",
          R"("operator": "combine", "options": {"image": "cone.png", "size": 0.01}, "strength": 0,
             "details": "ignore")",
          R"("operator": "pen", "options": {"width": 1, "height": 1}, "strokes": [[[0, 0]]],
             "details": "ignore", "strength": 0)"}) {
      for (const std::string view : {"front", "left"}) {
        const EditReport report =
            d.apply(edit(std::string(fields) + R"(, "view": ")" + view + "\""));
        EXPECT_EQ(report.pushed.changed, 0U) << fields;
      }
    }
    EXPECT_TRUE(same_codes(map_of(d).encode(), original.codes()));
  }
}

TEST(ApplyEdit, TexelsOutOfReachKeepTheirCodes) {
  const NormalMap original = noise_map(256, CodeType::U8);
  Document d = document(plane_grid(2), original);
  d.apply(edit(R"("operator": "smooth", "view": "front", "strokes": [[[-0.2, -0.2], [0.2, -0.2],
                  [0.2, 0.2], [-0.2, 0.2]]], "options": {"sigma": 0.02, "area": "inside"})"));
  const RawImage after = map_of(d).encode();
  double inside = 0.0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float far = plane_point(original, x, y).cwiseAbs().maxCoeff();
      const std::uint8_t* a =
          original.codes().row<std::uint8_t>(y) + static_cast<std::ptrdiff_t>(3 * x);
      const std::uint8_t* b = after.row<std::uint8_t>(y) + static_cast<std::ptrdiff_t>(3 * x);
      if (far > 0.22F) {
        ASSERT_TRUE(std::equal(a, a + 3, b)) << x << ", " << y;
      }
      if (far < 0.15F) inside = std::max(inside, std::abs(static_cast<double>(b[0]) - 127.5));
    }
  }
  EXPECT_LT(inside, 5.0);  // it was up to 28
}

double spread(const NormalMap& map, const Rect& r) {
  double sum = 0.0;
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x)
      sum += static_cast<double>(map.normal(x, y).head<2>().squaredNorm());
  }
  return std::sqrt(sum / r.width() / r.height());
}

TEST(ApplyEdit, SmoothingTheWholeViewReachesTheRimOfTheModel) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U16));
  const double before = spread(map_of(d), {0, 0, 256, 256});
  d.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.02})"));
  EXPECT_LT(spread(map_of(d), {8, 8, 248, 248}), 0.15 * before);
  EXPECT_LT(spread(map_of(d), {0, 0, 256, 4}), 0.25 * before);
}

TEST(ApplyEdit, SmoothingAPartFadesAtTheBorderOfTheView) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U16));
  const double before = spread(map_of(d), {0, 0, 256, 256});
  d.apply(edit(R"("operator": "smooth", "view": {"direction": [0, 0, 1], "center": [0.5, 0.5, 0],
                  "width": 0.5}, "options": {"sigma": 0.02, "feather": 0.1})"));
  EXPECT_LT(spread(map_of(d), {96, 96, 160, 160}), 0.15 * before);
  EXPECT_GT(spread(map_of(d), {64, 100, 68, 160}), 0.9 * before);
  for (int y = 0; y < 256; ++y) EXPECT_FALSE(map_of(d).edited(62, y));
}

TEST(ApplyEdit, ABrushSmoothsAlongItsStroke) {
  Document d = document(plane_grid(2), noise_map(256, CodeType::U16));
  const double before = spread(map_of(d), {0, 0, 256, 256});
  d.apply(edit(R"("operator": "smooth", "view": "front", "strokes": [[[-0.3, 0.25], [0.3, 0.25]]],
                  "options": {"sigma": 0.02, "area": "brush", "brush": 0.2})"));
  EXPECT_LT(spread(map_of(d), {64, 60, 192, 68}), 0.15 * before);
  for (int x = 0; x < 256; ++x) EXPECT_FALSE(map_of(d).edited(x, 92));
}

TEST(ApplyEdit, SharpeningGrowsTheDetails) {
  Document d = document(plane_grid(2), noise_map(128, CodeType::U16));
  const double before = spread(map_of(d), {32, 32, 96, 96});
  d.apply(
      edit(R"("operator": "sharpen", "view": "front", "options": {"sigma": 0.05, "amount": 1})"));
  EXPECT_NEAR(spread(map_of(d), {32, 32, 96, 96}), 2.0 * before, 0.3 * before);
}

/// A plane with the slopes (0, shape) and a fine wave of them along x.
NormalMap wave_on_slope(float shape) {
  RawImage codes(256, 256, 3, CodeType::F32);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float wave = 0.3F * std::cos(6.2831853F * static_cast<float>(x) / 16.0F);
      const Vec3f n = Vec3f(-wave, -shape, 1.0F).normalized();
      std::copy_n(n.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return NormalMap(std::move(codes), {.signed_float = true});
}

// Far from the rim a wave's slopes are multiplied by the filter's response and the shape's by that
// of a constant; 1/16 of the plane's width is the wave's length times 1/16.
TEST(ApplyEdit, FiltersHaveTheirResponses) {
  NORMALSHOP_SKIP_FIGURES();
  struct Case {
    std::string options;
    double wave;
    double shape;
  };
  constexpr double length = 16.0 / 256.0;
  const auto gauss = [](double sigma) {
    return std::exp(-0.5 * std::pow(6.283185307 * sigma / length, 2.0));
  };
  const double bend = std::pow(6.283185307 * 0.015 / length, 2.0) * gauss(0.015);
  for (const Case& c : {
           Case{R"("sigma": 0.01)", gauss(0.01), 1.0},
           Case{R"("kind": "high_pass", "sigma": 0.02, "amount": 2)", 2.0 - 2.0 * gauss(0.02), 0.0},
           Case{R"("kind": "band_pass", "sigma": 0.02, "noise_sigma": 0.01)",
                gauss(0.01) - gauss(0.02), 0.0},
           Case{R"("kind": "laplacian_of_gaussian", "sigma": 0.015)", bend, 0.0},
           Case{R"("kind": "unsharp", "sigma": 0.02)", 2.0 - gauss(0.02), 1.0},
           Case{R"("kind": "edge_enhance", "sigma": 0.02, "noise_sigma": 0.01)",
                1.0 + gauss(0.01) - gauss(0.02), 1.0},
           Case{R"("kind": "scale", "amount": 0.5)", 0.5, 0.5},
       }) {
    Document d = document(plane_grid(2), wave_on_slope(0.2F));
    d.apply(edit(R"("operator": "filter", "view": "front", "options": {)" + c.options + "}"));
    float most = 0.0F;
    for (int x = 112; x < 144; ++x) {
      const double wave = 0.3 * std::cos(6.2831853 * x / 16.0) * c.wave;
      const Vec3f expected(static_cast<float>(-wave), static_cast<float>(-0.2 * c.shape), 1.0F);
      most = std::max(most, degrees_between(map_of(d).normal(x, 128), expected));
    }
    EXPECT_LT(most, 0.3F) << c.options;
  }
}

TEST(ApplyEdit, CopiesLandOnTheirPoints) {
  for (
      const std::string what :
      {R"("operator": "stamp", "options": {"patch": "cone.png", "size": 0.2})",
       R"("operator": "text", "options": {"text": "I", "size": 0.3, "height": 0.01, "bevel": 0.03})"}) {
    Document d = flat_plane(256);
    d.apply(edit(std::string(what) + R"(, "view": "front", "strokes": [[[0.2, -0.1]]])"));
    EXPECT_GT(map_of(d).edited_count(), 300U);
    EXPECT_LT((centre_of_edits(map_of(d)) - Vec2f(0.2F, -0.1F)).norm(), 0.006F) << what;
  }
}

TEST(ApplyEdit, TheSameRecipeMeansTheSameAtAnyResolution) {
  NORMALSHOP_SKIP_FIGURES();
  for (const std::string what :
       {R"("operator": "pen", "options": {"profile": "scratch", "width": 0.15, "height": 0.02,
           "taper": 0.1}, "strokes": [[[-0.3, -0.2], [0, 0.1, 0.6], [0.3, 0]]])",
        R"("operator": "text", "strokes": [[[0, 0]]],
           "options": {"text": "I", "size": 0.5, "height": 0.03, "bevel": 0.15})",
        R"("operator": "combine", "options": {"image": "wave.png", "size": 0.13, "repeat": true,
           "rotation": 20})"}) {
    Document low = flat_plane(256);
    Document high = flat_plane(1024);
    const Edit e = edit(std::string(what) + R"(, "view": "front")");
    low.apply(e);
    high.apply(e);
    double sum = 0.0;
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        const Vec2f uv((static_cast<float>(x) + 0.5F) / 256.0F,
                       (static_cast<float>(y) + 0.5F) / 256.0F);
        sum +=
            static_cast<double>(degrees_between(map_of(low).normal(x, y), map_of(high).sample(uv)));
      }
    }
    EXPECT_LT(sum / 65536.0, 0.05) << what;
    EXPECT_GT(map_of(low).edited_count(), 2000U);
  }
}

TEST(ApplyEdit, ThreadsDoNotMatter) {
  const Edit first = edit(pen_line + R"(, "view": {"direction": [1, 1, 1]}, "mode": "base")");
  const Edit second = edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.1})");
  Document many = document(cube(4), noise_map(192, CodeType::U8));
  Document one = document(cube(4), noise_map(192, CodeType::U8));
  for (const Edit& e : {first, second}) many.apply(e);
  {
    const ThreadLimit limit(1);
    for (const Edit& e : {first, second}) one.apply(e);
  }
  EXPECT_GT(map_of(many).edited_count(), 1000U);
  for (int y = 0; y < 192; ++y) {
    for (int x = 0; x < 192; ++x) ASSERT_EQ(map_of(many).normal(x, y), map_of(one).normal(x, y));
  }
}

TEST(ApplyEdit, OverlappingViewsAddUpAndTheLogGrows) {
  Document d = hemisphere_document(256);
  const Edit front = edit(pen_line + R"(, "view": "front")");
  const Edit tilted = edit(pen_line + R"(, "view": {"direction": [0.3, 0.2, 1]}, "mode": "base")");
  d.apply(front);
  const std::size_t after_first = map_of(d).edited_count();
  d.apply(tilted);
  EXPECT_GT(map_of(d).edited_count(), after_first);
  ASSERT_EQ(d.log().size(), 2U);
  // Replaying the log gives the same bits.
  Document again = hemisphere_document(256);
  for (const Edit& e : d.log()) again.apply(e);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) ASSERT_EQ(map_of(d).normal(x, y), map_of(again).normal(x, y));
  }
  expect_unit_normals(map_of(d));
}

TEST(ApplyEdit, EveryTransferAndUpdateMakesTheSameEdit) {
  constexpr int size = 128;
  const std::vector<std::string> edits{
      pen_line + R"(, "view": "front")",
      pen_line + R"(, "view": "front", "mode": "base", "details": "ignore")",
      R"("operator": "smooth", "view": "front", "options": {"sigma": 0.02})"};
  const Document fresh = hemisphere_document(size);
  for (const std::string& text : edits) {
    Document usual = fresh;
    usual.apply(edit(text));
    for (const Transfer transfer : {Transfer::Triangle, Transfer::Point}) {
      for (const Update update : {Update::Gather, Update::Point, Update::Area}) {
        Document d = fresh;
        const EditReport report = d.apply(edit(text), {transfer, update});
        EXPECT_EQ(report.transfer.update, update);
        EXPECT_LT(20 * report.lost, report.pushed.changed + 1);
        double sum = 0.0;
        for (int y = 0; y < size; ++y) {
          for (int x = 0; x < size; ++x) {
            sum += static_cast<double>(
                degrees_between(map_of(usual).normal(x, y), map_of(d).normal(x, y)));
          }
        }
        EXPECT_LT(sum / (size * size), 0.15) << text << name_of(transfer) << name_of(update);
        EXPECT_GT(report.pushed.changed, 300U);
      }
    }
  }
}

}  // namespace
}  // namespace normalshop::test
