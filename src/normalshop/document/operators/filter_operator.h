#pragma once

#include "normalshop/core/error.h"
#include "normalshop/core/sample.h"
#include "normalshop/document/operators/area_operator.h"

namespace normalshop {

/// An edit that filters the slopes in an area. `Filter` has Options, name, summary, and
/// check(options, reader), limit(options, largest sigma in pixels), reach(options) and
/// apply(input, target, region, options); a low-pass filter has low_pass_sigma(options), too.
template <class Filter>
class FilterOperator : public AreaEdit<AreaEditOptions<typename Filter::Options>> {
 public:
  using Options = AreaEditOptions<typename Filter::Options>;

  explicit FilterOperator(const FieldReader& options) : AreaEdit<Options>(options) {
    Filter::check(this->options_, options);
  }
  std::string_view name() const override { return Filter::name; }
  bool reads() const override { return true; }
  bool is_local() const override { return true; }
  float reach(float /*pixel*/) const override { return Filter::reach(this->options_); }
  float removes_finer(float pixel) const override {
    if constexpr (requires { Filter::low_pass_sigma(this->options_); }) {
      // From there on the finest waves that pixels show are gone by 99 %.
      return smoothstep(0.5F, 1.0F, Filter::low_pass_sigma(this->options_) / pixel);
    }
    return 0.0F;
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    Options scaled = scale_lengths(this->options_, 1.0F / input.pixel);
    Filter::limit(scaled, widest_sigma(input));
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    Filter::apply(input, change, region, scaled);
    keep_masked_change(input.source, coverage, change, region);
    return region;
  }
};

template <class Filter>
OperatorType filter_type() {
  return area_operator_type<FilterOperator<Filter>, Filter>();
}

}  // namespace normalshop
