#pragma once

#include <vector>

#include "normalshop/core/raw_image.h"
#include "normalshop/core/rect.h"

namespace normalshop {

struct WrappedTaps;

/// An sRGB colour map (or a constant colour, without pixels), read as linear RGB.
class ColorMap {
 public:
  ColorMap() = default;
  /// Integer codes count as sRGB, float codes as linear. 1 or 2 channels: grey.
  explicit ColorMap(RawImage codes, const Vec3f& factor = Vec3f::Ones());
  explicit ColorMap(const Vec3f& constant) : factor_(constant) {}

  bool empty() const { return codes_.empty(); }
  const RawImage& codes() const { return codes_; }
  /// Linear RGB times the factor; bilinear and wrapping like NormalMap::sample().
  Vec3f sample(const Vec2f& uv) const;
  /// sample() at `count` places, faster; room for more entries as in NormalMap::sample().
  void sample(const float* u, const float* v, int count, float* r, float* g, float* b) const;

  /// Has to come once before add(): from here on codes of 8 bits are kept as ones of 16, so that
  /// many small edits don't round away. Shows the same to a sixteenth of an 8-bit code.
  void begin_edits();
  /// Adds linear RGB to what a texel shows. Integer codes stop at what they can hold; what a
  /// channel's factor hides stays as it is, and so does alpha; grey takes the mean. False where no
  /// code changes, or the sum is no number. Different texels may be edited at once.
  bool add(int x, int y, const Vec3f& change);
  bool has_edits() const { return edited_; }
  /// Codes of a rectangle, rows of the type that begin_edits() leaves, become these: an edit.
  void write_codes(const Rect& region, const std::uint8_t* codes);
  /// There are no edits any more: whoever calls this has written back the codes that came. They are
  /// kept as they came from here on.
  void end_edits();
  /// In the type of the codes that came; texels without edit have theirs.
  RawImage encode() const;

 private:
  template <class T>
  bool add_to(T* codes, const Vec3f& change);
  Vec3f texel(int x, int y) const;
  Vec3f sample_8bit(const WrappedTaps& tap) const;

  RawImage codes_;
  Vec3f factor_ = Vec3f::Ones();
  std::vector<float> to_linear_;  ///< by 8-bit code, or by the upper 12 bits of a 16-bit one
  CodeType type_ = CodeType::U8;  ///< of the codes that came
  bool edited_ = false;
};

float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);

}  // namespace normalshop
