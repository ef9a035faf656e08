#include "normalshop/core/color_map.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/sample.h"
#include "normalshop/core/sample_bytes.h"

namespace normalshop {

float srgb_to_linear(float encoded) {
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

float linear_to_srgb(float linear) {
  if (!(linear > 0.0F)) return 0.0F;
  return linear <= 0.0031308F ? linear * 12.92F : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

ColorMap::ColorMap(RawImage codes, const Vec3f& factor)
    : codes_(std::move(codes)), factor_(factor) {
  if (codes_.type() == CodeType::F32) return;
  const int count = codes_.type() == CodeType::U8 ? 256 : 4096;
  for (int i = 0; i < count; ++i) {
    to_linear_.push_back(srgb_to_linear(static_cast<float>(i) / static_cast<float>(count - 1)));
  }
}

Vec3f ColorMap::texel(int x, int y) const {
  const int step = codes_.channels() >= 3 ? 1 : 0;
  const int i = x * codes_.channels();
  if (codes_.type() == CodeType::U8) {
    const std::uint8_t* p = codes_.row<std::uint8_t>(y) + i;
    return {to_linear_[p[0]], to_linear_[p[step]], to_linear_[p[2 * step]]};
  }
  if (codes_.type() == CodeType::U16) {
    const std::uint16_t* p = codes_.row<std::uint16_t>(y) + i;
    return {to_linear_[p[0] >> 4U], to_linear_[p[step] >> 4U], to_linear_[p[2 * step] >> 4U]};
  }
  const float* p = codes_.row<float>(y) + i;
  return {p[0], p[step], p[2 * step]};
}

Vec3f ColorMap::sample(const Vec2f& uv) const {
  if (empty()) return factor_;
  const WrappedTaps tap(uv, codes_.width(), codes_.height());
  if (codes_.type() == CodeType::U8) return sample_8bit(tap).cwiseProduct(factor_);
  const Vec3f upper = texel(tap.x0, tap.y0) * (1.0F - tap.fx) + texel(tap.x1, tap.y0) * tap.fx;
  const Vec3f lower = texel(tap.x0, tap.y1) * (1.0F - tap.fx) + texel(tap.x1, tap.y1) * tap.fx;
  return (upper * (1.0F - tap.fy) + lower * tap.fy).cwiseProduct(factor_);
}

void ColorMap::sample(const float* u, const float* v, int count, float* r, float* g,
                      float* b) const {
  if (!empty() && sample_bytes(codes_, to_linear_.data(), u, v, count, r, g, b)) {
    for (int i = 0; i < count; ++i) {
      r[i] *= factor_.x();
      g[i] *= factor_.y();
      b[i] *= factor_.z();
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    const Vec3f c = sample({u[i], v[i]});
    r[i] = c.x();
    g[i] = c.y();
    b[i] = c.z();
  }
}

Vec3f ColorMap::sample_8bit(const WrappedTaps& tap) const {
  const int channels = codes_.channels();
  const int step = channels >= 3 ? 1 : 0;
  const std::uint8_t* upper = codes_.row<std::uint8_t>(tap.y0);
  const std::uint8_t* lower = codes_.row<std::uint8_t>(tap.y1);
  const int left = tap.x0 * channels;
  const int right = tap.x1 * channels;
  const float* table = to_linear_.data();
  const auto mean = [&](int c) {
    const float top = table[upper[left + c]] * (1.0F - tap.fx) + table[upper[right + c]] * tap.fx;
    const float low = table[lower[left + c]] * (1.0F - tap.fx) + table[lower[right + c]] * tap.fx;
    return top * (1.0F - tap.fy) + low * tap.fy;
  };
  return {mean(0), mean(step), mean(2 * step)};
}

}  // namespace normalshop
