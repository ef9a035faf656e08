#include <algorithm>
#include <limits>

#include "normalshop/document/edit_operator.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop {

Extent extent_of(const std::vector<UnitStroke>& strokes, float margin) {
  Extent e;
  for (const UnitStroke& stroke : strokes) {
    for (const UnitPoint& p : stroke) {
      e.low = e.low.cwiseMin(p.position);
      e.high = e.high.cwiseMax(p.position);
    }
  }
  if (e.empty()) return e;
  e.low.array() -= margin;
  e.high.array() += margin;
  return e;
}

namespace {

/// A smooth curve is another one from two points before one that moves on; the third shapes it
/// there.
constexpr std::size_t points_before = 3;

bool same(const UnitPoint& a, const UnitPoint& b) {
  return a.position == b.position && a.pressure == b.pressure;
}

/// The point so far before another.
std::size_t point_before(const UnitStroke& stroke, std::size_t at, float back) {
  while (at > 0 && back > 0.0F) {
    back -= (stroke[at].position - stroke[at - 1].position).norm();
    --at;
  }
  return at;
}

void add_tail(const UnitStroke& stroke, std::size_t first, std::vector<UnitStroke>& parts) {
  if (first >= stroke.size()) return;
  parts.emplace_back(stroke.begin() + static_cast<std::ptrdiff_t>(first), stroke.end());
}

}  // namespace

std::vector<UnitStroke> changed_parts(const std::vector<UnitStroke>& before,
                                      const std::vector<UnitStroke>& after, float back) {
  const UnitStroke none;
  std::vector<UnitStroke> parts;
  for (std::size_t i = 0; i < std::max(before.size(), after.size()); ++i) {
    const UnitStroke& a = i < before.size() ? before[i] : none;
    const UnitStroke& b = i < after.size() ? after[i] : none;
    const auto [at, end] = std::mismatch(a.begin(), a.end(), b.begin(), b.end(), same);
    if (at == a.end() && end == b.end()) continue;
    const auto common = static_cast<std::size_t>(at - a.begin());
    const std::size_t shaped = common > points_before ? common - points_before : 0;
    const std::size_t first = shaped > 0 ? point_before(a, shaped, back) : 0;
    add_tail(a, first, parts);
    add_tail(b, first, parts);
  }
  return parts;
}

Extent smooth_extent_of(const std::vector<UnitStroke>& strokes, float margin, StrokeEnds ends) {
  constexpr float fine = 2048.0F;  // pixels across the box in which curves are measured
  Extent e = extent_of(strokes, 0.0F);
  if (e.empty()) return e;
  const float size = (e.high - e.low).maxCoeff();
  if (size > 0.0F) {
    const float scale = fine / size;
    const Vec2f origin = e.low;
    for (const UnitStroke& stroke : strokes) {
      Stroke pixels;
      for (const UnitPoint& p : stroke) pixels.push_back({scale * (p.position - origin)});
      const Stroke curve = smooth_stroke(pixels, 2.0F, ends);
      for (const StrokePoint& p : curve) {
        e.low = e.low.cwiseMin(origin + p.position / scale);
        e.high = e.high.cwiseMax(origin + p.position / scale);
      }
    }
  }
  e.low.array() -= margin;
  e.high.array() += margin;
  return e;
}

}  // namespace normalshop
