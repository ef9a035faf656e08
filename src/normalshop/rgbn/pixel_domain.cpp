#include "normalshop/rgbn/detail/pixel_domain.h"

#include <cmath>
#include <vector>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Sets of numbers; the smallest stands for its set.
class Sets {
 public:
  int add() {
    parents_.push_back(static_cast<int>(parents_.size()));
    return parents_.back();
  }
  int find(int i) {
    while (parent(i) != i) {
      parent(i) = parent(parent(i));
      i = parent(i);
    }
    return i;
  }
  void join(int a, int b) {
    a = find(a);
    b = find(b);
    parent(std::max(a, b)) = std::min(a, b);
  }
  int size() const { return static_cast<int>(parents_.size()); }

 private:
  int& parent(int i) { return parents_[static_cast<std::size_t>(i)]; }

  std::vector<int> parents_;
};

/// A corner has pixels all around.
class Whole {
 public:
  Whole(MaskView weights, bool wraps) : weights_(weights), wraps_(wraps) {}
  bool operator()(int x, int y) const {
    return pixel(x - 1, y - 1) && pixel(x, y - 1) && pixel(x - 1, y) && pixel(x, y);
  }

 private:
  bool pixel(int x, int y) const {
    const int w = weights_.width();
    const int h = weights_.height();
    if (wraps_) return weights_((x + w) % w, (y + h) % h) > 0.0F;
    return x >= 0 && y >= 0 && x < w && y < h && weights_(x, y) > 0.0F;
  }

  MaskView weights_;
  bool wraps_;
};

/// One more from row to row, downwards and then upwards; around the ends when the image repeats.
void spread_along_columns(Image<float>& distance, bool wraps) {
  const int last = distance.height() - 1;
  const auto spread = [&](int from, int to) {
    for (int x = 0; x < distance.width(); ++x) {
      distance(x, to) = std::min(distance(x, to), distance(x, from) + 1.0F);
    }
  };
  for (int round = 0; round < (wraps ? 2 : 1); ++round) {
    if (wraps) spread(last, 0);
    for (int y = 1; y <= last; ++y) spread(y - 1, y);
    if (wraps) spread(0, last);
    for (int y = last; y > 0; --y) spread(y, y - 1);
  }
}

}  // namespace

ConnectedPixels connected_pixels(MaskView weights, bool wraps) {
  ConnectedPixels result;
  result.labels = Image<int>(weights.width(), weights.height(), -1);
  Image<int>& labels = result.labels;
  Sets sets;
  const auto join = [&](int x, int y, int ox, int oy) {
    if (labels(x, y) >= 0 && labels(ox, oy) >= 0) sets.join(labels(x, y), labels(ox, oy));
  };
  for (int y = 0; y < weights.height(); ++y) {
    for (int x = 0; x < weights.width(); ++x) {
      if (!(weights(x, y) > 0.0F)) continue;
      const bool continues = x > 0 && labels(x - 1, y) >= 0;
      labels(x, y) = continues ? labels(x - 1, y) : sets.add();
      if (y > 0) join(x, y, x, y - 1);
    }
    if (wraps) join(0, y, weights.width() - 1, y);
  }
  for (int x = 0; wraps && x < weights.width(); ++x) join(x, 0, x, weights.height() - 1);

  std::vector<int> names(static_cast<std::size_t>(sets.size()), -1);
  for (int i = 0; i < sets.size(); ++i) {
    int& name = names[static_cast<std::size_t>(sets.find(i))];
    if (name < 0) name = result.count++;
    names[static_cast<std::size_t>(i)] = name;
  }
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (labels(x, y) >= 0) labels(x, y) = names[static_cast<std::size_t>(labels(x, y))];
    }
  }
  return result;
}

Image<float> end_distance(MaskView weights, bool wraps, float limit) {
  const Whole whole(weights, wraps);
  Image<float> along(weights.width() + 1, weights.height() + 1);
  for (int y = 0; y < along.height(); ++y) {
    for (int x = 0; x < along.width(); ++x) along(x, y) = whole(x, y) ? limit : 0.0F;
  }
  spread_along_columns(along, wraps);
  Image<float> result(along.width(), along.height());
  const int radius = static_cast<int>(std::ceil(limit));
  const auto nearest = [&](const float* row, int x) {
    float best = std::min(row[x], limit) * std::min(row[x], limit);
    const auto look = [&](int at, float dx) {
      if (wraps) at = (at % weights.width() + weights.width()) % weights.width();
      if (at >= 0 && at <= weights.width()) best = std::min(best, dx * dx + row[at] * row[at]);
    };
    for (int k = 1; k <= radius && static_cast<float>(k) * static_cast<float>(k) < best; ++k) {
      look(x - k, static_cast<float>(k));
      look(x + k, static_cast<float>(k));
    }
    return std::sqrt(best);
  };
  parallel_for(static_cast<std::size_t>(result.height()), 8, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      for (int x = 0; x < result.width(); ++x) result(x, y) = nearest(along.row(y), x);
    }
  });
  return result;
}

}  // namespace normalshop
