#include <cmath>
#include <cstring>
#include <numbers>

#include "../io/temp_folder.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/meshes.h"
#include "support/same_codes.h"
#include "support/sanitized.h"
#include <gtest/gtest.h>

#include "normalshop/document/value.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

/// The verbs from end to end, with the arguments that a user or another program gives.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string>& verbs() {
  static const std::vector<std::string> all{"edit",     "render", "compare", "info",  "demo",
                                            "describe", "unwrap", "new",     "apply", "log",
                                            "undo",     "redo",   "verify",  "export"};
  return all;
}

/// Runs that all must succeed.
std::vector<ProgramRun> run_all(const std::vector<Arguments>& runs,
                                const std::optional<ProgramLimits>& limits = {}) {
  std::vector<ProgramRun> results = run_all_of(runs, limits);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(results[i].exit_code, 0) << command_line(runs[i]) << "\n" << results[i].err;
  }
  return results;
}

Value json_of(const ProgramRun& run) { return parse_json(run.out, "standard output"); }

double number(const Value& object, const char* field) {
  const Value* found = object.find(field);
  if (found == nullptr || found->number() == nullptr) {
    ADD_FAILURE() << "no number " << field;
    return -1.0;
  }
  return *found->number();
}

void expect_same_codes(const fs::path& a, const fs::path& b) {
  EXPECT_TRUE(same_codes(read_image(a), read_image(b))) << a << " " << b;
}

class Verbs : public ::testing::Test {
 protected:
  Verbs() {
    write_file(folder_ / "square.obj", square_obj());
    write_file(folder_ / "recipe.json", pen_recipe());
    write_image(folder_ / "map.png", wavy_map(size, 3, CodeType::U8));
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  Arguments edit(const std::string& map, const std::string& recipe, const std::string& output,
                 const Arguments& more = {}) const {
    Arguments all{"edit",     path("square.obj"), "--normal-map", path(map),
                  "--recipe", path(recipe),       "-o",           path(output)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// The result of `compare` as JSON.
  Value compare(const std::string& a, const std::string& b, const Arguments& more = {}) const {
    Arguments all{"compare", path(a), path(b), "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return json_of(run_all({all})[0]);
  }

  static constexpr int size = 96;
  TempFolder folder_;
};

TEST_F(Verbs, TellAboutThemselves) {
  std::vector<Arguments> runs{{"--help"}, {"--version"}};
  for (const std::string& verb : verbs()) runs.push_back({verb, "--help"});
  const std::vector<ProgramRun> results = run_all(runs);
  for (const std::string& verb : verbs()) {
    EXPECT_NE(results[0].out.find("  " + verb + " "), std::string::npos) << verb;
  }
  EXPECT_EQ(results[1].out.find_first_not_of("0123456789.\n"), std::string::npos);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_FALSE(results[i].out.empty());
    EXPECT_EQ(results[i].err, "") << command_line(runs[i]);
    if (i >= 2) {
      EXPECT_NE(results[i].out.find("normalshop " + runs[i][0]), std::string::npos);
    }
  }
}

TEST_F(Verbs, InfoIsForReading) {
  const std::string text = run_all({{"info", path("square.obj")}})[0].out;
  EXPECT_NE(text.find("\ntriangles: 2\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\ntexture set:\n  name: skin\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nnotes:\n  "), std::string::npos) << text;
  EXPECT_EQ(text.find('['), std::string::npos) << text;
}

TEST_F(Verbs, EditByEveryTransferAndUpdate) {
  std::vector<Arguments> runs;
  for (const std::string transfer : {"triangle", "point"}) {
    for (const std::string update : {"gather", "point", "area"}) {
      runs.push_back(edit("map.png", "recipe.json", transfer + update,
                          {"--transfer", transfer, "--update", update, "--json"}));
    }
  }
  runs.push_back(edit("map.png", "recipe.json", "plain", {"--json"}));
  const std::vector<ProgramRun> results = run_all(runs);
  for (std::size_t i = 0; i < 6; ++i) {
    const Value report = json_of(results[i]);
    EXPECT_EQ(*report.find("transfer")->text(), runs[i][9]);
    EXPECT_EQ(*report.find("update")->text(), runs[i][11]);
    EXPECT_GT(number(report, "texels_changed"), 50.0);
    EXPECT_EQ(number(report, "texels_lost"), 0.0) << "pixels as large as texels";
    // Values instead of changes: what the stroke's box holds is written, too.
    const Value difference =
        compare("plain/skin_normal.png", runs[i][9] + runs[i][11] + "/skin_normal.png");
    EXPECT_LT(number(difference, "mean"), 0.5) << command_line(runs[i]);
  }
  expect_same_codes(folder_ / "plain/skin_normal.png", folder_ / "trianglegather/skin_normal.png");
  const Value report = json_of(results[6]);
  EXPECT_EQ(*report.find("transfer")->text(), "triangle");
  EXPECT_EQ(*report.find("update")->text(), "gather");
}

TEST_F(Verbs, AreThoseOfTheProgram) {
  EXPECT_EQ(run_program({"--version"}).out, call_program({"--version"}).out);
  const ProgramRun wrong = run_program({"paint"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(wrong.err, call_program({"paint"}).err);
}

TEST_F(Verbs, SpeakJson) {
  const std::vector<ProgramRun> runs = run_all(
      {edit("map.png", "recipe.json", "out", {"--json"}),
       {"render", path("square.obj"), "-o", path("p.png"), "--resolution", "40x30", "--json"},
       {"compare", path("map.png"), path("map.png"), "-o", path("c.png"), "--json"},
       {"info", path("square.obj"), "--json"},
       {"info", path("map.png"), "--json"},
       {"describe", "--json"}});
  const Value report = json_of(runs[0]);
  EXPECT_GT(number(report, "texels_changed"), 50.0);
  EXPECT_GT(number(report, "largest_change_degrees"), 5.0);
  EXPECT_EQ(runs[0].out, read_file(folder_ / "out/report.json"));
  ASSERT_NE(report.find("files"), nullptr);
  for (const Value& file : *report.find("files")->array()) {
    EXPECT_TRUE(fs::is_regular_file(folder_ / ("out/" + *file.text()))) << *file.text();
  }
  EXPECT_EQ(number(json_of(runs[1]), "width"), 40.0);
  EXPECT_EQ(number(json_of(runs[2]), "largest"), 0.0);
  EXPECT_EQ(number(json_of(runs[2]), "pixels"), double(size) * size);
  EXPECT_EQ(read_image(folder_ / "c.png").width(), size);
  const Value model = json_of(runs[3]);
  EXPECT_EQ(number(model, "triangles"), 2.0);
  EXPECT_EQ(number(model, "vertices"), 4.0);
  ASSERT_EQ(model.find("texture set")->array()->size(), 1U);
  EXPECT_EQ(*model.find("texture set")->array()->front().find("name")->text(), "skin");
  const Value map = json_of(runs[4]);
  EXPECT_EQ(number(map, "channels"), 3.0);
  EXPECT_EQ(*map.find("bits")->text(), "8");
  EXPECT_TRUE(*map.find("normal map")->boolean());
  EXPECT_EQ(*map.find("guessed")->find("green")->text(), "up");
  EXPECT_EQ(*map.find("guessed")->find("space")->text(), "tangent");
  EXPECT_GE(json_of(runs[5]).array()->size(), 5U);
}

TEST_F(Verbs, TheDemoSpeaksJson) {
  NORMALSHOP_SKIP_FIGURES();
  const ProgramRun run = call_program({"demo", "-o", path("demo"), "--size", "256", "--json"});
  const Value demo = json_of(run);
  EXPECT_GT(number(*demo.find("edited"), "texels_changed"), 50.0);
  EXPECT_EQ(demo.find("pictures")->array()->size(), 3U);
  for (const char* field : {"model", "recipe"}) {
    EXPECT_TRUE(fs::is_regular_file(*demo.find(field)->text())) << field;
  }
  for (const Value& picture : *demo.find("pictures")->array()) {
    EXPECT_TRUE(fs::is_regular_file(*picture.text())) << *picture.text();
  }
}

struct MapKind {
  const char* file;
  int channels;
  CodeType type;
  bool green_down;
};

TEST_F(Verbs, EditsThatDoNothingKeepEveryCode) {
  write_file(folder_ / "none.json", std::string_view(R"({"version": 1, "edits": []})"));
  write_file(folder_ / "zero.json", pen_recipe(0.0));
  const std::vector<MapKind> kinds{
      {"rgb8.png", 3, CodeType::U8, false},   {"rgba8.png", 4, CodeType::U8, true},
      {"rgb16.png", 3, CodeType::U16, true},  {"rgba16.png", 4, CodeType::U16, false},
      {"rgba16.tif", 4, CodeType::U16, true}, {"rgb32.tif", 3, CodeType::F32, false},
      {"rgba32.exr", 4, CodeType::F32, true}};
  std::vector<Arguments> runs;
  for (const MapKind& kind : kinds) {
    const std::string name = kind.file;
    write_image(folder_ / name, wavy_map(size, kind.channels, kind.type, kind.green_down));
    runs.push_back(edit(name, runs.size() % 2 == 0 ? "none.json" : "zero.json", "out_" + name));
  }
  runs.push_back(edit("rgb8.png", "zero.json", "out"));
  run_all(runs);
  for (const MapKind& kind : kinds) {
    const std::string name = kind.file;
    const std::string extension = fs::path(name).extension();
    expect_same_codes(folder_ / name, folder_ / ("out_" + name) / ("skin_normal" + extension));
  }
  expect_same_codes(folder_ / "rgb8.png", folder_ / "out/skin_normal.png");
}

/// Image row -> y of the square, texel centres.
double height_of(int row, int rows) { return 1.0 - 2.0 * (row + 0.5) / rows; }

TEST_F(Verbs, TexelsOutsideAnEditKeepTheirCodes) {
  write_image(folder_ / "map16.png", wavy_map(size, 4, CodeType::U16, true));
  run_all({edit("map.png", "recipe.json", "out8"), edit("map16.png", "recipe.json", "out16")});
  for (const auto& [before, after] :
       {std::pair{"map.png", "out8/skin_normal.png"}, {"map16.png", "out16/skin_normal.png"}}) {
    const RawImage old = read_image(folder_ / before);
    const RawImage edited = read_image(folder_ / after);
    ASSERT_EQ(edited.type(), old.type());
    std::size_t inside = 0;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        bool changed = false;
        for (int c = 0; c < old.channels(); ++c) {
          const bool same = old.code(x, y, c) == edited.code(x, y, c);
          changed = changed || !same;
          EXPECT_TRUE(same || c != 3) << "alpha";
        }
        if (!changed) continue;
        ++inside;
        // The stroke's width and two texels beside it.
        EXPECT_LT(std::abs(height_of(y, size) - 0.1), 0.1 + 4.0 / size) << x << " " << y;
      }
    }
    EXPECT_GT(inside, 200U);
  }
}

TEST_F(Verbs, CompareMeasuresKnownAngles) {
  for (const CodeType type : {CodeType::U8, CodeType::U16, CodeType::F32}) {
    const std::string extension = type == CodeType::F32 ? ".exr" : ".png";
    write_image(folder_ / ("flat" + extension), tilted_map(32, 0.0, type));
    write_image(folder_ / ("tilted" + extension), tilted_map(32, 30.0, type));
    const Value result = compare("flat" + extension, "tilted" + extension);
    // 8 bits: codes are rounded to half a step of 1/255 in both components.
    const double tolerance = type == CodeType::U8 ? 0.35 : 0.01;
    for (const char* field : {"mean", "median", "p99", "largest"}) {
      EXPECT_NEAR(number(result, field), 30.0, tolerance) << field << extension;
    }
    EXPECT_EQ(number(result, "pixels"), 32.0 * 32.0);
  }
}

TEST_F(Verbs, CompareCountsUnderTheMask) {
  RawImage half = tilted_map(32, 20.0, CodeType::U16);
  const RawImage flat = tilted_map(32, 0.0, CodeType::U16);
  RawImage mask(32, 32, 1, CodeType::U8);
  for (int y = 0; y < 32; ++y) {
    std::memcpy(half.row_data(y), flat.row_data(y), half.row_bytes() / 2);
    for (int x = 0; x < 32; ++x) mask.row<std::uint8_t>(y)[x] = x >= 24 || y < 8 ? 255 : 0;
  }
  write_image(folder_ / "flat.png", flat);
  write_image(folder_ / "half.png", half);
  write_image(folder_ / "mask.png", mask);
  const Value all = compare("flat.png", "half.png");
  EXPECT_NEAR(number(all, "mean"), 10.0, 0.01);
  EXPECT_NEAR(number(all, "largest"), 20.0, 0.01);
  const Value masked = compare("flat.png", "half.png", {"--mask", path("mask.png")});
  EXPECT_EQ(number(masked, "pixels"), 8 * 32 + 24 * 8);
  EXPECT_NEAR(number(masked, "mean"), 20.0 * (8 * 16 + 24 * 8) / (8 * 32 + 24 * 8), 0.01);
}

TEST_F(Verbs, RenderDrawsEveryStyle) {
  RawImage color = wavy_map(size, 3, CodeType::U8);
  write_image(folder_ / "color.png", color);
  std::vector<Arguments> runs;
  const std::vector<std::string> styles{"lit",    "normals",   "albedo",
                                        "weight", "effective", "charts"};
  for (const std::string& style : styles) {
    runs.push_back({"render", path("square.obj"), "--normal-map", path("map.png"), "--albedo",
                    path("color.png"), "-o", path(style + ".png"), "--style", style, "--view",
                    "0.3,0.2,1", "--resolution", "90x60"});
  }
  run_all(runs);
  std::vector<std::string> pictures;
  for (const std::string& style : styles) {
    const RawImage picture = read_image(folder_ / (style + ".png"));
    EXPECT_EQ(picture.width(), 90);
    EXPECT_EQ(picture.height(), 60);
    EXPECT_EQ(picture.channels(), 3);
    pictures.emplace_back(reinterpret_cast<const char*>(picture.data()), picture.size_bytes());
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) {
      EXPECT_NE(pictures[i], pictures.back()) << styles[i] << " and " << style;
    }
  }
}

TEST_F(Verbs, NumbersMayBeginWithAPoint) {
  const Arguments common{"render", path("square.obj"), "--size", "16", "--resolution", "40x30"};
  std::vector<Arguments> runs;
  for (const char* view : {"-.5,.25,1", "-0.5,0.25,1"}) {
    runs.push_back(common);
    runs.back().insert(runs.back().end(),
                       {"--view", view, "-o", path(std::to_string(runs.size()) + ".png")});
  }
  run_all(runs);
  expect_same_codes(folder_ / "1.png", folder_ / "2.png");
}

TEST_F(Verbs, DescribeListsUnitsRangesAndNames) {
  const std::string text = run_all({{"describe"}})[0].out;
  const Value described = parse_json(run_all({{"describe", "--json"}})[0].out, "describe");
  std::size_t ranges = 0;
  for (const Value& type : *described.array()) {
    for (const Value& field : *type.find("options")->array()) {
      const std::string name = *field.find("name")->text();
      const std::size_t line =
          text.find("  " + name + " ", text.find(*type.find("operator")->text() + ": "));
      ASSERT_NE(line, std::string::npos) << name;
      const std::string said = text.substr(line, text.find('\n', line) - line);
      if (const Value* names = field.find("names")) {
        for (const Value& one : *names->array()) {
          EXPECT_NE(said.find(*one.text()), std::string::npos) << said;
        }
      }
      if (field.find("range") != nullptr) {
        ++ranges;
        EXPECT_NE(said.find(" to "), std::string::npos) << said;
      }
    }
  }
  EXPECT_GT(ranges, 5U);
  EXPECT_NE(text.find("0 to 1"), std::string::npos);
}

TEST_F(Verbs, DescribeListsTheStylesOfShade) {
  const std::string text = run_all({{"describe", "--styles"}})[0].out;
  const Value styles = parse_json(run_all({{"describe", "--styles", "--json"}})[0].out, "styles");
  EXPECT_EQ(styles.array()->size(), 4U);
  for (const Value& style : *styles.array()) {
    EXPECT_NE(text.find(*style.find("style")->text() + ": "), std::string::npos);
    EXPECT_GE(style.find("options")->array()->size(), 3U);
  }
  EXPECT_NE(text.find("  bands "), std::string::npos);
}

TEST_F(Verbs, EditsAreTheSameOnOneProcessor) {
  const Mesh mesh = hemisphere(12, 24);
  write_image(folder_ / "round_map.png", wavy_map(size, 3, CodeType::U16));
  write_gltf(folder_ / "round.gltf", mesh, "round_map.png");
  const auto run = [&](const std::string& output) {
    return Arguments{"edit", path("round.gltf"), "--recipe", path("recipe.json"),
                     "-o",   path(output)};
  };
  run_all({run("one"), run("two")});
  run_all({run("pinned")}, ProgramLimits{.cpu = 0});
  for (const char* file : {"map_normal.png", "round.gltf", "round.bin"}) {
    const std::string expected = read_file(folder_ / ("one/" + std::string(file)));
    EXPECT_EQ(read_file(folder_ / ("two/" + std::string(file))), expected) << file;
    EXPECT_EQ(read_file(folder_ / ("pinned/" + std::string(file))), expected) << file;
  }
  const RawImage before = read_image(folder_ / "round_map.png");
  const RawImage after = read_image(folder_ / "one/map_normal.png");
  EXPECT_NE(std::memcmp(before.data(), after.data(), before.size_bytes()), 0);
}

TEST_F(Verbs, DirectXTurnsGreenOver) {
  run_all({edit("map.png", "recipe.json", "gl", {"--preset", "opengl"}),
           edit("map.png", "recipe.json", "dx", {"--preset", "directx"})});
  const RawImage original = read_image(folder_ / "map.png");
  const RawImage gl = read_image(folder_ / "gl/skin_normal.png");
  const RawImage dx = read_image(folder_ / "dx/skin_normal.png");
  std::size_t unedited = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      bool same = true;
      for (int c = 0; c < 3; ++c) same = same && gl.code(x, y, c) == original.code(x, y, c);
      if (!same) continue;
      ++unedited;
      ASSERT_EQ(dx.code(x, y, 0), original.code(x, y, 0));
      ASSERT_EQ(dx.code(x, y, 1), 255.0F - original.code(x, y, 1));
      ASSERT_EQ(dx.code(x, y, 2), original.code(x, y, 2));
    }
  }
  EXPECT_GT(unedited, std::size_t{size} * size / 2);
}

TEST_F(Verbs, BitsChooseTheFile) {
  run_all({edit("map.png", "recipe.json", "b8", {"--bits", "8"}),
           edit("map.png", "recipe.json", "b16", {"--bits", "16"}),
           edit("map.png", "recipe.json", "b32", {"--bits", "32"}),
           edit("map.png", "recipe.json", "half", {"--size", "48"})});
  EXPECT_EQ(read_image(folder_ / "b8/skin_normal.png").type(), CodeType::U8);
  EXPECT_EQ(read_image(folder_ / "b16/skin_normal.png").type(), CodeType::U16);
  EXPECT_EQ(read_image(folder_ / "b32/skin_normal.exr").type(), CodeType::F32);
  EXPECT_FALSE(fs::exists(folder_ / "b32/skin_normal.png"));
  EXPECT_EQ(read_image(folder_ / "half/skin_normal.png").width(), 48);
  const Value result = compare("b16/skin_normal.png", "b32/skin_normal.exr");
  EXPECT_LT(number(result, "largest"), 0.01);
}

TEST_F(Verbs, ObjectSpaceAndBack) {
  write_file(folder_ / "none.json", std::string_view(R"({"version": 1, "edits": []})"));
  write_image(folder_ / "round_map.png", wavy_map(256, 3, CodeType::U16));
  write_gltf(folder_ / "round.gltf", hemisphere(16, 32), "round_map.png");
  run_all({{"edit", path("round.gltf"), "--recipe", path("none.json"), "--preset", "object", "-o",
            path("object")}});
  run_all({{"edit", path("round.gltf"), "--normal-map", path("object/map_normal.png"), "--space",
            "object", "--recipe", path("none.json"), "--preset", "opengl", "-o", path("back")},
           {"info", path("object/map_normal.png"), "--json"}});
  // Only texels inside the model's chart, a disk of radius 0.4, have a direction in object space.
  RawImage mask(256, 256, 1, CodeType::U8);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const double r = std::hypot(x - 127.5, y - 127.5) / 256.0;
      mask.row<std::uint8_t>(y)[x] = r < 0.39 ? 255 : 0;
    }
  }
  write_image(folder_ / "disk.png", mask);
  const Value result =
      compare("round_map.png", "back/map_normal.png", {"--mask", path("disk.png")});
  EXPECT_GT(number(result, "pixels"), 29000.0);
  EXPECT_LT(number(result, "mean"), 0.02);
  const Value changed = compare("round_map.png", "object/map_normal.png");
  EXPECT_GT(number(changed, "mean"), 20.0) << "object space was written";
}

}  // namespace
}  // namespace normalshop::test
