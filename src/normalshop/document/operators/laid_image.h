#pragma once

#include <algorithm>
#include <array>

#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/placed_operator.h"
#include "normalshop/rgbn/stamp.h"

/// What operators have in common that lay an image over the view, once or repeated.
namespace normalshop {

struct LaidImageOptions : StampOptions {
  std::string image;
  bool repeat = false;

  static constexpr std::array<std::string_view, 1> required_fields{"image"};
  static constexpr auto fields() {
    using Own = LaidImageOptions;
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
                                     "border; 0 cuts it off; without effect where it repeats")});
  }
};

/// Base of these operators; their options hold LaidImageOptions and the area's.
template <class Options>
class LaidImageEdit : public AreaEdit<Options> {
 public:
  explicit LaidImageEdit(const FieldReader& options) : AreaEdit<Options>(options) {
    if (this->options_.image.empty()) options.required("image").fail("the name of a file");
    check_scales(options);
  }
  void load(Assets& assets) override { image_ = assets.patch(this->options_.image); }
  std::string_view asset_field() const override { return "image"; }

 protected:
  /// With lengths in pixels of this input, the size never 0.
  Options scaled_options(const OperatorInput& input) const {
    Options scaled = scale_lengths(this->options_, 1.0F / input.pixel);
    scaled.size = this->options_.size > 0.0F ? std::max(scaled.size, 1e-6F) : input.view_width;
    return scaled;
  }
  /// The image in `region`: opacity times slopes, and opacity.
  void lay(const OperatorInput& input, const Options& scaled, Rect region, SlopeSpan slopes,
           MaskSpan opacity) const {
    const auto stamp_once_or_often = scaled.repeat ? stamp_repeated : stamp;
    stamp_once_or_often(slopes, opacity, region, image_, input.view_center, scaled);
  }

 private:
  Patch image_;
};

}  // namespace normalshop
