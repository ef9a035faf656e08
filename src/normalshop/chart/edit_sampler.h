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
  float tolerance = 0.0F;            ///< depths this far off the plane show it still

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
    // The surface may bend away by as much as the steeper of plane and base normals is steep.
    const float least =
        std::min({normals(2, 0), normals(2, 0) + normals(2, 1), normals(2, 0) + normals(2, 2)});
    const float bent = std::min(1.0F / std::max(least, 1e-6F), steepest) - 1.0F;
    tolerance = grid.pixel + std::max(depth_step.norm(), bent * grid.pixel);
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
};

/// Answers Effect for points in the chart. Blocks of 8 x 8 pixels without effect are skipped.
class EditSampler {
 public:
  EditSampler(const EditingChart& chart, const ChartEdit& edit);

  const ChartGrid& grid() const { return chart_.grid; }
  EditMode mode() const { return edit_.mode; }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;
  /// What happens at weights (1, b1, b2) of a triangle. `base` becomes the base normal there, in
  /// chart axes, not unit, unless nothing happens.
  Effect at(const PushTriangle& triangle, const Vec3f& weights, Vec3f& base) const;
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
  float weight_at(const PushTriangle& triangle, const Vec3f& point) const;

  const EditingChart& chart_;
  const ChartEdit& edit_;
  Rect region_;  ///< within the chart
  Image<std::uint8_t> blocks_;
  float right_ = 0.0F;  ///< of the blocks, in pixels
  float bottom_ = 0.0F;
};

}  // namespace normalshop
