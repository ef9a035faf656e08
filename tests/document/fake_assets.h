#pragma once

#include "normalshop/core/error.h"
#include "normalshop/document/assets.h"

namespace normalshop::test {

/// The patch "cone.png" and, for every text, one square letter of half an em around the origin.
class FakeAssets : public Assets {
 public:
  Patch patch(const std::string& file) override {
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
  Outline text(const std::string&, const std::string& font) override {
    if (!font.empty()) throw IoError(font + ": cannot be read: there is no such file");
    return {{{-0.25F, -0.25F}, {0.25F, -0.25F}, {0.25F, 0.25F}, {-0.25F, 0.25F}}};
  }
};

}  // namespace normalshop::test
