#include <algorithm>
#include <csignal>

#include "document/stored_document.h"
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/document/store/packing.h"

/// What may happen to a document's file.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

std::uint32_t number(std::uint32_t i) { return hash(i, 0, 0); }

class DocumentFileTest : public StoredSquare {
 protected:
  void apply_some() const {
    Document document = open();
    for (const Edit& e : some_edits()) document.apply(e);
  }
  static Document edited_in_memory() {
    Document document = imported();
    for (const Edit& e : some_edits()) document.apply(e);
    return document;
  }
  /// Changes a byte of the first edited tile's bytes where they lie in the file.
  void damage_first_tile() const {
    const std::vector<PackedTile> tiles = DocumentFile(path_).tiles();
    const auto edited =
        std::find_if(tiles.begin(), tiles.end(), [](const PackedTile& t) { return t.layer >= 0; });
    ASSERT_NE(edited, tiles.end());
    const std::string tile = edited->bytes;
    std::string bytes = bytes_of(path_);
    const std::size_t at = bytes.find(tile.substr(0, 200));
    ASSERT_NE(at, std::string::npos);
    bytes[at + 150] = static_cast<char>(bytes[at + 150] ^ 0x10);
    write_bytes(path_, bytes);
  }
};

void expect_names(const std::string& message, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    EXPECT_NE(message.find(name), std::string::npos) << "no " << name << " in: " << message;
  }
}

TEST_F(DocumentFileTest, HoldsImportedFilesByteForByte) {
  std::string large(5'000'000, '\0');  // two parts
  for (std::size_t i = 0; i < large.size(); i += 97)
    large[i] = static_cast<char>(number(static_cast<std::uint32_t>(i)));
  DocumentFile::Contents contents;
  contents.import = Value::Object{{"model", "x"}};
  const auto shared = std::make_shared<const std::string>(large);
  contents.files = {
      {"large", shared}, {"again", shared}, {"../empty", std::make_shared<const std::string>()}};
  const fs::path path = path_of("files.nshop");
  write_bytes(path, "");
  DocumentFile::create(path, contents);
  const DocumentFile file(path);
  EXPECT_EQ(file.read_file("large"), large);
  EXPECT_EQ(file.read_file("again"), large);
  EXPECT_EQ(file.read_file("../empty"), "");
  EXPECT_FALSE(file.has_file("empty"));
  EXPECT_THROW(file.read_file("empty"), DocumentError);
  EXPECT_EQ(*file.import().find("model")->text(), "x");
  EXPECT_LT(fs::file_size(path), large.size()) << "equal files are kept once";
}

TEST_F(DocumentFileTest, WholeOnesHaveNoFaults) {
  apply_some();
  EXPECT_EQ(DocumentFile(path_).check(), std::vector<std::string>());
  const Value summary = DocumentFile(path_).summary();
  EXPECT_EQ(*summary.find("steps")->number(), 3.0);
  EXPECT_EQ(*summary.find("document version")->number(), 1.0);
}

TEST_F(DocumentFileTest, ADamagedTileIsNamed) {
  apply_some();
  damage_first_tile();
  const std::string name = "the tile 0 of the colors of 'skin'";
  try {
    open();
    ADD_FAILURE() << "the checksum did not find it";
  } catch (const DocumentError& error) {
    expect_names(error.what(), {"square.nshop", name});
  }
  const std::vector<std::string> faults = DocumentFile(path_).check();
  ASSERT_EQ(faults.size(), 1U);
  expect_names(faults[0], {name, "after step 2"});
}

TEST_F(DocumentFileTest, AStepOntoADamagedTileIsNotTaken) {
  Document document = open();
  const std::vector<Edit> edits = some_edits();
  document.apply(edits[0]);
  document = Document({}, {});
  damage_first_tile();
  {
    DocumentFile file(path_);
    EXPECT_TRUE(file.undo());
    EXPECT_THROW(file.redo(), DocumentError);
    EXPECT_TRUE(file.history().at(0).undone);
  }
  document = open();
  EXPECT_TRUE(same_maps(document, imported()));
  EXPECT_THROW(document.redo(), DocumentError);
  EXPECT_TRUE(same_maps(document, imported()));
}

TEST_F(DocumentFileTest, SomeDamageAnywhereIsFoundOrHarmless) {
  apply_some();
  const std::string whole = bytes_of(path_);
  const Document expected = edited_in_memory();
  for (std::uint32_t i = 0; i < 20; ++i) {
    std::string bytes = whole;
    const std::size_t at = 100 + number(i) % (whole.size() - 100);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << i % 8));
    write_bytes(path_, bytes);
    try {
      const Document document = open();
      EXPECT_TRUE(same_maps(document, expected)) << "byte " << at;
    } catch (const DocumentError& error) {
      expect_names(error.what(), {"square.nshop"});
    }
  }
}

TEST_F(DocumentFileTest, TruncatedOnesAreRefused) {
  apply_some();
  const std::string whole = bytes_of(path_);
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{5000}}) {
    write_bytes(path_, whole.substr(0, size));
    expect_names(complaint_of(path_), {"square.nshop", "is truncated", std::to_string(size)});
  }
}

TEST_F(DocumentFileTest, NewerOnesAreRefusedWithTheVersion) {
  std::string bytes = bytes_of(path_);
  bytes[63] = 9;  // user_version
  write_bytes(path_, bytes);
  expect_names(complaint_of(path_),
               {"square.nshop", "version 9", "written by NormalShop 0.", "up to 1"});
  EXPECT_EQ(bytes_of(path_), bytes);
}

TEST_F(DocumentFileTest, OtherFilesAreRefused) {
  std::string other = bytes_of(path_);
  other[68] = 'X';  // another program's
  write_bytes(path_of("other.nshop"), other);
  write_bytes(path_of("text.nshop"), "a text");
  write_bytes(path_of("empty.nshop"), "");
  for (const char* name : {"other.nshop", "text.nshop", "empty.nshop", "."}) {
    expect_names(complaint_of(path_of(name)), {name, "is no NormalShop document"});
    EXPECT_FALSE(DocumentFile::is_one(path_of(name)));
  }
  expect_names(complaint_of(path_of("none.nshop")), {"none.nshop", "does not exist"});
  EXPECT_TRUE(DocumentFile::is_one(path_));
}

TEST_F(DocumentFileTest, OneProgramAtATime) {
  const DocumentFile first(path_);
  expect_names(complaint_of(path_), {"square.nshop", "is open in another program"});
}

TEST_F(DocumentFileTest, WriteProtectedOnesAreReadOnly) {
  apply_some();
  const Document expected = edited_in_memory();
  ASSERT_EQ(::chmod(path_.c_str(), 0444), 0);
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0555), 0);
  const uid_t user = ::geteuid();
  ASSERT_EQ(::seteuid(user == 0 ? 65534 : user), 0);  // root may write everywhere
  {
    Document document = open();
    EXPECT_TRUE(document.file()->read_only());
    EXPECT_TRUE(same_maps(document, expected));
    EXPECT_EQ(document.log().size(), 3U);
    EXPECT_THROW(document.undo(), DocumentError);
    EXPECT_THROW(document.apply(some_edits()[0]), DocumentError);
    EXPECT_TRUE(same_maps(document, expected));
  }
  ASSERT_EQ(::seteuid(user), 0);
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  EXPECT_EQ(files_in(folder_.path()), 1U);
}

/// Adds edits to a document until it is killed; a byte for each that is said to be safe.
[[noreturn]] void add_for_ever(const fs::path& path, const Edit& edit,
                               const std::vector<TileChange>& changes, int told) {
  try {
    DocumentFile file(path);
    for (std::size_t i = 1;; ++i) {
      file.add({{StackStep::Edit}, &edit, i}, changes);
      if (::write(told, "x", 1) != 1) break;
      if (i % 3 == 0 && !file.undo()) break;
    }
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(1);
}

TEST_F(DocumentFileTest, KilledProgramsLoseNoFinishedEdit) {
  Document document = imported();
  const MapsBefore before(document.storage(), true);
  const Edit stroke = pen("[-0.4, 0.4], [0.3, 0.3]");
  document.apply(stroke);
  const std::vector<TileChange> changes = changed_tiles(before, document.storage(), first_layer);
  std::size_t told = 0;
  for (std::uint32_t i = 0; i < 5; ++i) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) add_for_ever(path_, stroke, changes, ends[1]);
    ::close(ends[1]);
    char byte = 0;
    ASSERT_EQ(::read(ends[0], &byte, 1), 1) << "the program did not get so far";
    ++told;
    ::usleep(1000 + number(i) % 20000);
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    while (::read(ends[0], &byte, 1) == 1) ++told;
    ::close(ends[0]);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    const Document after = open();
    EXPECT_TRUE(after.file()->recovered());
    EXPECT_EQ(after.file()->notes().size(), 1U);
    EXPECT_EQ(after.file()->check(), std::vector<std::string>());
    const bool any = !after.log().empty();
    EXPECT_TRUE(same_maps(after, any ? document : imported()));
    EXPECT_GE(after.file()->history().back().id, static_cast<std::int64_t>(told)) << "ids of edits";
  }
}

TEST(Packing, BringsBackWhatWasPacked) {
  std::string bytes;
  for (std::uint32_t i = 0; i < 3000; ++i) bytes += static_cast<char>(number(i / 7));
  const std::string packed = pack(bytes);
  EXPECT_LT(packed.size(), bytes.size());
  EXPECT_EQ(unpack(packed, 3000), bytes);
  EXPECT_EQ(unpack(pack(""), 0), "");
  EXPECT_THROW(unpack(packed, 2999), InvalidInput);
  std::size_t found = 0;
  for (std::size_t i = 0; i < packed.size(); ++i) {
    std::string damaged = packed;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    try {
      EXPECT_EQ(unpack(damaged, 1U << 20U), bytes) << "byte " << i << ", a bit that means nothing";
    } catch (const InvalidInput&) {
      ++found;
    }
    EXPECT_THROW(unpack(packed.substr(0, i), 3000), InvalidInput);
  }
  EXPECT_GT(found, packed.size() * 9 / 10);
}

}  // namespace
}  // namespace normalshop::test
