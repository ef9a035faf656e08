#include "normalshop/rgbn/detail/normal_layer.h"

#include <atomic>
#include <cmath>

#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

/// Below this length a vector holds no direction.
constexpr float least_length = 1e-6F;

Vec3f unit_or_zero(const Vec3f& n) {
  const float length = n.norm();
  if (!(length > least_length) || !std::isfinite(length)) return Vec3f::Zero();
  return n / length;
}

}  // namespace

NormalLayer::NormalLayer(ImageView<Vec3f> normals, const Rect& rect)
    : rect_(intersect(rect, normals.rect())), normals_(rect_.width(), rect_.height()) {
  std::atomic<bool> gaps{false};
  for_each_row(rect_, [&](int y) {
    const Vec3f* from = normals.row(y);
    Vec3f* to = normals_.row(y - rect_.y0);
    bool whole = true;
    for (int x = rect_.x0; x < rect_.x1; ++x) {
      const Vec3f n = unit_or_zero(from[x]);
      whole = whole && has_direction(n);
      *to++ = n;
    }
    if (!whole) gaps = true;
  });
  has_gaps_ = gaps;
}

NormalLayer NormalLayer::smoothed(float sigma) const {
  if (sigma == 0.0F || rect_.empty()) return *this;
  const Rect all = normals_.rect();
  SlopeImage flat(all.width(), all.height());
  MaskImage valid(has_gaps_ ? all.width() : 0, has_gaps_ ? all.height() : 0);
  for_each_row(all, [&](int y) {
    for (int x = 0; x < all.width(); ++x) {
      flat(x, y) = normals_(x, y).head<2>();
      if (has_gaps_) valid(x, y) = has_direction(normals_(x, y)) ? 1.0F : 0.0F;
    }
  });
  smooth(flat, valid, flat, all, {.sigma = sigma});
  NormalLayer out;
  out.rect_ = rect_;
  out.has_gaps_ = has_gaps_;
  out.normals_.resize(all.width(), all.height());
  for_each_row(all, [&](int y) {
    for (int x = 0; x < all.width(); ++x) {
      const Vec2f& f = flat(x, y);
      const float n3 = std::sqrt(std::max(0.0F, 1.0F - f.squaredNorm()));
      const bool gap = has_gaps_ && valid(x, y) == 0.0F;
      out.normals_(x, y) = gap ? Vec3f(Vec3f::Zero()) : Vec3f(f.x(), f.y(), n3);
    }
  });
  return out;
}

int smoothing_reach(float sigma) { return reach(SmoothOptions{.sigma = sigma}); }

}  // namespace normalshop
