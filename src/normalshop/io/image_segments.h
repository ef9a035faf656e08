#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "normalshop/document/value.h"
#include "normalshop/io/open_image.h"
#include "normalshop/rgbn/segment.h"

namespace normalshop {

/// What is made of a picture's segments; files that are empty are not written.
struct SegmentJobOptions {
  SegmentOptions segments;
  std::filesystem::path labels;       ///< 16-bit grey: 0 none, then 1 for the first segment
  std::filesystem::path picture;      ///< 8-bit: each in a colour of its own
  std::vector<std::string> selected;  ///< "x,y" in pixels from the picture's middle, y up
  std::filesystem::path mask;         ///< 8-bit grey: the segments at these points
  float feather = 0.0F;               ///< width of its soft border in pixels; 0: hard
};

/// Divides a picture (rgbn/segment.h) and writes the files. Returns their number and names. Throws
/// InvalidInput: nothing to write, points beside the picture, more segments than 16 bits can count.
Value segment_image(const OpenImageOptions& open, const SegmentJobOptions& options);

}  // namespace normalshop
