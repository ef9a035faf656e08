#include <algorithm>
#include <array>

#include "normalshop/core/for_pixels.h"
#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/operators/placed_operator.h"

namespace normalshop {

namespace {

struct CombineEditOptions : StampOptions, FilterAreaOptions {
  std::string image;
  bool repeat = false;
  CombineModel model = CombineModel::Linear;

  static constexpr std::array<std::string_view, 1> required_fields{"image"};
  static constexpr auto fields() {
    using Own = CombineEditOptions;
    return std::tuple_cat(
        std::tuple{field("image", &Own::image,
                         "File of the image: a tangent-space normal map, green up, its alpha is "
                         "the opacity; relative to the recipe"),
                   field<Own, float>("size", &Own::size, "length", 0.0, 1e6,
                                     "Width of one copy on the surface; 0: the width of the view"),
                   field("repeat", &Own::repeat,
                         "Repeats the image without end, instead of laying it once; one copy's "
                         "middle is the view's"),
                   field<Own, float>("relief", &Own::relief, "1", -100.0, 100.0,
                                     "Multiplies the image's heights; negative digs; 0 flattens")},
        placement_fields<Own>(),
        std::tuple{field<Own, StampHeights>("heights", &Own::heights,
                                            "Whether heights keep or grow when the image is "
                                            "scaled"),
                   field<Own, float>("border", &Own::border, "1", 0.0, 0.5,
                                     "Part of the image's size over which it fades out at its "
                                     "border; 0 cuts it off; without effect where it repeats"),
                   field("model", &Own::model,
                         "How the image meets what is below it: slopes are added (linear), or the "
                         "surface is turned by the image (rotation), the image "
                         "is turned to lie on the surface (reoriented), or as game engines do it "
                         "(whiteout, udn; overlay, which flattens, is for comparison)")},
        filter_area_fields<Own>());
  }
};

class CombineOperator : public AreaEdit<CombineEditOptions> {
 public:
  explicit CombineOperator(const FieldReader& options) : AreaEdit(options) {
    if (options_.image.empty()) options.required("image").fail("the name of a file");
    check_scales(options);
  }
  std::string_view name() const override { return "combine"; }
  void load(Assets& assets) override { image_ = assets.patch(options_.image); }
  std::string_view asset_field() const override { return "image"; }
  bool reads() const override { return options_.model != CombineModel::Linear; }
  bool reads_base() const override { return options_.model == CombineModel::Rotation; }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    CombineEditOptions scaled = scale_lengths(options_, 1.0F / input.pixel);
    scaled.size = options_.size > 0.0F ? std::max(scaled.size, 1e-6F) : input.view_width;
    MaskImage mask(change.width(), change.height(), 0.0F);
    const Rect region = intersect(area_mask(scaled, input, mask), input.region);
    if (region.empty()) return {};
    const auto lay = scaled.repeat ? stamp_repeated : stamp;
    lay(change, coverage, region, image_, input.view_center, scaled);
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

  Patch image_;
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
