#include <array>

#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/operators/placed_operator.h"
#include "normalshop/rgbn/filter.h"

namespace normalshop {

namespace {

struct StampEditOptions : StampOptions {
  std::string patch;
  float high_pass = 0.0F;

  static constexpr std::array<std::string_view, 2> required_fields{"patch", "size"};
  static constexpr auto fields() {
    // A patch's size in pixels means nothing here, so that `size` has no 0.
    const auto others =
        std::apply([](auto, auto... rest) { return std::tuple{rest...}; }, StampOptions::fields());
    return std::tuple_cat(
        std::tuple{
            field("patch", &StampEditOptions::patch,
                  "File of the patch: a tangent-space normal map, green up, its alpha is "
                  "the opacity; relative to the recipe"),
            field<StampEditOptions, float>("size", &StampEditOptions::size, "length", 0.0, 1e6,
                                           "Width of the patch on the surface; above 0")},
        others,
        std::tuple{field("high_pass", &StampEditOptions::high_pass, "1", 0.0, 1.0,
                         "Takes the patch's shape away and stamps its details: what is finer than "
                         "this part of its width; 0 stamps all of it")});
  }
};

/// The patch without what a Gaussian of that sigma (pixels) leaves of it, seen where it is opaque.
void take_shape_away(Patch& patch, float sigma) {
  FilterOptions options;
  options.kind = FilterKind::HighPass;
  options.sigma = sigma;
  filter(patch.slopes, patch.opacity, patch.slopes, patch.slopes.rect(), options);
  if (patch.opacity.empty()) return;
  // Beside the last opaque pixel interpolation reads one that the filter has left as it was.
  for_pixels(patch.slopes.rect(), [&](int x, int y) {
    if (patch.opacity(x, y) == 0.0F) patch.slopes(x, y).setZero();
  });
}

class StampOperator : public PlacedOperator {
 public:
  explicit StampOperator(const FieldReader& options)
      : options_(read_options<StampEditOptions>(options)) {
    if (options_.patch.empty()) options.required("patch").fail("the name of a file");
    const FieldReader size = options.required("size");
    if (options_.size <= 0.0F) size.fail("a number above 0");
    check_scales(options);
  }
  std::string_view name() const override { return "stamp"; }
  Value options() const override { return options_value(options_); }
  void load(Assets& assets) override {
    patch_ = assets.patch(options_.patch);
    const auto width = static_cast<float>(patch_.slopes.width());
    if (options_.high_pass > 0.0F) take_shape_away(patch_, options_.high_pass * width);
  }
  std::string_view asset_field() const override { return "patch"; }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    // One unit a pixel: the reach in pixels is the reach in units, to a pixel.
    constexpr float fine = 1e-3F;
    const StampOptions scaled =
        scale_lengths<StampOptions>(options_, 1.0F / (fine * options_.size));
    return extent_of(strokes,
                     static_cast<float>(normalshop::reach(scaled, patch_)) * fine * options_.size);
  }

 protected:
  int copy_reach(float pixel) const override {
    return normalshop::reach(scale_lengths<StampOptions>(options_, 1.0F / pixel), patch_);
  }
  Rect place(const OperatorInput& input, SlopeSpan details, MaskSpan coverage, Rect region,
             const Vec2f& position) const override {
    return stamp(details, coverage, region, patch_, position,
                 scale_lengths<StampOptions>(options_, 1.0F / input.pixel));
  }

 private:
  StampEditOptions options_;
  Patch patch_;
};

}  // namespace

OperatorType stamp_operator() {
  return {"stamp", "Lays an RGBN patch on the surface", "Every point places one copy",
          describe_fields<StampEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<StampOperator>(options);
          }};
}

}  // namespace normalshop
