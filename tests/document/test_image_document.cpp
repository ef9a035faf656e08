#include "document/edit_fixture.h"
#include "support/same_codes.h"

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/document/image_document.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop::test {
namespace {

ImageDocument picture_of(NormalMap normals, Border border = Border::Clamp) {
  ImageDocument::Images images;
  images.normals = std::move(normals);
  images.border = border;
  return ImageDocument(std::move(images));
}

NormalMap flat(int width, int height) { return flat_normal_map(width, height, CodeType::U16); }

/// The map moved by (dx, dy) pixels; what leaves at one side enters at the other.
NormalMap rolled(const NormalMap& map, int dx, int dy) {
  const RawImage& from = map.codes();
  RawImage to(from.width(), from.height(), from.channels(), from.type());
  const auto size = static_cast<std::size_t>(from.channels() * RawImage::code_size(from.type()));
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < from.width(); ++x) {
      const int tx = (x + dx) % from.width();
      const int ty = (y + dy) % from.height();
      std::copy_n(from.row_data(y) + static_cast<std::size_t>(x) * size, size,
                  to.row_data(ty) + static_cast<std::size_t>(tx) * size);
    }
  }
  return {std::move(to), map.convention()};
}

std::string message_of(ImageDocument& document, const Edit& e) {
  try {
    document.apply(e);
  } catch (const InvalidInput& error) {
    EXPECT_FALSE(document.normals().has_edits());
    EXPECT_TRUE(document.log().empty());
    return error.what();
  }
  return "no error";
}

const std::string dot =
    R"("operator": "pen", "options": {"profile": "bump", "width": 9, "height": 3})";

TEST(ImageDocument, FiltersTheSlopesOfThePicture) {
  const NormalMap map = noise_map(64, CodeType::U16);
  ImageDocument document = picture_of(map);
  document.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 2.5})"));
  SlopeImage source(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) source(x, y) = slope_from_normal(map.normal(x, y));
  }
  SlopeImage smoothed(64, 64);
  SmoothOptions options;
  options.sigma = 2.5F;
  smooth(source, {}, smoothed, source.rect(), options);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec3f expected = normal_from_slope(smoothed(x, y));
      EXPECT_LT(angle_degrees(document.normals().normal(x, y), expected), 2e-4) << x << " " << y;
    }
  }
}

/// A dot in the middle of an odd and of an even side: the map mirrors in both.
TEST(ImageDocument, PointsCountFromTheMiddle) {
  for (const int width : {32, 33}) {
    for (const int height : {32, 35}) {
      ImageDocument document = picture_of(flat(width, height));
      const EditReport report =
          document.apply(edit(dot + R"(, "view": "front", "strokes": [[[0, 0]]])"));
      EXPECT_GT(report.pushed.changed, 40U);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const Vec3f here = document.normals().normal(x, y);
          const Vec3f there = document.normals().normal(width - 1 - x, height - 1 - y);
          EXPECT_LT((here - Vec3f(-there.x(), -there.y(), there.z())).norm(), 1e-5F)
              << width << " x " << height << " at " << x << " " << y;
        }
      }
    }
  }
}

/// y runs up: a dot above the middle changes upper rows; its upper half faces up, towards green.
TEST(ImageDocument, YRunsUp) {
  ImageDocument document = picture_of(flat(32, 32));
  document.apply(edit(dot + R"(, "view": "front", "strokes": [[[0, 8]]])"));
  EXPECT_GT(document.normals().normal(15, 5).y(), 0.1F);
  EXPECT_LT(document.normals().normal(15, 10).y(), -0.1F);
  EXPECT_FALSE(document.normals().edited(15, 24));
}

TEST(ImageDocument, APartOfThePictureIsAView) {
  ImageDocument whole = picture_of(flat(64, 64));
  ImageDocument part = picture_of(flat(64, 64));
  ImageDocument facing = picture_of(flat(64, 64));
  whole.apply(edit(dot + R"(, "view": "front", "strokes": [[[13, -9]]])"));
  part.apply(edit(dot + R"(, "view": {"direction": [0, 0, 2], "center": [10, -10, 0], "width": 20},
                            "strokes": [[[3, 1]]])"));
  facing.apply(
      edit(dot + R"(, "view": {"facing": [10, -10, 0], "width": 20}, "strokes": [[[3, 1]]])"));
  EXPECT_TRUE(same_codes(whole.normals().encode(), part.normals().encode()));
  EXPECT_TRUE(same_codes(whole.normals().encode(), facing.normals().encode()));
  EXPECT_TRUE(whole.normals().has_edits());
}

TEST(ImageDocument, WhatAnEditDoesNotReachKeepsItsCode) {
  ImageDocument document = picture_of(noise_map(96, CodeType::U8));
  document.apply(edit(dot + R"(, "view": "front", "strokes": [[[-20, 0], [20, 11]]])"));
  const RawImage after = document.normals().encode();
  int kept = 0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 96; ++x) {
      if (document.normals().edited(x, y)) continue;
      ++kept;
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(after.code(x, y, c), document.normals().codes().code(x, y, c));
    }
  }
  EXPECT_GT(kept, 96 * 96 / 2);
  EXPECT_LT(kept, 96 * 96 - 200);
}

TEST(ImageDocument, StrengthZeroChangesNothing) {
  ImageDocument document = picture_of(noise_map(32, CodeType::U8));
  document.apply(
      edit(R"("operator": "smooth", "view": "front", "strength": 0, "options": {"sigma": 3})"));
  EXPECT_FALSE(document.normals().has_edits());
  EXPECT_EQ(document.log().size(), 1U);
}

TEST(ImageDocument, IgnoredDetailsAreReplacedUnderAStroke) {
  ImageDocument noisy = picture_of(noise_map(64, CodeType::U16));
  ImageDocument smooth = picture_of(flat(64, 64));
  const Edit stroke = edit(R"("operator": "pen", "view": "front", "details": "ignore",
      "options": {"width": 24, "height": 2}, "strokes": [[[-20, 0], [20, 0]]])");
  noisy.apply(stroke);
  smooth.apply(stroke);
  for (int x = 16; x < 48; ++x) {
    EXPECT_LT(angle_degrees(noisy.normals().normal(x, 31), smooth.normals().normal(x, 31)), 1.0);
  }
}

TEST(ImageDocument, TheMaskWeighsTheEdit) {
  ImageDocument::Images images;
  images.normals = flat(32, 32);
  images.mask = MaskImage(32, 32, 1.0F);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 16; ++x) images.mask(x, y) = 0.0F;
  }
  ImageDocument document(std::move(images));
  document.apply(edit(dot + R"(, "view": "front", "strokes": [[[-10, 0], [10, 0]]])"));
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 16; ++x) EXPECT_FALSE(document.normals().edited(x, y));
  }
  EXPECT_TRUE(document.normals().edited(24, 13));
}

TEST(ImageDocument, PixelsWithoutANormalStayAndHarmNobody) {
  NormalMap map = noise_map(32, CodeType::U16);
  RawImage codes = map.codes();
  for (int c = 0; c < 3; ++c) codes.row<std::uint16_t>(16)[3 * 16 + c] = 32768;
  ImageDocument document = picture_of(NormalMap(codes, map.convention()));
  document.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 2})"));
  EXPECT_FALSE(document.normals().edited(16, 16));
  EXPECT_TRUE(document.normals().normal(17, 16).allFinite());
  EXPECT_TRUE(document.normals().edited(17, 16));
}

/// Editing a rolled tile is rolling an edited one: nothing marks where a tile begins.
TEST(ImageDocument, TilesStayTiles) {
  const NormalMap map = noise_map(64, CodeType::U16);
  const std::vector<std::pair<std::string, std::vector<Vec2f>>> edits{
      {R"("operator": "pen", "options": {"width": 9, "height": 2})", {{25, 3}, {38, 30}}},
      {R"("operator": "text", "options": {"text": "o", "size": 20, "height": 2, "bevel": 4})",
       {{30, -29}}}};
  for (const auto& each : edits) {
    const std::string& fields = each.first;
    const std::vector<Vec2f>& points = each.second;
    const auto at = [&](const Vec2f& by) {
      std::string text = fields + R"(, "view": "front", "strokes": [[)";
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec2f p = points[i] + by;
        text += (i > 0 ? ", [" : "[") + std::to_string(p.x()) + ", " + std::to_string(p.y()) + "]";
      }
      return edit(text + "]]");
    };
    ImageDocument here = picture_of(map, Border::Wrap);
    ImageDocument there = picture_of(rolled(map, 40, 24), Border::Wrap);
    here.apply(at({0, 0}));
    // The first point's place in the rolled tile.
    const auto inside = [](float v) { return v - 64.0F * std::round(v / 64.0F); };
    const Vec2f moved = points.front() + Vec2f(40.0F, -24.0F);
    there.apply(at(Vec2f(inside(moved.x()), inside(moved.y())) - points.front()));
    ASSERT_TRUE(here.normals().has_edits());
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const Vec3f a = here.normals().normal(x, y);
        const Vec3f b = there.normals().normal((x + 40) % 64, (y + 24) % 64);
        EXPECT_LT(angle_degrees(a, b), 1e-3) << fields << " at " << x << " " << y;
      }
    }
  }
}

/// The same for filters, which read beyond the sides.
TEST(ImageDocument, FiltersReadAcrossTheSidesOfTiles) {
  const NormalMap map = noise_map(64, CodeType::U16);
  for (const std::string fields :
       {R"("operator": "smooth", "options": {"sigma": 3})",
        R"("operator": "smooth", "options": {"sigma": 9})",
        R"("operator": "sharpen", "options": {"sigma": 2, "amount": 1})",
        R"("operator": "filter", "options": {"kind": "band_pass", "sigma": 5, "noise_sigma": 1})",
        R"("operator": "denoise", "options": {"sigma": 3, "sigma_normal": 1})",
        R"("operator": "denoise",
           "options": {"method": "bilateral", "sigma": 4, "sigma_normal": 1})",
        R"("operator": "denoise",
           "options": {"method": "transform", "sigma": 4, "sigma_normal": 1})",
        R"("operator": "project")"}) {
    const Edit e = edit(fields + R"(, "view": "front")");
    ImageDocument here = picture_of(map, Border::Wrap);
    ImageDocument there = picture_of(rolled(map, 40, 24), Border::Wrap);
    here.apply(e);
    there.apply(e);
    double worst = 0.0;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const Vec3f a = here.normals().normal(x, y);
        const Vec3f b = there.normals().normal((x + 40) % 64, (y + 24) % 64);
        worst = std::max(worst, angle_degrees(a, b));
      }
    }
    EXPECT_LT(worst, 0.02) << fields;
  }
}

/// What lies beyond the reach of an edit does not matter, so that a small window serves.
TEST(ImageDocument, FarPixelsDoNotMatter) {
  const Edit brush = edit(R"("operator": "smooth", "view": "front",
      "options": {"sigma": 2, "area": "brush", "brush": 12}, "strokes": [[[-5, 0], [5, 4]]])");
  ImageDocument small = picture_of(noise_map(64, CodeType::U16));
  NormalMap large_map = flat(192, 192);
  RawImage codes = large_map.codes();
  const RawImage& middle = small.normals().codes();
  for (int y = 0; y < 64; ++y) {
    std::copy_n(middle.row<std::uint16_t>(y), 64 * 3, codes.row<std::uint16_t>(64 + y) + 64 * 3);
  }
  ImageDocument large = picture_of(NormalMap(std::move(codes), small.normals().convention()));
  small.apply(brush);
  const EditReport report = large.apply(brush);
  EXPECT_LT(report.chart_width, 64);
  EXPECT_EQ(small.normals().edited_count(), large.normals().edited_count());
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(small.normals().normal(x, y), large.normals().normal(64 + x, 64 + y));
    }
  }
}

TEST(ImageDocument, RefusesWhatIsNotInThePicture) {
  ImageDocument document = picture_of(flat(32, 32));
  EXPECT_EQ(message_of(document, edit(dot + R"(, "view": "back", "strokes": [[[0, 0]]])")),
            "r.json: edits[0].view must look at a picture from the front: \"front\" or "
            "\"surface\", or an object "
            "with \"facing\", or with the \"direction\" [0, 0, 1] and the \"up\" [0, 1, 0]");
  EXPECT_NE(message_of(document, edit(dot + R"(, "view": {"direction": [1, 0, 1]},
                                             "strokes": [[[0, 0]]])"))
                .find("from the front"),
            std::string::npos);
  const std::string beside =
      message_of(document, edit(dot + R"(, "view": "front", "strokes": [[[0, 0]], [[40, 2]]])"));
  EXPECT_NE(beside.find("edits[0].strokes[1] lies off the surface"), std::string::npos) << beside;
  EXPECT_NE(beside.find("x -16 to 16, y -16 to 16"), std::string::npos) << beside;
}

TEST(ImageDocument, RefusesPicturesThatDoNotFit) {
  ImageDocument::Images colors;
  colors.normals = flat(8, 8);
  colors.colors = ColorImage(8, 9, Vec3f::Zero());
  EXPECT_THROW(ImageDocument{std::move(colors)}, InvalidInput);
  ImageDocument::Images mask;
  mask.normals = flat(8, 8);
  mask.mask = MaskImage(7, 8, 1.0F);
  EXPECT_THROW(ImageDocument{std::move(mask)}, InvalidInput);
  ImageDocument::Images object;
  object.normals = NormalMap(flat(8, 8).codes(), NormalConvention{.space = NormalSpace::Object});
  EXPECT_THROW(ImageDocument{std::move(object)}, InvalidInput);
  EXPECT_THROW(ImageDocument{ImageDocument::Images{}}, InvalidInput);
}

TEST(ImageDocument, OnePixelIsAPicture) {
  ImageDocument document = picture_of(flat(1, 1), Border::Wrap);
  document.apply(edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 3})"));
  document.apply(edit(dot + R"(, "view": "front", "strokes": [[[0, 0]]])"));
  EXPECT_TRUE(document.normals().normal(0, 0).allFinite());
}

}  // namespace
}  // namespace normalshop::test
