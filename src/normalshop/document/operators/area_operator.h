#pragma once

#include <algorithm>

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

/// In pixels: a Gaussian as wide as that is flat over the chart, wider ones give the same.
inline float widest_sigma(const OperatorInput& input) {
  return 4.0F * static_cast<float>(std::max(input.source.width(), input.source.height()));
}

/// What all edits with an area have in common. `Options` has theirs among its fields.
template <class Options>
class AreaEdit : public EditOperator {
 public:
  explicit AreaEdit(const FieldReader& options) : options_(read_options<Options>(options)) {
    check_brush(options_, options);
  }
  Value options() const override { return options_value(options_); }
  bool picks() const override { return normalshop::picks(options_.area); }
  StrokeUse stroke_use() const override { return area_stroke_use(options_); }
  float looks_back() const override {
    return options_.area == FilterArea::Brush ? 0.0F : EditOperator::looks_back();
  }
  bool follows_surface() const override { return options_.area == FilterArea::Brush; }
  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    check_area(options_, strokes, path);
  }
  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    return area_extent(options_, strokes);
  }

 protected:
  Options options_;
};

/// An edit that rewrites the slopes in an area, each pixel by what the tool makes of it and how far
/// the area's mask says. `Tool` has Options, name, summary, is_local (EditOperator) and
/// apply(input, mask, target, region, options), which fills target in region.
template <class Tool>
class AreaOperator : public AreaEdit<AreaEditOptions<typename Tool::Options>> {
 public:
  using Options = AreaEditOptions<typename Tool::Options>;
  using AreaEdit<Options>::AreaEdit;

  std::string_view name() const override { return Tool::name; }
  bool reads() const override { return true; }
  bool is_local() const override { return Tool::is_local; }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    const Options scaled = scale_lengths(this->options_, 1.0F / input.pixel);
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    Tool::apply(input, coverage, change, region, scaled);
    subtract(input.source, change, region);
    return region;
  }
};

/// The registry's entry of an operator with an area. `Kind` has name, summary and Options.
template <class Operator, class Kind>
OperatorType area_operator_type() {
  return {Kind::name, Kind::summary, area_strokes, describe_fields<typename Operator::Options>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<Operator>(options);
          }};
}

template <class Tool>
OperatorType area_type() {
  return area_operator_type<AreaOperator<Tool>, Tool>();
}

}  // namespace normalshop
