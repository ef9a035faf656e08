#include "normalshop/core/distance.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "normalshop/core/parallel.h"

namespace normalshop {

DistanceRows::DistanceRows(const Image<std::uint8_t>& set, int limit)
    : limit_(limit),
      squared_(set.width(), set.height()),
      used_((set.width() + piece - 1) / piece, set.height(), 0) {
  parallel_rows(set.height(), [&](int y) { fill(set, y); });
}

void DistanceRows::fill(const Image<std::uint8_t>& set, int y) {
  const int width = set.width();
  const std::uint8_t* row = set.row(y);
  std::uint8_t* active = used_.row(y);
  int last = -1;
  for (int x = 0; x < width; ++x) {
    const void* next = std::memchr(row + x, 1, static_cast<std::size_t>(width - x));
    if (next == nullptr) break;
    x = static_cast<int>(static_cast<const std::uint8_t*>(next) - row);
    const int first = std::max(x - limit_, std::max(last + 1, 0)) / piece;
    for (int i = first; i <= std::min(x + limit_, width - 1) / piece; ++i) active[i] = 1;
    last = x;
  }
  if (last < 0) return;
  for (int i = 0; i < pieces(); ++i) {
    if (active[i] != 0) fill_piece(row, i * piece, squared_.row(y));
  }
}

void DistanceRows::fill_piece(const std::uint8_t* row, int begin, float* out) const {
  const int width = squared_.width();
  const int end = std::min(begin + piece, width);
  int last = begin - limit_;
  for (int x = std::max(begin - limit_, 0); x < begin; ++x) {
    if (row[x] != 0) last = x;
  }
  for (int x = begin; x < end; ++x) {
    if (row[x] != 0) last = x;
    out[x] = static_cast<float>(std::min(x - last, limit_));
  }
  last = end + limit_;
  for (int x = std::min(end + limit_, width) - 1; x >= begin; --x) {
    if (row[x] != 0) last = x;
    if (x >= end) continue;
    const float nearest = std::min(out[x], static_cast<float>(last - x));
    out[x] = nearest * nearest;
  }
}

bool DistanceRows::read(int y, int i, float* out) const {
  const int begin = i * piece;
  const int count = std::min(piece, squared_.width() - begin);
  const auto cap = static_cast<float>(limit_);
  bool any = false;
  for (int j = std::max(0, y - limit_); j <= std::min(squared_.height() - 1, y + limit_); ++j) {
    if (used_(i, j) == 0) continue;
    if (!any) std::fill_n(out, count, cap * cap);
    any = true;
    const float* in = squared_.row(j) + begin;
    const auto dy = static_cast<float>((y - j) * (y - j));
    for (int x = 0; x < count; ++x) out[x] = std::min(out[x], in[x] + dy);
  }
  for (int x = 0; any && x < count; ++x) out[x] = std::sqrt(out[x]);
  return any;
}

void distance_to(const Image<std::uint8_t>& set, int limit, MaskImage& distance) {
  const DistanceRows rows(set, limit);
  distance.resize(set.width(), set.height());
  parallel_rows(set.height(), [&](int y) {
    for (int i = 0; i < rows.pieces(); ++i) {
      const int begin = i * DistanceRows::piece;
      float* out = distance.row(y) + begin;
      if (rows.read(y, i, out)) continue;
      std::fill_n(out, std::min(DistanceRows::piece, set.width() - begin),
                  static_cast<float>(limit));
    }
  });
}

}  // namespace normalshop
