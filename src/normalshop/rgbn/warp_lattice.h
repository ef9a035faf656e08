#pragma once

#include <functional>
#include <vector>

#include "normalshop/rgbn/warp.h"

namespace normalshop {

/// What a lattice's map is outside its area.
enum class LatticeEdge {
  Continue,  ///< the border moves on as it is
  Repeat,    ///< W repeats with the area, so that what tiles keeps tiling
};

/// A warp that can be edited: W minus the identity with its derivatives at the nodes of a coarse
/// lattice, bicubic Hermite between them (algorithms 3.2). W is continuously differentiable, and
/// the Jacobian that it hands out is exactly the derivative of the position that it hands out, so
/// warped slopes keep free of curl. Positions in pixels, y down.
class WarpLattice {
 public:
  /// W - identity and its derivatives per pixel. A node where the first three vanish has no mixed
  /// derivative either: cells between nodes that stay are exactly the identity.
  struct Node {
    Vec2d offset = Vec2d::Zero();
    Vec2d dx = Vec2d::Zero();
    Vec2d dy = Vec2d::Zero();
    Vec2d dxdy = Vec2d::Zero();
  };

  /// The identity, with nodes at most `spacing` pixels apart, so that cells fill the area (pixel
  /// (x0, y0) is on a node). Throws InvalidInput for an empty area, a spacing that is not a number
  /// of at least 1, and more than 2^25 nodes.
  explicit WarpLattice(Rect area, float spacing = 4.0F, LatticeEdge edge = LatticeEdge::Continue);

  Rect area() const { return area_; }
  LatticeEdge edge() const { return edge_; }
  const Vec2d& spacing() const { return spacing_; }
  /// One node more than cells an axis, or as many when it repeats.
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const Node& node(int column, int row) const { return nodes_[index(column, row)]; }
  /// Columns and rows outside the lattice count on.
  Vec2d place(int column, int row) const;
  /// The nodes within `distance` of a place; of a lattice that repeats they may lie outside.
  Rect nodes_near(const Vec2d& center, double distance) const;
  Rect all_nodes() const { return {0, 0, columns_, rows_}; }
  /// The pixels of the area that these nodes may change.
  Rect pixels_of(const Rect& nodes) const;

  WarpPoint at(const Vec2d& position) const;
  /// The same for the pixels (x0, y), (x0 + 1, y), ...
  void points(int x0, int y, std::span<WarpPoint> run) const;

  /// Replaces nodes by make(column, row), called by several threads at once and before anything
  /// changes. Mixed derivatives are made here, from the nodes around (fourth order).
  void edit(const Rect& nodes, const std::function<Node(int, int)>& make);

 private:
  struct Axis;
  struct Column;
  Axis locate(double at, int axis) const;
  Column column_at(int column, const Axis& y) const;
  static WarpPoint point_at(const Vec2d& position, const Axis& x, const Column& left,
                            const Column& right);
  Rect clip(Rect nodes) const;
  Vec2d mixed_derivative(int column, int row) const;
  std::size_t index(int column, int row) const;

  Rect area_;
  LatticeEdge edge_;
  Vec2d spacing_;
  int columns_;
  int rows_;
  std::vector<Node> nodes_;
};

/// The lattice as a map. It refers to the lattice, which must outlive it.
WarpMap map_of(const WarpLattice& lattice);

/// lattice := lattice o inner at these nodes: what `inner` maps on, the lattice maps further.
/// Elsewhere `inner` must be the identity. `inner` is called by several threads at once.
void compose(WarpLattice& lattice, const Rect& nodes,
             const std::function<WarpPoint(const Vec2d&)>& inner);
/// The same for two lattices with the same nodes.
void compose(WarpLattice& lattice, const WarpLattice& inner);

/// Where the warp comes closest to folding over.
struct LeastArea {
  double determinant = 1.0;  ///< of DW: 0 or less is a fold
  Vec2d place = Vec2d::Zero();
};

/// The smallest det DW between these nodes, certain within 1e-4 (minus infinity where W is no
/// number): bounds of the Bernstein coefficients of det DW in every cell, cut up where they leave
/// it open.
LeastArea least_area(const WarpLattice& lattice, const Rect& nodes);
LeastArea least_area(const WarpLattice& lattice);

}  // namespace normalshop
