#include "normalshop/core/normal_codes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace normalshop {

namespace {

float largest_code(CodeType type) {
  return type == CodeType::U8 ? 255.0F : type == CodeType::U16 ? 65535.0F : 1.0F;
}

/// Calls work(first code of a row) with the codes' own type.
template <class Image, class Work>
void with_row(Image& image, int y, Work&& work) {
  if (image.type() == CodeType::U8) return work(image.template row<std::uint8_t>(y));
  if (image.type() == CodeType::U16) return work(image.template row<std::uint16_t>(y));
  work(image.template row<float>(y));
}

template <class Code>
Code to_code(float value) {
  if constexpr (std::is_floating_point_v<Code>) {
    return value;
  } else {
    constexpr auto top = static_cast<float>(std::numeric_limits<Code>::max());
    const float clamped = value > 0.0F ? std::min(value, top) : 0.0F;  // NaN becomes 0
    return static_cast<Code>(static_cast<int>(clamped + 0.5F));
  }
}

/// All gains and zeros of codes are halves; exact ones make 0 the same code everywhere.
float nearest_half(float value) { return std::round(2.0F * value) / 2.0F; }

Vec3f complete(float x, float y, float z, const NormalConvention& convention) {
  if (convention.two_channel) z = std::sqrt(std::max(0.0F, 1.0F - x * x - y * y));
  return {convention.scale * x, (convention.green_down ? -convention.scale : convention.scale) * y,
          z};
}

template <class Code>
Vec3f decode(const Code* code, const NormalConvention& convention, const CodeRange& range) {
  const float x = static_cast<float>(code[0]) * range.scale + range.offset;
  const float y = static_cast<float>(code[1]) * range.scale + range.offset;
  if (convention.two_channel) return complete(x, y, 0.0F, convention);
  return complete(x, y, static_cast<float>(code[2]) * range.scale + range.offset, convention);
}

/// The vector as codes can hold it.
Vec3f storable(Vec3f v, const NormalConvention& convention, bool bounded) {
  v.head<2>() /= convention.scale;
  const float largest = v.cwiseAbs().maxCoeff();
  if (!(largest <= codes::longest_normal) || !v.allFinite()) return Vec3f::Zero();
  if (convention.two_channel) {
    const Vec3f held(v.x(), v.y(), std::max(v.z(), 0.0F));  // not mirrored
    return held.isZero() ? held : Vec3f(held.normalized());
  }
  return bounded && largest > 1.0F ? Vec3f(v / largest) : v;
}

}  // namespace

CodeRange code_range(CodeType type, const NormalConvention& convention) {
  if (type == CodeType::F32) return convention.signed_float ? CodeRange{1, 0} : CodeRange{2, -1};
  const float top = largest_code(type);
  if (!convention.centred_code) return {2.0F / top, -1.0F};
  const float centre = (top + 1.0F) / 2.0F;
  return {1.0F / (top - centre), -centre / (top - centre)};
}

namespace codes {

Vec3f decode_texel(const RawImage& image, const NormalConvention& convention,
                   const CodeRange& range, int x, int y) {
  Vec3f v;
  with_row(image, y, [&](const auto* row) {
    v = decode(row + static_cast<std::ptrdiff_t>(x) * image.channels(), convention, range);
  });
  return v;
}

void decode_row(const RawImage& image, const NormalConvention& convention, int x, int count, int y,
                Vec3f* vectors) {
  const CodeRange range = code_range(image.type(), convention);
  const int channels = image.channels();
  with_row(image, y, [&](const auto* row) {
    const auto* code = row + static_cast<std::ptrdiff_t>(x) * channels;
    for (int i = 0; i < count; ++i, code += channels) {
      vectors[i] = decode(code, convention, range);
    }
  });
}

void encode_texels(const Vec3f* vectors, int count, const NormalConvention& convention,
                   RawImage& image, int x0, int y) {
  const CodeRange range = code_range(image.type(), convention);
  const float gain = nearest_half(1.0F / range.scale);
  const float zero = nearest_half(-range.offset * gain);
  const float up = convention.green_down ? -gain : gain;
  const bool bounded = image.type() != CodeType::F32;
  const int channels = image.channels();
  with_row(image, y, [&]<class Code>(Code* row) {
    Code* code = row + static_cast<std::ptrdiff_t>(x0) * channels;
    for (int i = 0; i < count; ++i, code += channels) {
      const Vec3f v = storable(vectors[i], convention, bounded);
      code[0] = to_code<Code>(v.x() * gain + zero);
      code[1] = to_code<Code>(v.y() * up + zero);
      if (!convention.two_channel) code[2] = to_code<Code>(v.z() * gain + zero);
    }
  });
}

void copy_other_channels(const RawImage& from, int from_y, const std::vector<int>& columns,
                         RawImage& to, int to_y, int first) {
  const float opaque = largest_code(to.type());
  const float scale = opaque / largest_code(from.type());
  with_row(to, to_y, [&]<class To>(To* target) {
    with_row(from, from_y, [&](const auto* source) {
      for (int c = first; c < to.channels(); ++c) {
        for (int x = 0; x < to.width(); ++x) {
          const auto at = static_cast<std::ptrdiff_t>(columns[static_cast<std::size_t>(x)]);
          target[static_cast<std::ptrdiff_t>(x) * to.channels() + c] =
              c >= from.channels()
                  ? to_code<To>(opaque)
                  : to_code<To>(static_cast<float>(source[at * from.channels() + c]) * scale);
        }
      }
    });
  });
}

}  // namespace codes

}  // namespace normalshop
