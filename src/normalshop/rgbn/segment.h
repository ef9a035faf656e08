#pragma once

#include <cstdint>
#include <memory>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

struct SegmentOptions {
  float coarseness = 1.0F;
  int min_size = 50;
  float color_weight = 1.0F;
  float normal_weight = 1.0F;
  float sigma = 0.8F;

  static constexpr auto fields() {
    return std::tuple{
        field("coarseness", &SegmentOptions::coarseness, "1", 0.0, 1e6,
              "Larger values give fewer, larger segments; 0 joins only pixels that are alike"),
        field("min_size", &SegmentOptions::min_size, "pixels", 0.0, 1e9,
              "Smaller segments join a neighbour; 0 and 1 keep them all"),
        field("color_weight", &SegmentOptions::color_weight, "1", 0.0, 1e6,
              "How much a squared difference of linear colours counts; 0: by normals alone"),
        field("normal_weight", &SegmentOptions::normal_weight, "1", 0.0, 1e6,
              "How much a squared difference of unit normals counts; 0: by colours alone"),
        field("sigma", &SegmentOptions::sigma, "pixels", 0.0, 1e6,
              "Smoothing before pixels are compared; 0 compares them as they are")};
  }
};

/// The label of pixels that belong to no segment.
inline constexpr std::uint32_t no_label = 0xFFFFFFFFU;

struct Segments {
  Image<std::uint32_t> labels;  ///< 0 to count - 1 in scan order of the first pixel, or no_label
  std::uint32_t count = 0;
};

/// Graph-based segmentation (Felzenszwalb and Huttenlocher, IJCV 2004) of colours and normals
/// (Toler-Franklin, Finkelstein and Rusinkiewicz, NPAR 2007; thesis 3.3). Each pixel is joined to
/// its 8 neighbours by edges of weight
///     w = sqrt(color_weight |C_i - C_j|^2 + normal_weight |n_i - n_j|^2).
/// In the order of their weights, edges join segments A and B where
///     w <= min(Int(A) + coarseness / |A|, Int(B) + coarseness / |B|),
/// Int(A) being the largest weight that joined A so far. Then segments of less than min_size pixels
/// are joined along the edges that are left, in the same order.
///
/// Weights are held as 11 bits of mantissa from 2^-20 (below that they are 0) to 2^12 (above, that
/// value); equal ones come in scan order. A segment smaller than min_size remains where it touches
/// no other. Pixels with validity 0, and those with a slope or colour that counts and is not
/// finite, belong to no segment. Without colours, normals alone count.
///
/// With Border::Wrap, pixels on opposite sides are neighbours: segments of a tile know no sides.
/// Otherwise `border` only says what smoothing reads beyond them.
///
/// Smoothing blurs edges, too, and sharp ones can become narrow segments of their own. Where noise
/// has been removed by a filter that keeps edges, sigma = 0 finds the borders as they are.
///
/// The graph is for trying other coarsenesses. It joins at once what every coarseness from a
/// twentieth of its own on joins, and keeps the edges between these pieces: from there on segment()
/// takes a fraction of the time, below about as long as the function of that name without
/// smoothing. The segments are the same in either way.
class SegmentGraph {
 public:
  /// Throws InvalidInput for options out of their range and for images of 2^29 pixels or more.
  explicit SegmentGraph(const RgbnView& image, const SegmentOptions& options = {},
                        Border border = Border::Clamp);

  /// Throws InvalidInput for values out of the range that SegmentOptions gives them.
  Segments segment(float coarseness, int min_size) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// The same in one call.
Segments segment(const RgbnView& image, const SegmentOptions& options = {},
                 Border border = Border::Clamp);

}  // namespace normalshop
