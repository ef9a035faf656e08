#pragma once

#include <filesystem>

#include "normalshop/document/value.h"
#include "normalshop/io/open_image.h"

namespace normalshop {

/// What can be wrong with a picture's normals: their lengths as they are coded, pixels without a
/// direction or on the horizon, the conventions as guessed, and the curl's share of the slopes'
/// energy (rgbn/curl.h): what no surface has. Pixels outside the mask don't count.
Value check_image(const OpenedImage& opened, Border border);

/// The size of the curl as a false-colour PNG; `maximum` is the brightest, 0: the 99th percentile.
/// Returns the maximum.
float write_curl_picture(const OpenedImage& opened, Border border, float maximum,
                         const std::filesystem::path& file);

}  // namespace normalshop
