#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operators/laid_image.h"
#include "normalshop/document/operators/operators.h"

namespace normalshop {

namespace {

struct CombineEditOptions : LaidImageOptions, FilterAreaOptions {
  CombineModel model = CombineModel::Linear;

  static constexpr auto fields() {
    using Own = CombineEditOptions;
    return std::tuple_cat(
        LaidImageOptions::fields(),
        std::tuple{field("model", &Own::model,
                         "How the image meets what is below it: slopes are added (linear), or the "
                         "surface is turned by the image (rotation), the image "
                         "is turned to lie on the surface (reoriented), or as game engines do it "
                         "(whiteout, udn; overlay, which flattens, is for comparison)")},
        filter_area_fields<Own>());
  }
};

class CombineOperator : public LaidImageEdit<CombineEditOptions> {
 public:
  using LaidImageEdit::LaidImageEdit;
  std::string_view name() const override { return "combine"; }
  bool reads() const override { return options_.model != CombineModel::Linear; }
  bool reads_base() const override { return options_.model == CombineModel::Rotation; }
  bool is_local() const override { return true; }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    const CombineEditOptions scaled = scaled_options(input);
    MaskImage mask(change.width(), change.height(), 0.0F);
    const Rect region = intersect(area_mask(scaled, input, mask), input.region);
    if (region.empty()) return {};
    lay(input, scaled, region, change, coverage);
    for_pixels(region, [&](int x, int y) {
      // What is not linear takes the image's slopes and its weight apart.
      if (reads() && coverage(x, y) > 0.0F) change(x, y) /= coverage(x, y);
      if (!reads()) change(x, y) *= mask(x, y);
      coverage(x, y) *= mask(x, y);
    });
    if (reads()) apply_model(input, change, coverage, region);
    return region;
  }

 private:
  /// From the image's slopes to the change of what is below it.
  void apply_model(const OperatorInput& input, SlopeSpan change, MaskView weight,
                   const Rect& region) const {
    if (options_.model == CombineModel::Rotation) {
      combine_rotation(input.source, input.base, change, weight, 1.0F, change, region);
    } else {
      combine(input.source, change, weight, change, region, {.model = options_.model});
    }
    subtract(input.source, change, region);
  }
};

}  // namespace

OperatorType combine_operator() {
  return {"combine", "Lays an RGBN image over the view, once or repeated", area_strokes,
          describe_fields<CombineEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<CombineOperator>(options);
          }};
}

}  // namespace normalshop
