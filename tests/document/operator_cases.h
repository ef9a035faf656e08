#pragma once

#include <set>
#include <string>
#include <vector>

#include "document/edit_fixture.h"

/// One edit with every operator of the registry, for tests of what holds for all of them.
namespace normalshop::test {

struct OperatorCase {
  std::string name;
  std::string options;  ///< the inside of the braces
  std::string strokes;  ///< empty: none
};

/// Lengths as parts of `size`, the width of what is edited; points lie within 0.3 of the middle. At
/// 128 pixels the lattice of the warp's brush has a node a pixel, so that it looks the same from
/// every pixel.
inline std::vector<OperatorCase> operator_cases(double size) {
  const auto length = [&](const char* name, double part) {
    return "\"" + std::string(name) + "\": " + std::to_string(part * size) + ", ";
  };
  const auto point = [&](double x, double y) {
    return "[" + std::to_string(x * size) + ", " + std::to_string(y * size) + "]";
  };
  const std::string line =
      "[[" + point(-0.3, -0.1) + ", " + point(0.1, 0.2) + ", " + point(0.25, -0.05) + "]]";
  const std::string loop =
      "[[" + point(-0.2, -0.2) + ", " + point(0.2, -0.15) + ", " + point(0.05, 0.2) + "]]";
  const std::string places = "[[" + point(-0.28, 0.1) + ", " + point(0.2, -0.2) + "]]";
  const std::string brush = length("brush", 0.2) + R"("area": "brush")";
  const std::string inside = length("feather", 0.05) + R"("area": "inside")";
  return {
      {"pen", length("width", 0.1) + length("height", 0.02) + R"("profile": "crease")", line},
      {"trim", length("width", 0.12) + R"("pattern": "wave.png", "border": 0.2)", line},
      {"stamp", length("size", 0.3) + R"("patch": "slanted.png", "high_pass": 0.1, "rotation": 30)",
       places},
      {"text",
       length("size", 0.25) + length("height", 0.02) + length("bevel", 0.04) +
           R"("text": "I", "rotation": 20)",
       places},
      {"combine",
       length("size", 0.25) + R"("image": "wave.png", "repeat": true, "relief": 0.3,
         "model": "rotation", )" +
           brush,
       line},
      {"transplant",
       length("size", 0.25) + length("sigma", 0.02) + R"("image": "wave.png", "repeat": true, )" +
           inside,
       loop},
      {"smooth", length("sigma", 0.01) + brush, line},
      {"sharpen", length("sigma", 0.02) + length("noise_sigma", 0.005) + R"("amount": 0.5)", ""},
      {"filter", length("sigma", 0.015) + R"("kind": "unsharp", "amount": -0.5)", ""},
      {"convolve", length("pixel", 0.012) + R"("kernel": "blur.json", "normalize": true)", ""},
      {"equalize", length("sigma", 0.01) + R"("gains": [0.5, 1.5], "base_gain": 0.9)", ""},
      {"denoise", length("sigma", 0.015) + R"("sigma_normal": 0.3)", ""},
      {"flatten", R"("slope_x": 0.1, )" + inside, loop},
      {"paint", R"("azimuth": 70, "tilt": 20, )" + brush, line},
      {"rotate", R"("angle": 25, "tilt": 10)", ""},
      {"balance", "", ""},
      {"project", "", ""},
      {"warp", length("radius", 0.0625) + R"("kind": "twirl", "amount": 0.6)", places}};
}

/// Are these cases of every operator that there is?
inline std::set<std::string> names_of_cases() {
  std::set<std::string> names;
  for (const OperatorCase& one : operator_cases(1.0)) names.insert(one.name);
  return names;
}
inline std::set<std::string> names_of_registry() {
  std::set<std::string> names;
  for (const OperatorType& type : operator_types()) names.emplace(type.name);
  return names;
}

/// `view` as JSON.
inline Edit edit_of(const OperatorCase& one, const std::string& view = "\"front\"") {
  const std::string strokes = one.strokes.empty() ? "" : R"(, "strokes": )" + one.strokes;
  return edit(R"("operator": ")" + one.name + R"(", "view": )" + view + R"(, "options": {)" +
              one.options + "}" + strokes);
}

}  // namespace normalshop::test
