#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "normalshop/core/image.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

/// What the styles and curvature share: a piece of a picture of normals at one scale.
namespace normalshop {

/// Calls body(y) for the rows of `region` on all cores.
template <class Body>
void for_each_row(const Rect& region, const Body& body) {
  parallel_for(static_cast<std::size_t>(region.height()), 8, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) body(region.y0 + static_cast<int>(i));
  });
}

/// Normals of the pixels `rect` of a picture: unit, or zero where there is no direction.
class NormalLayer {
 public:
  /// The part of `normals` in `rect`, which is first cut to the picture.
  NormalLayer(ImageView<Vec3f> normals, const Rect& rect);

  const Rect& rect() const { return rect_; }
  /// Pixel of the picture, within rect().
  const Vec3f& operator()(int x, int y) const { return row(y)[x]; }
  /// Indexed by the picture's x.
  const Vec3f* row(int y) const { return normals_.row(y - rect_.y0) - rect_.x0; }
  bool has_gaps() const { return has_gaps_; }

  /// This layer with (n1, n2) averaged by a Gaussian and n3 completing it to a unit normal; no
  /// direction doesn't count and stays. The curvature of the result is the average of the
  /// curvature, spheres stay spheres, and normals near the horizon weigh no more than others (as
  /// slopes they would drown their neighbours). Right for pixels 4 sigma within rect() and at the
  /// picture's own border.
  NormalLayer smoothed(float sigma) const;

 private:
  NormalLayer() = default;
  Rect rect_;
  Image<Vec3f> normals_;
  bool has_gaps_ = false;
};

inline bool has_direction(const Vec3f& n) {
  return n.x() != 0.0F || n.y() != 0.0F || n.z() != 0.0F;
}

/// Pixels beyond a region that smoothed() needs.
int smoothing_reach(float sigma);

/// Which of a pixel's neighbours belong to the same smooth piece of surface.
struct Links {
  bool left;
  bool right;
  bool up;
  bool down;
};

/// Least cosine of normals that differ by no more than `degrees`; 180 accepts every pair.
inline float guard_cosine(float degrees) {
  if (degrees >= 180.0F) return -2.0F;  // rounded products of unit vectors may fall below -1
  return static_cast<float>(std::cos(static_cast<double>(degrees) * (3.14159265358979324 / 180.0)));
}

/// Neighbours in the layer that have a direction within acos(least_cosine) of the pixel's own.
inline Links links_at(const NormalLayer& layer, int x, int y, float least_cosine) {
  const Vec3f& n = layer(x, y);
  const Rect& r = layer.rect();
  const auto linked = [&](int i, int j) {
    const Vec3f& other = layer(i, j);
    return has_direction(other) && n.dot(other) >= least_cosine;
  };
  return {x > r.x0 && linked(x - 1, y), x + 1 < r.x1 && linked(x + 1, y),
          y > r.y0 && linked(x, y - 1), y + 1 < r.y1 && linked(x, y + 1)};
}

/// Derivative along a line of pixels from the neighbours that are linked; 0 when none is.
template <class T>
T slope_between(bool has_before, bool has_after, const T& before, const T& here, const T& after) {
  if (has_before && has_after) return 0.5F * (after - before);
  if (has_after) return after - here;
  if (has_before) return here - before;
  return zero<T>();
}

/// d(n1, n2) / d(x, y), y up, of the linked neighbours of a pixel.
inline Mat2f normal_jacobian(const NormalLayer& layer, const Links& links, int x, int y) {
  const Vec2f here = layer(x, y).head<2>();
  const auto at = [&](bool is_linked, int i, int j) -> Vec2f {
    return is_linked ? Vec2f(layer(i, j).head<2>()) : here;
  };
  Mat2f jacobian;
  jacobian.col(0) = slope_between<Vec2f>(links.left, links.right, at(links.left, x - 1, y), here,
                                         at(links.right, x + 1, y));
  jacobian.col(1) = slope_between<Vec2f>(links.down, links.up, at(links.down, x, y + 1), here,
                                         at(links.up, x, y - 1));
  return jacobian;
}

}  // namespace normalshop
