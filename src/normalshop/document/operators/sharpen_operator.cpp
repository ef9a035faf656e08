#include "normalshop/document/operators/filter_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/sharpen.h"

namespace normalshop {

namespace {

struct SharpenFilter {
  using Options = SharpenOptions;
  static constexpr std::string_view name = "sharpen";
  static constexpr std::string_view summary =
      "Enhances details (unsharp mask), or edges without the finest noise";
  static void check(const Options& options, const FieldReader& reader) {
    if (options.noise_sigma > 0.0F && options.noise_sigma >= options.sigma) {
      reader.required("noise_sigma").fail("a number below sigma");
    }
  }
  static void limit(Options& options, float largest) {
    if (options.sigma <= largest) return;
    options.sigma = largest;
    options.noise_sigma = std::min(options.noise_sigma, 0.5F * largest);
  }
  static float reach(const Options& options) { return 4.0F * options.sigma; }
  static void apply(const OperatorInput& input, SlopeSpan target, Rect region,
                    const Options& options) {
    sharpen(input.source, input.validity, target, region, options, input.border);
  }
};

}  // namespace

OperatorType sharpen_operator() { return filter_type<SharpenFilter>(); }

}  // namespace normalshop
