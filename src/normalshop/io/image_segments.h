#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "normalshop/document/value.h"
#include "normalshop/io/open_image.h"
#include "normalshop/rgbn/segment.h"
#include "normalshop/rgbn/selection.h"

namespace normalshop {

/// What is made of a picture's segments; files that are empty are not written. Points are "x,y" in
/// pixels from the picture's middle, y up.
struct SegmentJobOptions {
  SegmentOptions segments;
  std::filesystem::path labels;       ///< 16-bit grey: 0 none, then 1 for the first segment
  std::filesystem::path picture;      ///< 8-bit: each in a colour of its own
  std::vector<std::string> selected;  ///< points: the segment at each
  std::vector<std::string> wands;     ///< points: what is like the pixel at each
  WandOptions wand;                   ///< how like
  std::vector<std::string> lassos;    ///< "x,y x,y ...": what lies inside; may leave the picture
  std::filesystem::path mask;         ///< 8-bit grey: all that is selected
  float feather = 0.0F;               ///< width of its soft border in pixels; 0: hard
};

/// Divides a picture (rgbn/segment.h) as far as that is asked for, selects in it (rgbn/selection.h)
/// and writes the files. Returns their names, the number of segments if there are any, and that of
/// selected pixels if a mask is written. Throws InvalidInput: nothing to write, a mask without a
/// selection or the other way round, points that are none or beside the picture, lassos with fewer
/// than 3 points, tolerances out of their range, more segments than 16 bits can count.
Value segment_image(const OpenImageOptions& open, const SegmentJobOptions& options);

}  // namespace normalshop
