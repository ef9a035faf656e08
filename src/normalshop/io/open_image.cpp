#include "normalshop/io/open_image.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/color_map.h"
#include "normalshop/io/detail/naming.h"
#include "normalshop/io/image_file.h"

namespace normalshop {

namespace {

template <class T>
void encode_pixel(const Vec3f& linear, int channels, T* target) {
  constexpr float full = static_cast<float>(T(-1));
  const auto code = [](float value) {
    return static_cast<T>(std::clamp(linear_to_srgb(value), 0.0F, 1.0F) * full + 0.5F);
  };
  if (channels < 3) {
    target[0] = code(linear.mean());
  } else {
    for (Eigen::Index c = 0; c < 3; ++c) target[c] = code(linear[c]);
  }
}

template <>
void encode_pixel(const Vec3f& linear, int channels, float* target) {
  if (channels < 3) {
    target[0] = linear.mean();
  } else {
    for (Eigen::Index c = 0; c < 3; ++c) target[c] = linear[c];
  }
}

template <class T>
void encode_row(const Vec3f* before, const Vec3f* after, int y, RawImage& codes) {
  T* row = codes.row<T>(y);
  for (int x = 0; x < codes.width(); ++x) {
    if (after[x] == before[x] || !after[x].allFinite()) continue;
    encode_pixel<T>(after[x], codes.channels(), row + x * codes.channels());
  }
}

}  // namespace

OpenedImage open_image(const OpenImageOptions& options) {
  ImageTraits traits;
  RawImage codes = read_image(options.normals, &traits);
  // Tangent space is that of the picture's plane, whatever the directions.
  const ConventionGuess guess = naming(
      options.normals.native(), [&] { return guess_convention(codes, NormalSpace::Tangent); });
  NormalConvention convention = guess.convention;
  if (options.green_down) convention.green_down = *options.green_down;
  ImageDocument::Images images;
  images.normals =
      naming(options.normals.native(), [&] { return NormalMap(std::move(codes), convention); });
  images.border = options.border;
  RawImage color_codes;
  if (!options.color.empty()) {
    color_codes = read_image(options.color);
    images.colors = color_from_codes(color_codes);
  }
  if (!options.mask.empty()) images.mask = read_mask(options.mask);
  const auto make = [&] { return ImageDocument(std::move(images)); };
  OpenedImage opened{
      naming(options.normals.native(), make), std::move(color_codes), guess, {}, traits.half_float};
  opened.notes.push_back("green is " + std::string(convention.green_down ? "down" : "up") +
                         (options.green_down ? ", as the flags say; it looks like " : ": ") +
                         guess.sentence);
  return opened;
}

RawImage encode_colors(const OpenedImage& opened) {
  RawImage codes = opened.color_codes;
  if (codes.empty()) return codes;
  const ColorImage before = color_from_codes(codes);
  const ColorImage& after = opened.document.colors();
  for (int y = 0; y < codes.height(); ++y) {
    switch (codes.type()) {
      case CodeType::U8:
        encode_row<std::uint8_t>(before.row(y), after.row(y), y, codes);
        break;
      case CodeType::U16:
        encode_row<std::uint16_t>(before.row(y), after.row(y), y, codes);
        break;
      case CodeType::F32:
        encode_row<float>(before.row(y), after.row(y), y, codes);
        break;
    }
  }
  return codes;
}

}  // namespace normalshop
