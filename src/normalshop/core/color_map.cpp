#include "normalshop/core/color_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "normalshop/core/parallel.h"
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

namespace {

std::vector<float> linear_table(CodeType type) {
  std::vector<float> table;
  if (type == CodeType::F32) return table;
  const int count = type == CodeType::U8 ? 256 : 4096;
  for (int i = 0; i < count; ++i) {
    table.push_back(srgb_to_linear(static_cast<float>(i) / static_cast<float>(count - 1)));
  }
  return table;
}

/// 65535 / 255: an 8-bit code and the 16-bit one that shows the same.
constexpr int code_step = 257;

/// target(code) of every code, in an image of another type.
template <class From, class To, class Convert>
RawImage converted(const RawImage& source, CodeType type, const Convert& target) {
  RawImage out(source.width(), source.height(), source.channels(), type);
  const int codes = source.width() * source.channels();
  parallel_for(static_cast<std::size_t>(source.height()), 64, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      const From* from = source.row<From>(y);
      std::transform(from, from + codes, out.row<To>(y), target);
    }
  });
  return out;
}

float linear_of(std::uint16_t code) { return srgb_to_linear(static_cast<float>(code) / 65535.0F); }
float linear_of(float code) { return code; }

/// A linear value as code; the first argument tells the type.
std::uint16_t code_of(std::uint16_t /*type*/, float linear) {
  return static_cast<std::uint16_t>(
      std::lround(65535.0F * linear_to_srgb(std::clamp(linear, 0.0F, 1.0F))));
}
float code_of(float /*type*/, float linear) { return linear; }

}  // namespace

ColorMap::ColorMap(RawImage codes, const Vec3f& factor)
    : codes_(std::move(codes)),
      factor_(factor),
      to_linear_(linear_table(codes_.type())),
      type_(codes_.type()) {}

void ColorMap::begin_edits() {
  if (codes_.type() != CodeType::U8) return;
  codes_ = converted<std::uint8_t, std::uint16_t>(codes_, CodeType::U16, [](std::uint8_t code) {
    return static_cast<std::uint16_t>(code * code_step);
  });
  to_linear_ = linear_table(CodeType::U16);
}

void ColorMap::write_codes(const Rect& region, const std::uint8_t* codes) {
  const auto pixel =
      static_cast<std::size_t>(codes_.channels() * RawImage::code_size(codes_.type()));
  const std::size_t row = static_cast<std::size_t>(region.width()) * pixel;
  for (int y = region.y0; y < region.y1; ++y, codes += row) {
    std::memcpy(codes_.row_data(y) + static_cast<std::size_t>(region.x0) * pixel, codes, row);
  }
  edited_ = true;
}

void ColorMap::end_edits() {
  edited_ = false;
  if (codes_.type() == type_) return;
  codes_ = encode();
  to_linear_ = linear_table(type_);
}

RawImage ColorMap::encode() const {
  if (codes_.type() == type_) return codes_;
  return converted<std::uint16_t, std::uint8_t>(codes_, type_, [](std::uint16_t code) {
    return static_cast<std::uint8_t>((code + code_step / 2) / code_step);
  });
}

template <class T>
bool ColorMap::add_to(T* codes, const Vec3f& change) {
  Vec3f own = Vec3f::Zero();  // what the codes must grow by
  int shown = 0;
  for (int c = 0; c < 3; ++c) {
    if (factor_[c] == 0.0F) continue;
    own[c] = change[c] / factor_[c];
    ++shown;
  }
  const bool grey = codes_.channels() < 3;
  if (grey && shown > 0) own[0] = own.sum() / static_cast<float>(shown);
  bool changed = false;
  for (int c = 0; c < (grey ? 1 : 3); ++c) {
    if (own[c] == 0.0F) continue;
    const float sum = linear_of(codes[c]) + own[c];
    if (!std::isfinite(sum)) continue;
    const T code = code_of(T{}, sum);
    changed = changed || code != codes[c];
    codes[c] = code;
  }
  return changed;
}

bool ColorMap::add(int x, int y, const Vec3f& change) {
  const int i = x * codes_.channels();
  const bool changed = codes_.type() == CodeType::F32
                           ? add_to(codes_.row<float>(y) + i, change)
                           : add_to(codes_.row<std::uint16_t>(y) + i, change);
  if (changed) std::atomic_ref(edited_).store(true, std::memory_order_relaxed);
  return changed;
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
