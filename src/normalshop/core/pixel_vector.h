#pragma once

#include <new>
#include <vector>

#include "normalshop/core/pixel_memory.h"

namespace normalshop {

/// Gives std::vector the memory of images (pixel_memory.h).
template <class T>
struct PixelAllocator {
  using value_type = T;
  PixelAllocator() = default;
  template <class U>
  PixelAllocator(const PixelAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pixels(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) { free_pixels(memory); }
  /// resize() leaves numbers as they are.
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U{static_cast<Arguments&&>(arguments)...};
  }
  template <class U>
  bool operator==(const PixelAllocator<U>&) const {
    return true;
  }
};

/// A list as long as an image has pixels, in such memory; what resize() adds is NOT initialised.
template <class T>
using PixelVector = std::vector<T, PixelAllocator<T>>;

}  // namespace normalshop
