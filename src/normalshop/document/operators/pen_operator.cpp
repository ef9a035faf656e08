#include "normalshop/core/error.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/pen.h"

namespace normalshop {

namespace {

class PenOperator : public EditOperator {
 public:
  explicit PenOperator(const FieldReader& options) : options_(read_options<PenOptions>(options)) {
    try {
      const Profile probe({options_.profile, options_.closed, options_.curve});
    } catch (const InvalidInput& e) {
      throw InvalidInput(options.path() + ": " + e.what());
    }
  }
  std::string_view name() const override { return "pen"; }
  Value options() const override { return options_value(options_); }
  bool reads() const override { return false; }

  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    if (strokes.empty()) throw InvalidInput(path + ": the pen needs at least one stroke");
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      if (!options_.closed || strokes[i].size() >= 3) continue;
      throw InvalidInput(path + "[" + std::to_string(i) +
                         "]: a closed stroke needs at least 3 points");
    }
  }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    Extent e = extent_of(strokes, 0.5F * options_.width);
    if (!options_.smooth) return e;
    // A smooth curve may swing out between its points.
    const Vec2f swing = 0.1F * (e.high - e.low);
    return {e.low - swing, e.high + swing};
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    return pen(change, coverage, input.region, input.strokes,
               scale_lengths(options_, 1.0F / input.pixel));
  }

 private:
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
