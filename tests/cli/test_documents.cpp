#include <csignal>
#include <thread>

#include "../io/temp_folder.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "normalshop/document/document_file.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/stored_document.h"

/// Documents from end to end, by the verbs.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

constexpr int document_side = 160;

class DocumentVerbs : public ::testing::Test {
 protected:
  DocumentVerbs() {
    fs::create_directories(folder_ / "in");
    write_gltf(folder_ / "in/square.gltf", hemisphere(12, 24), "map.png");
    write_image(folder_ / "in/map.png", wavy_map(document_side, 4, CodeType::U16, true));
    write_file(folder_ / "scratch.json", pen_recipe());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramRun call(const Arguments& arguments, int exit_code = 0) const {
    ProgramRun run = call_program(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << command_line(arguments) << "\n" << run.err;
    return run;
  }
  Document imported() const {
    OpenOptions options;
    options.model = folder_ / "in/square.gltf";
    return open_document(options).document;
  }
  void make() const { call({"new", path("in/square.gltf"), "-o", path("d.nshop")}); }
  void apply() const { call({"apply", path("d.nshop"), path("scratch.json")}); }
  void expect_complaint(const Arguments& arguments, const std::vector<std::string>& names) const {
    const ProgramRun run = call(arguments, 1);
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
    for (const std::string& name : names) {
      EXPECT_NE(run.err.find(name), std::string::npos) << "no " << name << " in: " << run.err;
    }
  }
  void expect_same_files(const std::string& a, const std::string& b) const {
    for (const auto& entry : fs::directory_iterator(folder_ / a)) {
      const std::string name = entry.path().filename().string();
      if (name == "report.json") continue;
      EXPECT_EQ(read_file(entry.path()), read_file(folder_ / b / name)) << name;
    }
  }

  TempFolder folder_;
};

TEST_F(DocumentVerbs, ExportWhatEditWrites) {
  call({"edit", path("in/square.gltf"), "--recipe", path("scratch.json"), "-o", path("edited")});
  make();
  apply();
  fs::rename(folder_ / "in", folder_ / "elsewhere");  // the document needs nothing else
  call({"export", path("d.nshop"), "-o", path("exported")});
  EXPECT_TRUE(fs::exists(folder_ / "exported/square.bin"));
  expect_same_files("edited", "exported");
  expect_same_files("exported", "edited");
}

TEST_F(DocumentVerbs, WithoutEditsGiveEveryCodeBack) {
  make();
  call({"export", path("d.nshop"), "-o", path("out")});
  EXPECT_TRUE(
      same_codes(read_image(folder_ / "in/map.png"), read_image(folder_ / "out/map_normal.png")));
  DocumentFile file(folder_ / "d.nshop");
  EXPECT_EQ(file.read_file(path("in/map.png")), read_file(folder_ / "in/map.png"));
}

TEST_F(DocumentVerbs, LogUndoAndRedo) {
  make();
  apply();
  apply();
  call({"export", path("d.nshop"), "-o", path("two")});
  EXPECT_EQ(call({"undo", path("d.nshop")}).out, "undone: 1 of 1\n");
  call({"export", path("d.nshop"), "-o", path("one")});
  const std::string log = call({"log", path("d.nshop")}).out;
  EXPECT_NE(log.find("1 pen: "), std::string::npos) << log;
  EXPECT_NE(log.find("(undone)\n"), std::string::npos) << log;
  EXPECT_EQ(call({"undo", path("d.nshop"), "7"}).out, "undone: 1 of 7\n");
  call({"export", path("d.nshop"), "-o", path("none")});
  EXPECT_TRUE(
      same_codes(read_image(folder_ / "in/map.png"), read_image(folder_ / "none/map_normal.png")));
  EXPECT_EQ(call({"redo", path("d.nshop"), "9"}).out, "redone: 2 of 9\n");
  call({"export", path("d.nshop"), "-o", path("again")});
  expect_same_files("two", "again");
  EXPECT_FALSE(same_codes(read_image(folder_ / "one/map_normal.png"),
                          read_image(folder_ / "two/map_normal.png")));
  // The log is a recipe.
  write_file(folder_ / "log.json", call({"log", path("d.nshop"), "--json"}).out);
  call({"edit", path("in/square.gltf"), "--recipe", path("log.json"), "-o", path("replayed")});
  expect_same_files("two", "replayed");
}

TEST_F(DocumentVerbs, RecipesMayNameFiles) {
  fs::create_directories(folder_ / "r");
  write_image(folder_ / "r/patch.png", wavy_map(32, 3, CodeType::U8));
  write_file(folder_ / "r/recipe.json", std::string_view(R"({"version": 1, "edits": [
      {"operator": "stamp", "view": "front", "options": {"patch": "patch.png", "size": 0.2},
       "strokes": [[[0, 0]]]},
      {"operator": "text", "view": "front", "options": {"text": "a", "size": 0.2, "height": 0.01, "bevel": 0.02}, "strokes": [[[0.1, 0.1]]]}]})"));
  make();
  call({"apply", path("d.nshop"), path("r/recipe.json")});
  fs::remove_all(folder_ / "r");
  const OpenedDocument opened = open_stored_document(folder_ / "d.nshop");
  Document replayed = imported();
  for (const Edit& edit : opened.document.log()) replayed.apply(edit);
  ASSERT_EQ(replayed.log().size(), 2U);
  EXPECT_TRUE(same_codes(replayed.storage().sets[0].normals.encode(),
                         opened.document.storage().sets[0].normals.encode()));
}

TEST_F(DocumentVerbs, TellAboutDocuments) {
  make();
  apply();
  const std::string info = call({"info", path("d.nshop")}).out;
  EXPECT_NE(info.find("steps: 1\n"), std::string::npos) << info;
  EXPECT_NE(info.find("size: 160, 160\n"), std::string::npos) << info;
  EXPECT_EQ(call({"verify", path("d.nshop")}).out, path("d.nshop") + " is whole\n");
}

TEST_F(DocumentVerbs, ComplainInASentence) {
  make();
  apply();
  const std::string whole = read_file(folder_ / "d.nshop");
  expect_complaint({"new", path("in/square.gltf"), "-o", path("d.nshop")}, {"exists already"});
  expect_complaint({"apply", path("in/map.png"), path("scratch.json")}, {"no NormalShop document"});
  expect_complaint({"export", path("none.nshop"), "-o", path("x")}, {"does not exist"});
  write_file(folder_ / "half.json", std::string_view(R"({"version": 1, "edits": [
      {"operator": "pen", "view": "front", "options": {"width": 0.1, "height": 0.02},
       "strokes": [[[0, 0], [0.1, 0.1]]]},
      {"operator": "pen", "view": "front", "options": {"width": 0.1, "height": 0.02},
       "strokes": [[[50, 50], [51, 51]]]}]})"));
  expect_complaint({"apply", path("d.nshop"), path("half.json")},
                   {"edits[1]", "the document holds what came before it"});
  EXPECT_EQ(DocumentFile(folder_ / "d.nshop").history().size(), 2U);
  {
    const DocumentFile open(folder_ / "d.nshop");
    const ProgramRun other = run_program({"log", path("d.nshop")});
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_NE(other.err.find("is open in another program"), std::string::npos) << other.err;
  }
  std::string damaged = whole;
  const std::string tile = DocumentFile(folder_ / "d.nshop").tiles().at(0).bytes;
  const std::size_t at = damaged.find(tile.substr(0, 100));
  ASSERT_NE(at, std::string::npos);
  damaged[at + 60] = static_cast<char>(damaged[at + 60] ^ 8);
  write_file(folder_ / "d.nshop", damaged);
  expect_complaint({"export", path("d.nshop"), "-o", path("x")}, {"d.nshop", "tile ("});
  const ProgramRun verified = call({"verify", path("d.nshop")}, 1);
  EXPECT_NE(verified.out.find("of the normals of 'map'"), std::string::npos) << verified.out;
}

TEST_F(DocumentVerbs, AFullDiskChangesNothing) {
  make();
  apply();
  const std::string before = read_file(folder_ / "d.nshop");
  const ProgramLimits limits{.file_bytes = 20000};
  const ProgramRun run = run_program({"apply", path("d.nshop"), path("scratch.json")}, limits);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("d.nshop"), std::string::npos) << run.err;
  const ProgramRun made =
      run_program({"new", path("in/square.gltf"), "-o", path("e.nshop")}, limits);
  EXPECT_EQ(made.exit_code, 1);
  EXPECT_NE(made.err.find("cannot"), std::string::npos) << made.err;
  EXPECT_EQ(made.err.find("/."), std::string::npos) << "no hidden file in: " << made.err;
  EXPECT_EQ(call({"verify", path("d.nshop")}).out, path("d.nshop") + " is whole\n");
  EXPECT_EQ(DocumentFile(folder_ / "d.nshop").history().size(), 1U);
  EXPECT_EQ(files_in(folder_.path()), 3U) << "nothing is left behind";
}

TEST_F(DocumentVerbs, AKilledProgramLeavesAWholeDocument) {
  make();
  std::string edits;
  for (int i = 0; i < 200; ++i) {
    edits += std::string(i > 0 ? "," : "") +
             R"({"operator": "pen", "view": "front", "options": {"width": 0.1, "height": 0.01},
                 "strokes": [[[0, 0], [0.1, )" +
             std::to_string(0.001 * i) + "]]]}";
  }
  write_file(folder_ / "many.json", R"({"version": 1, "edits": [)" + edits + "]}");
  for (int i = 0; i < 3; ++i) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ::execl(NORMALSHOP_PROGRAM, NORMALSHOP_PROGRAM, "apply", path("d.nshop").c_str(),
              path("many.json").c_str(), nullptr);
      ::_exit(127);
    }
    // The first finished edit makes the log.
    const fs::path log = path("d.nshop-wal");
    for (int waits = 0; waits < 6000 && !(fs::exists(log) && fs::file_size(log) > 0); ++waits) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5 + 31 * i));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it was done too early";
    EXPECT_EQ(call({"verify", path("d.nshop")}).out, path("d.nshop") + " is whole\n");
  }
  const OpenedDocument opened = open_stored_document(folder_ / "d.nshop");
  Document replayed = imported();
  EXPECT_GE(opened.document.log().size(), 3U);
  for (const Edit& edit : opened.document.log()) replayed.apply(edit);
  EXPECT_TRUE(same_codes(replayed.storage().sets[0].normals.encode(),
                         opened.document.storage().sets[0].normals.encode()));
}

}  // namespace
}  // namespace normalshop::test
