#include "normalshop/rgbn/selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/rows.h"
#include "normalshop/rgbn/mask.h"

namespace normalshop {

namespace {

/// Which pixels are like the seed.
class Likeness {
 public:
  Likeness(const RgbnView& image, const Vec2i& seed, const WandOptions& options)
      : image_(image),
        normal_(normal_from_slope(image.slopes(seed.x(), seed.y()))),
        color_tolerance_(options.color_tolerance * options.color_tolerance) {
    const double half_angle = static_cast<double>(options.angle_tolerance) * (degrees / 2.0);
    const double chord = 2.0 * std::sin(half_angle);
    chord_ = static_cast<float>(chord * chord);
    all_angles_ = options.angle_tolerance >= 180.0F;
    if (!image.color.empty()) color_ = image.color(seed.x(), seed.y());
  }

  bool operator()(int x, int y) const {
    if (!image_.validity.empty() && !(image_.validity(x, y) > 0.0F)) return false;
    const Vec2f& slope = image_.slopes(x, y);
    if (!slope.allFinite()) return false;
    if (!all_angles_ && !((normal_from_slope(slope) - normal_).squaredNorm() <= chord_)) {
      return false;
    }
    if (image_.color.empty()) return true;
    return (image_.color(x, y) - color_).squaredNorm() <= color_tolerance_;
  }

 private:
  static constexpr double degrees = 3.14159265358979323846 / 180.0;

  const RgbnView& image_;
  Vec3f normal_;
  Vec3f color_ = Vec3f::Zero();
  float color_tolerance_;
  float chord_;
  bool all_angles_;
};

/// Sets the mask to 1 in the piece of `alike` around the seed (side by side), which is cleared.
void flood(Image<std::uint8_t>& alike, const Vec2i& seed, bool wraps, MaskSpan mask) {
  std::vector<Vec2i> waiting = {seed};
  while (!waiting.empty()) {
    const Vec2i at = waiting.back();
    waiting.pop_back();
    std::uint8_t* row = alike.row(at.y());
    if (row[at.x()] == 0) continue;
    int x0 = at.x();
    int x1 = at.x() + 1;
    while (x0 > 0 && row[x0 - 1] != 0) --x0;
    while (x1 < alike.width() && row[x1] != 0) ++x1;
    std::fill(row + x0, row + x1, std::uint8_t{0});
    std::fill(mask.row(at.y()) + x0, mask.row(at.y()) + x1, 1.0F);
    if (wraps && x0 == 0) waiting.emplace_back(alike.width() - 1, at.y());
    if (wraps && x1 == alike.width()) waiting.emplace_back(0, at.y());
    for (int y : {at.y() - 1, at.y() + 1}) {
      if (wraps) y = border_pixel(y, alike.height(), Border::Wrap).index;
      if (y < 0 || y >= alike.height()) continue;
      const std::uint8_t* next = alike.row(y);
      for (int x = x0; x < x1; ++x) {
        if (next[x] != 0 && (x == x0 || next[x - 1] == 0)) waiting.emplace_back(x, y);
      }
    }
  }
}

/// Where an edge crosses a line, and which way.
struct Crossing {
  float x;
  int winding;
};

/// Adds `weight` times the part of each pixel that [x0, x1) covers. Pixel i is [i - 0.5, i + 0.5).
void add_span(float x0, float x1, float weight, int first, int end, float* row) {
  const float low = std::max(x0 + 0.5F, static_cast<float>(first));
  const float high = std::min(x1 + 0.5F, static_cast<float>(end));
  if (!(low < high)) return;
  for (int x = static_cast<int>(low); x < end && static_cast<float>(x) < high; ++x) {
    const auto left = static_cast<float>(x);
    row[x] += weight * (std::min(high, left + 1.0F) - std::max(low, left));
  }
}

constexpr int lines = 16;

/// Crossings of a line with the polygon, from left to right.
void find_crossings(std::span<const Vec2f> polygon, const std::vector<std::uint32_t>& edges,
                    double y, std::vector<Crossing>& crossings) {
  crossings.clear();
  for (const std::uint32_t i : edges) {
    const Vec2d a = polygon[i].cast<double>();
    const Vec2d b = polygon[i + 1 < polygon.size() ? i + 1 : 0].cast<double>();
    if ((a.y() <= y) == (b.y() <= y)) continue;
    const double t = (y - a.y()) / (b.y() - a.y());
    crossings.push_back({static_cast<float>(a.x() + t * (b.x() - a.x())), a.y() <= y ? 1 : -1});
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return a.x != b.x ? a.x < b.x : a.winding < b.winding;
  });
}

std::vector<std::uint32_t> edges_across(std::span<const Vec2f> polygon, float top, float bottom) {
  std::vector<std::uint32_t> edges;
  for (std::uint32_t i = 0; i < polygon.size(); ++i) {
    const float a = polygon[i].y();
    const float b = polygon[i + 1 < polygon.size() ? i + 1 : 0].y();
    if (std::max(a, b) >= top && std::min(a, b) <= bottom) edges.push_back(i);
  }
  return edges;
}

/// Rows [y0, y1) of the lasso.
void fill_polygon(std::span<const Vec2f> polygon, MaskSpan mask, const Rect& region, int y0,
                  int y1) {
  const std::vector<std::uint32_t> edges =
      edges_across(polygon, static_cast<float>(y0) - 0.5F, static_cast<float>(y1) - 0.5F);
  std::vector<Crossing> crossings;
  for (int y = y0; y < y1; ++y) {
    float* row = mask.row(y);
    std::fill(row + region.x0, row + region.x1, 0.0F);
    for (int line = 0; line < lines; ++line) {
      find_crossings(polygon, edges, y + (line + 0.5) / lines - 0.5, crossings);
      int winding = 0;
      for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        winding += crossings[i].winding;
        if (winding == 0) continue;
        add_span(crossings[i].x, crossings[i + 1].x, 1.0F / static_cast<float>(lines), region.x0,
                 region.x1, row);
      }
    }
    for (int x = region.x0; x < region.x1; ++x) row[x] = std::min(row[x], 1.0F);
  }
}

}  // namespace

Rect select_labels(ImageView<std::uint32_t> labels, std::span<const std::uint32_t> chosen,
                   MaskSpan mask, Rect region) {
  region = intersect(region, mask.rect());
  if (region.empty()) return {};
  std::vector<std::uint32_t> sorted(chosen.begin(), chosen.end());
  std::sort(sorted.begin(), sorted.end());
  for_pixels(region, [&](int x, int y) {
    const bool found = std::binary_search(sorted.begin(), sorted.end(), labels(x, y));
    mask(x, y) = found ? 1.0F : 0.0F;
  });
  return region;
}

Rect select_alike(const RgbnView& image, const Vec2i& seed, MaskSpan mask,
                  const WandOptions& options, Border border) {
  if (!(options.color_tolerance >= 0.0F && options.color_tolerance <= 1e6F)) {
    throw InvalidInput("select_alike: color_tolerance must be a number from 0 to 1000000");
  }
  if (!(options.angle_tolerance >= 0.0F && options.angle_tolerance <= 180.0F)) {
    throw InvalidInput("select_alike: angle_tolerance must be a number from 0 to 180");
  }
  for_pixels(mask.rect(), [&](int x, int y) { mask(x, y) = 0.0F; });
  if (!mask.rect().contains(seed.x(), seed.y())) return {};
  const Likeness is_alike(image, seed, options);
  if (!is_alike(seed.x(), seed.y())) return {};
  if (!options.contiguous) {
    for_pixels(mask.rect(), [&](int x, int y) { mask(x, y) = is_alike(x, y) ? 1.0F : 0.0F; });
    return bounds(mask);
  }
  Image<std::uint8_t> alike(mask.width(), mask.height());
  for_pixels(mask.rect(), [&](int x, int y) { alike(x, y) = is_alike(x, y) ? 1 : 0; });
  flood(alike, seed, border == Border::Wrap, mask);
  return bounds(mask);
}

Rect select_polygon(std::span<const Vec2f> polygon, MaskSpan mask, Rect region) {
  for (const Vec2f& point : polygon) {
    if (!point.allFinite()) throw InvalidInput("select_polygon: points must be finite numbers");
  }
  region = intersect(region, mask.rect());
  if (region.empty()) return {};
  parallel_for(static_cast<std::size_t>(region.height()), 16, [&](std::size_t a, std::size_t b) {
    fill_polygon(polygon, mask, region, region.y0 + static_cast<int>(a),
                 region.y0 + static_cast<int>(b));
  });
  return region;
}

}  // namespace normalshop
