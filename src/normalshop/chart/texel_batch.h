#pragma once

#include <array>
#include <span>

#include "normalshop/chart/details.h"
#include "normalshop/chart/edit_sampler.h"

/// Push's arithmetic for many texels at once, private to floor 4.
namespace normalshop {

/// Up to `capacity` texels: what an edit does to them and what they hold. Vectors are in chart axes
/// and need not be unit, but for `stored` and `result`, which are in the map's own space.
struct TexelBatch {
  static constexpr int capacity = 64;
  using Lane = std::array<float, capacity>;
  struct Vectors {
    alignas(64) Lane x;
    alignas(64) Lane y;
    alignas(64) Lane z;
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
  // A texel's frame: tangent, bitangent, normal.
  Vectors tangent;
  Vectors bitangent;
  Vectors normal;
  Vectors base;               ///< along the base normal of the surface point that is edited
  Vectors stored;             ///< the vector that the map holds; its length does not matter
  alignas(64) Lane change_x;  ///< change times weight
  alignas(64) Lane change_y;
  alignas(64) Lane covered;  ///< coverage times weight
  Vectors result;            ///< unit
  alignas(64) Lane turn;     ///< 1 - cos of the angle between before and after

  void add(const Mat3f& frame, const Vec3f& along_base, const Vec3f& vector, const Effect& effect) {
    tangent.set(count, frame.col(0));
    bitangent.set(count, frame.col(1));
    normal.set(count, frame.col(2));
    base.set(count, along_base);
    stored.set(count, vector);
    const auto k = static_cast<std::size_t>(count);
    change_x[k] = effect.weight * effect.change.x();
    change_y[k] = effect.weight * effect.change.y();
    covered[k] = effect.weight * effect.coverage;
    ++count;
  }
};

/// Fills result and turn of the batch's texels: gradient_from_normal(), the edit,
/// normal_from_gradient() and the exact inverse of the frame.
void apply(EditMode mode, TexelBatch& batch);

}  // namespace normalshop
