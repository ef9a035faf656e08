#pragma once

#include <cstring>

#include "normalshop/core/raw_image.h"

namespace normalshop::test {

/// Equal in shape, type and every bit.
inline bool same_codes(const RawImage& a, const RawImage& b) {
  return a.width() == b.width() && a.height() == b.height() && a.channels() == b.channels() &&
         a.type() == b.type() && a.size_bytes() == b.size_bytes() &&
         std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace normalshop::test
