#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "normalshop/core/image.h"
#include "normalshop/core/raw_image.h"

/// Picture files: PNG, JPEG, TIFF, OpenEXR and TGA, told apart by their first bytes.
namespace normalshop {

inline constexpr int max_image_side = 65536;
inline constexpr std::size_t max_image_pixels = std::size_t{1} << 30;

/// What a file was and its RawImage does not say.
struct ImageTraits {
  bool tiff = false;
  bool half_float = false;  ///< F32 codes were 16-bit floats
};

/// The file's codes exactly as stored: no colour conversion, no alpha multiplication. Palettes are
/// expanded, fewer than 8 bits a channel are scaled to 8, half floats come as F32, further channels
/// than RGBA are left out. Throws IoError (missing, damaged, truncated) or InvalidInput (no
/// picture, a format or code type that is not accepted, too large). Fills `traits` if there are
/// any.
RawImage read_image(const std::filesystem::path& path, ImageTraits* traits = nullptr);
/// The same from memory; `name` stands for the file in messages.
RawImage read_image(std::span<const std::byte> bytes, std::string_view name,
                    ImageTraits* traits = nullptr);

struct ImageWriteOptions {
  bool half_float = false;  ///< OpenEXR only: 16-bit floats
};

/// Writes codes exactly (JPEG: as close as quality 95 allows), beside the target and then renamed.
/// The extension tells the format: .png (8, 16), .tif .tiff (8, 16, 32), .exr (32), .jpg .jpeg (8,
/// 1 or 3 channels), .tga (8). Throws InvalidInput when the format cannot hold the image, IoError
/// when it cannot be written.
void write_image(const std::filesystem::path& path, const RawImage& image,
                 const ImageWriteOptions& options = {});

/// The same for an image of `height` rows that need not be in memory at once: rows(y, count) makes
/// those from y on, from the top down.
void write_image(const std::filesystem::path& path, int height,
                 const std::function<RawImage(int y, int count)>& rows,
                 const ImageWriteOptions& options = {});

/// Linear RGB: 8- and 16-bit codes are taken as sRGB, floats as linear. Gray is repeated, alpha
/// left out.
ColorImage color_from_codes(const RawImage& codes);

/// A grey picture, or the mean of a coloured one's channels, as 0 (code 0 and NaN) to 1 (the
/// largest code); alpha left out. Throws like read_image().
MaskImage read_mask(const std::filesystem::path& path);
MaskImage mask_from_codes(const RawImage& codes);

/// 8-bit sRGB PNG of linear colours; values outside 0..1 are clamped.
void write_png_srgb(const std::filesystem::path& path, ColorView image);
/// The same of colours that are codes already.
void write_png_codes(const std::filesystem::path& path, ColorView image);

}  // namespace normalshop
