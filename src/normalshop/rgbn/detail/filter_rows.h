#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "normalshop/core/border.h"
#include "normalshop/core/image.h"

/// What filters read, images that go on beyond their borders, and where they put the numbers that
/// they compute; private to this floor.
namespace normalshop {

template <class T>
constexpr int channels_of = static_cast<int>(sizeof(T) / sizeof(float));

/// The numbers of a row of pixels.
template <class T>
float* numbers(T* pixels) {
  if constexpr (std::is_same_v<T, float>) {
    return pixels;
  } else {
    return pixels->data();
  }
}
template <class T>
const float* numbers(const T* pixels) {
  return numbers(const_cast<T*>(pixels));
}

/// Rows of the plane that an image with a border fills. Masked: every pixel is multiplied by its
/// validity, which follows it as one more number; pixels with 0 read as 0.
template <class T, bool masked>
class ExtendedRows {
 public:
  static constexpr bool is_masked = masked;
  static constexpr int pixel_channels = channels_of<T>;
  static constexpr int channels = pixel_channels + (masked ? 1 : 0);

  ExtendedRows(ImageView<T> image, MaskView validity, Border border)
      : ExtendedRows(image, validity, border, image.rect(), image.width(), image.height()) {}
  /// `part` holds the pixels `where` of an image of width x height: all that will be read, or what
  /// it is a copy of.
  ExtendedRows(ImageView<T> part, MaskView validity, Border border, const Rect& where, int width,
               int height)
      : part_(part),
        validity_(validity),
        border_(border),
        where_(where),
        width_(width),
        height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  Border border() const { return border_; }

  /// The pixels [x0, x1) of row y, anywhere in the plane.
  void read(int x0, int x1, int y, float* to) const {
    const BorderPixel row = border_pixel(y, height_, border_);
    const int a = std::clamp(0, x0, x1);
    const int b = std::clamp(width_, x0, x1);
    for (int x = x0; x < a; ++x, to += channels) put(x, row, to);
    if (b > a) {
      inside(a, b, row, to);
      to += (b - a) * channels;
    }
    for (int x = b; x < x1; ++x, to += channels) put(x, row, to);
  }

  /// The numbers that read() would give, where they lie in memory; else null.
  const float* direct(int x0, int x1, int y) const {
    if (masked || x0 < 0 || x1 > width_ || y < 0 || y >= height_) return nullptr;
    return numbers(part_.row(y - where_.y0) + (x0 - where_.x0));
  }

 private:
  void inside(int x0, int x1, const BorderPixel& row, float* to) const {
    const float* from = numbers(part_.row(row.index - where_.y0) + (x0 - where_.x0));
    if constexpr (masked) {
      const float* weights = validity_.row(row.index - where_.y0) + (x0 - where_.x0);
      for (int i = 0; i < x1 - x0; ++i)
        weigh(from + i * pixel_channels, weights[i], to + i * channels);
    } else {
      std::memcpy(to, from, static_cast<std::size_t>((x1 - x0) * channels) * sizeof(float));
    }
    if (!row.flipped || pixel_channels != 2) return;
    for (int i = 0; i < x1 - x0; ++i) to[i * channels + 1] = -to[i * channels + 1];
  }
  void put(int x, const BorderPixel& row, float* to) const {
    const BorderPixel column = border_pixel(x, width_, border_);
    inside(column.index, column.index + 1, row, to);
    if (column.flipped && pixel_channels == 2) to[0] = -to[0];
  }
  static void weigh(const float* from, float weight, float* to) {
    for (int c = 0; c < pixel_channels; ++c) to[c] = weight > 0.0F ? weight * from[c] : 0.0F;
    to[pixel_channels] = weight;
  }

  ImageView<T> part_;
  MaskView validity_;
  Border border_;
  Rect where_;
  int width_;
  int height_;
};

/// A pixel of an image that is the first one of a part of it.
struct Origin {
  int x = 0;
  int y = 0;
};

/// A part of an image, or all of it.
template <class T>
struct Output {
  ImageSpan<T> span;
  Origin origin;
  T* at(int x, int y) const { return span.row(y - origin.y) + (x - origin.x); }
};

template <class T, class U>
bool share_memory(ImageSpan<T> a, ImageView<U> b) {
  if (a.empty() || b.empty()) return false;
  const auto begin = [](const auto& image) {
    return reinterpret_cast<std::uintptr_t>(image.row(0));
  };
  const auto end = [](const auto& image) {
    return reinterpret_cast<std::uintptr_t>(image.row(image.height() - 1) + image.width());
  };
  return begin(a) < end(b) && begin(b) < end(a);
}

/// `region` of the image of which `from` is the part that begins at `origin`.
template <class T>
void copy_rows(ImageView<T> from, const Origin& origin, ImageSpan<T> to, const Rect& region) {
  for (int y = region.y0; y < region.y1; ++y) {
    const T* row = from.row(y - origin.y) + (region.x0 - origin.x);
    std::copy(row, row + region.width(), to.row(y) + region.x0);
  }
}

/// work(output): into the target itself, or `apart` from it and then copied.
template <class T, class Work>
void write_apart(ImageSpan<T> target, const Rect& region, bool apart, const Work& work) {
  if (!apart) return work(Output<T>{target, {}});
  Image<T> memory(region.width(), region.height());
  const Origin origin{region.x0, region.y0};
  work(Output<T>{memory, origin});
  copy_rows<T>(memory, origin, target, region);
}

/// Takes the results as they are.
template <class T>
struct PlainStore {
  Output<T> output;

  /// A place for the pixels of row y from x0 on, or `free`.
  float* begin(int x0, int y, float* /*free*/) const { return numbers(output.at(x0, y)); }
  void end(int /*x0*/, int /*x1*/, int /*y*/, const float* /*from*/) const {}
  /// Pixels that are `step` numbers apart.
  void spread(int x0, int x1, int y, const float* from, std::ptrdiff_t step) const {
    T* to = output.at(x0, y);
    for (int i = 0; i < x1 - x0; ++i, from += step) {
      std::memcpy(static_cast<void*>(to + i), from, sizeof(T));
    }
  }
};

/// Normalised convolution: divides by the filtered validity, which follows every pixel's numbers.
/// Less than `least_weight` of it counts as nothing valid in reach, where the source is kept.
template <class T>
struct ValidStore {
  static constexpr float least_weight = 1e-4F;
  Output<T> output;
  ImageView<T> source;

  float* begin(int /*x0*/, int /*y*/, float* free) const { return free; }
  void end(int x0, int x1, int y, const float* from) const {
    spread(x0, x1, y, from, channels_of<T> + 1);
  }
  void spread(int x0, int x1, int y, const float* from, std::ptrdiff_t step) const {
    constexpr int channels = channels_of<T>;
    T* to = output.at(x0, y);
    for (int i = 0; i < x1 - x0; ++i, from += step) {
      const float weight = from[channels];
      if (!(weight > least_weight)) {
        to[i] = source(x0 + i, y);
        continue;
      }
      for (int c = 0; c < channels; ++c) numbers(to + i)[c] = from[c] / weight;
    }
  }
};

}  // namespace normalshop
