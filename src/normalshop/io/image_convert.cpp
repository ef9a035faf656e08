#include "normalshop/io/image_convert.h"

#include <cmath>
#include <utility>
#include <vector>

#include "normalshop/io/image_file.h"
#include "normalshop/io/image_job.h"

namespace normalshop {

namespace {

/// Rounding x, y and z to codes moves a length by this much at most.
float length_step(CodeType type) {
  const float scale = code_range(type, {}).scale;
  return type == CodeType::F32 ? 1e-6F : 0.5F * std::sqrt(3.0F) * scale;
}

void convert_row(NormalMap& map, int y, const ConvertOptions& options, ConvertReport& report) {
  const auto width = static_cast<std::size_t>(map.width());
  std::vector<Vec3f> normals(width);
  std::vector<Vec3f> vectors(width);
  map.read_normals(y, normals.data());
  map.read_vectors(y, vectors.data());
  const float step = length_step(map.codes().type());
  for (std::size_t x = 0; x < width; ++x) {
    Vec3f normal = normals[x];
    const bool directed = !normal.isZero();
    const bool unit = std::abs(vectors[x].norm() - 1.0F) <= step;
    if (!directed) ++report.without_direction;
    if (directed && !unit) ++report.not_unit;
    if (options.swap_red_green) std::swap(normal.x(), normal.y());
    const bool changes = options.swap_red_green || (options.normalize && !unit);
    if (directed && changes) map.set_normal(static_cast<int>(x), y, normal);
  }
}

}  // namespace

ConvertReport convert_image(const OpenImageOptions& input, const OpenedImage& opened,
                            const std::filesystem::path& file, const ConvertOptions& options) {
  check_not_input(file, input);
  NormalMap map = opened.document.normals();
  ConvertReport report;
  report.pixels = static_cast<std::size_t>(map.width()) * static_cast<std::size_t>(map.height());
  for (int y = 0; y < map.height(); ++y) convert_row(map, y, options, report);
  write_normals(map, opened.half_float, {file, {}, options.type, options.green_down});
  return report;
}

}  // namespace normalshop
