#include "document/edit_fixture.h"

#include "normalshop/core/error.h"
#include "normalshop/document/image_document.h"

namespace normalshop::test {
namespace {

constexpr int picture_side = 96;

/// A flat picture with one round bump of radius 6 at `place` (from the middle, y up): red, where
/// the rest is grey.
ImageDocument bump_at(const Vec2f& place, Border border = Border::Clamp) {
  ImageDocument::Images images;
  RawImage codes(picture_side, picture_side, 3, CodeType::F32);
  images.colors = ColorImage(picture_side, picture_side);
  for (int y = 0; y < picture_side; ++y) {
    for (int x = 0; x < picture_side; ++x) {
      const Vec2f p(static_cast<float>(x) - 0.5F * (picture_side - 1),
                    0.5F * (picture_side - 1) - static_cast<float>(y));
      const Vec2f d = (p - place) / 6.0F;
      const float fall = std::max(0.0F, 1.0F - d.squaredNorm());
      const Vec3f n = normal_from_slope(-1.5F * fall * d);
      for (int c = 0; c < 3; ++c) codes.row<float>(y)[3 * x + c] = n[c];
      images.colors(x, y) = Vec3f(0.3F + 0.7F * fall * fall, 0.3F, 0.3F);
    }
  }
  images.normals = NormalMap(std::move(codes), NormalConvention{.signed_float = true});
  images.border = border;
  return ImageDocument(std::move(images));
}

/// The middle of what is red.
Vec2f red_place(const ColorImage& colors) {
  Vec2f sum(0.0F, 0.0F);
  float weight = 0.0F;
  for (int y = 0; y < picture_side; ++y) {
    for (int x = 0; x < picture_side; ++x) {
      const float red = colors(x, y).x() - 0.3F;
      sum += red * Vec2f(static_cast<float>(x) - 0.5F * (picture_side - 1),
                         0.5F * (picture_side - 1) - static_cast<float>(y));
      weight += red;
    }
  }
  return sum / weight;
}

/// The same of the bump, by the steepness of its slopes.
Vec2f bump_place(const ImageDocument& document) {
  const PictureSlopes picture = slopes_of(document);
  Vec2f sum(0.0F, 0.0F);
  float weight = 0.0F;
  for (int y = 0; y < picture_side; ++y) {
    for (int x = 0; x < picture_side; ++x) {
      const float steep = picture.slopes(x, y).norm();
      sum += steep * Vec2f(static_cast<float>(x) - 0.5F * (picture_side - 1),
                           0.5F * (picture_side - 1) - static_cast<float>(y));
      weight += steep;
    }
  }
  return sum / weight;
}

/// The square [0, 1]^2 with the picture's normals and colours; a pixel is 1 / picture_side.
Document mesh_of(const ImageDocument& picture) {
  RawImage codes(picture_side, picture_side, 3, CodeType::F32);
  for (int y = 0; y < picture_side; ++y) {
    std::copy_n(picture.colors()(0, y).data(), 3 * picture_side, codes.row<float>(y));
  }
  std::vector<Document::Maps> maps;
  maps.push_back({picture.normals(), ColorMap(std::move(codes))});
  return {plane_grid(2), std::move(maps)};
}

ColorImage colors_of(const Document& mesh) {
  const RawImage codes = mesh.storage().sets.at(0).albedo.encode();
  ColorImage colors(codes.width(), codes.height());
  for (int y = 0; y < codes.height(); ++y) {
    std::copy_n(codes.row<float>(y), 3 * codes.width(), colors(0, y).data());
  }
  return colors;
}

/// What GrabMovesNormalsAndColoursTogether does, on mesh_of() a picture.
std::string grab_on_mesh(const std::string& more_options = "") {
  const auto point = [](double x, double y) {
    return "[" + std::to_string(x / picture_side) + ", " + std::to_string(y / picture_side) + "]";
  };
  return R"("operator": "warp", "view": "front", "options": {"kind": "grab", "radius": )" +
         std::to_string(34.0 / picture_side) + more_options + R"(}, "strokes": [[)" + point(-8, 4) +
         ", " + point(4, -4) + "]]";
}

std::string message_of(const std::string& fields) {
  try {
    bump_at({0.0F, 0.0F}).apply(edit(R"("operator": "warp", "view": "front", )" + fields));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no error";
}

TEST(WarpOperator, GrabMovesNormalsAndColoursTogether) {
  ImageDocument document = bump_at({-8.0F, 4.0F});
  document.apply(
      edit(R"("operator": "warp", "view": "front", "options": {"kind": "grab", "radius": 34},
                         "strokes": [[[-8, 4], [4, -4]]])"));
  EXPECT_LT((red_place(document.colors()) - Vec2f(4.0F, -4.0F)).norm(), 1.0F)
      << red_place(document.colors());
  EXPECT_LT((bump_place(document) - red_place(document.colors())).norm(), 1.0F)
      << bump_place(document);
}

TEST(WarpOperator, BeyondTheBrushNothingChanges) {
  ImageDocument document = bump_at({-8.0F, 4.0F});
  const ColorImage before = document.colors();
  document.apply(
      edit(R"("operator": "warp", "view": "front", "options": {"kind": "twirl", "radius": 12},
                         "strokes": [[[-8, 8]]])"));
  EXPECT_TRUE(document.normals().has_edits());
  for (int y = 0; y < picture_side; ++y) {
    for (int x = 0; x < picture_side; ++x) {
      const Vec2f p(static_cast<float>(x) - 0.5F * (picture_side - 1),
                    0.5F * (picture_side - 1) - static_cast<float>(y));
      if ((p - Vec2f(-8.0F, 8.0F)).norm() < 15.0F) continue;  // a cell of the lattice more
      EXPECT_FALSE(document.normals().edited(x, y)) << x << " " << y;
      EXPECT_EQ(document.colors()(x, y), before(x, y));
    }
  }
}

TEST(WarpOperator, PairsOfStrokesMoveWhatIsBetween) {
  ImageDocument document = bump_at({-8.0F, 0.0F});
  document.apply(edit(R"("operator": "warp", "view": "front", "strokes": [
      [[-40, -40], [40, -40], [40, 40], [-40, 40]],
      [[-8, -8], [-8, 8]], [[8, -8], [8, 8]]])"));
  EXPECT_LT((red_place(document.colors()) - Vec2f(8.0F, 0.0F)).norm(), 1.0F)
      << red_place(document.colors());
  EXPECT_LT((bump_place(document) - Vec2f(8.0F, 0.0F)).norm(), 1.0F) << bump_place(document);
  EXPECT_FALSE(document.normals().edited(3, 3));
}

TEST(WarpOperator, ATileIsWarpedAcrossItsSides) {
  ImageDocument document = bump_at({42.0F, 0.0F}, Border::Wrap);
  document.apply(
      edit(R"("operator": "warp", "view": "front", "options": {"kind": "grab", "radius": 30},
                         "strokes": [[[42, 0], [54, 0]]])"));
  // 54 is -42 of the next copy.
  const int row = picture_side / 2;
  EXPECT_GT(document.colors()(5, row).x(), 0.7F);
  EXPECT_LT(document.colors()(picture_side - 6, row).x(), 0.5F);
}

TEST(WarpOperator, MovesTheDetailsOfAMesh) {
  Document mesh = document(plane_grid(2), noise_map(64, CodeType::U16));
  const EditReport report = mesh.apply(edit(R"("operator": "warp", "view": "front",
      "options": {"kind": "pinch", "radius": 0.3}, "strokes": [[[0, 0]]])"));
  EXPECT_GT(report.pushed.changed, 500U);
  EXPECT_FALSE(map_of(mesh).edited(2, 2));
}

TEST(WarpOperator, ColoursOfAMeshMoveAsThoseOfAPicture) {
  ImageDocument picture = bump_at({-8.0F, 4.0F});
  Document mesh = mesh_of(picture);
  const EditReport moved = picture.apply(edit(
      R"("operator": "warp", "view": "front", "options": {"kind": "grab", "radius": 34},
         "strokes": [[[-8, 4], [4, -4]]])"));
  const EditReport report = mesh.apply(edit(grab_on_mesh()));
  const ColorImage colors = colors_of(mesh);
  EXPECT_LT((red_place(colors) - red_place(picture.colors())).norm(), 0.1F) << red_place(colors);
  for (int y = 0; y < picture_side; ++y) {
    for (int x = 0; x < picture_side; ++x) {
      ASSERT_LT((colors(x, y) - picture.colors()(x, y)).cwiseAbs().maxCoeff(), 0.02F)
          << x << " " << y;
    }
  }
  EXPECT_GT(report.colors_changed, 100U);
  EXPECT_GT(moved.colors_changed, 100U);
  EXPECT_LT(degrees_between(map_of(mesh).normal(50, 52), picture.normals().normal(50, 52)), 1.0F);
}

/// There is nothing beyond the border that could come in.
TEST(WarpOperator, OneColourStaysOneUpToTheBorder) {
  RawImage codes(64, 64, 3, CodeType::U8);
  std::fill_n(codes.data(), codes.size_bytes(), std::uint8_t{200});
  std::vector<Document::Maps> maps;
  maps.push_back({flat_normal_map(64, 64, CodeType::U8), ColorMap(std::move(codes))});
  Document mesh(plane_grid(2), std::move(maps));
  mesh.apply(edit(R"("operator": "warp",
      "view": {"direction": [0.3, 0.2, 1]}, "options": {"kind": "grab", "radius": 0.4},
      "strokes": [[[-0.4, 0], [-0.2, 0.1]]])"));
  const RawImage after = mesh.storage().sets[0].albedo.encode();
  for (std::size_t i = 0; i < after.size_bytes(); ++i) ASSERT_EQ(after.data()[i], 200) << i;
}

TEST(WarpOperator, ColoursStayWhereTheyAreOnRequest) {
  const ImageDocument picture = bump_at({-8.0F, 4.0F});
  Document mesh = mesh_of(picture);
  const EditReport report = mesh.apply(edit(grab_on_mesh(R"(, "colors": "stay")")));
  EXPECT_GT(report.pushed.changed, 100U);
  EXPECT_EQ(report.colors_changed, 0U);
  EXPECT_FALSE(mesh.storage().sets[0].albedo.has_edits());
}

TEST(WarpOperator, NeitherMovesWithoutStrength) {
  Document mesh = mesh_of(bump_at({-8.0F, 4.0F}));
  const EditReport report = mesh.apply(edit(grab_on_mesh() + R"(, "strength": 0)"));
  EXPECT_EQ(report.pushed.changed + report.colors_changed, 0U);
  EXPECT_FALSE(mesh.storage().sets[0].albedo.has_edits());
}

/// A column of red in the middle, pinched on one side and its mirror image.
TEST(WarpOperator, MirroredEditsMoveColoursOnBothSides) {
  Document mesh = mesh_of(bump_at({-20.0F, 4.0F}));
  mesh.apply(edit(R"("operator": "warp", "view": "front",
      "options": {"kind": "grab", "radius": 0.2}, "strokes": [[[0.28, 0.04], [0.2, 0.04]]],
      "mirror": {"axis": "x", "at": 0.5})"));
  // The bump at -20 is on the other side of the stroke: its image moved it by 8 pixels to the
  // middle.
  const Vec2f place = red_place(colors_of(mesh));
  EXPECT_GT(place.x(), -17.0F) << place;
  EXPECT_NEAR(place.y(), 4.0F, 0.5F);
}

TEST(WarpOperator, SaysWhatItNeeds) {
  EXPECT_NE(message_of(R"("options": {"kind": "push"}, "strokes": [[[0, 0], [1, 1]]])")
                .find("options.radius is missing; it must be a number above 0 for a brush"),
            std::string::npos);
  EXPECT_NE(message_of(R"("options": {"kind": "grab", "radius": 20}, "strokes": [[[0, 0]]])")
                .find("strokes[0] must have at least 2 points"),
            std::string::npos);
  EXPECT_NE(message_of(R"("strokes": [[[0, 0], [1, 1]]])").find("odd number of lists"),
            std::string::npos);
  const std::string folded =
      message_of(R"("options": {"kind": "grab", "radius": 12, "on_fold": "refuse"},
      "strokes": [[[-10, 0], [40, 0]]])");
  EXPECT_NE(folded.find("r.json: edits[0]: "), std::string::npos) << folded;
  // A pair whose target lies outside the outline.
  const std::string outside = message_of(R"("strokes": [
      [[-20, -20], [20, -20], [20, 20], [-20, 20]], [[0, 0]], [[30, 0]]])");
  EXPECT_NE(outside.find("r.json: edits[0]: "), std::string::npos) << outside;
}

}  // namespace
}  // namespace normalshop::test
