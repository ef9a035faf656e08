#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "normalshop/core/random.h"

/// Bytes of files that no program would write.
namespace normalshop::test {

inline std::string random_bytes(std::size_t size) {
  Random random(11);
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.next() & 0xFFU);
  return bytes;
}

inline std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i) & 0xFFU);
  return out;
}

inline std::string big(std::uint32_t value) {
  std::string out = little(value, 4);
  std::reverse(out.begin(), out.end());
  return out;
}

inline std::string tga_header(int width, int height) {
  return std::string("\0\0\2\0\0\0\0\0\0\0\0\0", 12) +
         little(static_cast<std::uint64_t>(width), 2) +
         little(static_cast<std::uint64_t>(height), 2) + std::string("\x18\0", 2);
}

/// One strip of RGB, 8 bits.
inline std::string tiff_file(std::uint32_t width, std::uint32_t height) {
  const std::array<std::array<std::uint32_t, 4>, 9> entries{{{256, 4, 1, width},
                                                             {257, 4, 1, height},
                                                             {258, 3, 1, 8},
                                                             {259, 3, 1, 1},
                                                             {262, 3, 1, 2},
                                                             {273, 4, 1, 200},
                                                             {277, 3, 1, 3},
                                                             {278, 4, 1, height},
                                                             {279, 4, 1, 300}}};
  std::string bytes("II*\0", 4);
  bytes += little(8, 4) + little(entries.size(), 2);
  for (const auto& e : entries) {
    bytes += little(e[0], 2) + little(e[1], 2) + little(e[2], 4) + little(e[3], 4);
  }
  bytes.resize(500, '\x55');
  return bytes;
}

}  // namespace normalshop::test
