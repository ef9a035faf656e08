#include "normalshop/document/operators/placed_operator.h"

#include <cmath>

namespace normalshop {

namespace {

template <class T>
ImageSpan<T> part(ImageSpan<T> image, const Rect& r) {
  return {&image(r.x0, r.y0), r.width(), r.height(), &image(0, 1) - &image(0, 0)};
}

}  // namespace

void check_scales(const FieldReader& options) {
  for (const std::string_view name : {"scale_x", "scale_y"}) {
    if (options.has(name) && options.required(name).number() == 0.0) {
      options.required(name).fail("a scale that is not 0");
    }
  }
}

Rect PlacedOperator::add_copy(const OperatorInput& input, const Vec2f& position, SlopeSpan change,
                              MaskSpan coverage) const {
  const int reach = copy_reach(input.pixel);
  const int x = static_cast<int>(std::floor(position.x()));
  const int y = static_cast<int>(std::floor(position.y()));
  const Rect window = intersect({x - reach, y - reach, x + reach + 2, y + reach + 2}, input.region);
  if (window.empty()) return {};
  SlopeImage details(window.width(), window.height());
  MaskImage covered(window.width(), window.height());
  const Vec2f origin(static_cast<float>(window.x0), static_cast<float>(window.y0));
  Rect written = place(input, details, covered, details.rect(), position - origin);
  if (written.empty()) return {};
  const SlopeSpan target = part(change, window);
  combine_linear(target, details, {}, 1.0F, target, written);
  for (int j = written.y0; j < written.y1; ++j) {
    for (int i = written.x0; i < written.x1; ++i) {
      float& c = coverage(window.x0 + i, window.y0 + j);
      c = std::max(c, covered(i, j));
    }
  }
  return {written.x0 + window.x0, written.y0 + window.y0, written.x1 + window.x0,
          written.y1 + window.y0};
}

}  // namespace normalshop
