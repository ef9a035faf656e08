#include "normalshop/io/image_check.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/slope.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/curl.h"

namespace normalshop {

namespace {

/// Pixels that a mask leaves, and those of them that are no good normals.
struct Counts {
  std::size_t inside = 0;
  std::size_t no_direction = 0;
  std::size_t on_horizon = 0;  ///< steeper than a slope holds
};

Counts count(const ImageDocument& document) {
  const NormalMap& normals = document.normals();
  Counts out;
  for (int y = 0; y < normals.height(); ++y) {
    for (int x = 0; x < normals.width(); ++x) {
      if (!document.mask().empty() && !(document.mask()(x, y) > 0.0F)) continue;
      const Vec3f n = normals.normal(x, y);
      ++out.inside;
      if (n.isZero()) ++out.no_direction;
      if (!n.isZero() && n.z() <= min_cosine) ++out.on_horizon;
    }
  }
  return out;
}

/// The value that 99 % of the numbers stay below; 0 without any.
float percentile_99(MaskView values) {
  std::vector<float> sizes;
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      if (std::isfinite(values(x, y))) sizes.push_back(std::abs(values(x, y)));
    }
  }
  if (sizes.empty()) return 0.0F;
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 99 / 100);
  std::nth_element(sizes.begin(), at, sizes.end());
  return *at;
}

}  // namespace

Value check_image(const OpenedImage& opened, Border border) {
  const NormalMap& normals = opened.document.normals();
  const PictureSlopes found = slopes_of(opened.document);
  const Counts counts = count(opened.document);
  const CurlOptions curl{border};
  const LengthStatistics& lengths = opened.guess.lengths;
  const auto share = [&](double value) { return counts.inside > 0 ? value : 0.0; };
  return Value::Object{
      {"size", Value::Array{normals.width(), normals.height()}},
      {"bits", name_of(normals.codes().type())},
      {"green", normals.convention().green_down ? "down" : "up"},
      {"green_confidence", opened.guess.green_confidence},
      {"conventions", opened.guess.sentence},
      {"lengths",
       Value::Object{{"mean", lengths.mean}, {"least", lengths.min}, {"largest", lengths.max}}},
      {"pixels", counts.inside},
      {"without_direction", counts.no_direction},
      {"on_the_horizon", counts.on_horizon},
      {"curl_share", share(curl_share(found.slopes, found.validity, curl))},
      {"curl_share_of_derivatives",
       share(curl_share_of_derivatives(found.slopes, found.validity, curl))}};
}

float write_curl_picture(const OpenedImage& opened, Border border, float maximum,
                         const std::filesystem::path& file) {
  const PictureSlopes found = slopes_of(opened.document);
  const CurlOptions chosen{border};
  MaskImage values(found.slopes.width(), found.slopes.height());
  curl(found.slopes, found.validity, values, values.rect(), chosen);
  if (!(maximum > 0.0F)) maximum = std::max(percentile_99(values), 1e-6F);
  ColorImage colors(values.width(), values.height());
  curl_heatmap(found.slopes, found.validity, maximum, colors, chosen);
  write_png_codes(file, colors);
  return maximum;
}

}  // namespace normalshop
