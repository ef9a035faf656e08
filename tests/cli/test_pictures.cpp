#include <array>
#include <cmath>

#include "../io/temp_folder.h"
#include "cli/run_program.h"
#include "cli/small_models.h"
#include "support/same_codes.h"
#include <gtest/gtest.h>

#include "normalshop/document/edit_operator.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

/// The verbs that work on a picture with normals.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;

class Pictures : public ::testing::Test {
 protected:
  Pictures() {
    write_image(folder_ / "normal.png", wavy_map(size, 3, CodeType::U8));
    write_image(folder_ / "color.png", wavy_map(size, 4, CodeType::U8));
    write_image(folder_ / "small.png", wavy_map(8, 3, CodeType::U8));
    write_file(folder_ / "recipe.json", R"({"version": 1, "edits": [
        {"operator": "pen", "view": "front", "options": {"width": 10, "height": 3},
         "strokes": [[[-20, 0], [20, 6]]]}]})");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  RawImage image(const std::string& name) const { return read_image(folder_ / name); }
  ProgramRun good(const Arguments& arguments) const {
    const ProgramRun run = call_program(arguments);
    EXPECT_EQ(run.exit_code, 0) << command_line(arguments) << "\n" << run.err;
    return run;
  }
  /// The run fails with this code and one line that holds all of `names`, and writes nothing.
  void bad(const Arguments& arguments, int code, const std::vector<std::string>& names) const {
    const std::size_t before = files_in(folder_.path());
    const ProgramRun run = call_program(arguments);
    EXPECT_EQ(run.exit_code, code) << command_line(arguments);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    for (const std::string& name : names) {
      EXPECT_NE(run.err.find(name), std::string::npos) << "no " << name << " in: " << run.err;
    }
    EXPECT_EQ(files_in(folder_.path()), before) << command_line(arguments);
  }

  static constexpr int size = 64;
  TempFolder folder_;
};

TEST_F(Pictures, ARecipeEditsAPair) {
  good({"edit", path("color.png"), "--normals", path("normal.png"), "--recipe", path("recipe.json"),
        "-o", path("out")});
  const RawImage before = image("normal.png");
  const RawImage after = image("out/normal.png");
  ASSERT_EQ(after.size_bytes(), before.size_bytes());
  int changed = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      bool same = true;
      for (int c = 0; c < 3; ++c) same = same && after.code(x, y, c) == before.code(x, y, c);
      if (same) continue;
      ++changed;
      EXPECT_LT(std::abs(y - size / 2), 12) << x << " " << y;
    }
  }
  EXPECT_GT(changed, 200);
  EXPECT_TRUE(same_codes(image("color.png"), image("out/color.png")));
  const Value report = parse_json(read_file(folder_ / "out/report.json"), "report");
  EXPECT_GE(*report.find("texels_changed")->number(), changed);  // some round to the same code
  EXPECT_EQ(report.find("files")->array()->size(), 3U);
}

TEST_F(Pictures, AVerbIsARecipeOfOneEdit) {
  good({"edit", "--normals", path("normal.png"), "--recipe", path("recipe.json"), "-o",
        path("out")});
  const ProgramRun run = good({"pen", path("normal.png"), "--width", "10", "--height", "3",
                               "--stroke", "-20,0 20,6", "-o", path("verb.png"), "--json"});
  EXPECT_TRUE(same_codes(image("out/normal.png"), image("verb.png")));
  EXPECT_GT(*parse_json(run.out, "report").find("largest_change_degrees")->number(), 5.0);
}

TEST_F(Pictures, EveryOperatorIsAVerbWithItsOptions) {
  for (const OperatorType& type : operator_types()) {
    const std::string help = good({std::string(type.name), "--help"}).out;
    for (const Value& field : type.fields()) {
      EXPECT_NE(help.find("--" + *field.find("name")->text() + " "), std::string::npos)
          << type.name << " " << *field.find("name")->text();
    }
  }
}

TEST_F(Pictures, ListsOfNumbersHaveCommas) {
  good({"equalize", path("normal.png"), "--sigma", "1", "--gains", "0,1.5,-1", "-o",
        path("verb.png")});
  write_file(folder_ / "equalize.json", R"({"version": 1, "edits": [{"operator": "equalize",
      "view": "front", "options": {"sigma": 1, "gains": [0, 1.5, -1]}}]})");
  good({"edit", "--normals", path("normal.png"), "--recipe", path("equalize.json"), "-o",
        path("out")});
  EXPECT_TRUE(same_codes(image("out/normal.png"), image("verb.png")));
  EXPECT_FALSE(same_codes(image("normal.png"), image("verb.png")));
  for (const std::string gains : {"1;2", "", "1,,2", "1,x"}) {
    bad({"equalize", path("normal.png"), "--sigma", "1", "--gains", gains, "-o", path("o.png")}, 2,
        {"--gains"});
  }
  bad({"equalize", path("normal.png"), "--sigma", "1", "--gains", "1,200", "-o", path("o.png")}, 2,
      {"--gains[1] must be a number from -100 to 100", "200"});
}

TEST_F(Pictures, KernelsComeFromFiles) {
  write_file(folder_ / "blur.json", "[[1, 1, 1], [1, 1, 1], [1, 1, 1]]");
  write_file(folder_ / "edge.json", "[[1, 0, -1]]");
  write_file(folder_ / "broken.json", "[[1, 0, -1], [1, 2], [1, 0, 1]]");
  good({"convolve", path("normal.png"), "--kernel", path("blur.json"), "--normalize", "true", "-o",
        path("verb.png")});
  write_file(folder_ / "convolve.json", R"({"version": 1, "edits": [{"operator": "convolve",
      "view": "front", "options": {"kernel": "blur.json", "normalize": true}}]})");
  good({"edit", "--normals", path("normal.png"), "--recipe", path("convolve.json"), "-o",
        path("out")});
  EXPECT_TRUE(same_codes(image("out/normal.png"), image("verb.png")));
  EXPECT_FALSE(same_codes(image("normal.png"), image("verb.png")));
  const auto refuse = [&](const std::string& kernel, const std::vector<std::string>& names) {
    bad({"convolve", path("normal.png"), "--kernel", path(kernel), "--normalize", "true", "-o",
         path("o.png")},
        2, names);
  };
  refuse("none.json", {"--kernel", "none.json"});
  refuse("edge.json", {"--kernel", "sum"});
  refuse("broken.json", {"--kernel", "broken.json: row 2"});
  refuse("normal.png", {"--kernel", "normal.png", "JSON"});
}

TEST_F(Pictures, BitsAndGreenOfTheOutput) {
  good({"edit", "--normals", path("normal.png"), "--recipe", path("recipe.json"), "-o", path("out"),
        "--preset", "directx", "--bits", "16"});
  EXPECT_EQ(image("out/normal.png").type(), CodeType::U16);
  const double up = image("normal.png").code(3, 3, 1) / 255.0;
  EXPECT_NEAR(image("out/normal.png").code(3, 3, 1) / 65535.0, 1.0 - up, 1e-2);
}

TEST_F(Pictures, ConvertTurnsGreenAndBack) {
  good({"convert", path("normal.png"), "--green", "up", "--to-green", "down", "-o", path("d.png")});
  EXPECT_FALSE(same_codes(image("d.png"), image("normal.png")));
  good({"convert", path("d.png"), "--green", "down", "--to-green", "up", "-o", path("u.png")});
  EXPECT_TRUE(same_codes(image("u.png"), image("normal.png")));
  const ProgramRun run =
      good({"convert", path("normal.png"), "--normalize", "--json", "-o", path("n.png")});
  EXPECT_EQ(*parse_json(run.out, "convert").find("pixels")->number(), size * size);
  bad({"convert", path("normal.png"), "-o", path("normal.png")}, 1, {"normal.png", "input"});
}

TEST_F(Pictures, CheckAndProject) {
  const ProgramRun checked = good({"check", path("normal.png"), "--json", "-o", path("curl.png")});
  const Value report = parse_json(checked.out, "check");
  EXPECT_EQ(*report.find("pixels")->number(), size * size);
  EXPECT_EQ(*report.find("without_direction")->number(), 0.0);
  EXPECT_EQ(image("curl.png").width(), size);
  good({"project", path("normal.png"), "-o", path("flat.tif"), "--bits", "32"});
  const ProgramRun again = good({"check", path("flat.tif"), "--json"});
  EXPECT_LT(*parse_json(again.out, "check").find("curl_share")->number(), 1e-6);
}

TEST_F(Pictures, SegmentsAreLabelsPicturesAndMasks) {
  RawImage halves(size, size, 3, CodeType::U8);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      auto* p = halves.row<std::uint8_t>(y) + 3 * x;
      p[0] = x < size / 2 ? 128 : 218;
      p[1] = 128;
      p[2] = x < size / 2 ? 255 : 218;
    }
  }
  write_image(folder_ / "halves.png", halves);
  const ProgramRun run =
      good({"segment", path("halves.png"), "--sigma", "0", "-o", path("labels.png"), "--picture",
            path("picture.png"), "--select", "20,0", "--mask-output", path("mask.png"), "--json"});
  EXPECT_EQ(*parse_json(run.out, "segment").find("segments")->number(), 2.0);
  EXPECT_EQ(image("labels.png").code(3, 3, 0), 1.0F);
  EXPECT_EQ(image("labels.png").code(size - 3, 3, 0), 2.0F);
  EXPECT_EQ(image("mask.png").code(3, 3, 0), 0.0F);
  EXPECT_EQ(image("mask.png").code(size - 3, 3, 0), 255.0F);
  // The mask is one for edits.
  good({"flatten", path("halves.png"), "--mask", path("mask.png"), "-o", path("flat.png")});
  EXPECT_EQ(image("flat.png").code(3, 3, 0), 128.0F);
  EXPECT_NEAR(image("flat.png").code(size - 3, 3, 0), 127.5F, 1.0F);
}

/// A flat picture with two squares of 16 pixels that face right, and colours that tell them apart.
void write_squares(const fs::path& normals, const fs::path& colors) {
  RawImage codes(64, 64, 3, CodeType::U8);
  RawImage color(64, 64, 3, CodeType::U8);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const bool left = x >= 8 && x < 24 && y >= 8 && y < 24;
      const bool right = x >= 40 && x < 56 && y >= 40 && y < 56;
      auto* p = codes.row<std::uint8_t>(y) + 3 * x;
      p[0] = left || right ? 218 : 128;
      p[1] = 128;
      p[2] = left || right ? 218 : 255;
      auto* c = color.row<std::uint8_t>(y) + 3 * x;
      c[0] = c[1] = c[2] = right ? 250 : 100;
    }
  }
  write_image(normals, codes);
  write_image(colors, color);
}

TEST_F(Pictures, WandsAndLassosMakeMasks) {
  write_squares(folder_ / "squares.png", folder_ / "colors.png");
  const auto count = [&](Arguments arguments) {
    arguments.insert(arguments.begin(), {"segment", path("squares.png")});
    arguments.insert(arguments.end(), {"--mask-output", path("m.png"), "--json"});
    const Value report = parse_json(good(arguments).out, "segment");
    return static_cast<int>(*report.find("selected_pixels")->number());
  };
  const std::string color = path("colors.png");
  EXPECT_EQ(count({"--wand=-16,16"}), 256);
  EXPECT_EQ(image("m.png").code(10, 10, 0), 255.0F);
  EXPECT_EQ(image("m.png").code(30, 10, 0), 0.0F);
  EXPECT_EQ(image("m.png").code(45, 45, 0), 0.0F);
  EXPECT_EQ(count({"--wand=-16,16", "--everywhere"}), 512);
  EXPECT_EQ(count({"--wand=-16,16", "--everywhere", "--color", color}), 256);
  EXPECT_EQ(count({"--wand=-16,16", "--everywhere", "--color", color, "--color-tolerance", "2"}),
            512);
  EXPECT_EQ(count({"--wand=-16,16", "--angle-tolerance", "60"}), 64 * 64);
  // Union: both squares, by a wand each, by wand and lasso, and by all three.
  EXPECT_EQ(count({"--wand=-16,16", "--wand=16,-16"}), 512);
  const std::string lasso = "--lasso=8,-8 24,-8 24,-24 8,-24";
  EXPECT_EQ(count({lasso}), 256);
  EXPECT_EQ(image("m.png").code(39, 45, 0), 0.0F);
  EXPECT_EQ(image("m.png").code(40, 45, 0), 255.0F);
  EXPECT_EQ(image("m.png").code(55, 55, 0), 255.0F);
  EXPECT_EQ(image("m.png").code(55, 56, 0), 0.0F);
  EXPECT_EQ(count({"--wand=-16,16", lasso}), 512);
  EXPECT_EQ(count({"--sigma", "0", "--select=-16,16", "--wand=16,-16", lasso}), 512);
  // Beyond the picture's sides there is nothing to select; half a pixel is half selected.
  EXPECT_EQ(count({"--lasso=-500,0 500,0 0,500"}), 64 * 32);
  EXPECT_EQ(count({"--lasso=-16.5,-32 0,-32 0,32 -16.5,32"}), 17 * 64);
  EXPECT_NEAR(image("m.png").code(15, 20, 0), 127.5F, 1.0F);
  EXPECT_EQ(count({lasso, "--feather", "4"}), 256);
  EXPECT_GT(image("m.png").code(39, 48, 0), 40.0F);
}

TEST_F(Pictures, WandsAndLassosRefuseWhatIsNoPoint) {
  const auto refuse = [&](const std::string& flag, const std::vector<std::string>& names) {
    bad({"segment", path("normal.png"), flag, "--mask-output", path("m.png")}, 1, names);
  };
  refuse("--wand=40,0", {"40,0", "x from -32 to 32", "y up"});
  refuse("--wand=nan,0", {"nan,0", "x,y"});
  refuse("--wand=1 2", {"1 2", "x,y"});
  const std::vector<std::string> lasso = {"lasso", "at least 3 points x,y", "y up"};
  for (const std::string points : {"1,1 2,2", "1,1 2,2 3", "1,1 2,2 3,x", "1,1 2,2 inf,0",
                                   "1,1 2,2 1e30,0", "1,1;2,2;3,3", " "}) {
    refuse("--lasso=" + points, lasso);
  }
  bad({"segment", path("normal.png"), "--wand", "1,1", "-o", path("l.png")}, 1,
      {"need a file for the mask"});
  bad({"segment", path("normal.png"), "--mask-output", path("m.png")}, 1,
      {"needs places, wands or lassos"});
  bad({"segment", path("normal.png"), "--wand", "1,1", "--angle-tolerance", "200", "--mask-output",
       path("m.png")},
      1, {"angle_tolerance", "180"});
}

TEST_F(Pictures, ShadeLightsFromWhereItIsTold) {
  write_image(folder_ / "tilted.png", tilted_map(16, 40.0, CodeType::U8));  // towards +x
  good(
      {"shade", path("tilted.png"), "--light", "1,0,1", "--light", "1,0.1,1", "-o", path("r.png")});
  good({"shade", path("tilted.png"), "--light=-1,0,1", "--light=-1,0.1,1", "-o", path("l.png")});
  EXPECT_GT(image("r.png").code(8, 8, 1), image("l.png").code(8, 8, 1) + 60.0F);
  good({"shade", path("normal.png"), "--color", path("color.png"), "--shadows", "8", "-o",
        path("s.png")});
  EXPECT_EQ(image("s.png").width(), size);
  for (const std::string style : {"matte", "toon", "lines", "curvature", "exaggerated"}) {
    good({"shade", path("normal.png"), "--color", path("color.png"), "--style", style, "-o",
          path(style + ".png")});
    EXPECT_EQ(image(style + ".png").width(), size) << style;
  }
  good({"shade", path("tilted.png"), "--style", "toon", "--set", "bands=1", "-o", path("t.png")});
  bad({"shade", path("normal.png"), "--style", "toon", "--set", "bands=0", "-o", path("o.png")}, 2,
      {"--set.bands must be", "from 1 to 32"});
  bad({"shade", path("normal.png"), "--style", "toon", "--set", "bands", "-o", path("o.png")}, 2,
      {"NAME=VALUE"});
  bad({"shade", path("normal.png"), "--light", "1,2", "-o", path("o.png")}, 2,
      {"--light", "x,y,z"});
}

/// A ball of radius 20 before a wall that faces the viewer.
RawImage ball_map(int size) {
  RawImage codes(size, size, 3, CodeType::U16);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = x + 0.5 - 0.5 * size;
      const double v = 0.5 * size - y - 0.5;
      const double z = std::sqrt(std::max(0.0, 400.0 - u * u - v * v));
      const bool ball = z > 0.0;
      const std::array<double, 3> n{ball ? u / 20.0 : 0.0, ball ? v / 20.0 : 0.0,
                                    ball ? z / 20.0 : 1.0};
      for (int c = 0; c < 3; ++c) {
        codes.row<std::uint16_t>(y)[3 * x + c] =
            static_cast<std::uint16_t>(std::lround(65535.0 * 0.5 * (n[c] + 1.0)));
      }
    }
  }
  return codes;
}

TEST_F(Pictures, EdgesThrowShadowsAwayFromTheLight) {
  write_image(folder_ / "ball.png", ball_map(size));
  for (const std::string style : {"lit", "matte", "toon", "lines", "curvature", "exaggerated"}) {
    const Arguments shade{"shade", path("ball.png"), "--style", style, "--light=-1,0,1", "-o"};
    const auto shaded = [&](const std::string& name, const std::string& length) {
      Arguments all = shade;
      all.insert(all.end(), {path(name), "--edge-shadows", length});
      good(all);
      return image(name);
    };
    const RawImage without = shaded("without.png", "0");
    const RawImage with = shaded("with.png", "10");
    // Right of the ball, which ends at column 52; left of it and far off nothing changes.
    EXPECT_LT(with.code(54, 32, 1), without.code(54, 32, 1) - 8.0F) << style;
    EXPECT_LE(with.code(54, 32, 1), with.code(58, 32, 1)) << style;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < 20; ++x) {
        ASSERT_EQ(with.code(x, y, 1), without.code(x, y, 1)) << style << " " << x << ", " << y;
      }
    }
    EXPECT_EQ(with.code(63, 63, 1), without.code(63, 63, 1)) << style;
  }
  // The style's own light decides where there is no --light; one before the picture casts none.
  good({"shade", path("ball.png"), "--style", "toon", "--set", "azimuth=0", "--edge-shadows", "10",
        "-o", path("right.png")});
  EXPECT_LT(image("right.png").code(9, 32, 1), image("right.png").code(54, 32, 1) - 8.0F);
  good({"shade", path("ball.png"), "--style", "matte", "--light", "0,0,1", "--edge-shadows", "10",
        "-o", path("front.png")});
  EXPECT_EQ(image("front.png").code(54, 32, 1), image("front.png").code(2, 2, 1));
  for (const std::string length : {"-1", "5000", "nan"}) {
    bad({"shade", path("ball.png"), "--edge-shadows=" + length, "-o", path("o.png")}, 1,
        {"length must be a number from 0 to 1000"});
  }
}

TEST_F(Pictures, WrongUseIsOneSentence) {
  const std::string normal = path("normal.png");
  bad({"smooth", normal, "--sigma", "wide", "-o", path("o.png")}, 2,
      {"smooth: --sigma must be a number from 0", "wide"});
  bad({"pen", normal, "--width", "3", "--height", "1", "--stroke", "1;2", "-o", path("o.png")}, 2,
      {"--stroke", "x,y", "1;2"});
  bad({"pen", normal, "--width", "3", "--height", "1", "-o", path("o.png")}, 2,
      {"--stroke must have at least one"});
  bad({"stamp", normal, "--patch", path("none.png"), "--size", "9", "--stroke", "0,0", "-o",
       path("o.png")},
      2, {"none.png"});
  bad({"edit", "--recipe", path("recipe.json"), "-o", path("out")}, 2, {"--normals"});
  bad({"edit", path("color.png"), "--normals", normal, "--size", "64", "--recipe",
       path("recipe.json"), "-o", path("out")},
      2, {"--size", "models"});
  for (const std::string flag : {"--transfer", "--update"}) {
    bad({"edit", path("color.png"), "--normals", normal, flag, "point", "--recipe",
         path("recipe.json"), "-o", path("out")},
        2, {flag, "models", "its own chart"});
    bad({"edit", path("color.png"), flag, "splat", "--recipe", path("recipe.json"), "-o",
         path("out")},
        2, {flag, "splat"});
  }
  bad({"segment", normal}, 1, {"nothing would be written"});
}

TEST_F(Pictures, BadInputIsOneSentenceAndWritesNothing) {
  const std::string normal = path("normal.png");
  bad({"smooth", normal, "--sigma", "2", "-o", normal}, 1, {"normal.png", "input"});
  bad({"smooth", path("none.png"), "--sigma", "2", "-o", path("o.png")}, 1, {"none.png"});
  bad({"smooth", normal, "--color", path("small.png"), "--sigma", "2", "-o", path("o.png")}, 1,
      {"colours", "64 x 64", "8 x 8"});
  bad({"smooth", normal, "--mask", path("small.png"), "--sigma", "2", "-o", path("o.png")}, 1,
      {"mask", "64 x 64", "8 x 8"});
  bad({"pen", normal, "--width", "3", "--height", "1", "--stroke", "90,0 95,0", "-o",
       path("o.png")},
      1, {"--stroke lies off", "pixels", "-32 to 32"});
  bad({"smooth", normal, "--sigma", "2", "-o", path("o.xyz")}, 1, {"o.xyz"});
  bad({"segment", normal, "--select", "40,0", "--mask-output", path("m.png")}, 1, {"40,0", "32"});
  bad({"edit", "--normals", normal, "--recipe", path("recipe.json"), "-o", folder_.path().string()},
      1, {"input"});
}

}  // namespace
}  // namespace normalshop::test
