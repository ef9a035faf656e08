#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "normalshop/core/image_view.h"
#include "normalshop/core/pixel_memory.h"
#include "normalshop/core/rect.h"
#include "normalshop/core/vec.h"

namespace normalshop {

/// Owns its pixels, row after row without padding, aligned to 64 bytes. The pixels of
/// `Image(w, h)` are NOT initialised: large buffers are usually overwritten at once.
template <class T>
class Image {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  Image() = default;
  Image(int width, int height) { resize(width, height); }
  Image(int width, int height, const T& value) : Image(width, height) { fill(value); }
  Image(const Image& other) : Image(other.width_, other.height_) {
    std::copy_n(other.data(), size(), data());
  }
  Image& operator=(const Image& other) {
    if (this != &other) *this = Image(other);
    return *this;
  }
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    Image(std::move(other)).swap(*this);
    return *this;
  }
  ~Image() = default;

  /// Keeps the memory when it is large enough; the pixels are undefined afterwards.
  void resize(int width, int height) {
    assert(width >= 0 && height >= 0);
    const std::size_t needed = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (needed > capacity_) {
      data_.reset(static_cast<T*>(allocate_pixels(needed * sizeof(T))));
      capacity_ = needed;
    }
    width_ = width;
    height_ = height;
  }
  void fill(const T& value) { std::fill_n(data(), size(), value); }

  int width() const { return width_; }
  int height() const { return height_; }
  Rect rect() const { return {0, 0, width_, height_}; }
  bool empty() const { return width_ == 0 || height_ == 0; }
  std::size_t size() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T* row(int y) { return span().row(y); }
  const T* row(int y) const { return view().row(y); }
  T& operator()(int x, int y) { return span()(x, y); }
  const T& operator()(int x, int y) const { return view()(x, y); }

  ImageView<T> view() const { return {data_.get(), width_, height_, width_}; }
  ImageSpan<T> span() { return {data_.get(), width_, height_, width_}; }
  operator ImageView<T>() const { return view(); }
  operator ImageSpan<T>() { return span(); }

 private:
  struct Free {
    void operator()(T* p) const { free_pixels(p); }
  };
  void swap(Image& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(capacity_, other.capacity_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
  }

  std::unique_ptr<T, Free> data_;
  std::size_t capacity_ = 0;
  int width_ = 0;
  int height_ = 0;
};

/// Slopes (z_x, z_y): height per length, x right, y UP, although rows run down.
using SlopeView = ImageView<Vec2f>;
using SlopeSpan = ImageSpan<Vec2f>;
using SlopeImage = Image<Vec2f>;
using MaskView = ImageView<float>;
using MaskSpan = ImageSpan<float>;
using MaskImage = Image<float>;
using ColorView = ImageView<Vec3f>;  ///< linear RGB
using ColorSpan = ImageSpan<Vec3f>;
using ColorImage = Image<Vec3f>;

}  // namespace normalshop
