#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operators/laid_image.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/bands.h"

namespace normalshop {

namespace {

struct TransplantEditOptions : LaidImageOptions, FilterAreaOptions {
  float sigma = 0.0F;

  static constexpr std::array<std::string_view, 2> required_fields{"image", "sigma"};
  static constexpr auto fields() {
    using Own = TransplantEditOptions;
    return std::tuple_cat(
        LaidImageOptions::fields(),
        std::tuple{
            field("sigma", &Own::sigma, "length", 0.0, 1e6,
                  "Standard deviation of the Gaussian that parts shape from details: what is "
                  "finer comes from the image, what is coarser stays; 0 leaves the surface "
                  "as it is")},
        filter_area_fields<Own>());
  }
};

/// An image on the whole chart, and the part of it that is coarser than sigma.
struct Donor {
  SlopeImage slopes;
  SlopeImage base;
  MaskImage opacity;
};

class TransplantOperator : public LaidImageEdit<TransplantEditOptions> {
 public:
  using LaidImageEdit::LaidImageEdit;
  std::string_view name() const override { return "transplant"; }
  bool reads() const override { return true; }
  bool is_local() const override { return true; }
  float reach(float /*pixel*/) const override { return 4.0F * options_.sigma; }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    TransplantEditOptions scaled = scaled_options(input);
    scaled.sigma = std::min(scaled.sigma, widest_sigma(input));
    const Rect region = intersect(area_mask(scaled, input, coverage), input.region);
    if (region.empty()) return {};
    const Donor donor = make_donor(input, scaled, region);
    SlopeImage base(change.width(), change.height());
    SlopeImage details(change.width(), change.height());
    split(input.source, input.validity, base, details, region, {scaled.sigma, input.border});
    for_pixels(region, [&](int x, int y) { coverage(x, y) *= donor.opacity(x, y); });
    transplant_band(input.source, {details, {}}, {donor.slopes, donor.base}, coverage, 1.0F, change,
                    region);
    subtract(input.source, change, region);
    return region;
  }

 private:
  Donor make_donor(const OperatorInput& input, const TransplantEditOptions& scaled,
                   const Rect& region) const {
    const int width = input.source.width();
    const int height = input.source.height();
    Donor donor{SlopeImage(width, height), SlopeImage(width, height), MaskImage(width, height)};
    lay(input, scaled, donor.slopes.rect(), donor.slopes, donor.opacity);
    for_pixels(donor.slopes.rect(), [&](int x, int y) {
      const float opacity = donor.opacity(x, y);
      if (opacity > 0.0F) donor.slopes(x, y) /= opacity;
    });
    SlopeImage details(width, height);
    split(donor.slopes, donor.opacity, donor.base, details, region, {scaled.sigma, input.border});
    return donor;
  }
};

}  // namespace

OperatorType transplant_operator() {
  return {"transplant", "Brings the details of an RGBN image in place of the surface's own",
          area_strokes, describe_fields<TransplantEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<TransplantOperator>(options);
          }};
}

}  // namespace normalshop
