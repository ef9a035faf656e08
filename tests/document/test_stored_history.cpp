#include "document/stored_document.h"

#include "normalshop/document/live_edit.h"

/// Edits of a document on file, their undo and redo.
namespace normalshop::test {
namespace {

class StoredHistoryTest : public StoredSquare {};

TEST_F(StoredHistoryTest, ReopeningGivesTheSameBits) {
  Document in_memory = imported();
  {
    Document document = open();
    EXPECT_TRUE(same_maps(document, in_memory));
    for (const Edit& e : some_edits()) {
      EXPECT_GT(document.apply(e).pushed.changed, 50U);
      in_memory.apply(e);
    }
    EXPECT_TRUE(same_maps(document, in_memory));
  }
  EXPECT_EQ(files_in(folder_.path()), 1U);
  const Document again = open();
  EXPECT_TRUE(same_maps(again, in_memory));
  EXPECT_TRUE(again.storage().sets[0].albedo.has_edits());
  EXPECT_EQ(again.file()->history().size(), 3U);
  EXPECT_FALSE(again.file()->recovered());
}

TEST_F(StoredHistoryTest, TheLogReplaysToTheSameBits) {
  Document document = open();
  for (const Edit& e : some_edits()) document.apply(e);
  Document replayed = imported();
  for (const Edit& e : document.log()) replayed.apply(e);
  EXPECT_EQ(replayed.log().size(), 3U);
  EXPECT_TRUE(same_maps(document, replayed));
  FakeAssets assets;
  const Recipe recipe = parse_recipe(to_json(document.file()->recipe()), "log", assets);
  ASSERT_EQ(recipe.edits.size(), 3U);
  EXPECT_EQ(recipe.edits[1].operation->name(), "warp");
}

TEST_F(StoredHistoryTest, UndoAndRedoGoThroughEveryStateAfterReopening) {
  std::vector<Document> states{imported()};
  {
    Document document = open();
    for (const Edit& e : some_edits()) {
      document.apply(e);
      states.push_back(states.back());
      states.back().apply(e);
    }
  }
  Document document = open();
  for (std::size_t i = 3; i-- > 0;) {
    EXPECT_TRUE(document.undo());
    EXPECT_TRUE(same_maps(document, states[i])) << i;
    document = Document({}, {});  // lets go of the file
    document = open();
    EXPECT_TRUE(same_maps(document, states[i])) << i << " after reopening";
    EXPECT_EQ(document.log().size(), i);
  }
  EXPECT_FALSE(document.undo());
  EXPECT_FALSE(map_of(document).has_edits());
  EXPECT_FALSE(document.storage().sets[0].albedo.has_edits());
  for (std::size_t i = 1; i <= 3; ++i) {
    EXPECT_TRUE(document.redo());
    EXPECT_TRUE(same_maps(document, states[i])) << i;
  }
  EXPECT_FALSE(document.redo());
}

TEST_F(StoredHistoryTest, AnEditAfterUndoGoesOnFromThere) {
  Document document = open();
  document.apply(pen("[-0.4, 0.4], [-0.3, 0.3]"));
  document.apply(pen("[-0.4, 0.3], [-0.3, 0.4]"));
  EXPECT_TRUE(document.undo());
  document.apply(pen("[0.2, -0.4], [0.3, -0.3]"));
  EXPECT_FALSE(document.redo());
  Document expected = imported();
  expected.apply(pen("[-0.4, 0.4], [-0.3, 0.3]"));
  expected.apply(pen("[0.2, -0.4], [0.3, -0.3]"));
  EXPECT_TRUE(same_maps(document, expected));
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.undo());
  EXPECT_TRUE(document.redo());
  EXPECT_TRUE(document.redo());
  EXPECT_TRUE(same_maps(document, expected));
}

TEST_F(StoredHistoryTest, AnEditStoresTheTilesThatItChanges) {
  Document document = open();
  document.apply(pen("[-0.4, 0.4], [-0.35, 0.4]"));
  std::size_t touched = 0;
  for (std::size_t i = 0; i < map_of(document).tile_count(); ++i) {
    const auto tile = map_of(document).tile(i);
    touched += tile && tile->edited.any() ? 1 : 0;
  }
  EXPECT_EQ(document.file()->tiles().size(), touched);
  EXPECT_LE(touched, 4U);
  const std::size_t size = 25 * 49664;  // all tiles as they lie in memory
  EXPECT_LT(std::filesystem::file_size(path_), size / 4);
}

TEST_F(StoredHistoryTest, ADrawnEditIsKeptLikeAnAppliedOne) {
  Edit whole = pen("[-0.4, 0.4], [-0.3, 0.3], [0, 0.2]");
  whole.window = ChartWindow::View;
  Document expected = imported();
  expected.apply(whole);
  {
    Document document = open();
    const auto live = document.begin(whole);
    live->draw(whole.strokes);
    live->finish();
    const auto cancelled = document.begin(whole);
    cancelled->draw(whole.strokes);
    cancelled->cancel();
    EXPECT_TRUE(same_maps(document, expected));
  }
  Document again = open();
  EXPECT_TRUE(same_maps(again, expected));
  EXPECT_EQ(again.log().size(), 1U);
  EXPECT_TRUE(again.undo());
  EXPECT_TRUE(same_maps(again, imported()));
}

TEST_F(StoredHistoryTest, ARefusedEditChangesNothing) {
  Document document = open();
  document.apply(pen("[-0.4, 0.4], [-0.3, 0.3]"));
  const Document before = document;
  EXPECT_THROW(document.apply(pen("[3, 3], [4, 4]")), InvalidInput);
  TransferOptions other;
  other.update = Update::Point;
  EXPECT_THROW(document.apply(pen("[0, 0], [0.1, 0.1]"), other), InvalidInput);
  EXPECT_TRUE(same_maps(document, before));
  EXPECT_EQ(document.file()->history().size(), 1U);
}

TEST_F(StoredHistoryTest, WhatEditsNameIsInTheDocument) {
  {
    Document document = open();
    for (int i = 0; i < 2; ++i) {
      Edit stamp = edit(R"("operator": "stamp", "view": "front",
          "options": {"patch": "cone.png", "size": 0.1}, "strokes": [[[0.1, 0.1]]])");
      stamp.files = {{"cone.png", std::make_shared<const std::string>(1000, 'c')}};
      document.apply(stamp);
    }
  }
  const DocumentFile file(path_);
  for (const HistoryEntry& entry : file.history()) {
    const std::vector<NamedFile> files = file.files_of(entry.id);
    ASSERT_EQ(files.size(), 1U);
    EXPECT_EQ(files[0].name, "cone.png");
    EXPECT_EQ(*files[0].bytes, std::string(1000, 'c'));
  }
  EXPECT_TRUE(file.check().empty());
}

}  // namespace
}  // namespace normalshop::test
