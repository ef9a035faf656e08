#pragma once

#include "normalshop/core/image.h"
#include "normalshop/rgbn/detail/normal_layer.h"
#include "normalshop/rgbn/shade_lines.h"

/// The kinds of lines that find_lines() finds. Images have their origin at the corner of a
/// rectangle `area` of the picture.
namespace normalshop {

/// A pixel's place in the row across a line.
struct LinePoint {
  float distance;  ///< pixels from the middle of the line
  float strength;  ///< 1 at the limit that the options set
};

inline constexpr LinePoint no_line = {1e9F, 0.0F};

/// How far a line of this width covers a pixel at this distance from its middle.
inline float line_cover(float distance, float width) {
  return std::clamp(0.5F * width + 0.5F - distance, 0.0F, std::min(1.0F, width));
}

/// Strength below which nothing of a line remains.
inline constexpr float weak_line = 0.5F;
/// Strength from which on a line has its full width.
inline constexpr float full_line = 1.2F;

/// 1 at pixels on the rim of a surface in front of another one, 0 elsewhere.
MaskImage find_rims(const NormalLayer& layer, const Rect& area, const LineOptions& options);

/// Sets the mask to 1 at pixels of a surface that are beside a gap.
void add_outline(const NormalLayer& layer, const Rect& area, MaskImage& mask);

/// Outlines, rims and what is seen from the side. Reads the layer as far as the blur and 2 pixels
/// beyond the area.
Image<LinePoint> find_contours(const NormalLayer& layer, const Rect& area,
                               const LineOptions& options);
/// Sigma of the blur that turns the staircases of contours into smooth lines.
float rim_blur(const LineOptions& options);

Image<LinePoint> find_suggestive(const NormalLayer& smooth, const Rect& area,
                                 const LineOptions& options);

struct Creases {
  Image<LinePoint> ridges;
  Image<LinePoint> valleys;
};
Creases find_creases(const NormalLayer& smooth, const Rect& area, const LineOptions& options);

/// Keeps pixels of the line with strength 1 and those above weak_line that are joined to one by
/// such pixels within `steps`; takes the strength of the others.
void keep_connected(Image<LinePoint>& line, float width, int steps);

/// Takes the strength of lines that extend over fewer pixels than `shortest` both ways; those that
/// leave the image are kept.
void drop_short(Image<LinePoint>& line, float width, int shortest);

}  // namespace normalshop
