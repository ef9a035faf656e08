#include "normalshop/chart/footprint.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/normal_codes.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

int samples_along(float texels) {
  if (!(texels > fine_texels)) return 1;
  return static_cast<int>(std::ceil(std::min(texels, static_cast<float>(FootprintReader::most))));
}

float sample_offset(int i, int count) {
  return (static_cast<float>(i) + 0.5F) / static_cast<float>(count) - 0.5F;
}

/// The triangle's weights of its corners 1 and 2 at a place in the chart.
Vec2f weights_at(const PixelTriangle& triangle, const Vec2f& pixel) {
  return (pixel.x() - triangle.x0) * triangle.dx + (pixel.y() - triangle.y0) * triangle.dy;
}

Vec2f uv_at(const PixelTriangle& triangle, const Vec2f& weights) {
  return triangle.uv + weights.x() * triangle.uv1 + weights.y() * triangle.uv2;
}

float texels_along(const Vec2f& uv_step, const Vec2f& size) {
  return uv_step.cwiseProduct(size).norm();
}

int texel_of(float u, int size) {
  const float inside = u - static_cast<float>(floor_to_int(u));
  return std::clamp(static_cast<int>(inside * static_cast<float>(size)), 0, size - 1);
}

}  // namespace

void FootprintReader::begin(std::uint32_t triangle, int y) {
  triangle_ = triangles_.get(triangle);
  id_ = triangle;
  y_ = y;
}

/// Does the chart of the atlas go on to `uv`, so that the view shows it near that pixel? A triangle
/// that owns the texel must itself say so, to half a pixel.
bool FootprintReader::goes_on(const Vec2f& uv, const Vec2f& pixel, const Vec2f& size) {
  const Image<std::uint32_t>& owners = storage_.sets[triangle_.texture_set].texels.owner();
  if (owners.empty() || !(uv.cwiseAbs().maxCoeff() < 1e6F)) return false;
  const std::uint32_t owner =
      owners(texel_of(uv.x(), owners.width()), texel_of(uv.y(), owners.height()));
  if (owner == no_triangle) return false;
  if (owner == id_) return true;
  const PixelTriangle& other = triangles_.get(owner);
  Vec2f off = uv_at(other, weights_at(other, pixel)) - uv;
  off -= Vec2f(std::round(off.x()), std::round(off.y()));  // maps repeat
  const float pixel_texels =
      std::max(texels_along(triangle_.uv_dx, size), texels_along(triangle_.uv_dy, size));
  return off.cwiseProduct(size).norm() <= 0.5F * pixel_texels;
}

/// Where the chart's point `pixel` lies in the map, if the pixel in whose square it lies shows it.
std::optional<Vec2f> FootprintReader::place_of(const Vec2f& pixel, const Vec2f& size) {
  const Vec2f weights = weights_at(triangle_, pixel);
  const Vec2f uv = uv_at(triangle_, weights);
  const bool inside = weights.minCoeff() >= 0.0F && weights.sum() <= 1.0F;
  if (!inside && !goes_on(uv, pixel, size)) return std::nullopt;
  return reading_place(mesh_, triangle_.texture_set, uv, static_cast<int>(size.x()),
                       static_cast<int>(size.y()));
}

void FootprintReader::find_places(int x, const Vec2f& size) {
  const int across = samples_along(texels_along(triangle_.uv_dx, size));
  const int down = samples_along(texels_along(triangle_.uv_dy, size));
  const Vec2f center(static_cast<float>(x), static_cast<float>(y_));
  const auto add = [&](const Vec2f& place) {
    const auto k = static_cast<std::size_t>(count_++);
    u_[k] = place.x();
    v_[k] = place.y();
  };
  count_ = 0;
  const int last = across * down - 1;
  for (int i = 0; 2 * i <= last; ++i) {
    const Vec2f offset(sample_offset(i % across, across), sample_offset(i / across, down));
    const auto place = place_of(center + offset, size);
    const auto opposite = place ? place_of(center - offset, size) : std::nullopt;
    if (!opposite) continue;
    add(*place);
    if (2 * i < last) add(*opposite);
  }
}

bool FootprintReader::normal(int x, Vec3f& mean) {
  const NormalMap& map = storage_.sets[triangle_.texture_set].normals;
  find_places(x, Vec2f(static_cast<float>(map.width()), static_cast<float>(map.height())));
  if (count_ == 0) return false;
  map.sample(u_.data(), v_.data(), count_, a_.data(), b_.data(), c_.data());
  const bool tangent = map.convention().space == NormalSpace::Tangent;
  Vec3f sum = Vec3f::Zero();
  int directed = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const Vec3f n = codes::direction_of({a_[k], b_[k], c_[k]});
    if (n.isZero()) continue;
    ++directed;
    if (tangent) {
      sum.head<2>() -= slope_from_normal(n);
    } else {
      sum += n;
    }
  }
  if (tangent) sum.z() = static_cast<float>(directed);
  const float length = sum.norm();
  if (!(length > 1e-3F * static_cast<float>(directed))) return false;
  mean = sum / length;
  return true;
}

bool FootprintReader::color(int x, Vec3f& mean) {
  const ColorMap& map = storage_.sets[triangle_.texture_set].albedo;
  if (map.empty()) return false;
  const RawImage& codes = map.codes();
  find_places(x, Vec2f(static_cast<float>(codes.width()), static_cast<float>(codes.height())));
  if (count_ == 0) return false;
  map.sample(u_.data(), v_.data(), count_, a_.data(), b_.data(), c_.data());
  Vec3f sum = Vec3f::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    sum += Vec3f(a_[k], b_[k], c_[k]);
  }
  mean = sum / static_cast<float>(count_);
  return true;
}

}  // namespace normalshop
