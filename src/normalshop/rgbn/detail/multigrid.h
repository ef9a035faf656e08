#pragma once

#include <array>
#include <memory>
#include <vector>

#include "normalshop/rgbn/detail/grid_field.h"

/// Approximate inverse of sparse symmetric systems on a grid, private to this floor.
namespace normalshop {

/// A symmetric, positive semi-definite system of nine-point stencils: coefficients of a node with
/// itself and with its neighbours to the east, south (next row), south-east and south-west. A node
/// without unknown has 0 everywhere. Rows are closed.
struct Stencil {
  explicit Stencil(const GridShape& shape)
      : center(shape), east(shape), south(shape), south_east(shape), south_west(shape) {}

  const GridShape& shape() const { return center.shape(); }
  void close(int y) {
    for (GridField<float>* f : {&center, &east, &south, &south_east, &south_west}) f->close(y);
  }

  GridField<float> center;
  GridField<float> east;
  GridField<float> south;
  GridField<float> south_east;
  GridField<float> south_west;
};

/// How the nodes of a grid follow from those of the next coarser one, which has every second row
/// and column: weights of the coarse nodes (x / 2, y / 2), one to the right, one below, and both.
/// Rows are closed on the left; ghosts on the right are 0.
using Interpolation = std::array<GridField<float>, 4>;

/// The grid of every second node.
GridShape coarser(const GridShape& shape);
/// Operator-dependent interpolation (Alcouffe et al. 1981, Dendy 1982): a node follows those
/// neighbours that it is coupled with, so that it never mixes both sides of a gap.
Interpolation interpolation(const Stencil& stencil);
/// The Galerkin product: interpolation^T * stencil * interpolation.
Stencil coarse_stencil(const Stencil& stencil, const Interpolation& weights);

/// Symmetric V-cycle: a preconditioner. Smoothing is two Jacobi steps of Chebyshev's lengths, the
/// coarsest grid is solved directly.
class Multigrid {
 public:
  explicit Multigrid(Stencil finest);
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// About the inverse times `right`, closed. The result lives until the next call.
  const GridField<float>& solve(const GridField<double>& right);

 private:
  struct Level;
  struct Coarsest;

  void cycle(std::size_t level);

  std::vector<Level> levels_;
  std::unique_ptr<Coarsest> coarsest_;
};

}  // namespace normalshop
