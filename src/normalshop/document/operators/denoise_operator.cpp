#include <algorithm>
#include <array>

#include "normalshop/core/error.h"
#include "normalshop/document/operators/filter_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/bands.h"
#include "normalshop/rgbn/bilateral.h"
#include "normalshop/rgbn/domain_transform.h"
#include "normalshop/rgbn/rolling_guidance.h"

namespace normalshop {

namespace {

enum class DenoiseMethod { Bilateral, Rolling, Transform };
constexpr auto names_of(DenoiseMethod) {
  return std::array<std::string_view, 3>{"bilateral", "rolling", "transform"};
}

/// Of a sigma, where the guide's is not given.
constexpr float guide_share = 1.0F / 6.0F;
/// What bilateral() and rolling_guidance() take, in pixels.
constexpr float widest_window = 100.0F;

struct DenoiseOptions {
  DenoiseMethod method = DenoiseMethod::Rolling;
  float sigma = 3.0F;
  float sigma_normal = 0.2F;
  float sigma_color = 0.1F;
  float guide_sigma = 0.0F;
  int iterations = 3;
  float gain = 0.0F;

  static constexpr auto fields() {
    using Own = DenoiseOptions;
    return std::tuple{
        field("method", &Own::method,
              "Means of what is near and alike (bilateral), the same again and again with its "
              "result to say what is alike (rolling, cleans best near edges), or along rows and "
              "columns (transform, at a cost that does not grow with sigma)"),
        field<Own, float>("sigma", &Own::sigma, "length", 0.0, 1e6,
                          "Standard deviation where nothing differs, at most 100 pixels for "
                          "bilateral and rolling; 0 leaves everything as it is"),
        field<Own, float>("sigma_normal", &Own::sigma_normal, "1", 0.0, 1e6,
                          "Unit normals this far apart hardly mix: 0.2 is 11 degrees; more for "
                          "stronger noise; 0 ignores normals"),
        field<Own, float>("sigma_color", &Own::sigma_color, "1", 0.0, 1e6,
                          "Colours this far apart in linear RGB hardly mix their "
                          "normals; 0 ignores colours"),
        field<Own, float>("guide_sigma", &Own::guide_sigma, "length", 0.0, 1e6,
                          "Gaussian that takes noise out of what is compared; 0: a sixth of sigma"),
        field("iterations", &Own::iterations, "1", 1, 10,
              "Rounds of rolling, or passes of transform; without effect for bilateral"),
        field("gain", &Own::gain, "1", -100.0, 100.0,
              "Factor of what the filter takes away: 0 takes it away, 1 leaves the input as it is, "
              "more enhances details and keeps the edges between them as they are")};
  }
  float guide() const { return guide_sigma > 0.0F ? guide_sigma : guide_share * sigma; }
};

/// The options of one of the filters, lengths in pixels.
template <class Chosen>
Chosen options_of(const DenoiseOptions& options, Border border) {
  Chosen chosen;
  chosen.sigma_space = options.sigma;
  chosen.sigma_color = options.sigma_color;
  chosen.sigma_normal = options.sigma_normal;
  chosen.guide_sigma = options.guide();
  if constexpr (requires { chosen.iterations; }) chosen.iterations = options.iterations;
  chosen.border = border;
  return chosen;
}

struct DenoiseFilter {
  using Options = DenoiseOptions;
  static constexpr std::string_view name = "denoise";
  static constexpr std::string_view summary =
      "Takes noise off normals and keeps edges, theirs and those of the colours";
  static void check(const Options&, const FieldReader&) {}
  static void limit(Options& options, float largest) {
    if (options.method == DenoiseMethod::Transform) {
      options.guide_sigma = std::min(options.guide(), largest);
      options.sigma = std::min(options.sigma, largest);
      return;
    }
    if (std::max(options.sigma, options.guide_sigma) <= widest_window) return;
    throw InvalidInput(
        "denoise: sigma and guide_sigma must be at most 100 pixels for the methods \"bilateral\" "
        "and \"rolling\"; \"transform\" takes more");
  }
  /// In lengths, and so without the roundings that reach() of each method has.
  static float reach(const Options& options) {
    const float guide = 4.0F * options.guide();
    if (options.method == DenoiseMethod::Bilateral) return 2.0F * options.sigma + guide;
    if (options.method == DenoiseMethod::Transform) return 7.0F * options.sigma + guide;
    return 2.0F * static_cast<float>(options.iterations) * options.sigma + guide;
  }
  static void apply(const OperatorInput& input, SlopeSpan target, Rect region,
                    const Options& options) {
    const RgbnView source = {input.source, input.colors, input.validity};
    const RgbnSpan slopes = {target, {}};
    const Border border = input.border;
    switch (options.method) {
      case DenoiseMethod::Bilateral:
        bilateral(source, slopes, region, options_of<BilateralOptions>(options, border));
        break;
      case DenoiseMethod::Rolling:
        rolling_guidance(source, slopes, region,
                         options_of<RollingGuidanceOptions>(options, border));
        break;
      case DenoiseMethod::Transform:
        domain_transform(source, slopes, region,
                         options_of<DomainTransformOptions>(options, border));
        break;
    }
    if (options.gain == 0.0F) return;
    scale_band(input.source, {input.source, target}, {}, options.gain, target, region);
  }
};

/// Colours say where edges are; they stay as they are.
class DenoiseOperator : public FilterOperator<DenoiseFilter> {
 public:
  using FilterOperator::FilterOperator;
  bool reads_colors() const override { return options_.sigma_color > 0.0F || picks(); }
};

}  // namespace

OperatorType denoise_operator() { return area_operator_type<DenoiseOperator, DenoiseFilter>(); }

}  // namespace normalshop
