#include "normalshop/rgbn/emboss.h"

#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/rgbn/detail/polyline_field.h"

namespace normalshop {

namespace {

constexpr float least_bevel = 2.0F;

void check(const Outline& outline, const EmbossOptions& o) {
  if (!std::isfinite(o.size) || !std::isfinite(o.height) || !std::isfinite(o.bevel) ||
      o.size < 0.0F || o.bevel < 0.0F) {
    throw InvalidInput("text: size, height and bevel must be numbers, size and bevel at least 0");
  }
  for (const auto& contour : outline) {
    if (contour.size() < 3) throw InvalidInput("text: an outline needs at least 3 points");
    for (const Vec2f& p : contour) {
      if (!p.allFinite()) throw InvalidInput("text: an outline's points must be numbers");
    }
  }
}

}  // namespace

Outline centered(Outline outline) {
  Vec2f low = Vec2f::Constant(1e30F);
  Vec2f high = Vec2f::Constant(-1e30F);
  for (const auto& contour : outline) {
    for (const Vec2f& p : contour) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const Vec2f middle = 0.5F * (low + high);
  for (auto& contour : outline) {
    for (Vec2f& p : contour) p -= middle;
  }
  return outline;
}

Rect emboss(SlopeSpan details, MaskSpan coverage, Rect region, const Outline& outline, Vec2f origin,
            const EmbossOptions& options) {
  check(outline, options);
  if (!origin.allFinite()) throw InvalidInput("text: the place must be numbers");
  const Mat2f placed = options.size * placement_matrix(options);
  const float half_width = 0.5F * std::max(options.bevel, least_bevel);
  FieldShape shape;
  shape.closed = true;
  const bool draws = options.size > 0.0F && options.height != 0.0F;
  for (std::size_t i = 0; draws && i < outline.size(); ++i) {
    std::vector<FieldVertex> contour;
    for (const Vec2f& p : outline[i]) {
      const Vec2f up = placed * p;
      contour.push_back({{origin.x() + up.x(), origin.y() - up.y()}, half_width, 1.0F});
    }
    shape.contours.push_back(std::move(contour));
  }
  const Profile profile({.shape = ProfileShape::Step, .closed = true, .curve = {}});
  const PolylineField field({shape}, profile, options.height, FieldCoverage::Inside);
  region = intersect(region, details.rect());
  field.render(region, 1, [&](const Rect& pixels, int x, int y, const FieldCell& cell) {
    write_cell(pixels, x, y, cell, details, coverage);
  });
  return intersect(region, field.bounds());
}

int reach(const EmbossOptions& options, const Outline& outline) {
  check(outline, options);
  const Mat2f placed = options.size * placement_matrix(options);
  float far = 0.0F;
  for (const auto& contour : outline) {
    for (const Vec2f& p : contour) far = std::max(far, (placed * p).cwiseAbs().maxCoeff());
  }
  const float bevel = 0.5F * std::max(options.bevel, least_bevel);
  return static_cast<int>(std::ceil(std::min(far + bevel, 1e6F))) + 1;
}

}  // namespace normalshop
