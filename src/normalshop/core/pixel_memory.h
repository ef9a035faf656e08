#pragma once

#include <cstddef>

namespace normalshop {

/// Memory for an image, aligned to 64 bytes, NOT initialised. That of large images asks for large
/// pages: the first write then costs a fault every 2 MiB instead of every 4 KiB, and work that goes
/// down columns finds its pages. Throws std::bad_alloc.
void* allocate_pixels(std::size_t bytes);
void free_pixels(void* memory);

}  // namespace normalshop
