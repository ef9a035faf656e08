// The least det DW of a lattice. Between nodes W is a bicubic polynomial, so det DW has degree 5 in
// x and in y; no value lies below its least Bernstein coefficient, and the corner coefficients are
// values.
#include <algorithm>
#include <limits>
#include <vector>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/warp_lattice.h"

namespace normalshop {

namespace {

constexpr double certainty = 1e-4;
constexpr int most_cuts = 12;

/// Bernstein coefficients of degree P in x (columns) and Q in y (rows).
template <int P, int Q>
using Bernstein = Eigen::Array<double, Q + 1, P + 1>;

constexpr double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

/// One coordinate of W - identity in a cell.
Bernstein<3, 3> coefficients(const WarpLattice& lattice, int column, int row, int axis) {
  Bernstein<3, 3> c;
  const Vec2d third = lattice.spacing() / 3.0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const WarpLattice::Node& n = lattice.node(column + i, row + j);
      const double x = i == 0 ? third.x() : -third.x();
      const double y = j == 0 ? third.y() : -third.y();
      const int edge_x = 3 * i;
      const int edge_y = 3 * j;
      const int inner_x = 1 + i;
      const int inner_y = 1 + j;
      c(edge_y, edge_x) = n.offset[axis];
      c(edge_y, inner_x) = n.offset[axis] + x * n.dx[axis];
      c(inner_y, edge_x) = n.offset[axis] + y * n.dy[axis];
      c(inner_y, inner_x) = n.offset[axis] + x * n.dx[axis] + y * n.dy[axis] + x * y * n.dxdy[axis];
    }
  }
  return c;
}

Bernstein<2, 3> by_x(const Bernstein<3, 3>& c, double width) {
  return (c.rightCols<3>() - c.leftCols<3>()) * (3.0 / width);
}

Bernstein<3, 2> by_y(const Bernstein<3, 3>& c, double height) {
  return (c.bottomRows<3>() - c.topRows<3>()) * (3.0 / height);
}

Bernstein<5, 5> product(const Bernstein<2, 3>& a, const Bernstein<3, 2>& b) {
  Bernstein<5, 5> sum = Bernstein<5, 5>::Zero();
  for (int j = 0; j <= 3; ++j) {
    for (int i = 0; i <= 2; ++i) {
      const double scaled = a(j, i) * binomial(2, i) * binomial(3, j);
      for (int l = 0; l <= 2; ++l) {
        for (int k = 0; k <= 3; ++k) {
          sum(j + l, i + k) += scaled * (b(l, k) * binomial(3, k) * binomial(2, l));
        }
      }
    }
  }
  for (int j = 0; j <= 5; ++j) {
    for (int i = 0; i <= 5; ++i) sum(j, i) /= binomial(5, i) * binomial(5, j);
  }
  return sum;
}

using Determinant = Bernstein<5, 5>;

Determinant determinant(const WarpLattice& lattice, int column, int row) {
  const Vec2d& h = lattice.spacing();
  const Bernstein<3, 3> u = coefficients(lattice, column, row, 0);
  const Bernstein<3, 3> v = coefficients(lattice, column, row, 1);
  return product(by_x(u, h.x()) + 1.0, by_y(v, h.y()) + 1.0) -
         product(by_x(v, h.x()), by_y(u, h.y()));
}

/// The first or the second half of the rows' range, by de Casteljau.
Determinant half_of_rows(Determinant c, int half) {
  Determinant first;
  for (int level = 0; level <= 5; ++level) {
    first.row(level) = c.row(0);
    for (int k = 0; k < 5 - level; ++k) c.row(k) = 0.5 * (c.row(k) + c.row(k + 1));
  }
  // What is left are the coefficients of the second half.
  return half == 0 ? first : c;
}

Determinant quarter(const Determinant& c, int i, int j) {
  const Determinant rows = half_of_rows(c, j);
  return half_of_rows(rows.transpose(), i).transpose();
}

/// A part of a cell, in pixels.
struct Part {
  Vec2d corner;
  Vec2d size;
};

void search(const Determinant& c, const Part& part, int cuts, LeastArea& best) {
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      if (!(c(5 * j, 5 * i) < best.determinant)) continue;
      best = {c(5 * j, 5 * i), part.corner + part.size.cwiseProduct(Vec2d(i, j))};
    }
  }
  if (c.minCoeff() >= best.determinant - certainty || cuts == 0) return;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const Vec2d size = 0.5 * part.size;
      search(quarter(c, i, j), {part.corner + size.cwiseProduct(Vec2d(i, j)), size}, cuts - 1,
             best);
    }
  }
}

bool stays(const WarpLattice::Node& n) {
  return n.offset.isZero(0.0) && n.dx.isZero(0.0) && n.dy.isZero(0.0) && n.dxdy.isZero(0.0);
}

bool stays(const WarpLattice& lattice, int column, int row) {
  return stays(lattice.node(column, row)) && stays(lattice.node(column + 1, row)) &&
         stays(lattice.node(column, row + 1)) && stays(lattice.node(column + 1, row + 1));
}

}  // namespace

LeastArea least_area(const WarpLattice& lattice, const Rect& nodes) {
  Rect cells = {nodes.x0, nodes.y0, nodes.x1 - 1, nodes.y1 - 1};
  if (lattice.edge() == LatticeEdge::Continue) {
    cells = intersect(cells, {0, 0, lattice.columns() - 1, lattice.rows() - 1});
  }
  if (cells.empty()) return {};
  // Every row by itself, so that the answer does not depend on the threads.
  std::vector<LeastArea> rows(static_cast<std::size_t>(cells.height()));
  parallel_for(rows.size(), 4, [&](std::size_t a, std::size_t b) {
    for (std::size_t j = a; j < b; ++j) {
      const int row = cells.y0 + static_cast<int>(j);
      LeastArea best{1e300, lattice.place(cells.x0, row)};
      for (int column = cells.x0; column < cells.x1; ++column) {
        const Vec2d corner = lattice.place(column, row);
        if (!stays(lattice, column, row)) {
          const Determinant c = determinant(lattice, column, row);
          if (c.allFinite()) {
            search(c, {corner, lattice.spacing()}, most_cuts, best);
          } else {
            best = {-std::numeric_limits<double>::infinity(), corner};
          }
        } else if (best.determinant > 1.0) {
          best = {1.0, corner};
        }
      }
      rows[j] = best;
    }
  });
  return *std::min_element(rows.begin(), rows.end(), [](const LeastArea& a, const LeastArea& b) {
    return a.determinant < b.determinant;
  });
}

LeastArea least_area(const WarpLattice& lattice) {
  const int extra = lattice.edge() == LatticeEdge::Repeat ? 1 : 0;
  return least_area(lattice, {0, 0, lattice.columns() + extra, lattice.rows() + extra});
}

}  // namespace normalshop
