#pragma once

#include <cstddef>
#include <optional>

#include "normalshop/io/image_job.h"

namespace normalshop {

struct ConvertReport {
  std::size_t pixels = 0;
  std::size_t not_unit = 0;           ///< had another length than 1 by more than their codes' step
  std::size_t without_direction = 0;  ///< hold no direction, and still hold none
};

/// Writes the normals as `target` has them (no colours); with `normalize` every normal gets length
/// 1, as exactly as the written codes can say. Where nothing changes codes are kept bit for bit,
/// and alpha always. Throws IoError or InvalidInput, also where target.normals is one of the
/// inputs.
ConvertReport convert_image(const OpenImageOptions& input, const OpenedImage& opened,
                            const ImageExport& target, bool normalize);

/// Writes one mip level (NormalLevels; from 1 on) of the normals as `target` has them, or with a
/// `roughness` that of a material with what the level loses added (roughness_map), in 8 bits unless
/// target.type says otherwise. Throws IoError or InvalidInput.
void convert_level(const OpenImageOptions& input, const OpenedImage& opened,
                   const ImageExport& target, int level, std::optional<float> roughness);

}  // namespace normalshop
