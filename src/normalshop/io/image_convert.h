#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "normalshop/io/open_image.h"

namespace normalshop {

/// What of a picture's normals is to change. What is not given stays.
struct ConvertOptions {
  std::optional<bool> green_down = std::nullopt;  ///< of the written codes
  std::optional<CodeType> type = std::nullopt;
  bool normalize = false;  ///< every normal gets length 1, as exactly as the written codes can say
};

struct ConvertReport {
  std::size_t pixels = 0;
  std::size_t not_unit = 0;           ///< had another length than 1 by more than their codes' step
  std::size_t without_direction = 0;  ///< hold no direction, and still hold none
};

/// Writes the normals to `file` as `options` has them; its extension says the format. Where nothing
/// changes codes are kept bit for bit, and alpha always. Throws IoError or InvalidInput, also where
/// `file` is one of the inputs.
ConvertReport convert_image(const OpenImageOptions& input, const OpenedImage& opened,
                            const std::filesystem::path& file, const ConvertOptions& options);

}  // namespace normalshop
