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

StripRow::StripRow(int width) : longest_gap(width) {
  // Words beyond the end stay 0, so that shifts may read them.
  const auto words = static_cast<std::size_t>(2 * ((width + 63) / 64) + 1);
  smeared.assign(static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(width))),
                 std::vector<std::uint64_t>(words, 0));
}

void StripRow::update(int width) {
  for (std::size_t level = 1; level < smeared.size(); ++level) {
    const std::vector<std::uint64_t>& from = smeared[level - 1];
    for (std::size_t i = 0; i < static_cast<std::size_t>((width + 63) / 64); ++i) {
      smeared[level][i] = from[i] | word_at(from.data(), i, 1 << (level - 1));
    }
  }
  longest_gap = gap_of(smeared[0].data(), width);
}

namespace {

/// Finds where a mask fits in a row of places.
class FitFinder {
 public:
  FitFinder(const PackMask& mask, int width)
      : mask_(mask),
        places_(width - mask.width() + 1),
        free_(static_cast<std::size_t>((width + 63) / 64)) {
    order_.resize(static_cast<std::size_t>(mask.height()));
    longest_.resize(order_.size(), 0);
    for (int y = 0; y < mask.height(); ++y) {
      order_[static_cast<std::size_t>(y)] = y;
      for_each_run(y, [&](const BitRun& run) {
        int& longest = longest_[static_cast<std::size_t>(y)];
        longest = std::max(longest, run.end - run.begin);
        return true;
      });
    }
    // Long runs rule out most, rows far from each other more than neighbours.
    std::stable_sort(order_.begin(), order_.end(),
                     [&](int a, int b) { return spread_rank(a) < spread_rank(b); });
    const auto widest = std::max_element(order_.begin(), order_.end(),
                                         [&](int a, int b) { return longest(a) < longest(b); });
    std::rotate(order_.begin(), widest, widest + 1);
  }

  /// The first place in that row, or -1.
  int find(const std::vector<StripRow>& rows, int y) {
    const auto used = [&](int r) { return static_cast<std::size_t>(y + r) < rows.size(); };
    const auto row = [&](int r) -> const StripRow& {
      return rows[static_cast<std::size_t>(y + r)];
    };
    for (const int r : order_) {
      if (used(r) && row(r).longest_gap < longest(r)) return -1;
    }
    start();
    for (const int r : order_) {
      if (!used(r)) continue;
      if (!for_each_run(r, [&](const BitRun& run) { return exclude(row(r), run); })) return -1;
    }
    return static_cast<int>(first_) * 64 + std::countr_zero(free_[first_]);
  }

 private:
  /// Rows in the order of their bits from the lowest on: halves, quarters, eighths.
  static std::uint32_t spread_rank(int row) {
    std::uint32_t rank = 0;
    for (int bit = 0; bit < 16; ++bit)
      rank = rank << 1 | (static_cast<std::uint32_t>(row) >> bit & 1U);
    return rank;
  }
  int longest(int row) const { return longest_[static_cast<std::size_t>(row)]; }

  template <class Visit>
  bool for_each_run(int row, const Visit& visit) const {
    const auto y = static_cast<std::size_t>(row);
    for (std::uint32_t i = mask_.rim_start[y]; i < mask_.rim_start[y + 1]; ++i) {
      if (!visit(mask_.rim[i])) return false;
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
  bool exclude(const StripRow& row, const BitRun& run) {
    const int level = std::bit_width(static_cast<unsigned>(run.end - run.begin)) - 1;
    const std::uint64_t* smeared = row.smeared[static_cast<std::size_t>(level)].data();
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
  int places_;
  std::vector<std::uint64_t> free_;  ///< bits of places along a row
  std::size_t first_ = 0;            ///< words of free_ that are not 0
  std::size_t last_ = 0;
  std::vector<int> order_;
  std::vector<int> longest_;
};

}  // namespace

PackStrip::Place PackStrip::find(const PackMask& mask, const std::atomic<int>& limit) const {
  if (mask.width() > width_) return {};
  FitFinder finder(mask, width_);
  for (int y = 0; y + mask.height() <= limit; ++y) {
    const int x = finder.find(rows_, y);
    if (x >= 0) return {x, y, true};
  }
  return {};
}

void PackStrip::put(const PackMask& mask, const Place& place) {
  top_ = std::max(top_, place.y + mask.height());
  while (rows_.size() < static_cast<std::size_t>(top_)) rows_.emplace_back(width_);
  for (int y = 0; y < mask.height(); ++y) {
    StripRow& row = rows_[static_cast<std::size_t>(place.y + y)];
    bool changed = false;
    for (int x = 0; x < mask.width(); ++x) {
      if (!mask.cells.at(x, y)) continue;
      row.smeared[0][static_cast<std::size_t>((place.x + x) / 64)] |= std::uint64_t{1}
                                                                      << ((place.x + x) % 64);
      changed = true;
    }
    if (changed) row.update(width_);
  }
}

}  // namespace normalshop::unwrapping
