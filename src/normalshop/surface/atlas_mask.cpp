#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "normalshop/surface/detail/atlas_packing.h"

namespace normalshop::unwrapping {

void BitPicture::set(int y, int begin, int end) {
  std::uint64_t* words = row(y);
  for (int x = begin; x < end;) {
    const int next = std::min(end, (x / 64 + 1) * 64);
    const int count = next - x;
    const std::uint64_t ones = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    words[x / 64] |= ones << (x % 64);
    x = next;
  }
}

namespace {

Vec2d turned(const Vec2d& p, const Vec2d& turn) {
  return {turn.x() * p.x() - turn.y() * p.y(), turn.y() * p.x() + turn.x() * p.y()};
}

/// Marks all cells that a triangle touches: in each row the extent of its part there.
void mark_triangle(BitPicture& cells, const std::array<Vec2d, 3>& p) {
  const double bottom = std::min({p[0].y(), p[1].y(), p[2].y()});
  const double top = std::max({p[0].y(), p[1].y(), p[2].y()});
  for (int y = static_cast<int>(bottom); y <= static_cast<int>(top); ++y) {
    const double low = std::max<double>(y, bottom);
    const double high = std::min<double>(y + 1, top);
    double left = 1e300;
    double right = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d& a = p[k].y() <= p[(k + 1) % 3].y() ? p[k] : p[(k + 1) % 3];
      const Vec2d& b = p[k].y() <= p[(k + 1) % 3].y() ? p[(k + 1) % 3] : p[k];
      if (b.y() < low || a.y() > high) continue;
      const double rise = b.y() - a.y();
      const double slope = rise > 0.0 ? (b.x() - a.x()) / rise : 0.0;
      const double xa = rise > 0.0 ? a.x() + (std::max(low, a.y()) - a.y()) * slope : a.x();
      const double xb = rise > 0.0 ? a.x() + (std::min(high, b.y()) - a.y()) * slope : b.x();
      left = std::min({left, xa, xb});
      right = std::max({right, xa, xb});
    }
    if (left > right) continue;
    cells.set(y, std::max(0, static_cast<int>(left)),
              std::min(cells.width(), static_cast<int>(right) + 1));
  }
}

/// ORs `from` into `to`, moved right by `shift` (left if negative).
void add_shifted(std::uint64_t* to, const std::uint64_t* from, int words, int shift) {
  const int whole = std::abs(shift) / 64;
  const int part = std::abs(shift) % 64;
  for (int i = 0; i + whole < words; ++i) {
    if (shift >= 0) {
      to[i + whole] |= from[i] << part;
      if (part > 0 && i + whole + 1 < words) to[i + whole + 1] |= from[i] >> (64 - part);
    } else {
      to[i] |= from[i + whole] >> part;
      if (part > 0 && i + whole + 1 < words) to[i] |= from[i + whole + 1] << (64 - part);
    }
  }
}

BitPicture dilated(const BitPicture& cells, int rim) {
  BitPicture wide(cells.width(), cells.height());
  for (int y = 0; y < cells.height(); ++y) {
    for (int dx = -rim; dx <= rim; ++dx) {
      add_shifted(wide.row(y), cells.row(y), cells.words(), dx);
    }
  }
  BitPicture all(cells.width(), cells.height());
  for (int y = 0; y < cells.height(); ++y) {
    const int end = std::min(cells.height() - 1, y + rim);
    for (int near = std::max(0, y - rim); near <= end; ++near) {
      for (int i = 0; i < cells.words(); ++i) all.row(y)[i] |= wide.row(near)[i];
    }
  }
  return all;
}

/// The first column from x on that is set, or free, at most `width`.
int next_column(const std::uint64_t* row, int x, int width, bool set) {
  while (x < width) {
    const std::uint64_t word = set ? row[x / 64] : ~row[x / 64];
    const std::uint64_t rest = word >> (x % 64);
    if (rest != 0) return std::min(width, x + std::countr_zero(rest));
    x = (x / 64 + 1) * 64;
  }
  return width;
}

RunRows runs_of(const BitPicture& cells) {
  RunRows rows;
  rows.start.reserve(static_cast<std::size_t>(cells.height()) + 1);
  for (int y = 0; y < cells.height(); ++y) {
    const std::uint64_t* row = cells.row(y);
    for (int x = next_column(row, 0, cells.width(), true); x < cells.width();) {
      const int end = next_column(row, x, cells.width(), false);
      rows.runs.push_back({x, end});
      x = next_column(row, end, cells.width(), true);
    }
    rows.start.push_back(static_cast<std::uint32_t>(rows.runs.size()));
  }
  return rows;
}

RunRows upside_down(const RunRows& rows, int width) {
  RunRows turned_rows;
  turned_rows.runs.resize(rows.runs.size());
  std::transform(rows.runs.rbegin(), rows.runs.rend(), turned_rows.runs.begin(),
                 [&](const BitRun& run) {
                   return BitRun{width - run.end, width - run.begin};
                 });
  turned_rows.start.resize(rows.start.size());
  std::transform(rows.start.rbegin(), rows.start.rend(), turned_rows.start.begin(),
                 [&](std::uint32_t start) { return rows.start.back() - start; });
  return turned_rows;
}

}  // namespace

PackMask make_mask(const PackShape& shape, const Vec2d& turn, double scale, int rim) {
  std::vector<Vec2d> places(shape.corners.size());
  Vec2d low = Vec2d::Constant(1e300);
  Vec2d high = Vec2d::Constant(-1e300);
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = scale * turned(shape.corners[i], turn);
    low = low.cwiseMin(places[i]);
    high = high.cwiseMax(places[i]);
  }
  PackMask mask;
  mask.origin = low - Vec2d::Constant(rim);
  mask.width = static_cast<int>(high.x() - low.x()) + 1 + 2 * rim;
  mask.height = static_cast<int>(high.y() - low.y()) + 1 + 2 * rim;
  BitPicture cells(mask.width, mask.height);
  for (std::size_t i = 0; i + 2 < places.size(); i += 3) {
    mark_triangle(
        cells, {places[i] - mask.origin, places[i + 1] - mask.origin, places[i + 2] - mask.origin});
  }
  mask.cells = runs_of(cells);
  mask.rim = runs_of(dilated(cells, rim));
  return mask;
}

PackMask upside_down(const PackMask& mask) {
  PackMask turned_mask;
  turned_mask.width = mask.width;
  turned_mask.height = mask.height;
  turned_mask.cells = upside_down(mask.cells, mask.width);
  turned_mask.rim = upside_down(mask.rim, mask.width);
  turned_mask.origin = -mask.origin - Vec2d(mask.width, mask.height);
  return turned_mask;
}

}  // namespace normalshop::unwrapping
