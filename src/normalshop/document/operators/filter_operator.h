#pragma once

#include <algorithm>

#include "normalshop/core/error.h"
#include "normalshop/document/operators/filter_area.h"
#include "normalshop/document/option_values.h"

namespace normalshop {

/// Options of a filter edit: the filter's own, then where it works.
template <class Options>
struct FilterEditOptions : Options, FilterAreaOptions {
  static constexpr auto fields() {
    return std::tuple_cat(Options::fields(), filter_area_fields<FilterEditOptions>());
  }
};

/// An edit that filters the slopes in an area. `Filter` has Options, name, summary, and
/// check(options, reader), limit(options, largest sigma in pixels), reach(options) and
/// apply(input, target, region, options).
template <class Filter>
class FilterOperator : public EditOperator {
 public:
  using Options = FilterEditOptions<typename Filter::Options>;

  explicit FilterOperator(const FieldReader& options) : options_(read_options<Options>(options)) {
    check_brush(options_, options);
    Filter::check(options_, options);
  }
  std::string_view name() const override { return Filter::name; }
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
  float reach() const override { return Filter::reach(options_); }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    Options scaled = scale_lengths(options_, 1.0F / input.pixel);
    // A Gaussian as wide as that is flat over the chart: wider ones give the same.
    const int side = std::max(input.source.width(), input.source.height());
    Filter::limit(scaled, 4.0F * static_cast<float>(side));
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    Filter::apply(input, change, region, scaled);
    keep_masked_change(input.source, coverage, change, region);
    return region;
  }

 private:
  Options options_;
};

template <class Filter>
OperatorType filter_type() {
  return {Filter::name, Filter::summary, area_strokes,
          describe_fields<typename FilterOperator<Filter>::Options>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<FilterOperator<Filter>>(options);
          }};
}

}  // namespace normalshop
