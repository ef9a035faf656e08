#include "document/edit_fixture.h"
#include "document/picture_fixture.h"

#include "normalshop/document/live_edit.h"

/// Edits that arrive by the angle of the normals that were there (thesis, fig. 5.17).
namespace normalshop::test {
namespace {

constexpr int groove_texels = 96;

/// Grooves along y on the plane: normals lean by up to 50 degrees to both sides of x.
NormalMap grooves() {
  NormalMap map = flat_normal_map(groove_texels, groove_texels, CodeType::F32);
  for (int y = 0; y < groove_texels; ++y) {
    for (int x = 0; x < groove_texels; ++x) {
      const float lean = 0.87F * std::sin(0.1F * static_cast<float>(x));
      map.set_normal(x, y, Vec3f(std::sin(lean), 0.0F, std::cos(lean)));
    }
  }
  return {map.encode(), map.convention()};
}

/// Leans all normals.
std::string tilt(const std::string& more) {
  return R"("operator": "combine", "view": "front", "options": {"image": "slanted.png",
            "size": 5, "repeat": true})" +
         more;
}

/// check(angle that the normal had, part of a plain edit's change that has arrived)
template <class Check>
void for_parts(const NormalMap& before, const NormalMap& plain, const NormalMap& sprayed,
               const Check& check) {
  const int margin = groove_texels / 4;  // the whole view fades towards its sides
  for (int y = margin; y < groove_texels - margin; ++y) {
    for (int x = margin; x < groove_texels - margin; ++x) {
      const Vec2f slope = slope_from_normal(before.normal(x, y));
      const float whole = (slope_from_normal(plain.normal(x, y)) - slope).norm();
      ASSERT_GT(whole, 0.01F);
      check(degrees_between(before.normal(x, y), Vec3f::UnitZ()),
            (slope_from_normal(sprayed.normal(x, y)) - slope).norm() / whole);
    }
  }
}

void expect_sprayed(const NormalMap& before, const NormalMap& plain, const NormalMap& sprayed) {
  int partly = 0;
  for_parts(before, plain, sprayed, [&](float angle, float part) {
    if (angle < 10.0F) {
      EXPECT_NEAR(part, 1.0F, 0.02F);
    }
    if (angle > 40.0F) {
      EXPECT_LT(part, 0.02F);
    }
    partly += part > 0.2F && part < 0.8F ? 1 : 0;
  });
  EXPECT_GT(partly, 20) << "it fades between";
}

const char* const spray = R"(, "spray": {"full": 15, "zero": 35})";

TEST(Spray, ArrivesWhereDetailsFaceTheViewer) {
  Document plain = document(plane_grid(2), grooves());
  const Document before = plain;
  Document sprayed = before;
  plain.apply(edit(tilt("")));
  sprayed.apply(edit(tilt(spray)));
  expect_sprayed(map_of(before), map_of(plain), map_of(sprayed));
}

TEST(Spray, OfWideAnglesIsTheEdit) {
  Document plain = document(plane_grid(2), grooves());
  Document sprayed = plain;
  plain.apply(edit(tilt("")));
  sprayed.apply(edit(tilt(R"(, "spray": {"full": 80, "zero": 90})")));
  for (int x = 0; x < groove_texels; ++x) {
    EXPECT_EQ(map_of(plain).normal(x, 40), map_of(sprayed).normal(x, 40));
  }
}

TEST(Spray, IsThatOfADrawnStroke) {
  const Edit pen = edit(
      R"("operator": "pen", "view": "front", "window": "view",
         "options": {"width": 0.3, "height": 0.05}, "strokes": [[[-0.3, 0], [0.3, 0.1]]])" +
      std::string(spray));
  Document applied = document(plane_grid(2), grooves());
  Document drawn = applied;
  applied.apply(pen);
  Edit begun = pen;
  begun.strokes.clear();
  const auto live = drawn.begin(begun);
  live->draw(pen.strokes);
  live->finish();
  std::size_t edited = 0;
  for (int y = 0; y < groove_texels; ++y) {
    for (int x = 0; x < groove_texels; ++x) {
      ASSERT_EQ(map_of(drawn).vector(x, y), map_of(applied).vector(x, y));
      edited += map_of(drawn).edited(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(edited, 100U);
}

TEST(Spray, ArrivesSoOnAPicture) {
  const auto picture_of_grooves = [] {
    ImageDocument::Images images;
    images.normals = grooves();
    return ImageDocument(std::move(images));
  };
  const ImageDocument before = picture_of_grooves();
  ImageDocument plain = picture_of_grooves();
  ImageDocument sprayed = picture_of_grooves();
  const std::string fields = R"("operator": "combine", "view": "front",
      "options": {"image": "slanted.png", "size": 480, "repeat": true})";
  plain.apply(edit(fields));
  sprayed.apply(edit(fields + spray));
  expect_sprayed(before.normals(), plain.normals(), sprayed.normals());
}

}  // namespace
}  // namespace normalshop::test
