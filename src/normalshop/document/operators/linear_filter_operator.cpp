#include "normalshop/document/operators/filter_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/filter.h"

namespace normalshop {

namespace {

/// All but the border: a view goes on past its own.
struct LinearFilterOptions : FilterOptions {
  static constexpr auto fields() {
    return std::apply(
        [](const auto& kind, const auto& sigma, const auto& noise_sigma, const auto& amount,
           const auto& /*border*/) {
          return std::tuple{kind, sigma, noise_sigma, amount};
        },
        FilterOptions::fields());
  }
};

struct LinearFilter {
  using Options = LinearFilterOptions;
  static constexpr std::string_view name = "filter";
  static constexpr std::string_view summary =
      "Linear filters: low, high and band-pass, sharpening, and scaling the heights";
  static void check(const Options& options, const FieldReader& reader) {
    if (options.kind != FilterKind::Scale && !reader.has("sigma")) {
      reader.required("sigma").fail("a number from 0 to 1000000 for all kinds but \"scale\"");
    }
    if (uses_noise(options.kind) && options.noise_sigma > 0.0F &&
        options.noise_sigma >= options.sigma) {
      reader.required("noise_sigma").fail("a number below sigma");
    }
  }
  static void limit(Options& options, float largest) {
    if (options.sigma <= largest) return;
    options.sigma = largest;
    options.noise_sigma = std::min(options.noise_sigma, 0.5F * largest);
  }
  static float reach(const Options& options) {
    if (options.kind == FilterKind::Scale) return 0.0F;
    return (options.kind == FilterKind::LaplacianOfGaussian ? 8.0F : 4.0F) * options.sigma;
  }
  static float low_pass_sigma(const Options& options) {
    return options.kind == FilterKind::Gaussian ? options.sigma : 0.0F;
  }
  static void apply(const OperatorInput& input, SlopeSpan target, Rect region,
                    const Options& options) {
    FilterOptions chosen = options;
    chosen.border = input.border;
    filter(input.source, input.validity, target, region, chosen);
  }
};

}  // namespace

OperatorType filter_operator() { return filter_type<LinearFilter>(); }

}  // namespace normalshop
