#include <algorithm>
#include <cmath>
#include <limits>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/polyline_field.h"

// Which segments matter where, and where they have become others.
namespace normalshop {

namespace {

/// Around the pixels of a square, and half a pixel more.
Circle circle_around(const Rect& square) {
  return {Vec2f(0.5F * static_cast<float>(square.x0 + square.x1 - 1),
                0.5F * static_cast<float>(square.y0 + square.y1 - 1)),
          0.5F * static_cast<float>(square.width()) * std::sqrt(2.0F) + 0.5F};
}

/// The last multiple of a power of two that is not beyond x.
int aligned(int x, int power) { return x & ~(power - 1); }

}  // namespace

struct PolylineField::Task {
  const Rect& region;
  int grid;
  const Changes* changes;  ///< null: all counts
  const Write& write;
  SegmentOffsets offsets;
  SegmentOffsets gone;
  Level tile;
  Level block;
  Level small;
  Cell cell;
  FieldCell samples;
};

void PolylineField::render(const Rect& region, int grid, const Write& write) const {
  render(region, grid, nullptr, write);
}

void PolylineField::render_changes(const PolylineField& before, const Rect& region, int grid,
                                   const Write& write) const {
  const std::optional<Changes> changes = changes_from(before);
  render(region, grid, changes ? &*changes : nullptr, write);
}

/// None where they can be anywhere.
std::optional<PolylineField::Changes> PolylineField::changes_from(
    const PolylineField& before) const {
  Changes changes{before, {}, {}};
  for (std::size_t i = 0; i < std::max(shapes_.size(), before.shapes_.size()); ++i) {
    const Shape none;
    const Shape& now = i < shapes_.size() ? shapes_[i] : none;
    const Shape& then = i < before.shapes_.size() ? before.shapes_[i] : none;
    const std::uint32_t count = std::min(now.end - now.first, then.end - then.first);
    std::uint32_t same = 0;
    while (same < count && columns_.same(now.first + same, before.columns_, then.first + same)) {
      ++same;
    }
    const bool all = same == now.end - now.first && same == then.end - then.first;
    if (!all && (now.closed || then.closed)) return std::nullopt;
    // A segment's neighbours have a say in the places beside it.
    if (!all && same > 0) --same;
    if (i < shapes_.size()) changes.first.push_back(now.first + same);
    for (std::uint32_t k = then.first + same; k < then.end; ++k) changes.gone.push_back(k);
  }
  return changes;
}

void PolylineField::render(const Rect& region, int grid, const Changes* changes,
                           const Write& write) const {
  if (region.empty()) return;
  const int x0 = aligned(region.x0, tile_size);
  const int y0 = aligned(region.y0, tile_size);
  const int columns = (region.x1 - x0 + tile_size - 1) / tile_size;
  const int rows = (region.y1 - y0 + tile_size - 1) / tile_size;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  parallel_for(tiles, 1, [&](std::size_t a, std::size_t b) {
    Task task{region, grid, changes, write, {}, {}, {}, {}, {}, {}, {}};
    for (std::size_t i = a; i < b; ++i) {
      const int x = x0 + static_cast<int>(i) % columns * tile_size;
      const int y = y0 + static_cast<int>(i) / columns * tile_size;
      render_tile({x, y, x + tile_size, y + tile_size}, task);
    }
  });
}

/// body(square) for those of a larger square that meet the region.
template <class Body>
static void for_squares(const Rect& all, int side, const Rect& region, const Body& body) {
  for (int y = all.y0; y < all.y1; y += side) {
    for (int x = all.x0; x < all.x1; x += side) {
      const Rect square{x, y, x + side, y + side};
      if (!intersect(square, region).empty()) body(square);
    }
  }
}

void PolylineField::render_tile(const Rect& tile, Task& task) const {
  const Level all{near(tile), task.changes != nullptr ? task.changes->gone : List()};
  if (!narrow(all, tile, task, task.tile)) return;
  if (task.tile.segments.empty()) return render_far(tile, task);
  for_squares(tile, block_size, task.region, [&](const Rect& block) {
    if (!narrow(task.tile, block, task, task.block)) return;
    for_squares(block, cell_side, task.region, [&](const Rect& cell) { render_cell(cell, task); });
  });
}

/// No line comes near: one value for the whole tile.
void PolylineField::render_far(const Rect& tile, Task& task) const {
  pixels(tile.x0, tile.y0, {}, 1, task.samples);
  for (CellLanes<float>* lanes : {&task.samples.height, &task.samples.slope_x,
                                  &task.samples.slope_y, &task.samples.coverage}) {
    lanes->fill(lanes->front());
  }
  for_squares(tile, cell_side, task.region, [&](const Rect& cell) {
    task.write(intersect(cell, task.region), cell.x0, cell.y0, task.samples);
  });
}

void PolylineField::render_cell(const Rect& square, Task& task) const {
  if (!narrow(task.block, square, task, task.small)) return;
  std::swap(task.cell.segments, task.small.segments);
  look_at(task.cell);
  pixels(square.x0, square.y0, task.cell, task.grid, task.samples);
  task.write(intersect(square, task.region), square.x0, square.y0, task.samples);
}

/// What matters in a smaller square. False: nothing there has become another.
bool PolylineField::narrow(const Level& from, const Rect& square, Task& task, Level& to) const {
  prune(from.segments, square, task.offsets, to.segments);
  if (task.changes == nullptr) return true;
  prune_gone(from.gone, to.segments, square, task, to.gone);
  if (!to.gone.empty()) return true;
  return std::any_of(to.segments.begin(), to.segments.end(),
                     [&](std::uint32_t i) { return i >= task.changes->first[segments_[i].shape]; });
}

/// Those whose chunks may have the nearest segment of their shape anywhere in a square.
PolylineField::List PolylineField::near(const Rect& square) const {
  const auto [center, radius] = circle_around(square);
  List list;
  for (const Shape& shape : shapes_) {
    const auto distance = [&, c = center](const Chunk& chunk) { return (c - chunk.center).norm(); };
    float farthest = shape.largest_half_width + radius;
    for (const Chunk& chunk : shape.chunks) {
      farthest = std::min(farthest, distance(chunk) + chunk.radius + 2.0F * radius + 0.01F);
    }
    for (const Chunk& chunk : shape.chunks) {
      if (distance(chunk) - chunk.radius > farthest) continue;
      for (std::uint32_t i = chunk.first; i < chunk.end; ++i) list.push_back(i);
    }
  }
  return list;
}

/// Keeps, of each shape, what can be the nearest segment anywhere in the cell.
void PolylineField::prune(const List& segments, const Rect& cell, SegmentOffsets& offsets,
                          List& kept) const {
  kept.clear();
  const Circle circle = circle_around(cell);
  const std::span<const std::uint32_t> all(segments);
  for (std::size_t i = 0; i < all.size();) {
    const std::uint32_t shape = segments_[all[i]].shape;
    std::size_t end = i + 1;
    if (segments_[all.back()].shape == shape) {
      end = all.size();
    } else {
      while (segments_[all[end]].shape == shape) ++end;
    }
    nearest_segments(columns_, all.subspan(i, end - i), circle, shapes_[shape].largest_half_width,
                     offsets, kept);
    i = end;
  }
}

/// Keeps, of segments that are there no more, what may have been the nearest of their shape
/// anywhere in the square, given what is so now.
void PolylineField::prune_gone(const List& gone, const List& kept, const Rect& square, Task& task,
                               List& out) const {
  out.clear();
  if (gone.empty()) return;
  const PolylineField& before = task.changes->before;
  const auto [center, around] = circle_around(square);
  const float radius = around;  // clang 14 lets no lambda name a binding
  segment_offsets(columns_, kept, center, task.offsets);
  const auto farthest = [&](std::uint32_t shape) {
    float least = before.shapes_[shape].largest_half_width + radius;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (segments_[kept[i]].shape != shape) continue;
      least = std::min(least, std::sqrt(task.offsets.squared[i]) + 2.0F * radius + 0.01F);
    }
    return least;
  };
  segment_offsets(before.columns_, gone, center, task.gone);
  std::uint32_t shape = 0;
  float far = -1.0F;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    const std::uint32_t of = before.segments_[gone[i]].shape;
    if (far < 0.0F || of != shape) far = farthest(of);
    shape = of;
    if (task.gone.squared[i] <= far * far) out.push_back(gone[i]);
  }
}

}  // namespace normalshop
