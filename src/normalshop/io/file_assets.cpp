#include "normalshop/io/file_assets.h"

#include <algorithm>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/slope.h"
#include "normalshop/document/kernel_text.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/outline_font.h"

namespace normalshop {

namespace {

constexpr int largest_patch = 8192;
constexpr std::size_t largest_file = std::size_t{1} << 34U;
constexpr std::size_t largest_kernel = std::size_t{1} << 23U;  // 255 x 255 long numbers fit

}  // namespace

const std::string& FileAssets::read(const std::string& name, const std::filesystem::path& path,
                                    std::size_t largest) {
  if (!given_) {
    read_.push_back({name, std::make_shared<const std::string>(read_file(path, largest))});
    return *read_.back().bytes;
  }
  for (const NamedFile& file : *given_) {
    if (file.name != name) continue;
    read_.push_back(file);
    return *file.bytes;
  }
  throw IoError("the document does not hold '" + name + "'");
}

Patch FileAssets::patch(const std::string& file) {
  const std::filesystem::path path = folder_ / file;
  RawImage codes =
      read_image(std::as_bytes(std::span(read(file, path, largest_file))), path.string());
  if (codes.width() > largest_patch || codes.height() > largest_patch) {
    throw InvalidInput(path.string() + ": a patch may have at most 8192 x 8192 pixels");
  }
  if (codes.channels() < 3) {
    throw InvalidInput(path.string() + ": a patch needs red, green and blue; this file has " +
                       std::to_string(codes.channels()) + " channels");
  }
  const bool alpha = codes.channels() == 4;
  NormalConvention convention = guess_convention(codes).convention;
  convention.space = NormalSpace::Tangent;
  convention.green_down = false;
  const NormalMap map(std::move(codes), convention);
  Patch patch;
  patch.slopes.resize(map.width(), map.height());
  if (alpha) patch.opacity.resize(map.width(), map.height());
  const float opaque = RawImage::full_code(map.codes().type());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const Vec3f n = map.normal(x, y);
      patch.slopes(x, y) = n.isZero() ? Vec2f(0.0F, 0.0F) : slope_from_normal(n);
      if (!alpha) continue;
      const float a = map.codes().code(x, y, 3) / opaque;
      patch.opacity(x, y) = a > 0.0F ? std::min(a, 1.0F) : 0.0F;  // NaN becomes 0
    }
  }
  return patch;
}

MaskImage FileAssets::mask(const std::string& file) {
  const std::filesystem::path path = folder_ / file;
  return mask_from_codes(
      read_image(std::as_bytes(std::span(read(file, path, largest_file))), path.string()));
}

Image<float> FileAssets::kernel(const std::string& file) {
  const std::filesystem::path path = folder_ / file;
  return parse_kernel(read(file, path, largest_kernel), path.string());
}

Outline FileAssets::text(const std::string& text, const std::string& font) {
  // A name with a folder or an extension is a file; else the system's fonts are searched.
  const std::filesystem::path name(font);
  const bool is_file = name.has_parent_path() || name.has_extension();
  const std::filesystem::path file = given_ ? name : is_file ? folder_ / name : font_file(name);
  return text_outlines(text, read(font, file, largest_file), file.string());
}

}  // namespace normalshop
