#include "document/picture_fixture.h"
#include "support/tile.h"

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"

/// Areas that strokes pick in what is there: segments, and what is alike.
namespace normalshop::test {
namespace {

constexpr int picture_width = 96;
constexpr int picture_height = 64;

/// A disc around a pixel that tilts to the right, on ground that is level; both a little rough.
SlopeImage disc_slopes(int column, int row) {
  SlopeImage slopes(picture_width, picture_height);
  for (int y = 0; y < picture_height; ++y) {
    for (int x = 0; x < picture_width; ++x) {
      const Vec2i way = way_in_tile({column, row}, {x, y}, picture_width, picture_height);
      const int u = way.x();
      const int v = way.y();
      const float rough = 0.01F * static_cast<float>((u * 7 + v * 3) % 5);
      slopes(x, y) = {u * u + v * v < 256 ? 0.6F : 0.0F, rough};
    }
  }
  return slopes;
}

/// Blue to the left of the middle column, red to the right.
ColorImage two_colors() {
  ColorImage colors(picture_width, picture_height);
  for (int y = 0; y < picture_height; ++y) {
    for (int x = 0; x < picture_width; ++x) {
      colors(x, y) = x < picture_width / 2 ? Vec3f(0.1F, 0.1F, 0.6F) : Vec3f(0.6F, 0.1F, 0.1F);
    }
  }
  return colors;
}

ImageDocument colored(SlopeView slopes) {
  const ImageDocument plain = picture(slopes);
  ImageDocument::Images images;
  images.normals = plain.normals();
  images.colors = two_colors();
  return ImageDocument(std::move(images));
}

/// Flattens to the slope (-1, 0), so that what is picked is seen.
Edit mark(const std::string& area, const std::string& strokes, const std::string& more = "") {
  return edit(R"("operator": "flatten", "view": "front", "options": {"slope_x": -1, "area": ")" +
              area + "\"" + more + R"(}, "strokes": )" + strokes);
}

/// 0 where nothing has changed, 1 where the mark is at full strength.
float marked(const ImageDocument& document, SlopeView before, int x, int y) {
  const Vec2f after = slope_from_normal(document.normals().normal(x, y));
  return (after.x() - before(x, y).x()) / (-1.0F - before(x, y).x());
}

class PickedAreas : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Both, PickedAreas, testing::Values("segments", "alike"));

TEST_P(PickedAreas, AreWhatThePointLiesIn) {
  const SlopeImage slopes = disc_slopes(60, 30);
  ImageDocument document = picture(slopes);
  // Pixel (60, 30) from the picture's middle, y up.
  document.apply(mark(GetParam(), "[[[12.5, 1.5]]]"));
  for (int y = 0; y < picture_height; ++y) {
    for (int x = 0; x < picture_width; ++x) {
      const float distance =
          std::hypot(static_cast<float>(x) - 60.0F, static_cast<float>(y) - 30.0F);
      const float share = marked(document, slopes, x, y);
      if (distance < 13.0F) {
        ASSERT_NEAR(share, 1.0F, 1e-5F) << x << ", " << y;
      }
      if (distance > 19.0F) {
        ASSERT_FALSE(document.normals().edited(x, y)) << x << ", " << y;
      }
    }
  }
}

TEST_P(PickedAreas, FadeOverTheFeather) {
  const SlopeImage slopes = disc_slopes(48, 32);
  ImageDocument document = picture(slopes);
  document.apply(mark(GetParam(), "[[[0, 0]]]", R"(, "feather": 12)"));
  // Its border lies near column 64.
  float before = 1.0F;
  for (int x = 54; x < 74; ++x) {
    const float share = marked(document, slopes, x, 32);
    EXPECT_LE(share, before + 1e-5F) << x;
    EXPECT_LT(before - share, 0.25F) << x;
    before = share;
  }
  EXPECT_NEAR(marked(document, slopes, 63, 32), 0.5F, 0.2F);
}

TEST_P(PickedAreas, GoOnBeyondTheSidesOfATile) {
  const std::string feather = R"(, "feather": 8)";
  const SlopeImage slopes = disc_slopes(0, 0);
  ImageDocument tile = picture(slopes, Border::Wrap);
  tile.apply(mark(GetParam(), "[[[-47.5, 31.5]]]", feather));
  const SlopeImage whole = disc_slopes(48, 32);
  ImageDocument middle = picture(whole, Border::Wrap);
  middle.apply(mark(GetParam(), "[[[0.5, -0.5]]]", feather));
  for (int y = 0; y < picture_height; ++y) {
    for (int x = 0; x < picture_width; ++x) {
      ASSERT_NEAR(marked(tile, slopes, x, y),
                  marked(middle, whole, (x + 48) % picture_width, (y + 32) % picture_height), 1e-5F)
          << x << ", " << y;
    }
  }
  EXPECT_NEAR(marked(tile, slopes, 90, 60), 1.0F, 1e-5F);
}

TEST_P(PickedAreas, SeeDetailsThatTheEditIgnores) {
  const SlopeImage slopes = disc_slopes(60, 30);
  ImageDocument document = picture(slopes);
  document.apply(edit(R"("operator": "smooth", "view": "front", "details": "ignore",
                         "options": {"sigma": 1, "area": ")" +
                      std::string(GetParam()) + R"("}, "strokes": [[[12.5, 1.5]]])"));
  EXPECT_LT(slope_from_normal(document.normals().normal(60, 30)).norm(), 1e-5F);
  EXPECT_FALSE(document.normals().edited(20, 10));
}

/// A part of the picture is divided by itself, however far the operator reads beyond it.
TEST_P(PickedAreas, DependOnTheViewAlone) {
  const SlopeImage slopes = disc_slopes(60, 30);
  std::vector<std::vector<bool>> changed;
  for (const char* sigma : {"1", "9"}) {
    ImageDocument document = picture(slopes);
    document.apply(edit(R"("operator": "smooth", "view": {"facing": [6, -8, 0], "width": 30},
                           "options": {"sigma": )" +
                        std::string(sigma) + R"(, "area": ")" + GetParam() +
                        R"("}, "strokes": [[[4, 8]]])"));
    changed.emplace_back();
    for (int y = 0; y < picture_height; ++y) {
      for (int x = 0; x < picture_width; ++x) {
        changed.back().push_back(document.normals().edited(x, y));
      }
    }
    EXPECT_GT(document.normals().edited_count(), 50U);
  }
  // Beside the disc's border, where a wider Gaussian changes what a narrow one does not, they
  // differ.
  int apart = 0;
  for (std::size_t i = 0; i < changed[0].size(); ++i) apart += changed[0][i] && !changed[1][i];
  EXPECT_EQ(apart, 0);
  ImageDocument beside = picture(slopes);
  EXPECT_THROW(
      beside.apply(edit(R"("operator": "smooth", "view": {"facing": [6, -8, 0], "width": 30},
                           "options": {"sigma": 9, "area": ")" +
                        std::string(GetParam()) + R"("}, "strokes": [[[-20, 0]]])")),
      InvalidInput);
}

/// Segments have none that are so small.
TEST(PickedAlike, HolesCloseUnderTheFeather) {
  SlopeImage slopes = disc_slopes(48, 32);
  for (const int x : {44, 48, 52}) slopes(x, 32) = {-3.0F, 0.0F};
  ImageDocument document = picture(slopes);
  document.apply(mark("alike", "[[[0.5, 4.5]]]", R"(, "feather": 16)"));
  EXPECT_NEAR(marked(document, slopes, 48, 30), 1.0F, 1e-4F);
}

TEST_P(PickedAreas, AreTheSameOnOneThread) {
  const SlopeImage slopes = disc_slopes(60, 30);
  ImageDocument many = picture(slopes);
  many.apply(mark(GetParam(), "[[[12.5, 1.5]], [[-30, -20], [-20, -18]]]", R"(, "feather": 7)"));
  ImageDocument one = picture(slopes);
  {
    const ThreadLimit limit(1);
    one.apply(mark(GetParam(), "[[[12.5, 1.5]], [[-30, -20], [-20, -18]]]", R"(, "feather": 7)"));
  }
  EXPECT_EQ(farthest(one, slopes_of(many).slopes), 0.0F);
}

TEST_P(PickedAreas, TakeAnyFeather) {
  ImageDocument document = picture(disc_slopes(60, 30), Border::Wrap);
  document.apply(mark(GetParam(), "[[[12.5, 1.5]]]", R"(, "feather": 1e6)"));
  EXPECT_GT(document.normals().edited_count(), 300U);
}

TEST_P(PickedAreas, LieOnTheSurface) {
  ImageDocument document = picture(disc_slopes(60, 30));
  try {
    document.apply(mark(GetParam(), "[[[200, 0]]]"));
    FAIL() << "a point beside the picture was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("strokes[0]"), std::string::npos) << error.what();
  }
  EXPECT_EQ(document.normals().edited_count(), 0U);
}

TEST_P(PickedAreas, NeedStrokes) { EXPECT_THROW(mark(GetParam(), "[]"), InvalidInput); }

TEST(PickedByColor, ColorsDivideWhatNormalsDoNot) {
  const SlopeImage level(picture_width, picture_height, Vec2f(0.1F, 0.0F));
  for (const char* area : {"segments", "alike"}) {
    ImageDocument document = colored(level);
    document.apply(mark(area, "[[[-20, 0]]]"));
    EXPECT_NEAR(marked(document, level, 10, 30), 1.0F, 1e-5F) << area;
    EXPECT_FALSE(document.normals().edited(52, 30)) << area;
  }
  ImageDocument blind = colored(level);
  blind.apply(mark("segments", "[[[-20, 0]]]", R"(, "color_weight": 0)"));
  EXPECT_NEAR(marked(blind, level, 80, 30), 1.0F, 1e-5F);
  ImageDocument tolerant = colored(level);
  tolerant.apply(mark("alike", "[[[-20, 0]]]", R"(, "color_tolerance": 2)"));
  EXPECT_NEAR(marked(tolerant, level, 80, 30), 1.0F, 1e-5F);
}

TEST(PickedByColor, StrokesPickAllThatTheyTouch) {
  const SlopeImage level(picture_width, picture_height, Vec2f(0.1F, 0.0F));
  ImageDocument document = colored(level);
  document.apply(mark("segments", "[[[-20, 0], [20, 5]]]"));
  EXPECT_NEAR(marked(document, level, 10, 30), 1.0F, 1e-5F);
  EXPECT_NEAR(marked(document, level, 80, 30), 1.0F, 1e-5F);
}

TEST(PickedByColor, WhatDoesNotReadPicksToo) {
  const SlopeImage level(picture_width, picture_height, Vec2f(0.1F, 0.0F));
  ImageDocument document = colored(level);
  document.apply(edit(R"("operator": "combine", "view": "front", "strokes": [[[-20, 0]]],
                         "options": {"image": "wave.png", "area": "alike"})"));
  EXPECT_TRUE(document.normals().edited(10, 30));
  EXPECT_FALSE(document.normals().edited(60, 30));
}

/// Where all is picked, what only lays something down does what it does everywhere, on steep
/// surface, too.
TEST(PickedOnAMesh, TakesNothingElseThanTheView) {
  const std::string start = R"("operator": "combine", "view": "front", "options": {
      "image": "wave.png", "repeat": true, "size": 0.3)";
  Document whole = hemisphere_document(128);
  whole.apply(edit(start + "}"));
  Document picked = hemisphere_document(128);
  picked.apply(
      edit(start + R"(, "area": "alike", "angle_tolerance": 180}, "strokes": [[[0, 0]]])"));
  std::size_t changed = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      if (!picked.storage().sets[0].normals.edited(x, y)) continue;
      ++changed;
      // Towards the rim, where hardly anything arrives, what is picked ends softly.
      EXPECT_LT(degrees_between(map_of(picked).normal(x, y), map_of(whole).normal(x, y)), 0.02F)
          << x << ", " << y;
    }
  }
  EXPECT_GT(changed, 3000U);
}

/// On a mesh the colours come from its colour map: the right half of the square is bright.
TEST(PickedOnAMesh, ColorsOfTheMapCount) {
  for (const char* area : {"segments", "alike"}) {
    RawImage codes(64, 64, 1, CodeType::U8);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) codes.row<std::uint8_t>(y)[x] = x < 32 ? 40 : 200;
    }
    std::vector<Document::Maps> maps;
    maps.push_back({flat_normal_map(128, 128, CodeType::U16), ColorMap(std::move(codes))});
    Document d(plane_grid(2), std::move(maps));
    d.apply(mark(area, "[[[0.3, 0]]]"));
    EXPECT_TRUE(map_of(d).edited(100, 64)) << area;
    EXPECT_FALSE(map_of(d).edited(58, 64)) << area;
    EXPECT_FALSE(map_of(d).edited(20, 100)) << area;
  }
}

}  // namespace
}  // namespace normalshop::test
