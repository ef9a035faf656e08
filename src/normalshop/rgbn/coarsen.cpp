#include <cmath>

#include "normalshop/rgbn/detail/multigrid.h"

namespace normalshop {

namespace {

/// Sums of coefficients that are smaller than this part of the diagonal are rounding.
constexpr float rounding = 1e-5F;

/// The coefficients of one number with its eight neighbours and itself, [dy + 1][dx + 1].
struct Around {
  float at[3][3];

  /// What the couplings don't balance: > 0 beside a border where the value is given.
  float excess() const {
    float sum = 0.0F;
    for (const auto& line : at) sum += line[0] + line[1] + line[2];
    return sum > rounding * at[1][1] ? sum : 0.0F;
  }
};

/// A row of a stencil with what the row above has of it.
class StencilRow {
 public:
  StencilRow() = default;
  StencilRow(const Stencil& s, int y)
      : above_{s.south_east.row(y - 1), s.south.row(y - 1), s.south_west.row(y - 1)},
        east_(s.east.row(y)),
        center_(s.center.row(y)),
        below_{s.south_west.row(y), s.south.row(y), s.south_east.row(y)} {}

  Around operator()(int i) const {
    return {{{above_[0][i - 2], above_[1][i], above_[2][i + 2]},
             {east_[i - 2], center_[i], east_[i]},
             {below_[0][i], below_[1][i], below_[2][i]}}};
  }

 private:
  std::array<const float*, 3> above_{};
  const float* east_ = nullptr;
  const float* center_ = nullptr;
  std::array<const float*, 3> below_{};
};

/// Weights of the nodes before and after one that lies between them.
struct Pair {
  float before;
  float after;
};

Pair between(float before, float after, const Around& c) {
  const float sum = before + after - c.excess();
  if (!(-sum > rounding * c.at[1][1])) return {0.0F, 0.0F};
  return {before / sum, after / sum};
}

Pair across(const Around& c) {
  return between(c.at[0][0] + c.at[1][0] + c.at[2][0], c.at[0][2] + c.at[1][2] + c.at[2][2], c);
}

Pair down(const Around& c) {
  return between(c.at[0][0] + c.at[0][1] + c.at[0][2], c.at[2][0] + c.at[2][1] + c.at[2][2], c);
}

/// Nodes with an even row or column.
void edge_weights(const Stencil& stencil, int y, Interpolation& to) {
  const StencilRow row(stencil, y);
  for (int i = 0; i < stencil.shape().numbers(); ++i) {
    const bool odd_column = (i / 2) % 2 == 1;
    const bool odd_row = y % 2 == 1;
    if (odd_column && odd_row) continue;
    const Around c = row(i);
    if (!(c.at[1][1] > 0.0F)) continue;
    if (odd_column) {
      const Pair p = across(c);
      to[0].row(y)[i] = p.before;
      to[1].row(y)[i] = p.after;
    } else if (odd_row) {
      const Pair p = down(c);
      to[0].row(y)[i] = p.before;
      to[2].row(y)[i] = p.after;
    } else {
      to[0].row(y)[i] = 1.0F;
    }
  }
}

/// Nodes with an odd row and column: by their equation from the edge nodes around.
void center_weights(const Stencil& stencil, int y, Interpolation& to) {
  const StencilRow row(stencil, y);
  for (int i = 2; i < stencil.shape().numbers(); i += (i % 2 == 0 ? 1 : 3)) {
    const Around c = row(i);
    if (!(c.at[1][1] > 0.0F)) continue;
    const float scale = -1.0F / c.at[1][1];
    const float left = c.at[1][0];
    const float right = c.at[1][2];
    const float up = c.at[0][1];
    const float below = c.at[2][1];
    to[0].row(y)[i] = scale * (c.at[0][0] + up * to[0].row(y - 1)[i] + left * to[0].row(y)[i - 2]);
    to[1].row(y)[i] = scale * (c.at[0][2] + up * to[1].row(y - 1)[i] + right * to[0].row(y)[i + 2]);
    to[2].row(y)[i] =
        scale * (c.at[2][0] + below * to[0].row(y + 1)[i] + left * to[2].row(y)[i - 2]);
    to[3].row(y)[i] =
        scale * (c.at[2][2] + below * to[1].row(y + 1)[i] + right * to[2].row(y)[i + 2]);
  }
}

/// Index of the coarse node of a fine one, where the fine index may lie beyond the ends.
int coarse_index(int i, int size, int coarse_size) {
  if (i < 0) return (i + size) / 2 - coarse_size;
  if (i >= size) return (i - size) / 2 + coarse_size;
  return i / 2;
}

/// One row of the Galerkin product.
class ProductRow {
 public:
  ProductRow(const Stencil& fine, const Interpolation& weights, int y)
      : shape_(fine.shape()), coarse_(coarser(fine.shape())), y_(y) {
    for (int b = -1; b <= 1; ++b) {
      if (inside(2 * y + b)) fine_[at(b)] = StencilRow(fine, 2 * y + b);
    }
    for (int b = -2; b <= 2; ++b) {
      if (!inside(2 * y + b)) continue;
      for (std::size_t k = 0; k < 4; ++k) weights_[at(b)][k] = weights[k].row(2 * y + b);
    }
  }

  void write(Stencil& to) const {
    for (int i = 0; i < coarse_.numbers(); ++i) {
      double sum[3][3] = {};
      for (int b = -1; b <= 1; ++b) {
        if (2 * y_ + b >= shape_.rows || !inside(2 * y_ + b)) continue;
        for (int a = -1; a <= 1; ++a) add(i, a, b, sum);
      }
      to.center.row(y_)[i] = static_cast<float>(sum[1][1]);
      to.east.row(y_)[i] = static_cast<float>(sum[1][2]);
      to.south_west.row(y_)[i] = static_cast<float>(sum[2][0]);
      to.south.row(y_)[i] = static_cast<float>(sum[2][1]);
      to.south_east.row(y_)[i] = static_cast<float>(sum[2][2]);
    }
    to.close(y_);
  }

 private:
  static std::size_t at(int b) { return static_cast<std::size_t>(b + 2); }
  bool inside(int row) const { return shape_.wraps || (row >= 0 && row < shape_.rows); }
  int wrapped(int i, int size) const {
    if (!shape_.wraps) return i;
    return i < 0 ? i + size : (i < size ? i : i - size);
  }

  /// Adds what the fine node (a, b) away from coarse number i contributes.
  void add(int i, int a, int b, double (&sum)[3][3]) const {
    const int channel = i % 2;
    const int fx = 2 * (i / 2) + a;
    if (fx >= shape_.columns || (!shape_.wraps && fx < 0)) return;
    const std::size_t slot = (a < 0 ? 1U : 0U) + (b < 0 ? 2U : 0U);
    const float weight = weights_[at(b)][slot][2 * fx + channel];
    if (weight == 0.0F) return;
    const Around c = fine_[at(b)](2 * wrapped(fx, shape_.columns) + channel);
    for (int dy = -1; dy <= 1; ++dy) {
      const int fy = 2 * y_ + b + dy;
      if (!inside(fy)) continue;
      const int cy = coarse_index(fy, shape_.rows, coarse_.rows) - y_ + 1;
      const bool below = wrapped(fy, shape_.rows) % 2 == 1;
      for (int dx = -1; dx <= 1; ++dx) {
        const float coefficient = c.at[dy + 1][dx + 1];
        if (coefficient == 0.0F) continue;
        const int nx = wrapped(fx + dx, shape_.columns);
        const int cx = coarse_index(fx + dx, shape_.columns, coarse_.columns) - i / 2 + 1;
        const double part = static_cast<double>(weight) * static_cast<double>(coefficient);
        const int place = 2 * nx + channel;
        const auto& w = weights_[at(b + dy)];
        sum[cy][cx] += part * static_cast<double>(w[0][place]);
        if (nx % 2 == 1) sum[cy][cx + 1] += part * static_cast<double>(w[1][place]);
        if (!below) continue;
        sum[cy + 1][cx] += part * static_cast<double>(w[2][place]);
        if (nx % 2 == 1) sum[cy + 1][cx + 1] += part * static_cast<double>(w[3][place]);
      }
    }
  }

  GridShape shape_;
  GridShape coarse_;
  int y_;
  std::array<StencilRow, 5> fine_;  ///< rows 2 y - 2 to 2 y + 2, of which the middle three count
  std::array<std::array<const float*, 4>, 5> weights_{};
};

}  // namespace

GridShape coarser(const GridShape& shape) {
  const auto half = [&](int n) { return shape.wraps ? (n + 1) / 2 : n / 2 + 1; };
  return {half(shape.columns), half(shape.rows), shape.wraps};
}

Interpolation interpolation(const Stencil& stencil) {
  const GridShape& shape = stencil.shape();
  Interpolation weights = {GridField<float>(shape), GridField<float>(shape),
                           GridField<float>(shape), GridField<float>(shape)};
  for_each_row(shape, [&](int y) {
    edge_weights(stencil, y, weights);
    for (GridField<float>& w : weights) w.close(y);
  });
  for_each_row(shape, [&](int y) {
    if (y % 2 == 1) center_weights(stencil, y, weights);
  });
  for_each_row(shape, [&](int y) {
    for (GridField<float>& w : weights) {
      w.close(y);
      std::fill_n(w.row(y) + shape.numbers(), 2 * GridField<float>::margin, 0.0F);
    }
  });
  return weights;
}

Stencil coarse_stencil(const Stencil& stencil, const Interpolation& weights) {
  Stencil coarse(coarser(stencil.shape()));
  for_each_row(coarse.shape(), [&](int y) { ProductRow(stencil, weights, y).write(coarse); });
  return coarse;
}

}  // namespace normalshop
