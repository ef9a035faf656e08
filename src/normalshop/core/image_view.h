#pragma once

#include <cassert>
#include <cstddef>

#include "normalshop/core/rect.h"

namespace normalshop {

/// Read-only window on pixels that somebody else owns. Rows are `stride` pixels apart.
template <class T>
class ImageView {
 public:
  ImageView() = default;
  ImageView(const T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), stride_(stride), width_(width), height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  Rect rect() const { return {0, 0, width_, height_}; }
  bool empty() const { return width_ == 0 || height_ == 0; }
  const T* row(int y) const {
    assert(y >= 0 && y < height_);
    return data_ + y * stride_;
  }
  const T& operator()(int x, int y) const {
    assert(x >= 0 && x < width_);
    return row(y)[x];
  }

 private:
  const T* data_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  int width_ = 0;
  int height_ = 0;
};

/// Writable window on pixels that the caller owns.
template <class T>
class ImageSpan {
 public:
  ImageSpan() = default;
  ImageSpan(T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), stride_(stride), width_(width), height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  Rect rect() const { return {0, 0, width_, height_}; }
  bool empty() const { return width_ == 0 || height_ == 0; }
  T* row(int y) const {
    assert(y >= 0 && y < height_);
    return data_ + y * stride_;
  }
  T& operator()(int x, int y) const {
    assert(x >= 0 && x < width_);
    return row(y)[x];
  }
  operator ImageView<T>() const { return {data_, width_, height_, stride_}; }

 private:
  T* data_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace normalshop
