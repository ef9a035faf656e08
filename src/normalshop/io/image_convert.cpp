#include "normalshop/io/image_convert.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_levels.h"
#include "normalshop/io/image_file.h"

namespace normalshop {

namespace {

/// Rounding x, y and z to codes moves a length by this much at most.
float length_step(CodeType type, const NormalConvention& convention, bool half_float) {
  const float half_root_three = 0.5F * std::sqrt(3.0F);
  if (type != CodeType::F32) return half_root_three * code_range(type, convention).scale;
  const float components = convention.signed_float ? 1.0F : 2.0F;
  return half_float ? half_root_three * components * 0x1p-11F : 1e-6F;
}

struct Converter {
  NormalMap& map;
  float unsure;  ///< lengths of imported codes may be this far from 1
  float kept;    ///< lengths this close to 1 stay as they are
  ConvertReport report;

  void convert_row(int y, bool normalize) {
    const auto width = static_cast<std::size_t>(map.width());
    std::vector<Vec3f> normals(width);
    std::vector<Vec3f> vectors(width);
    map.read_normals(y, normals.data());
    map.read_vectors(y, vectors.data());
    for (std::size_t x = 0; x < width; ++x) {
      if (normals[x].isZero()) {
        ++report.without_direction;
        continue;
      }
      const float error = std::abs(vectors[x].norm() - 1.0F);
      if (error > unsure) ++report.not_unit;
      if (normalize && error > kept) map.set_normal(static_cast<int>(x), y, normals[x]);
    }
  }
};

}  // namespace

ConvertReport convert_image(const OpenImageOptions& input, const OpenedImage& opened,
                            const ImageExport& target, bool normalize) {
  check_not_input(target.normals, input);
  NormalMap map = opened.document.normals();
  const CodeType type = map.codes().type();
  const float step = length_step(type, map.convention(), opened.half_float);
  const float written = target.type ? length_step(*target.type, map.convention(), false) : step;
  // Codes read as if the middle one stood for 0 (or not) are off by half a code more.
  const float unsure = type == CodeType::F32 ? step : 2.0F * step;
  Converter converter{map, unsure, std::min(step, written), {}};
  converter.report.pixels =
      static_cast<std::size_t>(map.width()) * static_cast<std::size_t>(map.height());
  for (int y = 0; y < map.height(); ++y) converter.convert_row(y, normalize);
  write_normals(map, opened.half_float, target);
  return converter.report;
}

void convert_level(const OpenImageOptions& input, const OpenedImage& opened,
                   const ImageExport& target, int level, std::optional<float> roughness) {
  check_not_input(target.normals, input);
  const NormalMap& map = opened.document.normals();
  const NormalLevels levels(map);
  if (roughness) {
    write_image(target.normals,
                roughness_map(levels, level, *roughness, target.type.value_or(CodeType::U8)));
    return;
  }
  if (level > levels.last()) {
    throw InvalidInput("the map has mip levels 1 to " + std::to_string(levels.last()) + ", not " +
                       std::to_string(level));
  }
  const NormalMap written(levels.encode(level, map.codes().type(), map.convention()),
                          map.convention());
  write_normals(written, opened.half_float, target);
}

}  // namespace normalshop
