#include "normalshop/document/region_before.h"

#include <algorithm>
#include <cstring>

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

template <class T>
bool same(const T* a, const T* b, int count) {
  return std::memcmp(a, b, static_cast<std::size_t>(count) * sizeof(T)) == 0;
}

}  // namespace

void RegionBefore::take(const Rect& region, const OperatorResult& result) {
  change_.resize(region.width(), region.height());
  coverage_.resize(region.width(), region.height());
  parallel_rows(region.height(), [&](int y) {
    const int row = region.y0 + y;
    std::copy_n(result.change.row(row) + region.x0, region.width(), change_.row(y));
    std::copy_n(result.coverage.row(row) + region.x0, region.width(), coverage_.row(y));
  });
}

void RegionBefore::mark_different(const OperatorResult& result, PixelBlocks& drawn) const {
  const Rect& region = drawn.region();
  for_pixels(drawn.blocks(), [&](int x, int y) {
    const Rect block = drawn.pixels(x, y);
    const int column = block.x0 - region.x0;
    for (int row = block.y0; row < block.y1; ++row) {
      const int before = row - region.y0;
      const bool unchanged =
          same(result.change.row(row) + block.x0, change_.row(before) + column, block.width()) &&
          same(result.coverage.row(row) + block.x0, coverage_.row(before) + column, block.width());
      if (!unchanged) return drawn.mark(x, y);
    }
  });
}

}  // namespace normalshop
