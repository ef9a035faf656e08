#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/chart/push.h"
#include "normalshop/core/sample.h"

/// Reading an edit at surface points, private to floor 4.
namespace normalshop {

/// A triangle with what its points need to be found in the chart's depth.
struct PushTriangle : ChartTriangle {
  Vec2f depth_step = Vec2f::Zero();  ///< of its plane, per pixel; limited on edge-on triangles
  float slope = 0.0F;                ///< depth per length

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
    ChartTriangle::load(mesh, grid, triangle);
    const Vec3f across = points.col(1).cross(points.col(2));
    const float facing = std::abs(across.z());
    const float steep = across.head<2>().norm();
    constexpr float steepest = 20.0F;
    // Pixels to depth: the plane's gradient is -across.xy / across.z.
    const float limit = steepest * grid.pixel;
    depth_step.setZero();
    if (facing > 0.0F) {
      depth_step = -across.head<2>() / across.z();
      if (!(steep <= limit * facing)) depth_step *= limit * facing / steep;
    }
    if (!depth_step.allFinite()) depth_step.setZero();
    slope = depth_step.norm() / grid.pixel;
  }
};

/// What an edit does at one point of the surface.
struct Effect {
  Vec2f change = Vec2f::Zero();
  float weight = 0.0F;
  float coverage = 0.0F;

  bool any() const {
    return weight > 0.0F && (coverage > 0.0F || change.x() != 0.0F || change.y() != 0.0F);
  }
  /// The normal in chart axes after the edit. Both normals are unit.
  Vec3f apply(const Vec3f& before, const Vec3f& base, EditMode mode) const {
    const Vec2f own = gradient_from_normal(before, base, mode);
    Vec2f after = own + weight * change;
    if (coverage > 0.0F) after += weight * coverage * (base_gradient(base, mode) - own);
    return normal_from_gradient(after, base, mode);
  }
};

/// Answers Effect for points in the chart. Blocks of 8 x 8 pixels without effect are skipped.
class EditSampler {
 public:
  EditSampler(const EditingChart& chart, const ChartEdit& edit);

  const ChartGrid& grid() const { return chart_.grid; }
  EditMode mode() const { return edit_.mode; }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;
  /// `point`: pixel x, y and depth, on `triangle`; `base`: unit base normal in chart axes.
  Effect at(const PushTriangle& triangle, const Vec3f& point, const Vec3f& base) const;
  /// Cheap first question about a point: is anything active around it?
  bool active(float x, float y) const {
    if (!(x > -1.0F && y > -1.0F && x < right_ && y < bottom_)) return false;
    return blocks_
               .data()[(static_cast<int>(y) >> 3) * blocks_.width() + (static_cast<int>(x) >> 3)] !=
           0;
  }

 private:
  bool acts(int x, int y) const;
  Vec2f change_at(float x, float y) const;
  float coverage_at(float x, float y) const;
  float weight_at(const PushTriangle& triangle, const Vec3f& point, const Vec3f& base) const;

  const EditingChart& chart_;
  const ChartEdit& edit_;
  Rect region_;  ///< within the chart
  Image<std::uint8_t> blocks_;
  float right_ = 0.0F;  ///< of the blocks, in pixels
  float bottom_ = 0.0F;
};

}  // namespace normalshop
