#include "normalshop/surface/detail/atlas_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/surface/detail/convex_hull.h"

namespace normalshop::unwrapping {

namespace {

/// Cells along the square's side.
constexpr int strip_width = 1024;
/// Of the square that shapes cover at the first try; about what they come to.
constexpr double first_fill = 0.68;
constexpr int most_first_tries = 60;
constexpr int no_limit = 1 << 20;

constexpr std::size_t turn_count = 12;
/// (cos, sin) of every 30 degrees.
const Vec2d& turn_by(std::size_t twelfths) {
  constexpr double s = 0.86602540378443864;
  static const std::array<Vec2d, turn_count> all{
      Vec2d{1.0, 0.0}, {s, 0.5},   {0.5, s},   {0.0, 1.0},  {-0.5, s}, {-s, 0.5},
      {-1.0, 0.0},     {-s, -0.5}, {-0.5, -s}, {0.0, -1.0}, {0.5, -s}, {s, -0.5}};
  return all[twelfths];
}

Vec2d combined(const Vec2d& a, const Vec2d& b) {
  return {a.x() * b.x() - a.y() * b.y(), a.y() * b.x() + a.x() * b.y()};
}

/// A shape's smallest box: how to turn it upright, its area and its longer side.
struct ShapeBox {
  Vec2d turn{1.0, 0.0};
  double area = 0.0;
  double longest = 0.0;
};

ShapeBox smallest_box(const PackShape& shape) {
  const std::vector<Vec2d> hull = convex_hull(shape.corners);
  ShapeBox best;
  best.area = 1e300;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = edge.norm();
    if (!(length > 0.0)) continue;
    const Vec2d along = edge / length;
    double left = 1e300;
    double right = -1e300;
    double height = 0.0;
    for (const Vec2d& p : hull) {
      const Vec2d from = p - hull[i];
      left = std::min(left, along.dot(from));
      right = std::max(right, along.dot(from));
      height = std::max(height, cross(along, from));
    }
    const double area = (right - left) * height;
    if (area < best.area) best = {{along.x(), -along.y()}, area, std::max(right - left, height)};
  }
  return best;
}

double shape_area(const PackShape& shape) {
  double twice = 0.0;
  for (std::size_t i = 0; i + 2 < shape.corners.size(); i += 3) {
    twice += cross(Vec2d(shape.corners[i + 1] - shape.corners[i]),
                   Vec2d(shape.corners[i + 2] - shape.corners[i]));
  }
  return 0.5 * std::abs(twice);
}

void sink(std::atomic<int>& limit, int top) {
  int now = limit;
  while (top < now && !limit.compare_exchange_weak(now, top)) {
  }
}

class Packer {
 public:
  Packer(std::span<const PackShape> shapes, double gutter)
      : shapes_(shapes),
        rim_(static_cast<int>(std::ceil(gutter * strip_width - 1e-9))),
        areas_(shapes.size()),
        boxes_(shapes.size()) {
    parallel_for(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        areas_[i] = shape_area(shapes[i]);
        boxes_[i] = smallest_box(shapes[i]);
      }
    });
    const auto longest = std::max_element(
        boxes_.begin(), boxes_.end(),
        [](const ShapeBox& a, const ShapeBox& b) { return a.longest < b.longest; });
    largest_scale_ = 1.42 * strip_width / longest->longest;
    // However small the shapes, each takes a cell and its share of the rims.
    const double least = (1.0 + rim_) * (1.0 + rim_) * static_cast<double>(shapes.size());
    const bool crowded = shapes.size() > 1 && least > 0.8 * strip_width * strip_width;
    if (crowded || rim_ >= strip_width) refuse();
  }

  Packing run() {
    Packing best = first_that_fits();
    // Many shapes fill the square better at once, and take longer.
    const int tries = std::clamp(2000 / static_cast<int>(shapes_.size()), 3, 12);
    double fit = room_;
    double step = 1.02;
    int failures = 0;
    for (int i = 0; i < tries; ++i) {
      const double scale = best.scale * std::max(step, fit);
      if (scale > largest_scale_ && fit <= step) break;
      Packing packing = pack_at(std::min(scale, largest_scale_), i % order_count, strip_width);
      if (room_ >= 1.0) {
        best = std::move(packing);
        fit = room_;
        failures = 0;
        continue;
      }
      fit = std::sqrt(fit);
      if (fit > step || ++failures < order_count) continue;
      if (step < 1.01) break;
      step = 1.008;
      failures = 0;
    }
    best.scale /= strip_width;
    return best;
  }

 private:
  static constexpr int order_count = 3;
  /// Shapes whose masks are made at a time.
  static constexpr std::size_t block = 16;

  Packing first_that_fits() {
    const double area = std::accumulate(areas_.begin(), areas_.end(), 0.0);
    double scale =
        std::min(std::sqrt(first_fill * strip_width * strip_width / area), largest_scale_);
    for (int i = 0; i < most_first_tries; ++i) {
      Packing packing = pack_at(scale, 0, no_limit);
      if (room_ >= 1.0) return packing;
      scale *= 0.995 * room_;
    }
    refuse();
  }

  [[noreturn]] void refuse() const {
    throw InvalidInput("unwrap: " + std::to_string(shapes_.size()) +
                       " charts do not fit with this gutter; give a smaller gutter or a larger "
                       "size");
  }

  /// Large shapes first; what is large is told in different ways, one of which packs best.
  std::vector<std::size_t> order_by(int way) const {
    const auto size = [&](std::size_t i) {
      return way == 0 ? boxes_[i].area * areas_[i] : way == 1 ? boxes_[i].area : areas_[i];
    };
    std::vector<std::size_t> order(shapes_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    return order;
  }

  using Masks = std::array<PackMask, turn_count>;

  /// All shapes into a strip that may be `most` cells high. Afterwards room_ tells by which factor
  /// they could be larger, or below 1 must be smaller, as far as the height says.
  Packing pack_at(double scale, int way, int most) {
    PackStrip strip(strip_width + rim_);
    Packing packing;
    packing.scale = scale;
    packing.places.resize(shapes_.size());
    const std::vector<std::size_t> order = order_by(way);
    for (std::size_t first = 0; first < order.size(); first += block) {
      const auto shapes = std::span(order).subspan(first, std::min(block, order.size() - first));
      const std::vector<Masks> masks = masks_of(shapes, scale);
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        if (place(masks[i], shapes[i], most + rim_, strip, packing)) continue;
        room_ = 0.8;
        return packing;
      }
    }
    room_ = std::sqrt(strip_width / static_cast<double>(std::max(1, strip.top() - rim_)));
    return packing;
  }

  std::vector<Masks> masks_of(std::span<const std::size_t> shapes, double scale) const {
    std::vector<Masks> masks(shapes.size());
    constexpr std::size_t half = turn_count / 2;
    parallel_for(shapes.size() * half, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t shape = shapes[i / half];
        const Vec2d turn = combined(boxes_[shape].turn, turn_by(i % half));
        PackMask& mask = masks[i / half][i % half];
        mask = make_mask(shapes_[shape], turn, scale, rim_);
        masks[i / half][i % half + half] = upside_down(mask);
      }
    });
    return masks;
  }

  /// Tries all turns; the first of those that reach lowest is taken.
  bool place(const Masks& masks, std::size_t shape, int most, PackStrip& strip,
             Packing& packing) const {
    std::array<PackStrip::Place, turn_count> places;
    std::atomic<int> limit{most};
    parallel_for(turn_count, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        places[i] = strip.find(masks[i], limit);
        if (places[i].found) sink(limit, places[i].y + masks[i].height);
      }
    });
    const auto top = [&](std::size_t i) { return places[i].y + masks[i].height; };
    std::size_t best = turn_count;
    for (std::size_t i = 0; i < turn_count; ++i) {
      if (places[i].found && (best == turn_count || top(i) < top(best))) best = i;
    }
    if (best == turn_count) return false;
    strip.put(masks[best], places[best]);
    PackPlace& found = packing.places[shape];
    found.turn = combined(boxes_[shape].turn, turn_by(best));
    // Rims reach beyond the square, half a gutter of each lies within.
    found.offset =
        (Vec2d(places[best].x, places[best].y) - masks[best].origin - Vec2d::Constant(0.5 * rim_)) /
        strip_width;
    return true;
  }

  std::span<const PackShape> shapes_;
  int rim_;
  std::vector<double> areas_;
  std::vector<ShapeBox> boxes_;
  double largest_scale_ = 0.0;  ///< at which the longest shape spans the square's diagonal
  double room_ = 1.0;
};

}  // namespace

Packing pack(std::span<const PackShape> shapes, double gutter) {
  return Packer(shapes, gutter).run();
}

}  // namespace normalshop::unwrapping
