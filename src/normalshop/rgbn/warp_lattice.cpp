#include "normalshop/rgbn/warp_lattice.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr double most_nodes = 0x1p25;

int cells_of(int pixels, float spacing) {
  return std::max(1, static_cast<int>(std::ceil(static_cast<float>(pixels) / spacing)));
}

int wrapped(int i, int count) { return ((i % count) + count) % count; }

Vec2d mix(const std::array<double, 4>& weights, const Vec2d& a, const Vec2d& a_derivative,
          const Vec2d& b, const Vec2d& b_derivative) {
  return weights[0] * a + weights[1] * a_derivative + weights[2] * b + weights[3] * b_derivative;
}

}  // namespace

/// A place along one axis: its cell, and the weights of value and derivative at both of its ends.
struct WarpLattice::Axis {
  int low = 0;
  int high = 0;
  std::array<double, 4> value{};
  std::array<double, 4> slope{};
};

/// What a column of nodes gives at one y: offset and its derivatives.
struct WarpLattice::Column {
  Vec2d offset;
  Vec2d dx;
  Vec2d dy;
  Vec2d dxdy;
};

WarpLattice::WarpLattice(Rect area, float spacing, LatticeEdge edge) : area_(area), edge_(edge) {
  if (area.empty()) throw InvalidInput("warp lattice: the area must hold a pixel");
  if (!(spacing >= 1.0F) || !std::isfinite(spacing)) {
    throw InvalidInput("warp lattice: spacing must be a number of at least 1");
  }
  const int across = cells_of(area.width(), spacing);
  const int down = cells_of(area.height(), spacing);
  spacing_ = {static_cast<double>(area.width()) / across,
              static_cast<double>(area.height()) / down};
  columns_ = edge == LatticeEdge::Repeat ? across : across + 1;
  rows_ = edge == LatticeEdge::Repeat ? down : down + 1;
  if (static_cast<double>(columns_) * rows_ > most_nodes) {
    throw InvalidInput("warp lattice: too many nodes; take a larger spacing");
  }
  nodes_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

std::size_t WarpLattice::index(int column, int row) const {
  if (edge_ == LatticeEdge::Repeat) {
    column = wrapped(column, columns_);
    row = wrapped(row, rows_);
  }
  assert(column >= 0 && column < columns_ && row >= 0 && row < rows_);
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
         static_cast<std::size_t>(column);
}

Vec2d WarpLattice::place(int column, int row) const {
  return {area_.x0 + column * spacing_.x(), area_.y0 + row * spacing_.y()};
}

Rect WarpLattice::clip(Rect nodes) const {
  if (edge_ == LatticeEdge::Continue) return intersect(nodes, all_nodes());
  nodes.x1 = std::min(nodes.x1, nodes.x0 + columns_);
  nodes.y1 = std::min(nodes.y1, nodes.y0 + rows_);
  return nodes;
}

Rect WarpLattice::nodes_near(const Vec2d& center, double distance) const {
  const Vec2d reach = Vec2d::Constant(distance);
  const Vec2d origin(area_.x0, area_.y0);
  const Vec2d low = (center - reach - origin).cwiseQuotient(spacing_).cwiseMax(-1e8);
  const Vec2d high = (center + reach - origin).cwiseQuotient(spacing_).cwiseMin(1e8);
  return clip({static_cast<int>(std::ceil(std::min(low.x(), 1e8))),
               static_cast<int>(std::ceil(std::min(low.y(), 1e8))),
               static_cast<int>(std::floor(std::max(high.x(), -1e8))) + 1,
               static_cast<int>(std::floor(std::max(high.y(), -1e8))) + 1});
}

Rect WarpLattice::pixels_of(const Rect& nodes) const {
  if (nodes.empty()) return {};
  const Rect around = grow(nodes, 2);  // mixed derivatives of the neighbours, and their cells
  const Vec2d low = place(around.x0, around.y0);
  const Vec2d high = place(around.x1 - 1, around.y1 - 1);
  const Rect pixels = {static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())),
                       static_cast<int>(std::ceil(high.x())) + 1,
                       static_cast<int>(std::ceil(high.y())) + 1};
  Rect inside = intersect(pixels, area_);
  if (edge_ == LatticeEdge::Continue) return inside;
  // What crosses the seam comes in on the other side.
  if (inside.width() < pixels.width()) inside = {area_.x0, inside.y0, area_.x1, inside.y1};
  if (inside.height() < pixels.height()) inside = {inside.x0, area_.y0, inside.x1, area_.y1};
  return inside;
}

WarpLattice::Axis WarpLattice::locate(double at, int axis) const {
  const int nodes = axis == 0 ? columns_ : rows_;
  const double width = spacing_[axis];
  const double position = (at - (axis == 0 ? area_.x0 : area_.y0)) / width;
  Axis result;
  double t = 0.0;
  bool outside = false;
  if (edge_ == LatticeEdge::Repeat) {
    const double cell = std::floor(position);
    result.low = wrapped(static_cast<int>(std::clamp(cell, -1e9, 1e9)), nodes);
    result.high = result.low + 1 == nodes ? 0 : result.low + 1;
    t = position - cell;
  } else {
    const double inside = std::clamp(position, 0.0, static_cast<double>(nodes - 1));
    result.low = std::min(static_cast<int>(inside), nodes - 2);
    result.high = result.low + 1;
    t = inside - result.low;
    outside = position != inside;
  }
  const double s = 1.0 - t;
  result.value = {s * s * (1.0 + 2.0 * t), width * t * s * s, t * t * (1.0 + 2.0 * s),
                  -width * t * t * s};
  if (!outside) {
    result.slope = {-6.0 * t * s / width, s * (1.0 - 3.0 * t), 6.0 * t * s / width,
                    t * (1.0 - 3.0 * s)};
  }
  return result;
}

WarpLattice::Column WarpLattice::column_at(int column, const Axis& y) const {
  const Node& a = node(column, y.low);
  const Node& b = node(column, y.high);
  return {mix(y.value, a.offset, a.dy, b.offset, b.dy), mix(y.value, a.dx, a.dxdy, b.dx, b.dxdy),
          mix(y.slope, a.offset, a.dy, b.offset, b.dy), mix(y.slope, a.dx, a.dxdy, b.dx, b.dxdy)};
}

WarpPoint WarpLattice::point_at(const Vec2d& position, const Axis& x, const Column& left,
                                const Column& right) {
  WarpPoint point;
  point.position = position + mix(x.value, left.offset, left.dx, right.offset, right.dx);
  point.jacobian.col(0) =
      Vec2d::UnitX() + mix(x.slope, left.offset, left.dx, right.offset, right.dx);
  point.jacobian.col(1) = Vec2d::UnitY() + mix(x.value, left.dy, left.dxdy, right.dy, right.dxdy);
  return point;
}

WarpPoint WarpLattice::at(const Vec2d& position) const {
  const Axis x = locate(position.x(), 0);
  const Axis y = locate(position.y(), 1);
  return point_at(position, x, column_at(x.low, y), column_at(x.high, y));
}

void WarpLattice::points(int x0, int y, std::span<WarpPoint> run) const {
  const Axis row = locate(y, 1);
  int held = -1;
  Column left;
  Column right;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const int pixel = x0 + static_cast<int>(i);
    const Axis x = locate(pixel, 0);
    if (x.low != held) {
      left = column_at(x.low, row);
      right = column_at(x.high, row);
      held = x.low;
    }
    run[i] = point_at(Vec2d(pixel, y), x, left, right);
  }
}

Vec2d WarpLattice::mixed_derivative(int column, int row) const {
  const Node& here = node(column, row);
  if (here.offset.isZero(0.0) && here.dx.isZero(0.0) && here.dy.isZero(0.0)) return Vec2d::Zero();
  const bool repeats = edge_ == LatticeEdge::Repeat;
  const int left = repeats ? column - 1 : std::max(column - 1, 0);
  const int right = repeats ? column + 1 : std::min(column + 1, columns_ - 1);
  const int up = repeats ? row - 1 : std::max(row - 1, 0);
  const int down = repeats ? row + 1 : std::min(row + 1, rows_ - 1);
  const double width = (right - left) * spacing_.x();
  const double height = (down - up) * spacing_.y();
  // Differences Dx, Dy of the derivatives: dx Dy + dy Dx - Dx Dy, whose errors of second order
  // cancel.
  const Vec2d dx_along_y = (node(column, down).dx - node(column, up).dx) / height;
  const Vec2d dy_along_x = (node(right, row).dy - node(left, row).dy) / width;
  const Vec2d corners = node(right, down).offset - node(left, down).offset -
                        node(right, up).offset + node(left, up).offset;
  return dx_along_y + dy_along_x - corners / (width * height);
}

void WarpLattice::edit(const Rect& wanted, const std::function<Node(int, int)>& make) {
  const Rect nodes = clip(wanted);
  if (nodes.empty()) return;
  const auto width = static_cast<std::size_t>(nodes.width());
  std::vector<Node> made(width * static_cast<std::size_t>(nodes.height()));
  parallel_for(static_cast<std::size_t>(nodes.height()), 4, [&](std::size_t a, std::size_t b) {
    for (std::size_t j = a; j < b; ++j) {
      for (std::size_t i = 0; i < width; ++i) {
        made[j * width + i] = make(nodes.x0 + static_cast<int>(i), nodes.y0 + static_cast<int>(j));
      }
    }
  });
  for (std::size_t k = 0; k < made.size(); ++k) {
    const auto column = nodes.x0 + static_cast<int>(k % width);
    nodes_[index(column, nodes.y0 + static_cast<int>(k / width))] = made[k];
  }
  const Rect around = clip(grow(nodes, 1));
  for (int row = around.y0; row < around.y1; ++row) {
    for (int column = around.x0; column < around.x1; ++column) {
      nodes_[index(column, row)].dxdy = mixed_derivative(column, row);
    }
  }
}

namespace {

/// The node of lattice o inner. Where `inner` stays, so does the node, bit for bit.
WarpLattice::Node composed(const WarpLattice& lattice, int column, int row,
                           const WarpPoint& first) {
  const Vec2d here = lattice.place(column, row);
  if (first.position == here && first.jacobian == Eigen::Matrix2d::Identity()) {
    return lattice.node(column, row);
  }
  const WarpPoint then = lattice.at(first.position);
  const Eigen::Matrix2d jacobian = then.jacobian * first.jacobian;
  WarpLattice::Node node;
  node.offset = then.position - here;
  node.dx = jacobian.col(0) - Vec2d::UnitX();
  node.dy = jacobian.col(1) - Vec2d::UnitY();
  return node;
}

}  // namespace

WarpMap map_of(const WarpLattice& lattice) {
  return [&lattice](int x0, int y, std::span<WarpPoint> run) { lattice.points(x0, y, run); };
}

void compose(WarpLattice& lattice, const Rect& nodes,
             const std::function<WarpPoint(const Vec2d&)>& inner) {
  lattice.edit(nodes, [&](int column, int row) {
    return composed(lattice, column, row, inner(lattice.place(column, row)));
  });
}

void compose(WarpLattice& lattice, const WarpLattice& inner) {
  assert(lattice.area() == inner.area() && lattice.all_nodes() == inner.all_nodes());
  lattice.edit(lattice.all_nodes(), [&](int column, int row) {
    const WarpLattice::Node& n = inner.node(column, row);
    WarpPoint first;
    first.position = lattice.place(column, row) + n.offset;
    first.jacobian << Vec2d::UnitX() + n.dx, Vec2d::UnitY() + n.dy;
    return composed(lattice, column, row, first);
  });
}

}  // namespace normalshop
