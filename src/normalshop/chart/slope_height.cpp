#include "normalshop/chart/slope_height.h"

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/project.h"

namespace normalshop {

namespace {

constexpr float least_trust = 1e-3F;

}  // namespace

SlopeHeight::SlopeHeight(SlopeView slopes, MaskView weight, const Rect& region, int side)
    : region_(intersect(region, weight.rect())),
      step_(std::max(1, (std::max(region_.width(), region_.height()) + side - 1) / side)),
      height_((region_.width() + step_ - 1) / step_, (region_.height() + step_ - 1) / step_) {
  SlopeImage means(height_.width(), height_.height(), Vec2f(0.0F, 0.0F));
  MaskImage trust(height_.width(), height_.height(), 0.0F);
  for_pixels(trust.rect(), [&](int x, int y) {
    const int x0 = region_.x0 + x * step_;
    const int y0 = region_.y0 + y * step_;
    const Rect block = intersect({x0, y0, x0 + step_, y0 + step_}, region_);
    for (int j = block.y0; j < block.y1; ++j) {
      for (int i = block.x0; i < block.x1; ++i) {
        const float counts = std::max(weight(i, j), least_trust);
        means(x, y) += counts * slopes(i, j);
        trust(x, y) += counts;
      }
    }
    means(x, y) /= trust(x, y);
    trust(x, y) /= static_cast<float>(block.width() * block.height());
  });
  integrate_height(means, trust, height_, height_.rect(), {.tolerance = 1e-5F});
  // Lengths in single pixels; what holds no number has no height.
  const auto length = static_cast<float>(step_);
  for_pixels(height_.rect(), [&](int x, int y) {
    float& h = height_(x, y);
    h = std::isfinite(h) ? h * length : 0.0F;
  });
}

float SlopeHeight::at(int x, int y) const {
  if (step_ == 1) return coarse(x - region_.x0, y - region_.y0) - level_;
  const float scale = 1.0F / static_cast<float>(step_);
  const float px = (static_cast<float>(x - region_.x0) + 0.5F) * scale - 0.5F;
  const float py = (static_cast<float>(y - region_.y0) + 0.5F) * scale - 0.5F;
  const int i = floor_to_int(px);
  const int j = floor_to_int(py);
  const float fx = px - static_cast<float>(i);
  const float fy = py - static_cast<float>(j);
  const float above = (1.0F - fx) * coarse(i, j) + fx * coarse(i + 1, j);
  const float below = (1.0F - fx) * coarse(i, j + 1) + fx * coarse(i + 1, j + 1);
  return (1.0F - fy) * above + fy * below - level_;
}

float SlopeHeight::largest() const {
  float most = 0.0F;
  for (int y = 0; y < height_.height(); ++y) {
    for (int x = 0; x < height_.width(); ++x) {
      most = std::max(most, std::abs(height_(x, y) - level_));
    }
  }
  return most;
}

}  // namespace normalshop
