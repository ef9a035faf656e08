#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "normalshop/core/image.h"

namespace normalshop {

enum class CodeType { U8, U16, F32 };
constexpr auto names_of(CodeType) { return std::array<std::string_view, 3>{"8", "16", "32"}; }

/// Pixels exactly as a file holds them: 1 to 4 interleaved channels of one type, rows top to
/// bottom.
class RawImage {
 public:
  RawImage() = default;
  /// Not initialised.
  RawImage(int width, int height, int channels, CodeType type)
      : bytes_(width * channels * code_size(type), height),
        width_(width),
        channels_(channels),
        type_(type) {}

  static int code_size(CodeType type) {
    return type == CodeType::U8 ? 1 : type == CodeType::U16 ? 2 : 4;
  }
  /// The code that stands for 1.
  static float full_code(CodeType type) {
    return type == CodeType::U8 ? 255.0F : type == CodeType::U16 ? 65535.0F : 1.0F;
  }

  int width() const { return width_; }
  int height() const { return bytes_.height(); }
  int channels() const { return channels_; }
  CodeType type() const { return type_; }
  bool empty() const { return bytes_.empty(); }
  /// Bytes of a row, and of all rows (there is no padding between them).
  std::size_t row_bytes() const { return static_cast<std::size_t>(bytes_.width()); }
  std::size_t size_bytes() const { return bytes_.size(); }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::uint8_t* data() { return bytes_.data(); }

  const std::uint8_t* row_data(int y) const { return bytes_.row(y); }
  std::uint8_t* row_data(int y) { return bytes_.row(y); }

  /// First code of a row, as its own type. T must match type().
  template <class T>
  const T* row(int y) const {
    assert(sizeof(T) == static_cast<std::size_t>(code_size(type_)));
    return reinterpret_cast<const T*>(bytes_.row(y));
  }
  template <class T>
  T* row(int y) {
    assert(sizeof(T) == static_cast<std::size_t>(code_size(type_)));
    return reinterpret_cast<T*>(bytes_.row(y));
  }

  /// One code as a number: 0..255, 0..65535 or the float itself.
  float code(int x, int y, int channel) const {
    const int i = x * channels_ + channel;
    if (type_ == CodeType::U8) return static_cast<float>(row<std::uint8_t>(y)[i]);
    if (type_ == CodeType::U16) return static_cast<float>(row<std::uint16_t>(y)[i]);
    return row<float>(y)[i];
  }

 private:
  Image<std::uint8_t> bytes_;
  int width_ = 0;
  int channels_ = 0;
  CodeType type_ = CodeType::U8;
};

}  // namespace normalshop
