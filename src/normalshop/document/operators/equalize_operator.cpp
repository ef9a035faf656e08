#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/document/operators/filter_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/bands.h"

namespace normalshop {

namespace {

constexpr std::size_t most_gains = 16;

/// All but the border: a view goes on past its own.
struct EqualizeEditOptions : EqualizeOptions {
  std::vector<float> gains;

  static constexpr std::array<std::string_view, 1> required_fields{"gains"};
  static constexpr auto fields() {
    using Own = EqualizeEditOptions;
    return std::apply(
        [](const auto& sigma, const auto& base_gain, const auto& /*border*/) {
          return std::tuple{
              sigma,
              field<Own, std::vector<float>>(
                  "gains", &Own::gains, "1", -100.0, 100.0,
                  "Factors of the bands, 1 to 16 of them, the finest first: 0 takes a band away, 1 "
                  "leaves it, more enhances it"),
              base_gain};
        },
        EqualizeOptions::fields());
  }
};

struct EqualizeFilter {
  using Options = EqualizeEditOptions;
  static constexpr std::string_view name = "equalize";
  static constexpr std::string_view summary =
      "An equaliser: a factor for the details of each octave of sizes";
  static void check(const Options& options, const FieldReader& reader) {
    if (!(options.sigma > 0.0F)) reader.required("sigma").fail("a number above 0");
    if (options.gains.empty() || options.gains.size() > most_gains) {
      reader.required("gains").fail("a list of 1 to 16 numbers");
    }
  }
  static void limit(Options& options, float largest) {
    constexpr float finest = 1e-6F;  // of a pixel: far below all details
    options.sigma = std::clamp(options.sigma, finest, largest);
  }
  static float reach(const Options& options) {
    return 4.0F * std::ldexp(options.sigma, static_cast<int>(options.gains.size()) - 1);
  }
  static void apply(const OperatorInput& input, SlopeSpan target, Rect region,
                    const Options& options) {
    EqualizeOptions chosen = options;
    chosen.border = input.border;
    equalize(input.source, input.validity, options.gains, target, region, chosen);
  }
};

}  // namespace

OperatorType equalize_operator() { return filter_type<EqualizeFilter>(); }

}  // namespace normalshop
