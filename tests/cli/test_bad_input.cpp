#include <cstring>
#include <set>

#include "../io/temp_folder.h"
#include "cli/crafted_files.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/meshes.h"
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model_info.h"

/// What a user does wrong ends in exit code 1 (2: wrong flags), one line that names what is wrong,
/// and the folders as they were.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

struct Case {
  Arguments arguments;
  std::vector<std::string> names;  ///< what the message must hold
  int exit_code = 1;
};

void expect_complaint(const Case& wrong, const ProgramRun& run) {
  SCOPED_TRACE(command_line(wrong.arguments));
  EXPECT_FALSE(run.timed_out);
  EXPECT_EQ(run.exit_code, wrong.exit_code);
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(run.err.starts_with("normalshop: ")) << run.err;
  EXPECT_EQ(run.err.find('\n'), run.err.size() - 1) << run.err;
  for (const std::string& name : wrong.names) {
    EXPECT_NE(run.err.find(name), std::string::npos) << "no " << name << " in: " << run.err;
  }
}

void expect_complaints(const std::vector<Case>& cases,
                       const std::optional<ProgramLimits>& limits = {}) {
  std::vector<Arguments> arguments;
  for (const Case& wrong : cases) arguments.push_back(wrong.arguments);
  const std::vector<ProgramRun> runs = run_all_of(arguments, limits);
  for (std::size_t i = 0; i < cases.size(); ++i) expect_complaint(cases[i], runs[i]);
}

std::set<std::string> tree(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    names.insert(entry.path().lexically_relative(folder).string());
  }
  return names;
}

/// A folder with a model, a map and a recipe that all are good.
class BadInput : public ::testing::Test {
 protected:
  BadInput() {
    write("square.obj", square_obj());
    write_image(folder_ / "map.png", wavy_map(64, 3, CodeType::U8));
    write("recipe.json", pen_recipe());
  }
  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    write_file(folder_ / name, text);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// Each run has an output folder of its own unless one is given.
  Arguments edit(const std::string& model, const std::string& map, const std::string& recipe,
                 std::string output = {}) {
    if (output.empty()) output = "out" + std::to_string(outputs_++);
    return {"edit",     path(model),  "--normal-map", path(map),
            "--recipe", path(recipe), "-o",           path(output)};
  }
  /// The complaints, and no file or folder more or less than before.
  void expect_nothing_left(const std::vector<Case>& cases,
                           const std::optional<ProgramLimits>& limits = {}) {
    const std::set<std::string> before = tree(folder_.path());
    expect_complaints(cases, limits);
    EXPECT_EQ(tree(folder_.path()), before);
  }

  static void expect_sentence(const std::string& message, const std::string& name) {
    EXPECT_NE(message.find(name), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  /// What the program itself would do, without the time that starting it takes.
  void read_if_possible(const std::string& name) {
    try {
      file_info(folder_ / name);
    } catch (const Error& error) {
      expect_sentence(error.what(), path(name));
    }
  }
  void expect_refused(const std::string& name) {
    try {
      file_info(folder_ / name);
      ADD_FAILURE() << name << " was accepted";
    } catch (const Error& error) {
      expect_sentence(error.what(), path(name));
    }
  }

  TempFolder folder_;
  int outputs_ = 0;
};

TEST_F(BadInput, TheGoodCaseIsGood) {
  const ProgramRun run = run_program(edit("square.obj", "map.png", "recipe.json", "new/out"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("note: "), std::string::npos);
  EXPECT_NE(run.err.find("square.mtl"), std::string::npos) << "a missing library is only noted";
  const std::set<std::string> expected{"square.obj", "square.mtl", "skin_normal.png",
                                       "report.json"};
  EXPECT_EQ(tree(folder_ / "new/out"), expected);
}

TEST_F(BadInput, Pictures) {
  std::vector<Case> cases{{{"info", path("none.png")}, {path("none.png")}}};
  ::testing::internal::CaptureStderr();
  for (const std::string extension : {"png", "jpg", "tif", "exr", "tga"}) {
    const bool floats = extension == "exr";
    write_image(folder_ / ("good." + extension),
                wavy_map(64, 3, floats ? CodeType::F32 : CodeType::U8));
    const std::string good = read_file(folder_ / ("good." + extension));
    EXPECT_EQ(read_image(folder_ / ("good." + extension)).width(), 64);
    const std::string noise = random_bytes(4000);
    write("third." + extension, good.substr(0, good.size() / 3));
    cases.push_back(
        {edit("square.obj", "third." + extension, "recipe.json"), {path("third." + extension)}});
    expect_refused("none." + extension);
    for (const std::string& bytes : {std::string(), noise, good.substr(0, 40) + noise}) {
      write("bad." + extension, bytes);
      expect_refused("bad." + extension);
    }
    for (std::size_t i = 1; i < 8; ++i) {
      write("bad." + extension, good.substr(0, i * good.size() / 8));
      expect_refused("bad." + extension);
    }
    Random random(5);
    for (int i = 0; i < 40; ++i) {
      std::string bytes = good;
      bytes[random.next() % bytes.size()] ^= static_cast<char>(1 + random.next() % 255);
      bytes[random.next() % 100] ^= static_cast<char>(random.next() % 256);
      write("bad." + extension, bytes);
      read_if_possible("bad." + extension);  // some damage cannot be seen
    }
    fs::remove(folder_ / ("bad." + extension));
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library speaks for itself";
  expect_nothing_left(cases);
}

TEST_F(BadInput, PicturesOfImpossibleSize) {
  const std::string png = read_file(folder_ / "map.png");
  const auto png_of = [&](std::uint32_t side) {
    return png.substr(0, 16) + big(side) + big(side) + png.substr(24);
  };
  write_image(folder_ / "good.exr", wavy_map(8, 3, CodeType::F32));
  const auto exr_of = [&](std::int32_t last) {
    std::string bytes = read_file(folder_ / "good.exr");
    for (const char* window : {"dataWindow", "displayWindow"}) {
      const std::size_t at = bytes.find(window) + std::strlen(window) + 1 + 6 + 4;
      const std::string corner = little(static_cast<std::uint32_t>(last), 4);
      bytes.replace(at + 8, 8, corner + corner);
    }
    return bytes;
  };
  write("zero.png", png_of(0));
  write("huge.png", png_of(100000));
  write("zero.tga", tga_header(0, 0) + std::string(100, 'x'));
  write("huge.tga", tga_header(65535, 65535) + std::string(100, 'x'));
  write("zero.tif", tiff_file(0, 0));
  write("huge.tif", tiff_file(100000, 100000));
  write("large.tif", tiff_file(30000, 30000));
  write("zero.exr", exr_of(-1));
  write("huge.exr", exr_of(99999));
  ::testing::internal::CaptureStderr();
  for (const char* name : {"zero.png", "huge.png", "zero.tga", "huge.tga", "zero.tif", "huge.tif",
                           "large.tif", "zero.exr", "huge.exr"}) {
    expect_refused(name);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "a library speaks for itself";
  expect_nothing_left({{edit("square.obj", "zero.tif", "recipe.json"), {path("zero.tif")}},
                       {edit("square.obj", "huge.png", "recipe.json"), {"huge.png", "100000"}}});
}

TEST_F(BadInput, Models) {
  const Mesh mesh = plane_grid(2);
  write_gltf(folder_ / "plane.gltf", mesh);
  const std::string gltf = read_file(folder_ / "plane.gltf");
  const std::string noise = random_bytes(3000);
  write("lonely/lonely.gltf", gltf);  // without its .bin
  fs::copy(folder_ / "plane.bin", folder_ / "short.bin");
  fs::resize_file(folder_ / "short.bin", 20);
  std::string short_gltf = gltf;
  short_gltf.replace(short_gltf.find("plane.bin"), 9, "short.bin");
  write("short.gltf", short_gltf);
  std::string no_uvs = gltf;
  no_uvs.replace(no_uvs.find("TEXCOORD_0"), 10, "_UNRELATED");
  write("no_uvs.gltf", no_uvs);
  write("no_uvs.obj", square_obj(false));
  write("third.gltf", gltf.substr(0, gltf.size() / 3));
  write("chunk.glb", "glTF" + little(2, 4) + little(400, 4) + little(900, 4) + "JSON" + "{}");
  write("third.glb", "glTF" + little(2, 4) + little(4000, 4) + little(900, 4) + "JSON" + "{}");
  write("third.obj", square_obj().substr(0, 40));
  write("index.obj", square_obj() + "f 1/1 2/2 9/3\n");
  write("word.obj", "v 0 zero 0\n" + square_obj());
  write("nan.obj", "v nan 0 0\n" + square_obj());
  std::vector<Case> cases{
      {{"info", path("lonely/lonely.gltf")}, {path("lonely/plane.bin")}},
      {{"info", path("short.gltf")}, {path("short.gltf"), "buffers[0]"}},
      {{"info", path("model.fbx")}, {path("model.fbx")}},
      {edit("no_uvs.gltf", "map.png", "recipe.json"),
       {"no_uvs.gltf", "texture coordinates", "normalshop unwrap"}},
      {edit("no_uvs.obj", "map.png", "recipe.json"),
       {"no_uvs.obj", "texture coordinates", "normalshop unwrap"}},
      {{"render", path("third.obj"), "-o", path("picture.png")}, {"third.obj"}}};
  ::testing::internal::CaptureStderr();
  for (const std::string extension : {"gltf", "glb", "obj"}) {
    write("empty." + extension, "");
    write("random." + extension, noise);
    for (const char* kind : {"none.", "empty.", "random.", "third."}) {
      expect_refused(kind + extension);
    }
    cases.push_back({{"info", path("random." + extension)}, {path("random." + extension)}});
  }
  for (const char* name : {"chunk.glb", "index.obj", "word.obj", "nan.obj"}) expect_refused(name);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  expect_nothing_left(cases);
}

TEST_F(BadInput, Recipes) {
  const auto with = [](std::string text, const std::string& old, const std::string& fresh) {
    return text.replace(text.find(old), old.size(), fresh);
  };
  const std::string good = pen_recipe();
  struct Wrong {
    std::string text;
    std::vector<std::string> names;
  };
  const std::vector<Wrong> recipes{
      {"", {"line 1"}},
      {good.substr(0, good.size() / 2), {"line 1"}},
      {with(good, "pen", "scribble"), {"edits[0].operator", "scribble", "smooth"}},
      {with(good, "\"width\": 0.2, ", ""), {"edits[0].options.width", "missing"}},
      {with(good, "\"width\"", "\"wide\": 1, \"width\""), {"edits[0].options", "wide"}},
      {with(good, "0.2", "NaN"), {"line 1"}},
      {with(good, "\"version\": 1", "\"version\": 2"), {"version", "2"}},
      {with(good, "[[[-0.6, 0.1], [0.5, 0.1]]]", "[[[7, 7], [8, 8]]]"),
       {"edits[0].strokes", "off the surface"}}};
  std::vector<Case> cases{{edit("square.obj", "map.png", "none.json"), {path("none.json")}}};
  for (std::size_t i = 0; i < recipes.size(); ++i) {
    const std::string name = "r" + std::to_string(i) + ".json";
    write(name, recipes[i].text);
    Case wrong{edit("square.obj", "map.png", name), recipes[i].names};
    wrong.names.push_back(path(name));
    cases.push_back(wrong);
  }
  expect_nothing_left(cases);
}

TEST_F(BadInput, Maps) {
  write_image(folder_ / "gray.png", wavy_map(8, 1, CodeType::U8));
  write_image(folder_ / "small.png", wavy_map(8, 3, CodeType::U8));
  expect_nothing_left({{edit("square.obj", "gray.png", "recipe.json"), {"gray.png", "channel"}},
                       {{"compare", path("map.png"), path("small.png"), "-o", path("picture.png")},
                        {"map.png has 64 x 64", "small.png has 8 x 8"}},
                       {{"compare", path("map.png"), path("map.png"), "--mask", path("small.png")},
                        {"small.png has 8 x 8"}},
                       {{"compare", path("map.png"), path("gray.png")}, {"gray.png"}},
                       {{"compare", path("map.png"), path("none.png")}, {path("none.png")}}});
}

TEST_F(BadInput, FoldersThatCannotBeWritten) {
  write("a file", "kept");
  expect_nothing_left(
      {{edit("square.obj", "map.png", "recipe.json", "a file"), {path("a file")}},
       {edit("square.obj", "map.png", "recipe.json", "a file/out"), {path("a file/out")}},
       {{"edit", path("square.obj"), "--recipe", path("recipe.json"), "-o", "/proc/none/out"},
        {"/proc/none/out"}},
       {edit("square.obj", "map.png", "recipe.json", "."), {"own folder"}},
       {{"render", path("square.obj"), "--size", "16", "--resolution", "9x9", "-o",
         path("none/picture.png")},
        {path("none")}},
       {{"render", path("square.obj"), "--size", "16", "--resolution", "9x9", "-o",
         path("picture.bmp")},
        {path("picture.bmp"), ".png"}},
       {{"compare", path("map.png"), path("map.png"), "-o", path("a file/picture.png")},
        {path("a file/picture.png")}},
       {{"demo", "-o", path("a file/demo")}, {path("a file/demo")}}});
  EXPECT_EQ(read_file(folder_ / "a file"), "kept");
}

/// A limit on the length of files does what a full disk does: writing fails in the middle.
TEST_F(BadInput, FilesThatCannotBeWrittenWhole) {
  write_image(folder_ / "map.tif", wavy_map(64, 3, CodeType::U8));
  write_image(folder_ / "map.exr", wavy_map(64, 3, CodeType::F32));
  write("out/skin_normal.png", "of an earlier run");
  Arguments wide = edit("square.obj", "map.png", "recipe.json", "wide");
  wide.insert(wide.end(), {"--bits", "16"});
  expect_nothing_left(
      {{edit("square.obj", "map.png", "recipe.json", "out"), {path("out/skin_normal.png")}},
       {wide, {path("wide/skin_normal.png")}},
       {edit("square.obj", "map.tif", "recipe.json", "t"), {path("t/skin_normal.tif")}},
       {edit("square.obj", "map.exr", "recipe.json", "e"), {path("e/skin_normal.exr")}},
       {{"render", path("square.obj"), "--normal-map", path("map.png"), "--resolution", "99x99",
         "-o", path("p.png")},
        {path("p.png")}}},
      ProgramLimits{.file_bytes = 1000});
  // Room for the map and the model, none for the report.
  write_image(folder_ / "small.png", tilted_map(8, 0.0, CodeType::U8));
  expect_nothing_left(
      {{edit("square.obj", "small.png", "recipe.json", "out"), {path("out/report.json")}}},
      ProgramLimits{.file_bytes = 700});
  EXPECT_EQ(read_file(folder_ / "out/skin_normal.png"), "of an earlier run");
}

TEST_F(BadInput, AnOutputThatTakesNothing) {
  const std::string run =
      std::string(NORMALSHOP_PROGRAM) + " describe > /dev/full 2> " + path("err");
  EXPECT_EQ(WEXITSTATUS(std::system(run.c_str())), 1);
  EXPECT_EQ(read_file(folder_ / "err"), "normalshop: cannot write to the standard output\n");
}

TEST_F(BadInput, FullDisk) {
  const fs::path disk = folder_ / "disk";
  fs::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=16k") != 0) {
    GTEST_SKIP() << "mounting a small disk is not permitted: " << std::strerror(errno);
  }
  write_image(folder_ / "large.png", wavy_map(256, 4, CodeType::U16));
  const std::set<std::string> before = tree(folder_.path());
  expect_complaints({{edit("square.obj", "large.png", "recipe.json", "disk/out"), {"disk/out"}},
                     {{"render", path("square.obj"), "--normal-map", path("large.png"),
                       "--resolution", "300x300", "-o", path("disk/picture.png")},
                      {"disk/picture.png"}}});
  EXPECT_EQ(tree(folder_.path()), before);
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

TEST_F(BadInput, Flags) {
  const Arguments good = edit("square.obj", "map.png", "recipe.json");
  const auto plus = [&](const Arguments& more) {
    Arguments all = good;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const auto picture = [&](const Arguments& more) {
    Arguments all{"render", path("square.obj"), "-o", path("p.png")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  expect_nothing_left(
      {{{}, {"--help"}, 2},
       {{"scribble"}, {"scribble"}, 2},
       {{"edit"}, {"--recipe", "normalshop edit --help"}, 2},
       {plus({"--colour"}), {"--colour"}, 2},
       {plus({"--space", "screen"}), {"--space", "tangent"}, 2},
       {plus({"--bits", "12"}), {"--bits", "16"}, 2},
       {plus({"--preset", "unity"}), {"--preset", "directx"}, 2},
       {{"render", path("square.obj"), "-o", path("p.png"), "--view", "0,0,0"}, {"--view"}, 2},
       {{"render", path("square.obj"), "-o", path("p.png"), "--resolution", "0x5"},
        {"--resolution", "0x5"},
        2},
       {{"render", path("square.obj"), "-o", path("p.png"), "--style", "toon"}, {"--style"}, 2},
       {{"render", path("square.obj"), "-o", path("p.png"), "--effective", "70,60"},
        {"--effective", "FULL < ZERO", "70,60"},
        2},
       {picture({"--width", "nan"}), {"--width", "nan"}, 2},
       {picture({"--width", "1e39"}), {"--width", "1e39"}, 2},
       {picture({"--width", "inf"}), {"--width"}, 2},
       {picture({"--width", "-1"}), {"--width"}, 2},
       {picture({"--center", "1e30,0,0"}), {"--center"}, 2},
       {picture({"--view", "nan,0,1"}), {"--view"}, 2},
       {{"compare", path("map.png")}, {"b is required"}, 2},
       {plus({"--albedo", "arm=" + path("map.png")}), {"arm=" + path("map.png")}}});
}

}  // namespace
}  // namespace normalshop::test
