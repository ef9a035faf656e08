#include <algorithm>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop {

namespace {

class PenOperator : public EditOperator {
 public:
  explicit PenOperator(const FieldReader& options) : options_(read_options<PenOptions>(options)) {
    if (options_.profile == ProfileShape::Step && !options_.closed) {
      throw InvalidInput(options.path() + ".closed must be true for the profile \"step\"");
    }
    if (options_.profile == ProfileShape::Custom) check_curve(options.required("curve"));
  }
  std::string_view name() const override { return "pen"; }
  Value options() const override { return options_value(options_); }
  bool reads() const override { return false; }
  bool is_local() const override { return true; }
  StrokeUse stroke_use() const override {
    return options_.closed ? StrokeUse::Loop : StrokeUse::Path;
  }
  bool follows_surface() const override { return !options_.closed; }

  /// The last pieces of the curve (rgbn/detail/stroke_line.h) may become others.
  float looks_back() const override {
    const bool anywhere = options_.closed || options_.taper > 0.0F;
    return anywhere ? EditOperator::looks_back() : 0.25F * options_.width;
  }

  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    if (strokes.empty()) {
      throw InvalidInput(path + " must have at least one list of points [x, y] for the pen");
    }
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      if (!options_.closed || strokes[i].size() >= 3) continue;
      throw InvalidInput(path + "[" + std::to_string(i) +
                         "] must have at least 3 points, because the pen's stroke is closed");
    }
  }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    const float margin = 0.5F * options_.width;
    return options_.smooth
               ? smooth_extent_of(strokes, margin,
                                  options_.closed ? StrokeEnds::Closed : StrokeEnds::Open)
               : extent_of(strokes, margin);
  }

  /// Between two points their smooth curve, a mean of three lines through them and their
  /// neighbours, stays within a quarter of their distance.
  Extent bounds(const std::vector<UnitStroke>& strokes) const override {
    float longest = 0.0F;
    for (const UnitStroke& stroke : strokes) {
      for (std::size_t i = options_.closed ? 0 : 1; i < stroke.size(); ++i) {
        const UnitPoint& previous = i > 0 ? stroke[i - 1] : stroke.back();
        longest = std::max(longest, (stroke[i].position - previous.position).norm());
      }
    }
    return extent_of(strokes, 0.5F * options_.width + (options_.smooth ? 0.25F * longest : 0.0F));
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    return pen(change, coverage, input.region, input.strokes,
               scale_lengths(options_, 1.0F / input.pixel));
  }

  bool rerun(const OperatorInput& input, const std::vector<Stroke>& before, SlopeSpan change,
             MaskSpan coverage, PixelBlocks& drawn) const override {
    if (options_.closed) return false;  // all that they enclose may change
    redraw_pen(change, coverage, before, input.strokes, scale_lengths(options_, 1.0F / input.pixel),
               drawn);
    return true;
  }

 private:
  void check_curve(const FieldReader& curve) const {
    const std::vector<FieldReader> points = curve.items();
    if (points.empty()) curve.fail("a list of at least one point [u, height]");
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(options_.curve.points()[i].x()) <= 1.0F) continue;
      points[i].fail("[u, height] with u from -1 to 1");
    }
  }

  PenOptions options_;
};

}  // namespace

OperatorType pen_operator() {
  return {"pen", "Sketches a height profile along strokes: bumps, creases, scratches, steps",
          "Polylines that the profile follows; a single point makes a dot",
          describe_fields<PenOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<PenOperator>(options);
          }};
}

}  // namespace normalshop
