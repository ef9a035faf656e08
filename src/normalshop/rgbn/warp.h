#pragma once

#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <tuple>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"
#include "normalshop/core/options.h"
#include "normalshop/rgbn/rgbn_image.h"

namespace normalshop {

/// Where a pixel of the target comes from. Positions in pixels, y DOWN like the rows, on both
/// sides.
struct WarpPoint {
  Vec2d position;            ///< W(x), in the source
  Eigen::Matrix2d jacobian;  ///< DW(x); the columns are the derivatives by x and by y
};

/// The inverse map W from target to source, a run of pixels at a time: fills `run` for the pixels
/// (x0, y), (x0 + 1, y), ... Called by several threads at once; a pixel's answer may depend on the
/// pixel alone, must be finite and below 1e9. The Jacobian must be the derivative of the position,
/// or the warped slopes get curl.
using WarpMap = std::function<void(int x0, int y, std::span<WarpPoint> run)>;

/// What becomes of the heights where the picture is enlarged or reduced.
enum class WarpHeights {
  Keep,  ///< heights are copied, so what is enlarged gets flatter (thesis 2.4)
  Grow,  ///< heights grow with the root of the area: a similarity keeps the steepness
};
constexpr auto names_of(WarpHeights) { return std::array<std::string_view, 2>{"keep", "grow"}; }

/// What a pixel shows where the picture is reduced.
enum class WarpReduction {
  Average,  ///< the mean over its footprint: no aliasing
  Sample,   ///< the source at W(x) alone: fine structures alias
};
constexpr auto names_of(WarpReduction) {
  return std::array<std::string_view, 2>{"average", "sample"};
}

struct WarpOptions {
  WarpHeights heights = WarpHeights::Keep;
  WarpReduction reduction = WarpReduction::Average;
  Border border = Border::Clamp;

  static constexpr auto fields() {
    return std::tuple{
        field("heights", &WarpOptions::heights,
              "Whether heights keep or grow where the picture is enlarged; keep flattens there"),
        field("reduction", &WarpOptions::reduction,
              "Whether pixels average what they show or sample it where the picture is reduced; "
              "sampling keeps slopes free of curl there, too"),
        field("border", &WarpOptions::border, "What is read beyond the image")};
  }
};

/// Warps slopes as the gradients that they are, and colours beside them (thesis 2.4): with W read
/// from `map`,
///     slopes'(x) = DW(x)^T slopes(W(x)),    color'(x) = color(W(x)),
/// the slopes of the height z(W(x)). With WarpHeights::Grow DW is divided by the root of |det DW|
/// (1e-6 at least); the result is then no gradient unless the scale is the same everywhere.
///
/// Bicubic (Catmull-Rom): the error for a wave of wave number k (1 / pixel) is below k^3 / 45 of
/// its height for k up to 1. Along an axis of the target that W steps through at more than a pixel
/// a pixel, WarpReduction::Average takes the mean over sqrt(step^2 - 1) pixels, at most 64 samples
/// an axis, so enlarging and reducing join smoothly; that flattens a wave along the axis by k^2
/// (step^2 - 1) / 24 and, where the step changes, adds curl of that order. Pixels that fall on
/// centres of the source are copied: the identity leaves all bits, quarter turns and mirrors all
/// values. Validity: pixels with 0 do not count (beside them bilinear, by validity); where nothing
/// valid is in reach, it is ignored.
///
/// Source and target may differ in size, must not overlap. Empty slopes or colours of the target
/// are not wanted. Returns region within target. Throws InvalidInput for a source that lacks what
/// the target wants.
Rect warp(const RgbnView& source, const RgbnSpan& target, Rect region, const WarpMap& map,
          const WarpOptions& options = {});
/// The same for one number per pixel, moved as it is: masks, heights.
Rect warp(MaskView source, MaskSpan target, Rect region, const WarpMap& map,
          const WarpOptions& options = {});

/// Pixels read beyond the region, by this map.
int reach(const WarpMap& map, Rect region);

}  // namespace normalshop
