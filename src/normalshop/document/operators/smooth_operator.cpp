#include "normalshop/document/operators/filter_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

struct SmoothFilter {
  using Options = SmoothOptions;
  static constexpr std::string_view name = "smooth";
  static constexpr std::string_view summary = "Gaussian smoothing of the slopes";
  static void check(const Options&, const FieldReader&) {}
  static void limit(Options& options, float largest) {
    options.sigma = std::min(options.sigma, largest);
  }
  static float reach(const Options& options) { return 4.0F * options.sigma; }
  static float low_pass_sigma(const Options& options) { return options.sigma; }
  static void apply(const OperatorInput& input, SlopeSpan target, Rect region,
                    const Options& options) {
    smooth(input.source, input.validity, target, region, options, input.border);
  }
};

}  // namespace

OperatorType smooth_operator() { return filter_type<SmoothFilter>(); }

}  // namespace normalshop
