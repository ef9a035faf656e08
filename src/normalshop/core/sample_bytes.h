#pragma once

#include "normalshop/core/raw_image.h"
#include "normalshop/core/sample.h"

/// Bilinear reading of 8-bit pixels at many places, internal to floor 1.
namespace normalshop {

/// Three components of an image with 3 or 4 channels, wrapping like WrappedTaps: means of the codes
/// or, with a table of 256 numbers, of the numbers that they stand for. The arrays have
/// sample_padding more entries. False, and nothing is known, when the image must be read one by one
/// (a place beside its last byte, or 2 GiB and more).
bool sample_bytes(const RawImage& image, const float* table, const float* u, const float* v,
                  int count, float* out0, float* out1, float* out2);

}  // namespace normalshop
