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
