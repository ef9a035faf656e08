#include "normalshop/chart/nearest_fill.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <tuple>
#include <vector>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr std::int32_t no_point = -1;
constexpr std::int32_t waiting = -2;  // in the next front

/// One search: fronts of pixels at the same distance, one after the other.
class Search {
 public:
  explicit Search(const Image<Shown>& shown)
      : shown_(shown), nearest_(shown.width(), shown.height()) {}

  Image<std::int32_t> run() {
    begin();
    while (!front_.empty()) advance();
    return std::move(nearest_);
  }

 private:
  void begin();
  void advance();
  std::int32_t choose(std::int32_t pixel) const;
  /// Puts the holes around a pixel that wait for no front yet into `next`.
  void invite(int x, int y, std::vector<std::int32_t>& next);
  void add_to_front(const std::vector<std::int32_t>& part) {
    const std::lock_guard lock(mutex_);
    next_.insert(next_.end(), part.begin(), part.end());
  }
  template <class Visit>
  void around(int x, int y, const Visit& visit) const {
    const Rect box = intersect({x - 1, y - 1, x + 2, y + 2}, nearest_.rect());
    for (int j = box.y0; j < box.y1; ++j) {
      for (int i = box.x0; i < box.x1; ++i) visit(i, j);
    }
  }

  const Image<Shown>& shown_;
  Image<std::int32_t> nearest_;
  std::vector<std::int32_t> front_;
  std::vector<std::int32_t> next_;
  std::mutex mutex_;
};

void Search::invite(int x, int y, std::vector<std::int32_t>& next) {
  around(x, y, [&](int i, int j) {
    if (shown_(i, j) != Shown::Hole) return;
    std::atomic_ref<std::int32_t> place(nearest_(i, j));
    std::int32_t expected = no_point;
    if (place.load(std::memory_order_relaxed) != no_point) return;
    if (!place.compare_exchange_strong(expected, waiting, std::memory_order_relaxed)) return;
    next.push_back(j * nearest_.width() + i);
  });
}

void Search::begin() {
  const int width = shown_.width();
  parallel_rows(shown_.height(), [&](int y) {
    for (int x = 0; x < width; ++x) {
      nearest_(x, y) = shown_(x, y) == Shown::Point ? y * width + x : no_point;
    }
  });
  parallel_for(static_cast<std::size_t>(shown_.height()), 16, [&](std::size_t a, std::size_t b) {
    std::vector<std::int32_t> found;
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < width; ++x) {
        if (shown_(x, y) != Shown::Hole) continue;
        bool beside = false;
        around(x, y, [&](int i, int j) { beside = beside || shown_(i, j) == Shown::Point; });
        if (!beside) continue;
        nearest_(x, y) = waiting;
        found.push_back(y * width + x);
      }
    }
    add_to_front(found);
  });
  front_.swap(next_);
}

std::int32_t Search::choose(std::int32_t pixel) const {
  const int width = nearest_.width();
  const int x = pixel % width;
  const int y = pixel / width;
  using Rank = std::tuple<int, int, std::int32_t>;
  Rank best{1 << 30, 1 << 30, no_point};
  around(x, y, [&](int i, int j) {
    const std::int32_t point = nearest_(i, j);
    if (point < 0) return;
    const int dx = std::abs(point % width - x);
    const int dy = std::abs(point / width - y);
    best = std::min(best, Rank{std::max(dx, dy), dx * dx + dy * dy, point});
  });
  return std::get<2>(best);
}

void Search::advance() {
  // All choose before any is filled, so that their order does not matter.
  std::vector<std::int32_t> chosen(front_.size());
  parallel_for(front_.size(), 1024, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) chosen[i] = choose(front_[i]);
  });
  parallel_for(front_.size(), 1024, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      nearest_.data()[static_cast<std::size_t>(front_[i])] = chosen[i];
    }
  });
  next_.clear();
  parallel_for(front_.size(), 1024, [&](std::size_t a, std::size_t b) {
    std::vector<std::int32_t> next;
    for (std::size_t i = a; i < b; ++i) {
      invite(front_[i] % nearest_.width(), front_[i] / nearest_.width(), next);
    }
    add_to_front(next);
  });
  front_.swap(next_);
}

}  // namespace

Image<std::int32_t> nearest_points(const Image<Shown>& shown) { return Search(shown).run(); }

}  // namespace normalshop
