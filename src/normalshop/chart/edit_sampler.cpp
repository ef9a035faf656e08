#include "normalshop/chart/edit_sampler.h"

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr int block = 8;

/// Below this cosine to the viewing direction a point is left alone, whatever the weight says.
constexpr float grazing = 0.05F;

Image<std::uint8_t> dilate(const Image<std::uint8_t>& in) {
  Image<std::uint8_t> out(in.width(), in.height(), 0);
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      if (in(x, y) == 0) continue;
      const Rect around = intersect({x - 1, y - 1, x + 2, y + 2}, in.rect());
      for (int j = around.y0; j < around.y1; ++j) {
        std::fill_n(out.row(j) + around.x0, around.width(), std::uint8_t{1});
      }
    }
  }
  return out;
}

}  // namespace

EditSampler::EditSampler(const EditingChart& chart, const ChartEdit& edit)
    : chart_(chart), edit_(edit), region_(intersect(edit.region, edit.change.rect())) {
  Image<std::uint8_t> exact((chart.grid.width() + block - 1) / block,
                            (chart.grid.height() + block - 1) / block, 0);
  parallel_for(static_cast<std::size_t>(exact.height()), 4, [&](std::size_t a, std::size_t b) {
    const int first = std::max(static_cast<int>(a) * block, region_.y0);
    const int last = std::min(static_cast<int>(b) * block, region_.y1);
    for (int y = first; y < last; ++y) {
      std::uint8_t* row = exact.row(y / block);
      for (int x = region_.x0; x < region_.x1; ++x) {
        if (row[x / block] == 0 && acts(x, y)) row[x / block] = 1;
      }
    }
  });
  blocks_ = dilate(exact);  // the bicubic kernel reaches two pixels
  right_ = static_cast<float>(block * blocks_.width());
  bottom_ = static_cast<float>(block * blocks_.height());
}

bool EditSampler::acts(int x, int y) const {
  if (!(chart_.weight(x, y) > 0.0F)) return false;
  const Vec2f& c = edit_.change(x, y);
  return c.x() != 0.0F || c.y() != 0.0F || (!edit_.coverage.empty() && edit_.coverage(x, y) > 0.0F);
}

bool EditSampler::reaches(float x0, float y0, float x1, float y1) const {
  // Whatever a stray vertex gives stays within what int holds.
  const auto bounded = [](float v) { return v > -1.0F ? std::min(v, 1e6F) : -1.0F; };
  const Rect pixels =
      intersect({floor_to_int(bounded(x0)), floor_to_int(bounded(y0)),
                 static_cast<int>(bounded(x1)) + 1, static_cast<int>(bounded(y1)) + 1},
                chart_.ids.depth.rect());
  if (pixels.empty()) return false;
  for (int y = pixels.y0 / block; y <= (pixels.y1 - 1) / block; ++y) {
    for (int x = pixels.x0 / block; x <= (pixels.x1 - 1) / block; ++x) {
      if (blocks_(x, y) != 0) return true;
    }
  }
  return false;
}

/// The effective chart's weight around a point, read only from the pixels that show the point's
/// surface: those whose depth is what the triangle's plane has there, within what the surface may
/// bend over a pixel. 0 where no pixel around the point does: something nearer hides it.
float EditSampler::weight_at(const PushTriangle& triangle, const Vec3f& point) const {
  const Image<float>& depth = chart_.ids.depth;
  const int x0 = floor_to_int(point.x());
  const int y0 = floor_to_int(point.y());
  const float fx = point.x() - static_cast<float>(x0);
  const float fy = point.y() - static_cast<float>(y0);
  const float corner = point.z() - fx * triangle.depth_step.x() - fy * triangle.depth_step.y();
  // A point exactly on a pixel's border must not lose all its pixels.
  constexpr float least = 1e-4F;
  const std::array<float, 2> across{1.0F - fx + least, fx + least};
  const std::array<float, 2> down{1.0F - fy + least, fy + least};
  float sum = 0.0F;
  float total = 0.0F;
  for (int j = 0; j < 2; ++j) {
    const int y = y0 + j;
    if (y < 0 || y >= depth.height()) continue;
    const float* depths = depth.row(y);
    const float* weights = chart_.weight.row(y);
    const float row = corner + static_cast<float>(j) * triangle.depth_step.y();
    for (int i = 0; i < 2; ++i) {
      const int x = x0 + i;
      if (x < 0 || x >= depth.width()) continue;
      const float expected = row + static_cast<float>(i) * triangle.depth_step.x();
      if (!(std::abs(depths[x] - expected) <= triangle.tolerance)) continue;
      const float share = across[static_cast<std::size_t>(i)] * down[static_cast<std::size_t>(j)];
      sum += share * weights[x];
      total += share;
    }
  }
  return total > 0.0F ? sum / total : 0.0F;
}

/// Bicubic. Pixels outside the region count as 0, and the image's border continues within it.
Vec2f EditSampler::change_at(float x, float y) const {
  const SlopeView& change = edit_.change;
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const std::array<float, 4> wx = cubic_weights(x - static_cast<float>(x0));
  const std::array<float, 4> wy = cubic_weights(y - static_cast<float>(y0));
  float sum_x = 0.0F;
  float sum_y = 0.0F;
  if (x0 > region_.x0 && y0 > region_.y0 && x0 + 2 < region_.x1 && y0 + 2 < region_.y1) {
    for (int j = 0; j < 4; ++j) {
      const float* p = change.row(y0 - 1 + j)[x0 - 1].data();
      const float w = wy[static_cast<std::size_t>(j)];
      sum_x += w * (wx[0] * p[0] + wx[1] * p[2] + wx[2] * p[4] + wx[3] * p[6]);
      sum_y += w * (wx[0] * p[1] + wx[1] * p[3] + wx[2] * p[5] + wx[3] * p[7]);
    }
    return {sum_x, sum_y};
  }
  for (int j = 0; j < 4; ++j) {
    const int yj = std::clamp(y0 - 1 + j, 0, change.height() - 1);
    for (int i = 0; i < 4; ++i) {
      const int xi = std::clamp(x0 - 1 + i, 0, change.width() - 1);
      if (!region_.contains(xi, yj)) continue;
      const float w = wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)];
      sum_x += w * change(xi, yj).x();
      sum_y += w * change(xi, yj).y();
    }
  }
  return {sum_x, sum_y};
}

/// Bilinear, otherwise like change_at().
float EditSampler::coverage_at(float x, float y) const {
  const MaskView& coverage = edit_.coverage;
  const int x0 = floor_to_int(x);
  const int y0 = floor_to_int(y);
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  float sum = 0.0F;
  for (int j = 0; j < 2; ++j) {
    const int yj = std::clamp(y0 + j, 0, coverage.height() - 1);
    for (int i = 0; i < 2; ++i) {
      const int xi = std::clamp(x0 + i, 0, coverage.width() - 1);
      if (!region_.contains(xi, yj)) continue;
      sum += (i == 0 ? 1.0F - fx : fx) * (j == 0 ? 1.0F - fy : fy) * coverage(xi, yj);
    }
  }
  return std::clamp(sum, 0.0F, 1.0F);
}

Effect EditSampler::at(const PushTriangle& triangle, const Vec3f& weights, Vec3f& base) const {
  Effect effect;
  const Vec3f point = triangle.points * weights;
  const float x = point.x();
  const float y = point.y();
  if (!active(x, y)) return effect;
  base = triangle.normals * weights;
  if (!(base.z() > 0.0F && base.z() * base.z() > grazing * grazing * base.squaredNorm())) {
    return effect;
  }
  effect.weight = weight_at(triangle, point);
  if (!(effect.weight > 0.0F)) return effect;
  effect.change = change_at(x, y);
  if (!edit_.coverage.empty()) effect.coverage = coverage_at(x, y);
  return effect;
}

}  // namespace normalshop
