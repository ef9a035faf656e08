#include <array>

#include "normalshop/core/error.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/pen.h"
#include "normalshop/rgbn/trim.h"

namespace normalshop {

namespace {

struct TrimEditOptions : TrimOptions {
  std::string pattern;

  static constexpr std::array<std::string_view, 1> required_fields{"pattern"};
  static constexpr auto fields() {
    return std::tuple_cat(
        std::tuple{field("pattern", &TrimEditOptions::pattern,
                         "File of the pattern: a tangent-space normal map, green up, that repeats "
                         "sideways; its alpha is the opacity; relative to the recipe")},
        TrimOptions::fields());
  }
};

class TrimOperator : public EditOperator {
 public:
  explicit TrimOperator(const FieldReader& options)
      : options_(read_options<TrimEditOptions>(options)) {
    if (options_.pattern.empty()) options.required("pattern").fail("the name of a file");
  }
  std::string_view name() const override { return "trim"; }
  Value options() const override { return options_value(options_); }
  void load(Assets& assets) override { pattern_ = assets.patch(options_.pattern); }
  std::string_view asset_field() const override { return "pattern"; }
  bool reads() const override { return false; }
  bool is_local() const override { return true; }
  StrokeUse stroke_use() const override {
    return options_.closed ? StrokeUse::Loop : StrokeUse::Path;
  }
  bool follows_surface() const override { return !options_.closed; }

  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    const std::size_t least = options_.closed ? 3 : 2;
    if (strokes.empty()) {
      throw InvalidInput(path + " must have at least one list of points [x, y] for the pattern");
    }
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      if (strokes[i].size() >= least) continue;
      throw InvalidInput(path + "[" + std::to_string(i) + "] must have at least " +
                         std::to_string(least) + " points for the pattern to run along");
    }
  }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    const float margin = 0.5F * options_.width;
    return options_.smooth
               ? smooth_extent_of(strokes, margin,
                                  options_.closed ? StrokeEnds::Closed : StrokeEnds::Open)
               : extent_of(strokes, margin);
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    return trim(change, coverage, input.region, input.strokes, pattern_,
                scale_lengths<TrimOptions>(options_, 1.0F / input.pixel));
  }

 private:
  TrimEditOptions options_;
  Patch pattern_;
};

}  // namespace

OperatorType trim_operator() {
  return {"trim", "Repeats a pattern along strokes: seams, ropes, ornaments",
          "Polylines that the pattern runs along", describe_fields<TrimEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<TrimOperator>(options);
          }};
}

}  // namespace normalshop
