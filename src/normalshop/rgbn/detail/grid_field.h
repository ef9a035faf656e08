#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "normalshop/core/image.h"
#include "normalshop/core/parallel.h"

/// Numbers on the nodes of a grid with ghosts around them, private to this floor. Each node has two
/// numbers of two problems that don't touch each other: node x holds numbers 2x and 2x + 1.
namespace normalshop {

struct GridShape {
  int columns = 0;  ///< nodes
  int rows = 0;
  bool wraps = false;  ///< the last node's neighbour is the first, both ways

  int numbers() const { return 2 * columns; }
};

template <class T>
class GridField {
 public:
  /// Ghost nodes on every side. They are 0, except that the ends of a row that wraps are copied
  /// into them by close().
  static constexpr int margin = 2;

  GridField() = default;
  explicit GridField(const GridShape& shape)
      : shape_(shape), data_(2 * (shape.columns + 2 * margin), shape.rows + 2 * margin, T{0}) {}

  const GridShape& shape() const { return shape_; }
  /// y from -margin to rows + margin - 1; numbers from -2 margin on.
  T* row(int y) { return data_.row(place(y)) + 2 * margin; }
  const T* row(int y) const { return data_.row(place(y)) + 2 * margin; }

  /// To call when row y has been written.
  void close(int y) {
    if (!shape_.wraps) return;
    T* to = row(y);
    const int n = shape_.numbers();
    for (int i = 0; i < 2 * margin; ++i) {
      to[n + i] = to[i % n];
      to[-1 - i] = to[n - 1 - i % n];
    }
  }

 private:
  int place(int y) const {
    if (!shape_.wraps) return y + margin;
    return (y + shape_.rows * margin) % shape_.rows + margin;
  }

  GridShape shape_;
  Image<T> data_;
};

/// Rows that are worth a task.
inline std::size_t row_grain(int numbers) {
  return static_cast<std::size_t>(std::max(1, 16384 / std::max(1, numbers)));
}

/// body(y) for all rows, in parallel.
template <class Body>
void for_each_row(const GridShape& shape, const Body& body) {
  parallel_for(static_cast<std::size_t>(shape.rows), row_grain(shape.numbers()),
               [&](std::size_t a, std::size_t b) {
                 for (std::size_t y = a; y < b; ++y) body(static_cast<int>(y));
               });
}

/// Sum of body(y) over all rows in an order that does not depend on threads: by halves, which also
/// keeps the rounding small.
inline double sum_by_halves(const double* values, std::size_t count) {
  if (count == 0) return 0.0;
  if (count == 1) return *values;
  const std::size_t half = count / 2;
  return sum_by_halves(values, half) + sum_by_halves(values + half, count - half);
}

template <class Body>
double sum_rows(const GridShape& shape, const Body& body) {
  std::vector<double> sums(static_cast<std::size_t>(shape.rows));
  for_each_row(shape, [&](int y) { sums[static_cast<std::size_t>(y)] = body(y); });
  return sum_by_halves(sums.data(), sums.size());
}

}  // namespace normalshop
