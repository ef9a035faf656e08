#pragma once

#include <array>
#include <cmath>

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/chart/details.h"

/// Push's arithmetic for many texels at once, private to floor 4.
namespace normalshop {

/// Surface steeper than this, in depth per length, counts as this steep.
inline constexpr float steepest_surface = 20.0F;

/// A triangle with what its points need to be found in the chart's depth.
struct PushTriangle : ChartTriangle {
  Vec2f depth_step = Vec2f::Zero();  ///< of its plane, per pixel; limited on edge-on triangles
  float steepness = 0.0F;            ///< its length

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle);
};

/// Up to `capacity` texels on their way through a push: where their surface points lie in the
/// chart, what the edit does there, what they hold and what they get. Vectors are in chart axes and
/// need not be unit, but for `stored` and `result`, which are in the map's own space.
struct TexelBatch {
  static constexpr int capacity = 64;
  static constexpr int padding = 16;  ///< room for the widest vector past the end
  using Lane = std::array<float, capacity + padding>;
  struct Vectors {
    alignas(64) Lane x{};
    alignas(64) Lane y{};
    alignas(64) Lane z{};
    void set(int i, const Vec3f& v) {
      const auto k = static_cast<std::size_t>(i);
      x[k] = v.x();
      y[k] = v.y();
      z[k] = v.z();
    }
    Vec3f get(int i) const {
      const auto k = static_cast<std::size_t>(i);
      return {x[k], y[k], z[k]};
    }
  };

  int count = 0;
  // The surface point of the edit: filled by add_run() and add_point().
  Vectors point;  ///< pixel x, pixel y, depth
  Vectors base;   ///< along the base normal
  alignas(64) Lane depth_dx{};
  alignas(64) Lane depth_dy{};
  alignas(64) Lane steepness{};
  // The edit there: filled by a sampler, all 0 where nothing happens.
  alignas(64) Lane weight{};  ///< of the effective chart; 0 where the chart does not see the point
  alignas(64) Lane change_x{};  ///< change times weight
  alignas(64) Lane change_y{};
  alignas(64) Lane change_z{};  ///< the third number of a colour's change
  alignas(64) Lane covered{};   ///< coverage times weight
  // The frame that decodes the texel.
  Vectors tangent;
  Vectors bitangent;
  Vectors normal;
  alignas(64) Lane sign{};     ///< of the bitangent, until finish_frames()
  alignas(64) Lane regular{};  ///< 0 where tangents give no frame
  Vectors stored;              ///< what the map holds; its length does not matter
  // After apply().
  Vectors result;           ///< unit
  alignas(64) Lane turn{};  ///< 1 - cos of the angle between before and after

  /// Does the edit do anything there? What is no number or has no unit normal does not.
  bool acts(int i) const {
    const auto k = static_cast<std::size_t>(i);
    const float size =
        std::abs(change_x[k]) + std::abs(change_y[k]) + std::abs(change_z[k]) + covered[k];
    return size > 0.0F && size < 1e18F;
  }
  void clear_edit(int i) {
    const auto k = static_cast<std::size_t>(i);
    change_x[k] = change_y[k] = change_z[k] = covered[k] = 0.0F;
  }
  void set_frame(int i, const Mat3f& frame) {
    tangent.set(i, frame.col(0));
    bitangent.set(i, frame.col(1));
    normal.set(i, frame.col(2));
  }
  /// Adds a surface point by its weights (1, b1, b2), with its frame as far as tangents give it.
  void add_point(const PushTriangle& triangle, const Vec3f& weights);
};

/// Adds `count` texels from (x, y) on to the right, which lie in one triangle, with their frames as
/// far as tangents give them: finish_frames() does the rest.
void add_run(const PushTriangle& triangle, const TexelAffine& affine, int x, int y, int count,
             TexelBatch& batch);
/// Bitangents of tangent-space frames; where tangents give none, any frame.
void finish_frames(TexelBatch& batch);

/// Fills result and turn of the texels that the edit acts on: gradient_from_normal(), the edit,
/// normal_from_gradient() and the exact inverse of the frame. A texel whose stored vector has no
/// direction counts as undetailed; one beyond the horizon of the edit's direction stays as far
/// beyond it.
void apply(const EditDirection& direction, TexelBatch& batch);

}  // namespace normalshop
