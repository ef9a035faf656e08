#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "normalshop/core/vec.h"

namespace normalshop::unwrapping {

/// Three corners each, in the chart's plane, in lengths on the surface.
struct PackShape {
  std::vector<Vec2d> corners;
};

/// place = turn * (p * scale) + offset, where turn = (cos, sin): a chart's place in the unit
/// square, y up.
struct PackPlace {
  Vec2d turn{1.0, 0.0};
  Vec2d offset{0.0, 0.0};
};
struct Packing {
  double scale = 1.0;
  std::vector<PackPlace> places;  ///< per shape
};

/// Packs shapes, all scaled alike, as pictures into the unit square, as large as it finds them to
/// fit, with `gutter` (in the square's sides) between them and half of it along the square's
/// border. Shapes may lie in holes and bays of others. Throws InvalidInput when the gutter leaves
/// no room for that many.
Packing pack(std::span<const PackShape> shapes, double gutter);

/// Rows of bits, 64 a word.
class BitPicture {
 public:
  BitPicture() = default;
  BitPicture(int width, int height)
      : width_(width),
        height_(height),
        words_((width + 63) / 64),
        bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(height), 0) {}
  int width() const { return width_; }
  int height() const { return height_; }
  int words() const { return words_; }
  std::uint64_t* row(int y) { return bits_.data() + static_cast<std::ptrdiff_t>(y) * words_; }
  const std::uint64_t* row(int y) const {
    return bits_.data() + static_cast<std::ptrdiff_t>(y) * words_;
  }
  /// Sets columns begin to end - 1.
  void set(int y, int begin, int end);

 private:
  int width_ = 0;
  int height_ = 0;
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// Set cells of a row: columns begin to end - 1.
struct BitRun {
  int begin;
  int end;
};

/// A picture as runs, row by row.
struct RunRows {
  std::vector<BitRun> runs;
  std::vector<std::uint32_t> start{0};  ///< per row its first run, and the number of all

  std::span<const BitRun> of(int row) const {
    const auto y = static_cast<std::size_t>(row);
    return std::span(runs).subspan(start[y], start[y + 1] - start[y]);
  }
};

/// A shape as the cells that it touches, with its rim of free cells around it.
struct PackMask {
  int width = 0;  ///< with the rim
  int height = 0;
  RunRows cells;
  RunRows rim;             ///< cells and rim
  Vec2d origin{0.0, 0.0};  ///< place of the picture's corner, in cells
};

/// The shape turned and scaled to cells. `rim`: cells around it that others may not touch.
PackMask make_mask(const PackShape& shape, const Vec2d& turn, double scale, int rim);
/// The same shape turned by 180 degrees.
PackMask upside_down(const PackMask& mask);

class FitFinder;

/// Places masks in a strip of a given width, one after the other, as low as they go.
class PackStrip {
 public:
  explicit PackStrip(int width);

  struct Place {
    int x = 0;
    int y = 0;
    bool found = false;
  };
  /// The lowest place, then the leftmost, with the mask's upper end at `limit` or below, which may
  /// sink meanwhile.
  Place find(const PackMask& mask, const std::atomic<int>& limit) const;
  void put(const PackMask& mask, const Place& place);
  /// Upper end of what was put.
  int top() const { return top_; }

 private:
  friend class FitFinder;
  void add_row();
  void update(std::size_t row);
  std::uint64_t* smeared(std::size_t row, std::size_t level) {
    return smeared_.data() + (row * levels_ + level) * stride_;
  }
  const std::uint64_t* smeared(std::size_t row, std::size_t level) const {
    return smeared_.data() + (row * levels_ + level) * stride_;
  }

  int width_;
  int top_ = 0;
  std::size_t words_;
  std::size_t stride_;  ///< words beyond the end stay 0, so that shifts may read them
  std::size_t levels_;
  /// Bit x of a row's level k: one of the cells x to x + 2^k - 1 is used.
  std::vector<std::uint64_t> smeared_;
  std::vector<int> gaps_;  ///< per row, the longest of free cells
};

}  // namespace normalshop::unwrapping
