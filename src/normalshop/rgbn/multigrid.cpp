#include "normalshop/rgbn/detail/multigrid.h"

#include <Eigen/SparseCholesky>

namespace normalshop {

namespace {

/// Up to so many unknowns the system is solved directly.
constexpr std::size_t direct_limit = 10000;
/// Grids narrower than this are not made coarser: solving them directly is cheap.
constexpr int narrow = 5;
/// Steps of the two Jacobi sweeps: Chebyshev's for eigenvalues from 0.6 to 1.6 of the operator over
/// its diagonal. Inside a domain rough errors have 2/3 to 4/3, at borders up to 2.
constexpr std::array<float, 2> smoothing_steps = {1.3405F, 0.6877F};

using Row = Eigen::Map<Eigen::ArrayXf>;
using ConstRow = Eigen::Map<const Eigen::ArrayXf>;

ConstRow numbers(const GridField<float>& field, int y, int shift = 0) {
  return {field.row(y) + shift, field.shape().numbers()};
}

Row numbers(GridField<float>& field, int y) { return {field.row(y), field.shape().numbers()}; }

/// b - A x of one row, as an expression.
auto residual(const Stencil& a, const GridField<float>& x, const GridField<float>& b, int y) {
  return numbers(b, y) - numbers(a.center, y) * numbers(x, y) -
         (numbers(a.east, y) * numbers(x, y, 2) + numbers(a.east, y, -2) * numbers(x, y, -2)) -
         (numbers(a.south, y) * numbers(x, y + 1) + numbers(a.south, y - 1) * numbers(x, y - 1)) -
         (numbers(a.south_east, y) * numbers(x, y + 1, 2) +
          numbers(a.south_east, y - 1, -2) * numbers(x, y - 1, -2)) -
         (numbers(a.south_west, y) * numbers(x, y + 1, -2) +
          numbers(a.south_west, y - 1, 2) * numbers(x, y - 1, 2));
}

std::size_t unknowns(const Stencil& stencil) {
  return static_cast<std::size_t>(sum_rows(stencil.shape(), [&](int y) {
    return static_cast<double>((numbers(stencil.center, y) > 0.0F).count());
  }));
}

/// Row y of the coarser grid: interpolation^T * fine.
void restrict_row(const Interpolation& weights, const GridField<float>& fine, int y,
                  GridField<float>& coarse) {
  float* to = coarse.row(y);
  std::fill_n(to, coarse.shape().numbers(), 0.0F);
  for (int b = -1; b <= 1; ++b) {
    if (2 * y + b >= fine.shape().rows) continue;
    const std::size_t slot = b < 0 ? 2 : 0;
    const float* here = weights[slot].row(2 * y + b);
    const float* left = weights[slot + 1].row(2 * y + b);
    const float* from = fine.row(2 * y + b);
    for (int i = 0; i < coarse.shape().numbers(); ++i) {
      const int k = 2 * i - i % 2;
      to[i] += left[k - 2] * from[k - 2] + here[k] * from[k] + here[k + 2] * from[k + 2];
    }
  }
  coarse.close(y);
}

/// Adds interpolation * coarse to row y of `fine`.
void add_interpolated(const Interpolation& weights, const GridField<float>& coarse, int y,
                      GridField<float>& fine) {
  float* to = fine.row(y);
  for (std::size_t below = 0; below <= static_cast<std::size_t>(y % 2); ++below) {
    const float* first = weights[2 * below].row(y);
    const float* second = weights[2 * below + 1].row(y);
    const float* from = coarse.row(y / 2 + static_cast<int>(below));
    for (int i = 0; i < fine.shape().numbers(); ++i) {
      const int k = i / 4 * 2 + i % 2;
      to[i] += first[i] * from[k] + second[i] * from[k + 2];
    }
  }
  fine.close(y);
}

}  // namespace

struct Multigrid::Level {
  explicit Level(Stencil stencil)
      : a(std::move(stencil)), inverse(a.shape()), x(a.shape()), b(a.shape()), next(a.shape()) {
    for_each_row(a.shape(), [&](int y) {
      numbers(inverse, y) = (numbers(a.center, y) > 0.0F).select(1.0F / numbers(a.center, y), 0.0F);
    });
  }
  void start() {
    for_each_row(a.shape(), [&](int y) {
      numbers(x, y) = smoothing_steps[0] * numbers(inverse, y) * numbers(b, y);
      x.close(y);
    });
  }
  void smooth(float step) {
    for_each_row(a.shape(), [&](int y) {
      numbers(next, y) = numbers(std::as_const(x), y) +
                         step * numbers(std::as_const(inverse), y) * residual(a, x, b, y);
      next.close(y);
    });
    std::swap(x, next);
  }

  Stencil a;
  GridField<float> inverse;  ///< of the centre
  Interpolation weights;     ///< to the next coarser level
  GridField<float> x;
  GridField<float> b;
  GridField<float> next;
};

/// Eigen's sparse Cholesky, in double.
struct Multigrid::Coarsest {
  using Matrix = Eigen::SparseMatrix<double>;

  explicit Coarsest(const Stencil& a) {
    Image<int> index(a.shape().numbers(), a.shape().rows, -1);
    for (int y = 0; y < a.shape().rows; ++y) {
      for (int i = 0; i < a.shape().numbers(); ++i) {
        if (!(a.center.row(y)[i] > 0.0F)) continue;
        index(i, y) = static_cast<int>(places.size());
        places.emplace_back(i, y);
      }
    }
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> sums(places.size(), 0.0);
    for (const Vec2i& place : places) add_row(a, index, place, entries, sums);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto center = static_cast<double>(a.center.row(places[k].y())[places[k].x()]);
      // Without a border of given heights a constant may be added to the solution. A little more
      // on the diagonal chooses one.
      const double given = center + sums[k] > 1e-5 * center ? center + sums[k] : 0.0;
      const int i = static_cast<int>(k);
      entries.emplace_back(i, i, given - sums[k] + 1e-7 * center);
    }
    if (places.empty()) return;
    const int n = static_cast<int>(places.size());
    Matrix matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    cholesky.compute(matrix);
    vector.resize(n);
  }
  void solve(const GridField<float>& b, GridField<float>& x) {
    if (places.empty()) return;
    Eigen::Index k = 0;
    for (const Vec2i& p : places) vector[k++] = static_cast<double>(b.row(p.y())[p.x()]);
    vector = cholesky.solve(vector).eval();
    k = 0;
    for (const Vec2i& p : places) x.row(p.y())[p.x()] = static_cast<float>(vector[k++]);
    for (int y = 0; y < x.shape().rows; ++y) x.close(y);
  }

  std::vector<Vec2i> places;  ///< number and row of each unknown
  Eigen::SimplicialLDLT<Matrix> cholesky;
  Eigen::VectorXd vector;

 private:
  static void add_row(const Stencil& a, const Image<int>& index, const Vec2i& place,
                      std::vector<Eigen::Triplet<double>>& entries, std::vector<double>& sums) {
    const int i = place.x();
    const int y = place.y();
    const auto couple = [&](float coefficient, int di, int dy) {
      if (coefficient == 0.0F) return;
      const int n = a.shape().numbers();
      const int other = index((i + di + n) % n, (y + dy) % a.shape().rows);
      const int self = index(i, y);
      if (other < 0) return;
      const auto value = static_cast<double>(coefficient);
      entries.emplace_back(std::max(self, other), std::min(self, other), value);
      sums[static_cast<std::size_t>(self)] += value;
      sums[static_cast<std::size_t>(other)] += value;
    };
    couple(a.east.row(y)[i], 2, 0);
    couple(a.south_west.row(y)[i], -2, 1);
    couple(a.south.row(y)[i], 0, 1);
    couple(a.south_east.row(y)[i], 2, 1);
  }
};

Multigrid::Multigrid(Stencil finest) {
  levels_.emplace_back(std::move(finest));
  for (;;) {
    Level& fine = levels_.back();
    const GridShape& shape = fine.a.shape();
    if (std::min(shape.columns, shape.rows) < narrow || unknowns(fine.a) <= direct_limit) break;
    fine.weights = interpolation(fine.a);
    Stencil coarse = coarse_stencil(fine.a, fine.weights);
    levels_.emplace_back(std::move(coarse));
  }
  coarsest_ = std::make_unique<Coarsest>(levels_.back().a);
}

Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;
Multigrid& Multigrid::operator=(Multigrid&&) noexcept = default;

void Multigrid::cycle(std::size_t level) {
  Level& fine = levels_[level];
  if (level + 1 == levels_.size()) return coarsest_->solve(fine.b, fine.x);
  fine.start();
  fine.smooth(smoothing_steps[1]);
  for_each_row(fine.a.shape(), [&](int y) {
    numbers(fine.next, y) = residual(fine.a, fine.x, fine.b, y);
    fine.next.close(y);
  });
  Level& coarse = levels_[level + 1];
  for_each_row(coarse.a.shape(),
               [&](int y) { restrict_row(fine.weights, fine.next, y, coarse.b); });
  cycle(level + 1);
  for_each_row(fine.a.shape(), [&](int y) { add_interpolated(fine.weights, coarse.x, y, fine.x); });
  fine.smooth(smoothing_steps[1]);
  fine.smooth(smoothing_steps[0]);
}

const GridField<float>& Multigrid::solve(const GridField<double>& right) {
  Level& finest = levels_.front();
  for_each_row(finest.a.shape(), [&](int y) {
    std::transform(right.row(y), right.row(y) + finest.a.shape().numbers(), finest.b.row(y),
                   [](double value) { return static_cast<float>(value); });
  });
  cycle(0);
  return finest.x;
}

}  // namespace normalshop
