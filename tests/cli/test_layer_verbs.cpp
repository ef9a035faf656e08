#include "../io/temp_folder.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>

#include "normalshop/document/document_file.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/stored_document.h"

/// Layers, changed edits, branches and replay of documents, by the verbs.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

class LayerVerbs : public ::testing::Test {
 protected:
  LayerVerbs() {
    write_gltf(folder_ / "ball.gltf", hemisphere(12, 24), "map.png");
    write_image(folder_ / "map.png", wavy_map(160, 4, CodeType::U16, true));
    write_file(folder_ / "scratch.json", pen_recipe());
    write_file(folder_ / "smooth.json", std::string_view(R"({"version": 1, "edits": [
        {"operator": "smooth", "view": "front", "options": {"sigma": 0.05}}]})"));
    call({"new", path("ball.gltf"), "-o", document_});
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  ProgramRun call(const Arguments& arguments, int exit_code = 0) const {
    ProgramRun run = call_program(arguments);
    EXPECT_EQ(run.exit_code, exit_code) << command_line(arguments) << "\n" << run.err;
    return run;
  }
  std::string out(const Arguments& arguments) const { return call(arguments).out; }
  void apply(const std::string& recipe, const Arguments& more = {}) const {
    Arguments arguments{"apply", document_, path(recipe)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    call(arguments);
  }
  RawImage codes(const std::string& document) const {
    return open_stored_document(document).document.storage().sets.at(0).normals.encode();
  }
  /// What these recipes make of the model, one after the other.
  RawImage made_by(const std::vector<std::string>& recipes) const {
    call({"new", path("ball.gltf"), "-o", path("other.nshop")});
    for (const std::string& recipe : recipes) {
      call({"apply", path("other.nshop"), path(recipe)});
    }
    RawImage made = codes(path("other.nshop"));
    fs::remove(path("other.nshop"));
    return made;
  }
  void expect_refused(const Arguments& arguments, int exit_code, const std::string& word) const {
    const ProgramRun run = call(arguments, exit_code);
    EXPECT_NE(run.err.find(word), std::string::npos) << "no " << word << " in: " << run.err;
    EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
  }

  TempFolder folder_;
  std::string document_ = path("d.nshop");
};

TEST_F(LayerVerbs, ListAndChangeLayers) {
  apply("scratch.json");
  EXPECT_EQ(out({"layers", document_, "add", "--name", "soft"}),
            "2 'soft': 0 edits\n0 'first': 1 edit\n");
  apply("smooth.json");
  EXPECT_TRUE(same_codes(codes(document_), made_by({"scratch.json", "smooth.json"})));
  apply("scratch.json", {"--layer", "0"});
  EXPECT_TRUE(
      same_codes(codes(document_), made_by({"scratch.json", "scratch.json", "smooth.json"})));
  EXPECT_EQ(out({"layers", document_, "set", "2", "--opacity", "0.5", "--blend", "rotation"}),
            "2 'soft': 1 edit, opacity 0.5, rotation\n0 'first': 2 edits\n");
  EXPECT_EQ(out({"layers", document_, "move", "2", "--place", "0"}),
            "0 'first': 2 edits\n2 'soft': 1 edit, opacity 0.5, rotation\n");
  EXPECT_EQ(out({"layers", document_, "duplicate", "2"}),
            "0 'first': 2 edits\n7 'soft copy': 1 edit, opacity 0.5, rotation\n"
            "2 'soft': 1 edit, opacity 0.5, rotation\n");
  out({"disable", document_, "7.1"});
  out({"layers", document_, "set", "2", "--hide"});
  EXPECT_EQ(out({"layers", document_}),
            "0 'first': 2 edits\n7 'soft copy': 1 edit (0 enabled), opacity 0.5, rotation\n"
            "2 'soft': 1 edit, opacity 0.5, rotation, hidden\n");
  EXPECT_TRUE(same_codes(codes(document_), made_by({"scratch.json", "scratch.json"})));
  out({"layers", document_, "remove", "2"});
  EXPECT_EQ(out({"verify", document_}), document_ + " is whole\n");
  const Value layers = parse_json(out({"layers", document_, "--json"}), "layers");
  ASSERT_EQ(layers.array()->size(), 2U);
  EXPECT_EQ(*layers.array()->back().find("name")->text(), "first");
}

TEST_F(LayerVerbs, RefuseWhatCannotBe) {
  apply("scratch.json");
  expect_refused({"layers", document_, "set", "5", "--hide"}, 1, "0 'first'");
  expect_refused({"layers", document_, "set", "0"}, 2, "needs a flag");
  expect_refused({"layers", document_, "set", "0", "--opacity", "2"}, 2, "from 0 to 1");
  expect_refused({"layers", document_, "set", "0", "--hide", "--show"}, 2, "--show");
  expect_refused({"layers", document_, "set", "x", "--hide"}, 2, "whole number");
  expect_refused({"layers", document_, "move", "0"}, 2, "--place");
  expect_refused({"layers", document_, "remove"}, 2, "must be given");
  expect_refused({"layers", document_, "remove", "0"}, 1, "the only one");
  expect_refused({"layers", document_, "add", "3"}, 2, "not taken");
  expect_refused({"layers", document_, "merge", "0", "--name", "x"}, 2, "alone");
  expect_refused({"disable", document_, "one"}, 2, "number");
  expect_refused({"disable", document_, "9"}, 1, "no edit 9");
  expect_refused({"change", document_, "1"}, 2, "--set");
  expect_refused({"change", document_, "1", "--set", "width"}, 2, "FIELD=VALUE");
  expect_refused({"change", document_, "1", "--set", "options.wide=3"}, 1, "wide");
  expect_refused({"change", document_, "1", "--set", "operator.name=3"}, 1, "name");
  expect_refused({"jump", document_, "7"}, 1, "no step 7");
  expect_refused({"apply", document_, path("scratch.json"), "--layer", "4"}, 1, "no layer 4");
  EXPECT_EQ(DocumentFile(document_).history().size(), 1U);
}

TEST_F(LayerVerbs, ChangeEditsAndTellIt) {
  apply("scratch.json");
  apply("smooth.json");
  out({"change", document_, "1", "--set", "options.width=0.5", "--set", "strength=0.5"});
  const Value edit = DocumentFile(document_).edit(3);
  EXPECT_EQ(*edit.find("options")->find("width")->number(), 0.5);
  EXPECT_EQ(*edit.find("strength")->number(), 0.5);
  out({"change", document_, "2", path("scratch.json")});
  out({"disable", document_, "1"});
  EXPECT_TRUE(same_codes(codes(document_), made_by({"scratch.json"})));
  EXPECT_EQ(out({"log", document_}).find("1 pen: "), 0U);
  EXPECT_NE(out({"log", document_}).find("3 pen: changes edit 1: "), std::string::npos);
  out({"jump", document_, "1"});
  apply("smooth.json");
  EXPECT_TRUE(same_codes(codes(document_), made_by({"scratch.json", "smooth.json"})));
  const std::string all = out({"log", document_, "--all"});
  EXPECT_NE(all.find("5 (on 4) disables edit 1: "), std::string::npos) << all;
  EXPECT_NE(all.find("6 (on 1) smooth: "), std::string::npos) << all;
  EXPECT_EQ(out({"jump", document_, "0"}), "2 steps back, 0 on\n");
  EXPECT_FALSE(open_stored_document(document_).document.storage().sets[0].normals.has_edits());
}

TEST_F(LayerVerbs, ReplayAtAnotherSizeAndOnOtherMaps) {
  apply("scratch.json");
  out({"layers", document_, "add", "--name", "soft", "--opacity", "0.5"});
  apply("smooth.json");
  apply("scratch.json");
  out({"disable", document_, "4"});
  const ProgramRun run = call({"replay", document_, "-o", path("large.nshop"), "--size", "320"});
  EXPECT_NE(run.err.find("disabled are not in the new document: 1"), std::string::npos) << run.err;
  EXPECT_EQ(out({"layers", path("large.nshop")}),
            "2 'soft': 1 edit, opacity 0.5, linear\n0 'first': 1 edit\n");
  EXPECT_EQ(codes(path("large.nshop")).width(), 320);
  EXPECT_EQ(out({"verify", path("large.nshop")}), path("large.nshop") + " is whole\n");
  call({"new", path("ball.gltf"), "-o", path("direct.nshop"), "--size", "320"});
  call({"apply", path("direct.nshop"), path("scratch.json")});
  out({"layers", path("direct.nshop"), "add", "--opacity", "0.5"});
  call({"apply", path("direct.nshop"), path("smooth.json")});
  EXPECT_TRUE(same_codes(codes(path("large.nshop")), codes(path("direct.nshop"))));

  write_image(folder_ / "flat.png", flat_normal_map(64, 64, CodeType::U8).codes());
  call({"replay", document_, "-o", path("flat.nshop"), "--normal-map", path("flat.png")});
  EXPECT_EQ(codes(path("flat.nshop")).width(), 64);
  expect_refused({"replay", document_, "-o", path("flat.nshop")}, 1, "exists already");
  expect_refused({"replay", document_, "-o", path("x.nshop"), "--normal-map", path("map.png")}, 1,
                 "another name");
  EXPECT_FALSE(fs::exists(path("x.nshop")));
}

TEST_F(LayerVerbs, ReplayOnAnotherModelTellsWhatMisses) {
  apply("scratch.json");
  write_gltf(folder_ / "finer.gltf", hemisphere(24, 48), "map2.png");
  write_image(folder_ / "map2.png", wavy_map(200, 3, CodeType::U8, true));
  call({"replay", document_, "-o", path("finer.nshop"), "--model", path("finer.gltf")});
  EXPECT_EQ(codes(path("finer.nshop")).width(), 200);
  Mesh far = hemisphere(12, 24);
  for (Vec3f& p : far.positions) p = 0.01F * p + Vec3f(40.0F, 0.0F, 0.0F);
  write_gltf(folder_ / "far.gltf", far, "map2.png");
  write_file(folder_ / "placed.json", std::string_view(R"({"version": 1, "edits": [
      {"operator": "pen", "view": {"direction": [0, 0, 1], "center": [0, 0, 0], "width": 2},
       "options": {"width": 0.1, "height": 0.01}, "strokes": [[[0, 0], [0.2, 0.1]]]}]})"));
  apply("placed.json");
  const Arguments onto{"replay", document_, "-o", path("far.nshop"), "--model", path("far.gltf")};
  const ProgramRun run = call(onto, 1);
  EXPECT_NE(run.err.find("step 1.strokes[0] lies off the surface"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(path("far.nshop")));
  Arguments skipping = onto;
  skipping.emplace_back("--skip-failing");
  EXPECT_NE(call(skipping).err.find("left out: step 2"), std::string::npos);
  EXPECT_TRUE(fs::exists(path("far.nshop")));
}

}  // namespace
}  // namespace normalshop::test
