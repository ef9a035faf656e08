#include "normalshop/rgbn/trim.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/polyline_field.h"
#include "normalshop/rgbn/detail/stroke_line.h"

namespace normalshop {

namespace {

/// Columns repeated at both sides, so that reading across the seam needs no border.
constexpr int seam = 2;
constexpr float finest_grid = 8.0F;

void check(std::span<const Stroke> strokes, const Patch& pattern, const TrimOptions& o) {
  if (pattern.slopes.empty()) throw InvalidInput("trim: the pattern is empty");
  if (!pattern.opacity.empty() && pattern.opacity.rect() != pattern.slopes.rect()) {
    throw InvalidInput("trim: the pattern's slopes and opacity must have one size");
  }
  if (!std::isfinite(o.width) || !std::isfinite(o.relief) || o.width < 0.0F ||
      !(o.border >= 0.0F && o.border <= 0.5F)) {
    throw InvalidInput(
        "trim: width and relief must be numbers, width at least 0 and border from 0 to 0.5");
  }
  check_strokes("trim", strokes, o.closed);
}

template <class T>
Image<T> wrapped(ImageView<T> image) {
  const int width = image.width();
  if (image.empty()) return {};
  Image<T> out(width + 2 * seam, image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      out(x, y) = image(border_pixel(x - seam, width, Border::Wrap).index, y);
    }
  }
  return out;
}

std::vector<FieldShape> shapes_of(std::span<const Stroke> strokes, const TrimOptions& o) {
  std::vector<FieldShape> shapes;
  for (const Stroke& stroke : strokes) {
    if (stroke.size() < 2 || o.width == 0.0F || o.relief == 0.0F) continue;
    FieldShape shape;
    shape.closed = o.closed;
    shape.contours.emplace_back();
    if (is_part(stroke)) shape.length = stroke.front().along + stroke.front().rest;
    for (const StrokePoint& p : line_of(stroke, o)) {
      const float pressure = o.pressure ? std::clamp(p.pressure, 0.0F, 1.0F) : 1.0F;
      shape.contours.back().push_back(
          {p.position, 0.5F * o.width * pressure * p.across, 1.0F, p.along, o.smooth});
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

/// The pattern as a function of the place beside a line.
class Pattern {
 public:
  Pattern(const Patch& patch, const TrimOptions& o)
      : slopes_(wrapped(ImageView<Vec2f>(patch.slopes))),
        opacity_(wrapped(MaskView(patch.opacity))),
        options_(o),
        width_(static_cast<float>(patch.slopes.width())),
        height_(static_cast<float>(patch.slopes.height())),
        scale_(o.width / height_) {}

  /// Places averaged across a pixel of the chart: as many as it covers pixels of the pattern.
  int grid() const {
    return std::max(1, static_cast<int>(std::ceil(std::min(1.0F / scale_, finest_grid))));
  }

  FieldSample operator()(const FieldPlace& place) const {
    const float repetitions = std::max(1.0F, std::round(place.length / (width_ * scale_)));
    const float period = place.length / repetitions;
    const float turns = place.v / period;
    const float x = (turns - std::floor(turns)) * width_ - 0.5F + static_cast<float>(seam);
    const float y = 0.5F * (1.0F - place.u) * height_ - 0.5F;
    float weight = border(place);
    if (!opacity_.empty()) weight *= sample_bilinear<float>(MaskView(opacity_), x, y);
    // The nearer line counts, if ever so little.
    FieldSample out{2.0F - std::abs(place.u), Vec2f::Zero(), weight};
    if (weight <= 0.0F) return out;
    const ImageView<Vec2f> slopes(slopes_);
    const Vec2f g =
        scale_ < 1.0F ? sample_bilinear<Vec2f>(slopes, x, y) : sample_bicubic<Vec2f>(slopes, x, y);
    const float lift = weight * options_.relief * scale_;
    const Vec2f across =
        (place.grad_distance - (place.u * place.width_change) * place.grad_v) / place.half_width;
    const Vec2f gradient =
        lift * (g.x() * (width_ / period) * place.grad_v + g.y() * (0.5F * height_) * across);
    out.slope = {gradient.x(), -gradient.y()};
    return out;
  }

 private:
  float border(const FieldPlace& place) const {
    if (!(options_.border > 0.0F)) return 1.0F;
    const float side = 0.5F * (1.0F - std::abs(place.u));
    const float end = std::min(place.v, place.length - place.v) / options_.width;
    const float fade = smoothstep(0.0F, options_.border, side);
    return options_.closed ? fade : fade * smoothstep(0.0F, options_.border, end);
  }

  SlopeImage slopes_;
  MaskImage opacity_;
  TrimOptions options_;
  float width_;
  float height_;
  float scale_;  ///< pixels of the chart a pixel of the pattern
};

}  // namespace

Rect trim(SlopeSpan details, MaskSpan coverage, Rect region, std::span<const Stroke> strokes,
          const Patch& pattern, const TrimOptions& options) {
  check(strokes, pattern, options);
  const Pattern laid(pattern, options);
  const PolylineField field(shapes_of(strokes, options), std::cref(laid));
  region = intersect(region, details.rect());
  field.render(region, laid.grid(), [&](const Rect& pixels, int x, int y, const FieldCell& cell) {
    write_cell(pixels, x, y, cell, details, coverage);
  });
  return intersect(region, field.bounds());
}

int reach(const TrimOptions& options) {
  return static_cast<int>(std::ceil(std::min(0.5F * options.width, 1e6F))) + 1;
}

}  // namespace normalshop
