#include "normalshop/rgbn/detail/corner_heights.h"

#include <cmath>

// A pixel's two slopes are the differences of the heights along its two diagonals, so the corners
// with even x + y and those with odd x + y never touch. In either set the odd rows of corners are
// coupled with even rows only: each odd corner is the weighted mean of the four around it. Taking
// them out leaves the even rows with compact nine-point stencils, in which both sets lie
// interleaved: columns of nodes x / 2, numbers x.
namespace normalshop {

namespace {

using Row = Eigen::Map<Eigen::ArrayXd>;

Row numbers(GridField<double>& field, int y) { return {field.row(y), field.shape().numbers()}; }

/// Four sums side by side: fixed order, and fit for vector instructions.
template <class A, class B>
double dot(const A* a, const B* b, int count) {
  double sums[4] = {};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    for (int k = 0; k < 4; ++k) {
      sums[k] += static_cast<double>(a[i + k]) * static_cast<double>(b[i + k]);
    }
  }
  for (; i < count; ++i) sums[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

template <class A, class B>
double dot(const GridField<A>& a, const GridField<B>& b) {
  return sum_rows(a.shape(), [&](int y) { return dot(a.row(y), b.row(y), a.shape().numbers()); });
}

/// The four weights around a corner, beginning with those of the row above.
struct CornerWeights {
  double at[4];
  CornerWeights(const float* above, const float* below, int x)
      : at{static_cast<double>(above[x - 1]), static_cast<double>(above[x]),
           static_cast<double>(below[x - 1]), static_cast<double>(below[x])} {}
  double sum() const { return (at[0] + at[1]) + (at[2] + at[3]); }
  bool whole() const { return at[0] > 0.0 && at[1] > 0.0 && at[2] > 0.0 && at[3] > 0.0; }
};

GridShape even_rows(const Rect& pixels, bool wraps) {
  if (wraps) return {pixels.width() / 2, pixels.height() / 2, true};
  return {pixels.width() / 2 + 1, pixels.height() / 2 + 1, false};
}

}  // namespace

CornerHeights::CornerHeights(MaskView weights, bool wraps, Ends ends)
    : size_(weights.rect()),
      shape_(even_rows(size_, wraps)),
      weights_({shape_.columns, 2 * shape_.rows, wraps}),
      inverse_(shape_),
      free_(shape_) {
  for_each_row({shape_.columns, size_.height(), wraps}, [&](int y) {
    std::copy_n(weights.row(y), size_.width(), weights_.row(y));
    weights_.close(y);
  });
  for_each_row(shape_, [&](int y) {
    for (int x = 0; x < shape_.numbers(); ++x) {
      const CornerWeights even(pixels(2 * y - 1), pixels(2 * y), x);
      const CornerWeights odd(pixels(2 * y), pixels(2 * y + 1), x);
      const bool fixed = ends == Ends::Zero;
      free_.row(y)[x] = even.sum() > 0.0 && !(fixed && !even.whole()) ? 1.0F : 0.0F;
      const bool free = odd.sum() > 0.0 && !(fixed && !odd.whole());
      inverse_.row(y)[x] = free ? 1.0 / odd.sum() : 0.0;
    }
    free_.close(y);
    inverse_.close(y);
  });
  preconditioner_.emplace(stencil());
}

/// The system of the even rows with the odd ones taken out: an odd corner with weights w leaves
/// couplings -w_k w_l / sum(w) between the four around it.
Stencil CornerHeights::stencil() const {
  Stencil a(shape_);
  for_each_row(shape_, [&](int y) {
    for (int x = 0; x < shape_.numbers(); ++x) {
      if (free_.row(y)[x] == 0.0F) continue;
      const auto odd = [&](int dx, int dy) {  // the odd corner there and its weights
        const int row = 2 * (y + dy);
        return std::pair(inverse_.row(y + dy)[x + dx],
                         CornerWeights(pixels(row), pixels(row + 1), x + dx));
      };
      const auto [i_nw, nw] = odd(-1, -1);
      const auto [i_ne, ne] = odd(1, -1);
      const auto [i_sw, sw] = odd(-1, 0);
      const auto [i_se, se] = odd(1, 0);
      const auto part = [](double inverse, const CornerWeights& w, std::size_t k, std::size_t l) {
        return w.at[k] * w.at[l] * inverse;
      };
      const double center = nw.at[3] - part(i_nw, nw, 3, 3) + (ne.at[2] - part(i_ne, ne, 2, 2)) +
                            (sw.at[1] - part(i_sw, sw, 1, 1)) + (se.at[0] - part(i_se, se, 0, 0));
      const auto coupling = [&](double sum, int dx, int dy) {
        return static_cast<float>(-sum) * free_.row(y + dy)[x + dx];
      };
      a.center.row(y)[x] = static_cast<float>(center);
      a.east.row(y)[x] = coupling(part(i_ne, ne, 2, 3) + part(i_se, se, 0, 1), 2, 0);
      a.south.row(y)[x] = coupling(part(i_sw, sw, 1, 3) + part(i_se, se, 0, 2), 0, 1);
      a.south_east.row(y)[x] = coupling(part(i_se, se, 0, 3), 2, 1);
      a.south_west.row(y)[x] = coupling(part(i_sw, sw, 1, 2), -2, 1);
    }
    a.close(y);
  });
  return a;
}

/// The right side of the whole system, odd rows, and of the even rows alone.
struct CornerHeights::Right {
  explicit Right(const GridShape& shape) : odd(shape), even(shape) {}
  GridField<double> odd;
  GridField<double> even;
};

CornerHeights::Right CornerHeights::right_side(SlopeView slopes) const {
  const auto divergence = [&](const float* weight, int row, int x) {
    // Where the weight is 0 nothing is read: the slope may be anything, or lie outside.
    const auto slope = [&](int dx, int dy) -> Vec2d {
      if (weight[dx + x] == 0.0F) return Vec2d::Zero();
      const auto inside = [&](int i, int n) { return i < 0 ? i + n : (i < n ? i : i - n); };
      const Vec2f& s = slopes(inside(x + dx, size_.width()), inside(row + dy, size_.height()));
      return static_cast<double>(weight[dx + x]) * s.cast<double>();
    };
    return std::pair(slope(-1, 0), slope(0, 0));
  };
  const auto at = [&](int row, int x) {  // corner (x, row)
    const auto [nw, ne] = divergence(pixels(row - 1), row - 1, x);
    const auto [sw, se] = divergence(pixels(row), row, x);
    return (nw.x() - nw.y()) - (ne.x() + ne.y()) + (sw.x() + sw.y()) - (se.x() - se.y());
  };
  Right right(shape_);
  for_each_row(shape_, [&](int y) {
    for (int x = 0; x < shape_.numbers(); ++x) {
      right.odd.row(y)[x] = inverse_.row(y)[x] > 0.0 ? at(2 * y + 1, x) : 0.0;
    }
    right.odd.close(y);
  });
  for_each_row(shape_, [&](int y) {
    const auto from_odd = [&](int dy, int x) {
      const double* inverse = inverse_.row(dy);
      const double* odd = right.odd.row(dy);
      return std::pair(inverse[x - 1] * odd[x - 1], inverse[x + 1] * odd[x + 1]);
    };
    for (int x = 0; x < shape_.numbers(); ++x) {
      if (free_.row(y)[x] == 0.0F) continue;
      const CornerWeights w(pixels(2 * y - 1), pixels(2 * y), x);
      const auto [nw, ne] = from_odd(y - 1, x);
      const auto [sw, se] = from_odd(y, x);
      right.even.row(y)[x] =
          at(2 * y, x) + ((w.at[0] * nw + w.at[1] * ne) + (w.at[2] * sw + w.at[3] * se));
    }
  });
  return right;
}

/// Odd corners of row y as the means of the even ones around, with a ghost on both sides.
void CornerHeights::odd_row(const GridField<double>& x, int y, double* out) const {
  const float* above = pixels(2 * y);
  const float* below = pixels(2 * y + 1);
  const double* up = x.row(y);
  const double* down = x.row(y + 1);
  const double* inverse = inverse_.row(y);
  for (int i = -1; i <= shape_.numbers(); ++i) {
    out[i] = inverse[i] * ((static_cast<double>(above[i - 1]) * up[i - 1] +
                            static_cast<double>(above[i]) * up[i + 1]) +
                           (static_cast<double>(below[i - 1]) * down[i - 1] +
                            static_cast<double>(below[i]) * down[i + 1]));
  }
}

/// out = A x for the even rows; returns <x, A x>.
double CornerHeights::apply(const GridField<double>& x, GridField<double>& out) const {
  const int n = shape_.numbers();
  std::vector<double> sums(static_cast<std::size_t>(shape_.rows));
  parallel_for(sums.size(), row_grain(n), [&](std::size_t first, std::size_t last) {
    std::vector<double> buffers(2 * static_cast<std::size_t>(n + 4));
    double* before = buffers.data() + 2;
    double* after = before + n + 4;
    odd_row(x, static_cast<int>(first) - 1, before);
    for (std::size_t k = first; k < last; ++k) {
      const int y = static_cast<int>(k);
      odd_row(x, y, after);
      const float* above = pixels(2 * y - 1);
      const float* below = pixels(2 * y);
      const float* free = free_.row(y);
      const double* here = x.row(y);
      double* to = out.row(y);
      for (int i = 0; i < n; ++i) {
        const double sum = (static_cast<double>(above[i - 1]) * (here[i] - before[i - 1]) +
                            static_cast<double>(above[i]) * (here[i] - before[i + 1])) +
                           (static_cast<double>(below[i - 1]) * (here[i] - after[i - 1]) +
                            static_cast<double>(below[i]) * (here[i] - after[i + 1]));
        to[i] = static_cast<double>(free[i]) * sum;
      }
      sums[k] = dot(here, to, n);
      std::swap(before, after);
    }
  });
  return sum_by_halves(sums.data(), sums.size());
}

Image<double> CornerHeights::corners(const GridField<double>& even, const Right& right) const {
  Image<double> heights(size_.width() + 1, size_.height() + 1, 0.0);
  for_each_row(shape_, [&](int y) {
    std::vector<double> buffer(static_cast<std::size_t>(shape_.numbers() + 4));
    double* odd = buffer.data() + 2;
    odd_row(even, y, odd);
    for (int x = 0; x < heights.width(); ++x) {
      const int i = shape_.wraps ? x % shape_.numbers() : x;
      heights(x, 2 * y) = even.row(y)[i];
      if (2 * y + 1 >= heights.height()) continue;
      heights(x, 2 * y + 1) = odd[i] + inverse_.row(y)[i] * right.odd.row(y)[i];
    }
  });
  if (shape_.wraps) {
    std::copy_n(heights.row(0), heights.width(), heights.row(heights.height() - 1));
  }
  return heights;
}

CornerHeights::Solution CornerHeights::solve(SlopeView slopes, const Options& options,
                                             const Progress& progress) {
  assert(slopes.rect() == size_);
  const Right right = right_side(slopes);
  const double energy = sum_rows({shape_.columns, size_.height()}, [&](int y) {
    double sum = 0.0;
    for (int x = 0; x < size_.width(); ++x) {
      const auto weight = static_cast<double>(pixels(y)[x]);
      if (weight > 0.0) sum += weight * slopes(x, y).cast<double>().squaredNorm();
    }
    return sum;
  });
  // <r, M r> is about twice the energy of the slopes' error (along the diagonals they are counted
  // twice).
  const double goal = 2.0 * options.tolerance * options.tolerance * energy;
  GridField<double> x(shape_);
  GridField<double> residual = right.even;
  GridField<double> step(shape_);
  GridField<double> product(shape_);
  Solution solution;
  double last = 0.0;
  double first = 0.0;
  while (solution.iterations < options.most_iterations) {
    const GridField<float>& better = preconditioner_->solve(residual);
    const double size = dot(residual, better);
    if (!(size > goal)) break;
    if (first == 0.0) first = size;
    const double done = std::log(first / size) / std::log(first / goal);
    progress.at(std::clamp(done, 0.0, 1.0), "integrating slopes");
    const double keep = last > 0.0 ? size / last : 0.0;
    last = size;
    for_each_row(shape_, [&](int y) {
      const Eigen::Map<const Eigen::ArrayXf> to(better.row(y), shape_.numbers());
      numbers(step, y) = to.cast<double>() + keep * numbers(step, y);
      step.close(y);
    });
    const double curvature = apply(step, product);
    if (!(curvature > 0.0)) break;
    const double length = size / curvature;
    for_each_row(shape_, [&](int y) {
      numbers(x, y) += length * numbers(step, y);
      numbers(residual, y) -= length * numbers(product, y);
    });
    ++solution.iterations;
  }
  for_each_row(shape_, [&](int y) { x.close(y); });
  solution.heights = corners(x, right);
  return solution;
}

}  // namespace normalshop
