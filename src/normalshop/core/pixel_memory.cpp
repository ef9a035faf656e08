#include "normalshop/core/pixel_memory.h"

#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace normalshop {

namespace {

constexpr std::size_t large_page = std::size_t{2} << 20U;
constexpr std::size_t least_for_large_pages = 2 * large_page;

}  // namespace

void* allocate_pixels(std::size_t bytes) {
  const bool large = bytes >= least_for_large_pages;
  const std::size_t alignment = large ? large_page : 64;
  // aligned_alloc wants whole multiples of the alignment.
  const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
  if (memory == nullptr) throw std::bad_alloc();
  if (large) madvise(memory, whole, MADV_HUGEPAGE);  // a wish; nothing depends on it
  return memory;
}

void free_pixels(void* memory) { std::free(memory); }

}  // namespace normalshop
