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

Vec3f Effect::apply(const Vec3f& before, const Vec3f& base, EditMode mode) const {
  const Vec2f own = gradient_from_normal(before, base, mode);
  const Vec2f covered = coverage * (base_gradient(base, mode) - own);
  return normal_from_gradient(own + weight * (covered + change), base, mode);
}

EditSampler::EditSampler(const EditingChart& chart, const ChartEdit& edit)
    : chart_(chart), edit_(edit) {
  const Rect region = intersect(edit.region, edit.change.rect());
  Image<std::uint8_t> exact((chart.grid.width() + block - 1) / block,
                            (chart.grid.height() + block - 1) / block, 0);
  parallel_for(static_cast<std::size_t>(exact.height()), 4, [&](std::size_t a, std::size_t b) {
    const int first = std::max(static_cast<int>(a) * block, region.y0);
    const int last = std::min(static_cast<int>(b) * block, region.y1);
    for (int y = first; y < last; ++y) {
      std::uint8_t* row = exact.row(y / block);
      for (int x = region.x0; x < region.x1; ++x) {
        if (row[x / block] == 0 && acts(x, y)) row[x / block] = 1;
      }
    }
  });
  blocks_ = dilate(exact);  // the bicubic kernel reaches two pixels
}

bool EditSampler::acts(int x, int y) const {
  if (!(chart_.weight(x, y) > 0.0F)) return false;
  const Vec2f& c = edit_.change(x, y);
  return c.x() != 0.0F || c.y() != 0.0F || (!edit_.coverage.empty() && edit_.coverage(x, y) > 0.0F);
}

bool EditSampler::reaches(float x0, float y0, float x1, float y1) const {
  const Rect pixels = intersect(
      {static_cast<int>(std::floor(std::max(x0, -1.0F))),
       static_cast<int>(std::floor(std::max(y0, -1.0F))), static_cast<int>(std::min(x1, 1e6F)) + 1,
       static_cast<int>(std::min(y1, 1e6F)) + 1},
      chart_.ids.depth.rect());
  if (pixels.empty()) return false;
  for (int y = pixels.y0 / block; y <= (pixels.y1 - 1) / block; ++y) {
    for (int x = pixels.x0 / block; x <= (pixels.x1 - 1) / block; ++x) {
      if (blocks_(x, y) != 0) return true;
    }
  }
  return false;
}

/// A point lies on the surface that the chart shows if a pixel around it has its depth, within what
/// the slope changes over one and a half pixels.
bool EditSampler::visible(const Vec3f& point, const Vec3f& base) const {
  const Image<float>& depth = chart_.ids.depth;
  const float slope = std::sqrt(std::max(0.0F, 1.0F - base.z() * base.z())) / base.z();
  const float tolerance = chart_.grid.pixel * (1.0F + 1.5F * slope);
  const int x0 = static_cast<int>(std::floor(point.x()));
  const int y0 = static_cast<int>(std::floor(point.y()));
  for (int y = std::max(y0, 0); y <= std::min(y0 + 1, depth.height() - 1); ++y) {
    for (int x = std::max(x0, 0); x <= std::min(x0 + 1, depth.width() - 1); ++x) {
      if (std::abs(depth(x, y) - point.z()) <= tolerance) return true;
    }
  }
  return false;
}

Effect EditSampler::at(const Vec3f& point, const Vec3f& base) const {
  Effect effect;
  const float x = point.x();
  const float y = point.y();
  if (!active(x, y) || !(base.z() > grazing) || !visible(point, base)) return effect;
  effect.weight = sample_bilinear(chart_.weight.view(), x, y);
  if (!(effect.weight > 0.0F)) return effect;
  effect.change = sample_bicubic(edit_.change, x, y);
  if (!edit_.coverage.empty()) {
    effect.coverage = std::clamp(sample_bilinear(edit_.coverage, x, y), 0.0F, 1.0F);
  }
  return effect;
}

}  // namespace normalshop
