#pragma once

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/document/assets.h"
#include "normalshop/document/kernel_text.h"

namespace normalshop::test {

/// Masks, and the patches "cone.png", "wave.png", which tiles sideways, and "slanted.png", a plane
/// with fine waves; some kernels; and, for every text, one square letter of half an em around the
/// origin.
class FakeAssets : public Assets {
 public:
  Patch patch(const std::string& file) override {
    if (file == "wave.png") return wave();
    if (file == "slanted.png") return slanted();
    if (file != "cone.png") throw IoError(file + ": cannot be read: there is no such file");
    constexpr int size = 32;
    Patch patch{SlopeImage(size, size), MaskImage(size, size), {}};
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const Vec2f p(static_cast<float>(x) - 15.5F, 15.5F - static_cast<float>(y));
        patch.slopes(x, y) = p.norm() < 12.0F ? Vec2f(-0.5F * p.normalized()) : Vec2f(0.0F, 0.0F);
        patch.opacity(x, y) = p.norm() < 14.0F ? 1.0F : 0.0F;
      }
    }
    return patch;
  }
  /// "left.png" is 1 in its left half, "grey.png" 0.5, "black.png" 0.
  MaskImage mask(const std::string& file) override {
    if (file == "grey.png") return {3, 2, 0.5F};
    if (file == "black.png") return {4, 4, 0.0F};
    if (file != "left.png") throw IoError(file + ": cannot be read: there is no such file");
    MaskImage left(64, 16, 0.0F);
    for (int y = 0; y < 16; ++y) std::fill_n(left.row(y), 32, 1.0F);
    return left;
  }
  /// "blur.json", "edge.json", which has a sum of 0, "shift.json" (two pixels to the right), and
  /// "broken.json", which is none.
  Image<float> kernel(const std::string& file) override {
    if (file == "blur.json") return parse_kernel("[[1, 2, 1], [2, 4, 2], [1, 2, 1]]", file);
    if (file == "edge.json") return parse_kernel("[[0.5, 0, -0.5]]", file);
    if (file == "shift.json") return parse_kernel("[[0, 0, 0, 0, 1]]", file);
    if (file == "broken.json") return parse_kernel("[[1, 2, 1], [2, 4], [1, 2, 1]]", file);
    throw IoError(file + ": cannot be read: there is no such file");
  }
  Outline text(const std::string&, const std::string& font) override {
    if (!font.empty()) throw IoError(font + ": cannot be read: there is no such file");
    return {{{-0.25F, -0.25F}, {0.25F, -0.25F}, {0.25F, 0.25F}, {-0.25F, 0.25F}}};
  }

 private:
  /// Slopes (0.8 + (-1)^(x / 2) / 10, -0.3) in a circle of 28 pixels, and more outside of it.
  static Patch slanted() {
    Patch patch{SlopeImage(64, 64), MaskImage(64, 64), {}};
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const Vec2f p(static_cast<float>(x) - 31.5F, static_cast<float>(y) - 31.5F);
        const bool inside = p.norm() < 28.0F;
        patch.opacity(x, y) = inside ? 1.0F : 0.0F;
        patch.slopes(x, y) =
            inside ? Vec2f(x / 2 % 2 == 0 ? 0.9F : 0.7F, -0.3F) : Vec2f(9.0F, 9.0F);
      }
    }
    return patch;
  }
  /// Slopes (cos(2 pi x), 0) / 2 over a width of 1, x from the middle.
  static Patch wave() {
    Patch patch{SlopeImage(64, 32), {}, {}};
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 64; ++x) {
        const float phase = 6.2831853F * (static_cast<float>(x) - 31.5F) / 64.0F;
        patch.slopes(x, y) = {0.5F * std::cos(phase), 0.0F};
      }
    }
    return patch;
  }
};

}  // namespace normalshop::test
