#pragma once

#include "normalshop/document/operators/filter_area.h"
#include "normalshop/document/option_values.h"

namespace normalshop {

/// Options of such an edit: the tool's own, then where it works.
template <class Options>
struct AreaEditOptions : Options, FilterAreaOptions {
  static constexpr auto fields() {
    return std::tuple_cat(Options::fields(), filter_area_fields<AreaEditOptions>());
  }
};

/// An edit that rewrites the slopes in an area, each pixel by what the tool makes of it and how far
/// the area's mask says. `Tool` has Options, name, summary and
/// apply(input, mask, target, region, options), which fills target in region.
template <class Tool>
class AreaOperator : public EditOperator {
 public:
  using Options = AreaEditOptions<typename Tool::Options>;

  explicit AreaOperator(const FieldReader& options) : options_(read_options<Options>(options)) {
    check_brush(options_, options);
  }
  std::string_view name() const override { return Tool::name; }
  Value options() const override { return options_value(options_); }
  bool reads() const override { return true; }
  StrokeUse stroke_use() const override { return area_stroke_use(options_); }
  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    check_area(options_, strokes, path);
  }
  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    return area_extent(options_, strokes);
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    const Options scaled = scale_lengths(options_, 1.0F / input.pixel);
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    Tool::apply(input, coverage, change, region, scaled);
    subtract(input.source, change, region);
    return region;
  }

 private:
  Options options_;
};

template <class Tool>
OperatorType area_type() {
  return {Tool::name, Tool::summary, area_strokes,
          describe_fields<typename AreaOperator<Tool>::Options>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<AreaOperator<Tool>>(options);
          }};
}

}  // namespace normalshop
