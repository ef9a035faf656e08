#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/core/color_map.h"
#include "normalshop/core/parallel.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

namespace normalshop {

namespace {

constexpr std::size_t rows_per_task = 32;

std::vector<float> decoding_table(CodeType type) {
  const int top = type == CodeType::U8 ? 255 : 65535;
  std::vector<float> table(static_cast<std::size_t>(top) + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = srgb_to_linear(static_cast<float>(i) / static_cast<float>(top));
  }
  return table;
}

/// 8-bit code of a linear value that is rounded to 16 bits: off by at most 0.03 of a code from the
/// exact curve, so every 8-bit code comes back as it was.
const std::array<std::uint8_t, 65536>& encoding_table() {
  static const std::array<std::uint8_t, 65536> table = [] {
    std::array<std::uint8_t, 65536> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const float s = linear_to_srgb(static_cast<float>(i) / 65535.0F);
      t[i] = static_cast<std::uint8_t>(std::lround(255.0F * s));
    }
    return t;
  }();
  return table;
}

template <class T, class Decode>
void decode_row(const RawImage& codes, int y, Vec3f* target, Decode decode) {
  const T* source = codes.row<T>(y);
  const int step = codes.channels();
  const int green = step >= 3 ? 1 : 0;
  for (int x = 0; x < codes.width(); ++x, source += step) {
    target[x] = Vec3f(decode(source[0]), decode(source[green]), decode(source[2 * green]));
  }
}

template <class Encode>
void write_png(const std::filesystem::path& path, ColorView image, const Encode& encode) {
  RawImage codes(image.width(), image.height(), 3, CodeType::U8);
  const auto rows = static_cast<std::size_t>(image.height());
  parallel_for(rows, rows_per_task, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      auto* target = codes.row<std::uint8_t>(y);
      for (int x = 0; x < image.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          const float value = image(x, y)[c];
          // The comparison's order sends NaN to 0.
          *target++ = encode(value > 0.0F ? std::min(value, 1.0F) : 0.0F);
        }
      }
    }
  });
  write_image(path, codes);
}

}  // namespace

ColorImage color_from_codes(const RawImage& codes) {
  ColorImage image(codes.width(), codes.height());
  const std::vector<float> table =
      codes.type() == CodeType::F32 ? std::vector<float>() : decoding_table(codes.type());
  const auto look_up = [&](auto code) { return table[code]; };
  const auto rows = static_cast<std::size_t>(codes.height());
  parallel_for(rows, rows_per_task, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      if (codes.type() == CodeType::U8) decode_row<std::uint8_t>(codes, y, image.row(y), look_up);
      if (codes.type() == CodeType::U16) decode_row<std::uint16_t>(codes, y, image.row(y), look_up);
      if (codes.type() == CodeType::F32) {
        decode_row<float>(codes, y, image.row(y), [](float value) { return value; });
      }
    }
  });
  return image;
}

MaskImage read_mask(const std::filesystem::path& path) { return mask_from_codes(read_image(path)); }

MaskImage mask_from_codes(const RawImage& codes) {
  const int channels = codes.channels() >= 3 ? 3 : 1;
  const float full = RawImage::full_code(codes.type()) * static_cast<float>(channels);
  MaskImage mask(codes.width(), codes.height());
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      float sum = 0.0F;
      for (int c = 0; c < channels; ++c) sum += codes.code(x, y, c);
      mask(x, y) = sum > 0.0F ? std::min(sum / full, 1.0F) : 0.0F;  // NaN: 0
    }
  }
  return mask;
}

void write_png_srgb(const std::filesystem::path& path, ColorView image) {
  const auto& table = encoding_table();
  write_png(path, image, [&](float linear) {
    return table[static_cast<std::size_t>(linear * 65535.0F + 0.5F)];
  });
}

void write_png_codes(const std::filesystem::path& path, ColorView image) {
  write_png(path, image,
            [](float code) { return static_cast<std::uint8_t>(code * 255.0F + 0.5F); });
}

}  // namespace normalshop
