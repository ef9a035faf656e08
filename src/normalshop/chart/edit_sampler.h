#pragma once

#include <algorithm>
#include <cmath>

#include "normalshop/chart/push.h"
#include "normalshop/core/sample.h"

/// Reading an edit at surface points, private to floor 4.
namespace normalshop {

/// What an edit does at one point of the surface.
struct Effect {
  Vec2f change = Vec2f::Zero();
  float weight = 0.0F;
  float coverage = 0.0F;

  bool any() const {
    return weight > 0.0F && (coverage > 0.0F || change.x() != 0.0F || change.y() != 0.0F);
  }
  /// The normal in chart axes after the edit.
  Vec3f apply(const Vec3f& before, const Vec3f& base, EditMode mode) const;
};

/// Answers Effect for points in the chart. Blocks of 8 x 8 pixels without effect are skipped.
class EditSampler {
 public:
  EditSampler(const EditingChart& chart, const ChartEdit& edit);

  const ChartGrid& grid() const { return chart_.grid; }
  EditMode mode() const { return edit_.mode; }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;
  /// `point`: pixel x, y and depth; `base`: unit base normal in chart axes.
  Effect at(const Vec3f& point, const Vec3f& base) const;
  /// Cheap first question about a point: is anything active around it?
  bool active(float x, float y) const {
    const int bx = static_cast<int>(x) >> 3;
    const int by = static_cast<int>(y) >> 3;
    return x > -1.0F && y > -1.0F && bx < blocks_.width() && by < blocks_.height() &&
           blocks_(bx, by) != 0;
  }

 private:
  bool acts(int x, int y) const;
  bool visible(const Vec3f& point, const Vec3f& base) const;

  const EditingChart& chart_;
  const ChartEdit& edit_;
  Image<std::uint8_t> blocks_;
};

}  // namespace normalshop
