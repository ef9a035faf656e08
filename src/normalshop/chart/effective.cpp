#include "normalshop/chart/effective.h"

#include <cmath>

#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr float degrees = 3.14159265358979F / 180.0F;
constexpr std::size_t rows_per_task = 16;

template <class Body>
void for_rows(int height, const Body& body) {
  parallel_for(static_cast<std::size_t>(height), rows_per_task,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
               });
}

/// How much deeper a plane with that normal gets from one pixel to the next, `along` its image axis
/// in chart axes. Grazing normals count as 80 degrees.
float expected_rise(const Vec3f& normal, const Vec2f& along) {
  const float z = std::max(normal.z(), 0.17F);
  return -(normal.x() * along.x() + normal.y() * along.y()) / z;
}

/// Depth step between two neighbouring pixels, `along` from the first to the second (chart axes).
bool is_step(const EditingChart& chart, int x0, int y0, int x1, int y1, const Vec2f& along) {
  if (chart.ids.triangle(x0, y0) == chart.ids.triangle(x1, y1)) return false;
  const float z0 = chart.ids.depth(x0, y0);
  const float z1 = chart.ids.depth(x1, y1);
  if (!std::isfinite(z0) || !std::isfinite(z1)) return false;
  const Vec3f& n0 = chart.base_normal(x0, y0);
  const Vec3f& n1 = chart.base_normal(x1, y1);
  if ((n0.z() > 0.0F) != (n1.z() > 0.0F)) return true;
  const float expected = 0.5F * (expected_rise(n0, along) + expected_rise(n1, along));
  const float rise = (z1 - z0) / chart.grid.pixel;
  return std::abs(rise - expected) > 2.0F + std::abs(expected);
}

}  // namespace

void find_depth_steps(const EditingChart& chart, Image<std::uint8_t>& steps) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  steps.resize(width, height);
  const Vec2f right(1.0F, 0.0F);
  const Vec2f down(0.0F, -1.0F);
  for_rows(height, [&](int y) {
    std::uint8_t* row = steps.row(y);
    bool before = false;  // step between x - 1 and x
    for (int x = 0; x < width; ++x) {
      const bool after = x + 1 < width && is_step(chart, x, y, x + 1, y, right);
      const bool below = y + 1 < height && is_step(chart, x, y, x, y + 1, down);
      const bool above = y > 0 && is_step(chart, x, y - 1, x, y, down);
      row[x] = before || after || below || above ? 1 : 0;
      before = after;
    }
  });
}

void distance_to(const Image<std::uint8_t>& set, int limit, MaskImage& distance) {
  const int width = set.width();
  const int height = set.height();
  const auto cap = static_cast<float>(limit);
  Image<float> across(width, height);  // squared distance along the row
  std::vector<std::uint8_t> used(static_cast<std::size_t>(height), 0);
  for_rows(height, [&](int y) {
    const std::uint8_t* row = set.row(y);
    float* out = across.row(y);
    int last = -limit;
    bool any = false;
    for (int x = 0; x < width; ++x) {
      if (row[x] != 0) last = x;
      any = any || row[x] != 0;
      out[x] = static_cast<float>(std::min(x - last, limit));
    }
    used[static_cast<std::size_t>(y)] = any ? 1 : 0;
    last = width + limit;
    for (int x = width - 1; x >= 0; --x) {
      if (row[x] != 0) last = x;
      out[x] = std::min(out[x], static_cast<float>(last - x));
      out[x] *= out[x];
    }
  });
  distance.resize(width, height);
  for_rows(height, [&](int y) {
    float* out = distance.row(y);
    std::fill_n(out, width, cap * cap);
    for (int j = std::max(0, y - limit); j <= std::min(height - 1, y + limit); ++j) {
      if (used[static_cast<std::size_t>(j)] == 0) continue;
      const float* in = across.row(j);
      const auto dy = static_cast<float>((y - j) * (y - j));
      for (int x = 0; x < width; ++x) out[x] = std::min(out[x], in[x] + dy);
    }
    for (int x = 0; x < width; ++x) out[x] = std::sqrt(out[x]);
  });
}

void compute_weight(EditingChart& chart, const EffectiveOptions& options) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  Image<std::uint8_t> steps;
  find_depth_steps(chart, steps);
  const float falloff = std::max(2.0F, options.step_falloff / chart.grid.pixel);
  const int limit = static_cast<int>(std::ceil(falloff)) + 1;
  distance_to(steps, limit, chart.weight);
  const float low = std::cos(options.zero_angle * degrees);
  const float high = std::cos(options.full_angle * degrees);
  for_rows(height, [&](int y) {
    float* weight = chart.weight.row(y);
    const Vec3f* normals = chart.base_normal.row(y);
    for (int x = 0; x < width; ++x) {
      const float facing = smoothstep(low, high, normals[x].z());
      weight[x] = facing > 0.0F ? facing * smoothstep(1.0F, falloff + 1.0F, weight[x]) : 0.0F;
    }
  });
}

}  // namespace normalshop
