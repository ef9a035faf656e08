#include <algorithm>
#include <atomic>
#include <bit>

#include "normalshop/surface/detail/atlas_packing.h"

namespace normalshop::unwrapping {

namespace {

/// 64 columns from 64 * i + shift on.
std::uint64_t word_at(const std::uint64_t* words, std::size_t i, int shift) {
  const std::uint64_t* from = words + i + static_cast<std::size_t>(shift / 64);
  const int part = shift % 64;
  return part == 0 ? from[0] : from[0] >> part | from[1] << (64 - part);
}

int gap_of(const std::uint64_t* row, int width) {
  int longest = 0;
  for (int x = 0; x < width;) {
    const std::uint64_t used = row[x / 64] >> (x % 64);
    if ((used & 1U) != 0) {
      x += std::min(std::countr_one(used), 64 - x % 64);
      continue;
    }
    const int begin = x;
    while (x < width) {
      const std::uint64_t rest = row[x / 64] >> (x % 64);
      const int free = std::min(std::countr_zero(rest), 64 - x % 64);
      x += free;
      if (x % 64 != 0 || free == 0) break;
    }
    longest = std::max(longest, std::min(x, width) - begin);
  }
  return longest;
}

}  // namespace

/// Finds where a mask fits in a row of places.
class FitFinder {
 public:
  FitFinder(const PackMask& mask, const PackStrip& strip)
      : mask_(mask), strip_(strip), places_(strip.width_ - mask.width + 1), free_(strip.words_) {
    longest_.resize(static_cast<std::size_t>(mask.height), 0);
    for (int y = 0; y < mask.height; ++y) {
      for_each_run(y, [&](const BitRun& run) {
        int& longest = longest_[static_cast<std::size_t>(y)];
        longest = std::max(longest, run.end - run.begin);
        return true;
      });
    }
    order_rows();
  }

  /// The first place in that row, or -1.
  int find(int y) {
    const auto rows = static_cast<int>(strip_.gaps_.size());
    const int* gaps = strip_.gaps_.data() + std::min(y, rows);
    for (int r = 0, end = std::min(mask_.height, rows - y); r < end; ++r) {
      if (gaps[r] < longest(r)) return -1;
    }
    start();
    for (const int r : order_) {
      if (y + r >= rows) continue;
      const auto row = static_cast<std::size_t>(y + r);
      if (!for_each_run(r, [&](const BitRun& run) { return exclude(row, run); })) return -1;
    }
    return static_cast<int>(first_) * 64 + std::countr_zero(free_[first_]);
  }

 private:
  /// The longest run first, which rules out most; then rows far from each other, whose answers
  /// differ more than neighbours': halves, quarters, eighths.
  void order_rows() {
    const auto height = static_cast<std::uint32_t>(mask_.height);
    const auto bits = static_cast<int>(std::bit_width(height));
    for (std::uint32_t i = 0; i < std::uint32_t{1} << bits; ++i) {
      std::uint32_t row = 0;
      for (int bit = 0; bit < bits; ++bit) row = row << 1 | (i >> bit & 1U);
      if (row < height) order_.push_back(static_cast<int>(row));
    }
    const auto widest = std::max_element(order_.begin(), order_.end(),
                                         [&](int a, int b) { return longest(a) < longest(b); });
    std::rotate(order_.begin(), widest, widest + 1);
  }
  int longest(int row) const { return longest_[static_cast<std::size_t>(row)]; }

  template <class Visit>
  bool for_each_run(int row, const Visit& visit) const {
    for (const BitRun& run : mask_.rim.of(row)) {
      if (!visit(run)) return false;
    }
    return true;
  }

  void start() {
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const int count = std::clamp(places_ - static_cast<int>(i) * 64, 0, 64);
      free_[i] = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    }
    first_ = 0;
    last_ = static_cast<std::size_t>(places_ - 1) / 64;
  }

  /// Takes the places away at which the run meets a used cell; false: none is left.
  bool exclude(std::size_t row, const BitRun& run) {
    const int level =
        static_cast<int>(std::bit_width(static_cast<unsigned>(run.end - run.begin))) - 1;
    const std::uint64_t* smeared = strip_.smeared(row, static_cast<std::size_t>(level));
    const int second = run.end - (1 << level);
    for (std::size_t i = first_; i <= last_; ++i) {
      if (free_[i] == 0) continue;
      free_[i] &= ~(word_at(smeared, i, run.begin) | word_at(smeared, i, second));
    }
    while (first_ <= last_ && free_[first_] == 0) ++first_;
    while (last_ > first_ && free_[last_] == 0) --last_;
    return first_ <= last_;
  }

  const PackMask& mask_;
  const PackStrip& strip_;
  int places_;
  std::vector<std::uint64_t> free_;  ///< bits of places along a row
  std::size_t first_ = 0;            ///< words of free_ that are not 0
  std::size_t last_ = 0;
  std::vector<int> order_;
  std::vector<int> longest_;
};

PackStrip::PackStrip(int width)
    : width_(width),
      words_(static_cast<std::size_t>((width + 63) / 64)),
      stride_(words_ + 2),
      levels_(static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(width)))) {}

PackStrip::Place PackStrip::find(const PackMask& mask, const std::atomic<int>& limit) const {
  if (mask.width > width_) return {};
  FitFinder finder(mask, *this);
  for (int y = 0; y + mask.height <= limit; ++y) {
    const int x = finder.find(y);
    if (x >= 0) return {x, y, true};
  }
  return {};
}

void PackStrip::add_row() {
  smeared_.resize(smeared_.size() + levels_ * stride_, 0);
  gaps_.push_back(width_);
}

void PackStrip::update(std::size_t row) {
  for (std::size_t level = 1; level < levels_; ++level) {
    const std::uint64_t* from = smeared(row, level - 1);
    std::uint64_t* to = smeared(row, level);
    const int shift = 1 << (level - 1);
    for (std::size_t i = 0; i < words_; ++i) {
      const bool inside = i + static_cast<std::size_t>(shift / 64) < words_;
      to[i] = from[i] | (inside ? word_at(from, i, shift) : 0);
    }
  }
  gaps_[row] = gap_of(smeared(row, 0), width_);
}

void PackStrip::put(const PackMask& mask, const Place& place) {
  top_ = std::max(top_, place.y + mask.height);
  while (gaps_.size() < static_cast<std::size_t>(top_)) add_row();
  for (int y = 0; y < mask.height; ++y) {
    const auto row = static_cast<std::size_t>(place.y + y);
    const auto runs = mask.cells.of(y);
    std::uint64_t* words = smeared(row, 0);
    for (const BitRun& run : runs) {
      for (int x = place.x + run.begin; x < place.x + run.end; ++x) {
        words[x / 64] |= std::uint64_t{1} << (x % 64);
      }
    }
    if (!runs.empty()) update(row);
  }
}

}  // namespace normalshop::unwrapping
