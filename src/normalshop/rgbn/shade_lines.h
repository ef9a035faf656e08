#pragma once

#include <array>
#include <string_view>
#include <tuple>

#include "normalshop/core/image.h"
#include "normalshop/core/options.h"

namespace normalshop {

/// What lines are drawn on. White: paper, everywhere. Keep: what target holds, such as a toon.
enum class LinePaper { White, Keep };
constexpr auto names_of(LinePaper) { return std::array<std::string_view, 2>{"white", "keep"}; }

struct LineOptions {
  float width = 2.0F;
  float sigma = 3.0F;
  float contours = 1.0F;
  float suggestive = 0.8F;
  float ridges = 0.0F;
  float valleys = 0.8F;
  float jump = 40.0F;
  float dip = 0.02F;
  float crease = 15.0F;
  float connect = 24.0F;
  float shortest = 16.0F;
  LinePaper paper = LinePaper::White;

  static constexpr auto fields() {
    return std::tuple{
        field("width", &LineOptions::width, "length", 0.0, 1e3, "Width of the lines; 0 draws none"),
        field("sigma", &LineOptions::sigma, "length", 0.3, 1e3,
              "Details of the normals smaller than about this get no lines"),
        field("contours", &LineOptions::contours, "1", 0.0, 1.0,
              "Darkness of outlines and edges in front of something; 0 draws none"),
        field(
            "suggestive", &LineOptions::suggestive, "1", 0.0, 1.0,
            "Darkness of suggestive contours, which would be contours from a view nearby; 0 draws "
            "none"),
        field("ridges", &LineOptions::ridges, "1", 0.0, 1.0, "Darkness of ridges; 0 draws none"),
        field("valleys", &LineOptions::valleys, "1", 0.0, 1.0, "Darkness of valleys; 0 draws none"),
        field("jump", &LineOptions::jump, "degrees", 1.0, 180.0,
              "Least angle between the normals of neighbours that counts as a step in depth, where "
              "one of them is a rim; 180 draws outlines only"),
        field("dip", &LineOptions::dip, "1", 0.0, 100.0,
              "How sharp a suggestive contour must be: change of the radial curvature over sigma, "
              "times sigma"),
        field("crease", &LineOptions::crease, "degrees", 0.0, 180.0,
              "Least angle by which the surface turns across a ridge or valley"),
        field("connect", &LineOptions::connect, "length", 0.0, 1e3,
              "How far a line goes on below these limits, down to half of them; 0 stops there"),
        field("shortest", &LineOptions::shortest, "length", 0.0, 1e3,
              "Shorter lines than this are left out; 0 keeps them all"),
        field("paper", &LineOptions::paper, "Whether lines are drawn on white or on the picture")};
  }
};

/// Where lines go, 0 (none) to 1; an empty one is not wanted.
struct LineSpans {
  MaskSpan contours;
  MaskSpan suggestive;
  MaskSpan ridges;
  MaskSpan valleys;
};

/// Finds lines in unit normals in view axes (zero: nothing there), antialiased from where they run
/// between pixels. The options' darkness doesn't count here.
/// - Contours: the border of what is there, n3 = 0.1, and rims whose neighbour's normal jumps.
/// - Suggestive contours (DeCarlo et al. 2003): n3 is least along (n1, n2), which is where the
///   radial curvature changes its sign.
/// - Ridges and valleys: the larger principal curvature is extreme along its direction.
/// The last three thin out towards their weak ends and keep away from rims, suggestive contours
/// also from outlines and from valleys, which they would double. All images have one size. Returns
/// the pixels that it wrote. Throws InvalidInput for options out of range.
Rect find_lines(ImageView<Vec3f> normals, const LineSpans& lines, Rect region,
                const LineOptions& options = {});

/// Line drawing: find_lines() in ink over the paper. Linear colours. Writes all of `region`, also
/// where there is no normal.
Rect shade_lines(ImageView<Vec3f> normals, ColorSpan target, Rect region,
                 const LineOptions& options = {});

/// Pixels read beyond the region.
int reach(const LineOptions& options);

}  // namespace normalshop
