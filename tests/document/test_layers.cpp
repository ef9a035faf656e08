#include "document/stored_document.h"

#include "normalshop/core/error.h"
#include "normalshop/document/layer_blend.h"
#include "normalshop/document/live_edit.h"

/// Layers of a document on file, and edits that change after they were made.
namespace normalshop::test {
namespace {

class LayersTest : public StoredSquare {
 protected:
  static Document with(const std::vector<Edit>& edits) {
    Document document = imported();
    for (const Edit& e : edits) document.apply(e);
    return document;
  }
  static Edit smooth() {
    return edit(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.02})");
  }
  static Edit first() { return pen("[-0.4, 0.4], [-0.1, 0.1]"); }
  static Edit second() { return pen("[-0.4, 0.1], [-0.1, 0.4]"); }
  /// Adds a layer, which edits then go to. Its number.
  static std::int64_t add_layer(Document& document) {
    document.change({.step = StackStep::AddLayer});
    return document.active_layer();
  }
  /// `expected`, at once and after closing.
  void expect_shows(Document& document, const Document& expected, const char* what) const {
    EXPECT_TRUE(same_maps(document, expected)) << what;
    document = Document({}, {});
    document = open();
    EXPECT_TRUE(same_maps(document, expected)) << what << ", after opening";
    EXPECT_EQ(document.file()->check(), std::vector<std::string>()) << what;
  }
};

TEST_F(LayersTest, AnUpperOneStandsOnTheLowerOne) {
  Document document = open();
  document.apply(first());
  const std::int64_t upper = add_layer(document);
  EXPECT_EQ(upper, 2);
  document.apply(smooth());
  expect_shows(document, with({first(), smooth()}), "one on the other");
  ASSERT_EQ(document.stack().layers.size(), 2U);
  EXPECT_EQ(document.stack().layers[1].edits.size(), 1U);
  EXPECT_EQ(document.log().size(), 2U);
}

TEST_F(LayersTest, AnEditOfTheLowerOneMakesTheUpperOneAnew) {
  Document document = open();
  document.apply(first());
  add_layer(document);
  document.apply(smooth());
  document.choose_layer(first_layer);
  Document alone = with({first()});
  EXPECT_EQ(document.apply(second()).pushed.changed, alone.apply(second()).pushed.changed);
  expect_shows(document, with({first(), second(), smooth()}), "below");
  EXPECT_TRUE(document.undo());
  expect_shows(document, with({first(), smooth()}), "undone");
  EXPECT_TRUE(document.redo());
  expect_shows(document, with({first(), second(), smooth()}), "redone");
}

TEST_F(LayersTest, AreHiddenAndShown) {
  Document document = open();
  document.apply(first());
  const std::int64_t upper = add_layer(document);
  document.apply(smooth());
  document.change({.step = StackStep::SetLayer, .target = upper, .hidden = true});
  expect_shows(document, with({first()}), "hidden");
  EXPECT_EQ(document.active_layer(), first_layer);
  document.choose_layer(upper);
  EXPECT_THROW(document.apply(second()), InvalidInput) << "it would not be seen";
  document.change({.step = StackStep::SetLayer, .target = upper, .hidden = false});
  expect_shows(document, with({first(), smooth()}), "shown");
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  expect_shows(document, with({first()}), "all undone");
}

/// In tangent space: slopes, as they are mixed.
Vec2f slopes_at(const Document& document, int x, int y) {
  return slope_from_normal(map_of(document).normal(x, y));
}

TEST_F(LayersTest, OpacityMixesSlopes) {
  Document document = open();
  document.apply(first());
  const std::int64_t upper = add_layer(document);
  document.change({.step = StackStep::SetLayer, .target = upper, .opacity = 0.25F});
  document.apply(second());
  const Document below = with({first()});
  const Document whole = with({first(), second()});
  float largest = 0.0F;
  float most = 0.0F;
  for (int y = 0; y < map_side; ++y) {
    for (int x = 0; x < map_side; ++x) {
      const Vec2f a = slopes_at(below, x, y);
      const Vec2f b = slopes_at(whole, x, y);
      const Vec2f expected = 0.75F * a + 0.25F * b;
      largest = std::max(largest, (slopes_at(document, x, y) - expected).norm());
      most = std::max(most, (b - a).norm());
    }
  }
  EXPECT_GT(most, 0.3F);
  EXPECT_LT(largest, 1e-5F);
  const NormalMap shown = map_of(document);
  document = Document({}, {});
  document = open();
  EXPECT_TRUE(same_codes(map_of(document).encode(), shown.encode())) << "after opening";
  document.change({.step = StackStep::SetLayer, .target = upper, .opacity = 1.0F});
  expect_shows(document, whole, "whole");
  document.change({.step = StackStep::SetLayer, .target = upper, .opacity = 0.0F});
  for (int i = 0; i < map_side * map_side; ++i) {
    const int x = i % map_side;
    const int y = i / map_side;
    ASSERT_LT(degrees_between(map_of(document).normal(x, y), map_of(below).normal(x, y)), 1e-4F);
  }
}

TEST_F(LayersTest, DrawingInOneThatIsMixedIsApplying) {
  const Edit stroke = second();
  Document document = open();
  const std::int64_t upper = add_layer(document);
  document.change({.step = StackStep::SetLayer, .target = upper, .opacity = 0.5F});
  document.apply(stroke);
  const NormalMap applied = map_of(document);
  document.undo();
  const auto live = document.begin(stroke);
  live->draw(stroke.strokes);
  live->finish();
  // The window of a drawn edit is the view, which its pixels follow.
  float largest = 0.0F;
  for (int i = 0; i < map_side * map_side; ++i) {
    const int x = i % map_side;
    const int y = i / map_side;
    largest =
        std::max(largest, degrees_between(map_of(document).normal(x, y), applied.normal(x, y)));
  }
  EXPECT_LT(largest, 1.0F);
  EXPECT_GT(map_of(document).edited_count(), 50U);
}

TEST_F(LayersTest, ChangePlacesAreMergedCopiedAndRemoved) {
  Document document = open();
  document.apply(first());
  const std::int64_t upper = add_layer(document);
  document.apply(smooth());
  document.change({.step = StackStep::MoveLayer, .target = upper, .place = 0});
  expect_shows(document, with({smooth(), first()}), "moved");
  document.change({.step = StackStep::Merge, .target = first_layer});
  expect_shows(document, with({smooth(), first()}), "merged");
  ASSERT_EQ(document.stack().layers.size(), 1U);
  EXPECT_EQ(document.stack().layers[0].edits.size(), 2U);
  document.change({.step = StackStep::Duplicate, .target = upper});
  expect_shows(document, with({smooth(), first(), smooth(), first()}), "copied");
  const std::int64_t copy = document.stack().layers[1].id;
  document.change({.step = StackStep::Disable, .target = document.stack().layers[1].edits[0].id});
  expect_shows(document, with({smooth(), first(), first()}), "an edit of the copy disabled");
  document.change({.step = StackStep::Remove, .target = upper});
  expect_shows(document, with({first()}), "removed");
  EXPECT_EQ(document.active_layer(), copy);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(document.undo());
  expect_shows(document, with({first(), smooth()}), "as before all that");
}

TEST_F(LayersTest, EditsAreLeftOutAndTakenInAgain) {
  const std::vector<Edit> edits = some_edits();
  Document document = open();
  for (const Edit& e : edits) document.apply(e);
  document.change({.step = StackStep::Disable, .target = 2});
  expect_shows(document, with({edits[0], edits[2]}), "without the one that moves colours");
  EXPECT_FALSE(document.storage().sets[0].albedo.has_edits());
  document.change({.step = StackStep::Enable, .target = 2});
  expect_shows(document, with(edits), "with it");
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  expect_shows(document, with(edits), "as before");
}

TEST_F(LayersTest, EditsGetOtherOptions) {
  const std::vector<Edit> edits = some_edits();
  Document document = open();
  for (const Edit& e : edits) document.apply(e);
  document.change_edit(1, second());
  expect_shows(document, with({second(), edits[1], edits[2]}), "another stroke");
  document.change_edit(3, first());
  expect_shows(document, with({second(), edits[1], first()}), "and another last one");
  EXPECT_EQ(document.log().back().strokes.at(0).at(1).position,
            first().strokes.at(0).at(1).position);
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  expect_shows(document, with(edits), "as before");
}

TEST_F(LayersTest, WhatCannotBeChangesNothing) {
  Document document = open();
  document.apply(first());
  const std::int64_t upper = add_layer(document);
  document.apply(smooth());
  const EditStack stack = document.stack();
  EXPECT_THROW(document.change_edit(1, pen("[3, 3], [4, 4]")), InvalidInput);
  EXPECT_THROW(document.change({.step = StackStep::Disable, .target = 7}), InvalidInput);
  EXPECT_THROW(document.change({.step = StackStep::Remove, .target = 7}), InvalidInput);
  EXPECT_THROW(document.change({.step = StackStep::Merge, .target = first_layer}), InvalidInput);
  EXPECT_THROW(document.change({.step = StackStep::MoveLayer, .target = upper, .place = 2}),
               InvalidInput);
  EXPECT_THROW(document.choose_layer(9), InvalidInput);
  EXPECT_THROW(document.jump(99), InvalidInput);
  Progress cancel;
  cancel.report = [](double, std::string_view) { return false; };
  EXPECT_THROW(document.change({.step = StackStep::MoveLayer, .target = upper, .place = 0}, cancel),
               Cancelled);
  EXPECT_EQ(document.stack(), stack);
  expect_shows(document, with({first(), smooth()}), "untouched");
  EXPECT_EQ(document.file()->history().size(), 3U);
}

TEST_F(LayersTest, EveryBranchCanBeGoneTo) {
  Document document = open();
  document.apply(first());   // 1
  document.apply(second());  // 2
  document.undo();
  document.apply(smooth());  // 3, on 1
  add_layer(document);       // 4
  document.apply(second());  // 5
  document.jump(2);
  expect_shows(document, with({first(), second()}), "the branch that was left");
  EXPECT_EQ(document.stack().layers.size(), 1U);
  EXPECT_FALSE(document.redo());
  document.jump(5);
  expect_shows(document, with({first(), smooth(), second()}), "the other");
  document.jump(std::nullopt);
  expect_shows(document, imported(), "the beginning");
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(document.redo());
  expect_shows(document, with({first(), smooth(), second()}), "redo goes where undo came from");
  EXPECT_EQ(document.file()->all_steps().size(), 5U);
}

TEST(LayerBlend, TurnsOrMixes) {
  const Vec3f up = Vec3f::UnitZ();
  const Vec3f tilted = normal_from_slope({1.0F, 0.0F});
  const auto blend = [&](float opacity, LayerBlend kind) {
    return blend_normals(up, tilted, opacity, kind, NormalSpace::Tangent);
  };
  EXPECT_LT((blend(0.5F, LayerBlend::Linear) - normal_from_slope({0.5F, 0.0F})).norm(), 1e-6F);
  EXPECT_NEAR(degrees_between(blend(0.5F, LayerBlend::Rotation), up), 22.5F, 1e-3F);
  EXPECT_NEAR(degrees_between(blend(1.0F, LayerBlend::Rotation), tilted), 0.0F, 1e-3F);
  const Vec3f down = -up;
  EXPECT_EQ(blend_normals(up, down, 0.25F, LayerBlend::Rotation, NormalSpace::Object), up);
}

TEST(EditStack, NamesCopiesOfEdits) {
  EditStack stack;
  stack.take({}, 1);
  stack.take({.step = StackStep::Duplicate}, 2);
  const std::int64_t copy = stack.layers.at(1).edits.at(0).id;
  EXPECT_EQ(edit_text(copy), "2.1");
  EXPECT_EQ(edit_from_text("2.1"), copy);
  EXPECT_EQ(edit_from_text("12"), 12);
  for (const char* wrong : {"", "x", "0", "-1", "1.", "1.0", ".1", "99999999999", "1.2.3"}) {
    EXPECT_FALSE(edit_from_text(wrong)) << wrong;
  }
}

TEST(EditStack, DoesNotGrowWithoutEnd) {
  EditStack stack;
  stack.take({}, 1);
  const auto twice = [&](std::int64_t step) {
    stack.take({.step = StackStep::Duplicate}, step);
    stack.take({.step = StackStep::Merge, .target = step}, step + 1);
  };
  for (std::int64_t i = 0; i < 19; ++i) twice(2 + 2 * i);
  EXPECT_THROW(twice(60), InvalidInput);
  EXPECT_THROW(stack.take({.step = StackStep::Duplicate}, 70), InvalidInput);
}

}  // namespace
}  // namespace normalshop::test
