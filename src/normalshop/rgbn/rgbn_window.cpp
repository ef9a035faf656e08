#include "normalshop/rgbn/detail/rgbn_window.h"

#include <atomic>
#include <vector>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

std::vector<BorderPixel> border_pixels(int begin, int end, int size, Border border) {
  std::vector<BorderPixel> pixels;
  for (int i = begin; i < end; ++i) pixels.push_back(border_pixel(i, size, border));
  return pixels;
}

/// Copies one pixel; returns how far it counts.
float gather_pixel(const RgbnView& image, const BorderPixel& from_x, const BorderPixel& from_y,
                   Vec2f& slope, Vec3f* color) {
  const int x = from_x.index;
  const int y = from_y.index;
  slope = image.slopes(x, y);
  if (from_x.flipped) slope.x() = -slope.x();
  if (from_y.flipped) slope.y() = -slope.y();
  if (color != nullptr) *color = image.color(x, y);
  const float weight = image.validity.empty() ? 1.0F : image.validity(x, y);
  // 0 unless something is not finite.
  float zero = 0.0F * slope.x() + 0.0F * slope.y();
  if (color != nullptr) zero += 0.0F * color->x() + 0.0F * color->y() + 0.0F * color->z();
  if (zero == 0.0F && weight > 0.0F) return weight;
  slope.setZero();
  if (color != nullptr) color->setZero();
  return 0.0F;
}

}  // namespace

RgbnWindow make_window(const Rect& size, bool color) {
  RgbnWindow window;
  window.slopes.resize(size.width(), size.height());
  if (color) window.color.resize(size.width(), size.height());
  return window;
}

RgbnWindow gather_window(const RgbnView& image, const Rect& where, Border border) {
  assert(!image.slopes.empty());
  const Rect size = image.slopes.rect();
  const std::vector<BorderPixel> columns = border_pixels(where.x0, where.x1, size.x1, border);
  const std::vector<BorderPixel> rows = border_pixels(where.y0, where.y1, size.y1, border);
  RgbnWindow window = make_window(where, !image.color.empty());
  window.validity.resize(where.width(), where.height());
  std::atomic<bool> all_count = true;
  parallel_for(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
    bool ones = true;
    for (std::size_t i = begin; i < end; ++i) {
      const int y = static_cast<int>(i);
      for (int x = 0; x < where.width(); ++x) {
        Vec3f* color = window.color.empty() ? nullptr : &window.color(x, y);
        const float weight = gather_pixel(image, columns[static_cast<std::size_t>(x)], rows[i],
                                          window.slopes(x, y), color);
        window.validity(x, y) = weight;
        ones = ones && weight == 1.0F;
      }
    }
    if (!ones) all_count = false;
  });
  if (all_count) window.validity = {};
  return window;
}

bool all_count(const RgbnView& image, const Rect& where) {
  std::atomic<bool> all = true;
  parallel_for(static_cast<std::size_t>(where.height()), 64, [&](std::size_t a, std::size_t b) {
    // 0 unless something is not finite or does not count 1.
    float zero = 0.0F;
    for (int y = where.y0 + static_cast<int>(a); y < where.y0 + static_cast<int>(b); ++y) {
      for (int x = where.x0; x < where.x1; ++x) {
        zero += 0.0F * image.slopes(x, y).sum();
        if (!image.color.empty()) zero += 0.0F * image.color(x, y).sum();
        if (!image.validity.empty()) zero += std::abs(image.validity(x, y) - 1.0F);
      }
    }
    if (zero != 0.0F) all = false;
  });
  return all;
}

void copy_region(const RgbnView& source, const RgbnSpan& target, const Rect& region) {
  for (int y = region.y0; y < region.y1; ++y) {
    if (!target.slopes.empty()) {
      std::copy_n(source.slopes.row(y) + region.x0, region.width(),
                  target.slopes.row(y) + region.x0);
    }
    if (!target.color.empty()) {
      std::copy_n(source.color.row(y) + region.x0, region.width(), target.color.row(y) + region.x0);
    }
  }
}

}  // namespace normalshop
