#pragma once

#include <algorithm>

namespace normalshop {

/// Half-open rectangle of pixels: x0 <= x < x1, y0 <= y < y1. Empty when x1 <= x0 or y1 <= y0.
struct Rect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  int width() const { return std::max(0, x1 - x0); }
  int height() const { return std::max(0, y1 - y0); }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  bool operator==(const Rect&) const = default;
};

inline Rect intersect(const Rect& a, const Rect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// Smallest rectangle that holds both; an empty one adds nothing.
inline Rect unite(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

inline Rect grow(const Rect& r, int pixels) {
  return {r.x0 - pixels, r.y0 - pixels, r.x1 + pixels, r.y1 + pixels};
}

inline Rect shift(const Rect& r, int x, int y) { return {r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y}; }

}  // namespace normalshop
