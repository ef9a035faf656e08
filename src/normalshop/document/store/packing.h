#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace normalshop {

/// Bytes compressed by zstd, with a checksum of what they were.
std::string pack(std::string_view bytes);

/// What was packed. Throws InvalidInput saying what is wrong: damaged (by the checksum, too), or
/// more than `largest` bytes.
std::string unpack(std::string_view packed, std::size_t largest);

}  // namespace normalshop
