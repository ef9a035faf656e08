#include <algorithm>
#include <array>

#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/resample_kernel.h"

namespace normalshop {

namespace {

struct ConvolveEditOptions : ConvolveOptions, FilterAreaOptions {
  std::string kernel;
  float pixel = 0.0F;

  static constexpr std::array<std::string_view, 1> required_fields{"kernel"};
  static constexpr auto fields() {
    using Own = ConvolveEditOptions;
    // All but the border: a view goes on past its own.
    const auto normalize = std::get<0>(ConvolveOptions::fields());
    return std::tuple_cat(
        std::tuple{field("kernel", &Own::kernel,
                         "File of the kernel: a JSON list of rows of numbers, the upper row first, "
                         "an odd number of rows and of numbers in each, at most 255; relative to "
                         "the recipe"),
                   normalize,
                   field("pixel", &Own::pixel, "length", 0.0, 1e6,
                         "Length of the kernel's pixels on the surface; 0: each is a pixel of the "
                         "picture or of the chart, about a texel")},
        filter_area_fields<Own>());
  }
};

class ConvolveOperator : public AreaEdit<ConvolveEditOptions> {
 public:
  explicit ConvolveOperator(const FieldReader& options) : AreaEdit(options) {
    if (options_.kernel.empty()) options.required("kernel").fail("the name of a file");
  }
  std::string_view name() const override { return "convolve"; }
  std::string_view asset_field() const override { return "kernel"; }
  bool reads() const override { return true; }
  bool is_local() const override { return true; }

  void load(Assets& assets) override {
    kernel_ = assets.kernel(options_.kernel);
    // A kernel that cannot be normalised is refused here, with its name.
    SlopeImage pixel(1, 1, Vec2f(0.0F, 0.0F));
    convolve(pixel, {}, kernel_, pixel, pixel.rect(), options_);
  }
  float reach(float pixel) const override {
    const int radius = normalshop::reach(KernelView(kernel_));
    if (!(options_.pixel > 0.0F)) return static_cast<float>(radius) * pixel;
    return static_cast<float>(radius) * options_.pixel + std::max(options_.pixel, pixel);
  }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    const ConvolveEditOptions scaled = scale_lengths(options_, 1.0F / input.pixel);
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    Image<float> resampled;
    if (options_.pixel > 0.0F) resampled = resample_kernel(kernel_, scaled.pixel);
    convolve(input.source, input.validity, options_.pixel > 0.0F ? resampled : kernel_, change,
             region, {options_.normalize, input.border});
    keep_masked_change(input.source, coverage, change, region);
    return region;
  }

 private:
  Image<float> kernel_;
};

}  // namespace

OperatorType convolve_operator() {
  return {"convolve", "Convolves the slopes with any kernel from a file", area_strokes,
          describe_fields<ConvolveEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<ConvolveOperator>(options);
          }};
}

}  // namespace normalshop
