#include <algorithm>
#include <cmath>

#include "normalshop/surface/detail/atlas_chart.h"

namespace normalshop::unwrapping {

namespace {

/// Depths below this share of the model are rounding of positions.
constexpr double overlap_tolerance = 1e-7;

/// Whether a line along an edge of `p` has all of `q` on its outer side.
bool edge_separates(const FlatTriangle& p, const FlatTriangle& q, double tolerance) {
  for (int k = 0; k < 3; ++k) {
    const Vec2d& a = p.corner[k];
    const Vec2d along = p.corner[(k + 1) % 3] - a;
    const double depth = std::max({cross(along, q.corner[0] - a), cross(along, q.corner[1] - a),
                                   cross(along, q.corner[2] - a)});
    if (depth <= tolerance * along.norm()) return true;
  }
  return false;
}

struct FlatBox {
  Vec2d low;
  Vec2d high;
};

FlatBox box_of(const FlatTriangle& t) {
  return {t.corner[0].cwiseMin(t.corner[1]).cwiseMin(t.corner[2]),
          t.corner[0].cwiseMax(t.corner[1]).cwiseMax(t.corner[2])};
}

/// Boxes in the cells of a square grid.
class BoxGrid {
 public:
  explicit BoxGrid(std::span<const FlatTriangle> triangles) {
    boxes_.reserve(triangles.size());
    Vec2d high = Vec2d::Constant(-1e300);
    double sides = 0.0;
    for (const FlatTriangle& t : triangles) {
      boxes_.push_back(box_of(t));
      low_ = low_.cwiseMin(boxes_.back().low);
      high = high.cwiseMax(boxes_.back().high);
      sides += (boxes_.back().high - boxes_.back().low).maxCoeff();
    }
    const double most = std::ceil(std::sqrt(4.0 * static_cast<double>(boxes_.size()) + 16.0));
    const Vec2d extent = high - low_;
    cell_ = std::max(
        {1.2 * sides / static_cast<double>(boxes_.size()), extent.maxCoeff() / most, 1e-300});
    columns_ = static_cast<int>(extent.x() / cell_) + 1;
    rows_ = static_cast<int>(extent.y() / cell_) + 1;
    fill();
  }

  /// visit(i, j) for every two boxes that meet, once.
  template <class Visit>
  void for_each_pair(const Visit& visit) const {
    for (int cell = 0; cell < columns_ * rows_; ++cell) {
      const auto items = std::span(items_).subspan(
          start_[static_cast<std::size_t>(cell)],
          start_[static_cast<std::size_t>(cell) + 1] - start_[static_cast<std::size_t>(cell)]);
      for (std::size_t i = 0; i < items.size(); ++i) {
        for (std::size_t j = i + 1; j < items.size(); ++j) {
          if (meet_in(cell, items[i], items[j])) visit(items[i], items[j]);
        }
      }
    }
  }

 private:
  int column(double x) const { return static_cast<int>((x - low_.x()) / cell_); }
  int row(double y) const { return static_cast<int>((y - low_.y()) / cell_); }

  template <class Visit>
  void for_each_cell(const FlatBox& box, const Visit& visit) const {
    for (int y = row(box.low.y()); y <= row(box.high.y()); ++y) {
      for (int x = column(box.low.x()); x <= column(box.high.x()); ++x) {
        visit(static_cast<std::size_t>(y * columns_ + x));
      }
    }
  }

  void fill() {
    start_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (const FlatBox& box : boxes_) {
      for_each_cell(box, [&](std::size_t cell) { ++start_[cell + 1]; });
    }
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    items_.resize(start_.back());
    std::vector<std::uint32_t> cursor(start_);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      for_each_cell(boxes_[i], [&](std::size_t cell) {
        items_[cursor[cell]++] = static_cast<std::uint32_t>(i);
      });
    }
  }

  /// Pairs are counted in the cell of the lower corner of what their boxes share.
  bool meet_in(int cell, std::uint32_t i, std::uint32_t j) const {
    const Vec2d low = boxes_[i].low.cwiseMax(boxes_[j].low);
    const Vec2d high = boxes_[i].high.cwiseMin(boxes_[j].high);
    return low.x() <= high.x() && low.y() <= high.y() &&
           row(low.y()) * columns_ + column(low.x()) == cell;
  }

  std::vector<FlatBox> boxes_;
  Vec2d low_ = Vec2d::Constant(1e300);
  double cell_ = 1.0;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::uint32_t> start_;
  std::vector<std::uint32_t> items_;
};

}  // namespace

std::vector<NamePair> overlapping_pairs(std::span<const FlatTriangle> triangles, double tolerance) {
  std::vector<NamePair> pairs;
  if (triangles.size() < 2) return pairs;
  BoxGrid(triangles).for_each_pair([&](std::uint32_t i, std::uint32_t j) {
    const FlatTriangle& p = triangles[i];
    const FlatTriangle& q = triangles[j];
    if (edge_separates(p, q, tolerance) || edge_separates(q, p, tolerance)) return;
    pairs.emplace_back(std::min(p.name, q.name), std::max(p.name, q.name));
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<FlatTriangle> flatten(const Surface& surface, const AtlasChart& chart) {
  const ChartPlane plane(chart.direction);
  std::vector<FlatTriangle> flat;
  flat.reserve(chart.triangles.size());
  for (const std::uint32_t t : chart.triangles) {
    if (!surface.has_area(t)) continue;
    const Vec3d* p = surface.points.data() + std::size_t{3} * t;
    flat.push_back({{plane(p[0]), plane(p[1]), plane(p[2])}, t});
  }
  return flat;
}

std::vector<NamePair> overlaps_of(const Surface& surface, const AtlasChart& chart) {
  return overlapping_pairs(flatten(surface, chart), overlap_tolerance * surface.extent);
}

}  // namespace normalshop::unwrapping
