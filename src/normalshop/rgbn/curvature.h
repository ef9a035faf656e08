#pragma once

#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

/// How a surface bends, from its normals alone. Lengths are pixels, so curvatures are 1 / pixels:
/// positive where it is convex towards the viewer, 1 / R on a sphere of radius R. Foreshortening is
/// exact, because projecting the tangent plane into the picture maps (n1, n2) along with it: the
/// shape operator in picture coordinates is J = d(n1, n2) / d(x, y). Source: Toler-Franklin et al.
/// 2007 (RGBN images).
namespace normalshop {

struct CurvatureOptions {
  float sigma = 1.0F;
  float guard = 60.0F;

  static constexpr auto fields() {
    return std::tuple{
        field("sigma", &CurvatureOptions::sigma, "length", 0.0, 1e4,
              "Details smaller than about this are averaged first; 0 takes differences of the "
              "normals as they are"),
        field("guard", &CurvatureOptions::guard, "degrees", 0.0, 180.0,
              "Neighbours whose normals differ by more count as different surfaces; 180 joins "
              "everything")};
  }
};

/// k1 >= k2: the most convex and the most concave bend. e1, e2: their directions as they appear in
/// the picture, unit, x right, y up; perpendicular on the surface, not in the picture. Where all
/// directions bend alike they are any such pair.
struct Curvature {
  float k1 = 0.0F;
  float k2 = 0.0F;
  Vec2f e1 = Vec2f(1.0F, 0.0F);
  Vec2f e2 = Vec2f(0.0F, 1.0F);

  float mean() const { return 0.5F * (k1 + k2); }
  float gaussian() const { return k1 * k2; }
};

/// Curvature in `region` of unit normals in view axes (zero: nothing there, curvature 0).
/// Derivatives are central differences of the smoothed normals, one-sided beside a neighbour that
/// is missing or fails the guard. The guard looks at the normals before smoothing; the smoothing
/// itself knows gaps but not creases. Where normals are not those of any height, the part of J that
/// is symmetric on the surface counts. All images have one size. Returns the pixels that it wrote.
/// Throws InvalidInput for options out of range.
Rect curvature(ImageView<Vec3f> normals, ImageSpan<Curvature> target, Rect region,
               const CurvatureOptions& options = {});

/// Mean curvature H = 1/2 (d n1 / dx + d n2 / dy) alone, which is faster.
Rect mean_curvature(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                    const CurvatureOptions& options = {});

/// Gaussian curvature K = det J alone, 1 / pixels^2 (J as it is, also without a height).
Rect gaussian_curvature(ImageView<Vec3f> normals, MaskSpan target, Rect region,
                        const CurvatureOptions& options = {});

/// Pixels read beyond the region.
int reach(const CurvatureOptions& options);

}  // namespace normalshop
