#include "normalshop/chart/splat_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "normalshop/chart/splat.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

constexpr int splat_tile = 64;
constexpr float inner_cell = 0.6F;  // texels from the middle
constexpr float ring = 1.0F;
constexpr float border_ring = 2.0F;
constexpr float nothing_near = -std::numeric_limits<float>::infinity();

/// Which eighth of a turn an offset lies in; `eighth ^ 6` is the opposite one.
unsigned eighth(float dx, float dy) {
  const unsigned right = dx > 0.0F ? 4U : 0U;
  const unsigned below = dy > 0.0F ? 2U : 0U;
  return right | below | (std::abs(dx) > std::abs(dy) ? 1U : 0U);
}

bool outside_cell(const Splat& splat, float dx, float dy) {
  return (splat.to_texel * Vec2f(dx, dy)).cwiseAbs().maxCoeff() > inner_cell;
}

bool has_opposites(unsigned eighths) {
  for (unsigned i = 0; i < 8; ++i) {
    if ((eighths >> i & 1U) != 0 && (eighths >> (i ^ 6U) & 1U) != 0) return true;
  }
  return false;
}

/// Draws all splats that reach a tile of the chart.
class TileCover {
 public:
  TileCover(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
            const Image<PointOffset>& offsets)
      : mesh_(mesh),
        storage_(storage),
        chart_(chart),
        offsets_(offsets),
        splats_(mesh, storage, chart.grid),
        triangles_(mesh, chart.grid) {}

  /// The largest reach of the points in a rectangle.
  int reach(const Rect& rect);
  void begin(const Rect& tile) {
    tile_ = tile;
    front_.fill(nothing_near);
    sides_.fill(0);
    inner_.fill(false);
  }
  void draw(const Rect& points);
  void finish(Image<Shown>& shown) const;
  /// True, and shown is filled, where the tile has a point in every pixel, of which their direct
  /// neighbours hide none: for splats that reach no further.
  bool finish_plain(const Rect& tile, Image<Shown>& shown);

 private:
  /// Depth steps of the planes of a row's points.
  struct StepRow {
    std::array<float, splat_tile + 2> right;
    std::array<float, splat_tile + 2> down;
  };

  void draw_point(int x, int y, const Splat& splat);
  bool on_surface(int x, int y, int other_x, int other_y);
  bool load_steps(const Rect& wide, int y);
  float rise_over(const Rect& tile, int y) const;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((y - tile_.y0) * splat_tile + x - tile_.x0);
  }

  const Mesh& mesh_;
  const StorageAtlas& storage_;
  const EditingChart& chart_;
  const Image<PointOffset>& offsets_;
  SplatCache splats_;
  TriangleCache<ChartTriangle> triangles_;
  std::array<StepRow, 3> steps_;  // of a row and those beside it
  Rect tile_;
  std::array<float, splat_tile * splat_tile> front_;         // depth of what the splats show
  std::array<std::uint8_t, splat_tile * splat_tile> sides_;  // eighths from which rings cover
  std::array<bool, splat_tile * splat_tile> inner_;          // covered by a splat's middle
};

int TileCover::reach(const Rect& rect) {
  float most = 0.0F;
  for (int y = rect.y0; y < rect.y1; ++y) {
    const std::uint32_t* ids = chart_.ids.triangle.row(y);
    const PointOffset* offsets = offsets_.row(y);
    std::uint32_t last = no_triangle;
    for (int x = rect.x0; x < rect.x1; ++x) {
      if (ids[x] == no_triangle || (ids[x] == last && !offsets[x].at_border)) continue;
      last = ids[x];
      const float wide = offsets[x].at_border ? border_ring : ring;
      most = std::max(most, wide * splats_.get(last).reach.maxCoeff());
    }
  }
  return floor_to_int(most + 0.5F);  // points lie up to half a pixel off their pixels' centres
}

/// Does a triangle show at a pixel's centre, if nothing hides it?
bool holds(const ChartTriangle& triangle, float x, float y) {
  const Vec3f& e = triangle.points.col(1);
  const Vec3f& f = triangle.points.col(2);
  const float dx = x - triangle.points(0, 0);
  const float dy = y - triangle.points(1, 0);
  const float area = e.x() * f.y() - e.y() * f.x();
  const float b1 = (dx * f.y() - dy * f.x()) / area;
  const float b2 = (e.x() * dy - e.y() * dx) / area;
  constexpr float least = -1e-4F;
  return b1 >= least && b2 >= least && b1 + b2 <= 1.0F - least;
}

/// Does one of the triangles around the texel of a pixel's point show at another pixel?
bool TileCover::on_surface(int x, int y, int other_x, int other_y) {
  const TexelMap& map = storage_.sets[mesh_.texture_sets[chart_.ids.triangle(x, y)]].texels;
  const TexelPlace at = texel_place(chart_.texel(x, y), map.width());
  const Rect around = intersect({at.x - 1, at.y - 1, at.x + 2, at.y + 2}, map.owner().rect());
  std::uint32_t last = no_triangle;
  for (int j = around.y0; j < around.y1; ++j) {
    for (int i = around.x0; i < around.x1; ++i) {
      const std::uint32_t owner = map.owner()(i, j);
      if (owner == last || owner == no_triangle) continue;
      last = owner;
      if (holds(triangles_.get(owner), static_cast<float>(other_x), static_cast<float>(other_y))) {
        return true;
      }
    }
  }
  return false;
}

void TileCover::draw_point(int x, int y, const Splat& splat) {
  const float right = PointOffset::unit * offsets_(x, y).x;  // of the splat's middle
  const float down = PointOffset::unit * offsets_(x, y).y;
  const bool at_border = offsets_(x, y).at_border;
  const float widest = at_border ? border_ring : ring;
  const Vec2f reach = widest * splat.reach;
  Rect box{x - floor_to_int(reach.x() - right), y - floor_to_int(reach.y() - down),
           x + floor_to_int(reach.x() + right) + 1, y + floor_to_int(reach.y() + down) + 1};
  box = intersect(box, tile_);
  const float depth = chart_.ids.depth(x, y);
  const Mat2f& wide = splat.to_wide;
  for (int j = box.y0; j < box.y1; ++j) {
    const auto dy = static_cast<float>(j - y);
    const float oy = dy - down;
    const float wide_x = wide(0, 1) * oy;
    const float wide_y = wide(1, 1) * oy;
    const float row_depth = depth + dy * splat.depth_step.y();
    std::size_t k = index(box.x0, j);
    for (int i = box.x0; i < box.x1; ++i, ++k) {
      const auto dx = static_cast<float>(i - x);
      const float ox = dx - right;
      const float from_middle =
          std::max(std::abs(wide(0, 0) * ox + wide_x), std::abs(wide(1, 0) * ox + wide_y));
      if (from_middle > widest) continue;
      float z = row_depth + dx * splat.depth_step.x();
      if (from_middle > inner_cell) {
        z -= widest * splat.ring_back;
        if (at_border && !inner_[k]) inner_[k] = on_surface(x, y, i, j);
        if (from_middle <= ring) {
          sides_[k] = static_cast<std::uint8_t>(sides_[k] | 1U << eighth(ox, oy));
        }
      } else {
        inner_[k] = true;
        if (splat.widened && outside_cell(splat, ox, oy)) z -= splat.wide_back;
      }
      front_[k] = std::max(front_[k], z);
    }
  }
}

void TileCover::draw(const Rect& points) {
  for (int y = points.y0; y < points.y1; ++y) {
    const std::uint32_t* ids = chart_.ids.triangle.row(y);
    for (int x = points.x0; x < points.x1; ++x) {
      if (ids[x] != no_triangle) draw_point(x, y, splats_.get(ids[x]));
    }
  }
}

void TileCover::finish(Image<Shown>& shown) const {
  const float behind = chart_.grid.pixel;
  for (int y = tile_.y0; y < tile_.y1; ++y) {
    for (int x = tile_.x0; x < tile_.x1; ++x) {
      const std::size_t i = index(x, y);
      const bool point = chart_.ids.triangle(x, y) != no_triangle;
      const bool hidden = point && chart_.ids.depth(x, y) < front_[i] - behind;
      const bool surface = point || inner_[i] || has_opposites(sides_[i]);
      shown(x, y) = point && !hidden ? Shown::Point : surface ? Shown::Hole : Shown::Nothing;
    }
  }
}

bool TileCover::finish_plain(const Rect& tile, Image<Shown>& shown) {
  const Rect wide = grow(tile, 1);
  if (intersect(wide, chart_.ids.depth.rect()) != wide) return false;
  if (!load_steps(wide, wide.y0) || !load_steps(wide, wide.y0 + 1)) return false;
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (!load_steps(wide, y + 1) || !(rise_over(tile, y) <= chart_.grid.pixel)) return false;
  }
  for (int y = tile.y0; y < tile.y1; ++y) {
    std::fill_n(shown.row(y) + tile.x0, tile.width(), Shown::Point);
  }
  return true;
}

/// The depth steps of a row's points. False where a pixel has none.
bool TileCover::load_steps(const Rect& wide, int y) {
  const std::uint32_t* ids = chart_.ids.triangle.row(y) + wide.x0;
  StepRow& steps = steps_[static_cast<std::size_t>(y) % steps_.size()];
  Vec2f step = Vec2f::Zero();
  std::uint32_t last = no_triangle;
  for (std::size_t x = 0; x < static_cast<std::size_t>(wide.width()); ++x) {
    if (ids[x] == no_triangle) return false;
    if (ids[x] != last) {
      last = ids[x];
      step = splats_.get(last).depth_step;
    }
    steps.right[x] = step.x();
    steps.down[x] = step.y();
  }
  return true;
}

/// By how much the planes of the points around come nearer than a row's points, at most.
float TileCover::rise_over(const Rect& tile, int y) const {
  std::array<float, splat_tile> front;
  front.fill(nothing_near);
  const auto count = static_cast<std::size_t>(tile.width());
  for (int j = -1; j <= 1; ++j) {
    const float* depth = chart_.ids.depth.row(y + j) + tile.x0 - 1;
    const StepRow& steps = steps_[static_cast<std::size_t>(y + j) % steps_.size()];
    const auto below = static_cast<float>(-j);
    for (std::size_t x = 0; x < count; ++x) {
      const float a = depth[x] + steps.right[x] + below * steps.down[x];
      const float b = depth[x + 1] + below * steps.down[x + 1];
      const float c = depth[x + 2] - steps.right[x + 2] + below * steps.down[x + 2];
      front[x] = std::max(std::max(front[x], a), std::max(b, c));
    }
  }
  const float* depth = chart_.ids.depth.row(y) + tile.x0;
  float most = nothing_near;
  for (std::size_t x = 0; x < count; ++x) most = std::max(most, front[x] - depth[x]);
  return most;
}

/// Finds cracks of a single pixel, where texels are crowded in one direction and far apart in the
/// other and splats of those that lost their pixels are missing: pixels that show nothing, or a
/// point far behind, between surface on opposite sides.
class Cracks {
 public:
  Cracks(const EditingChart& chart, const Image<Shown>& shown) : chart_(chart), shown_(shown) {}

  bool at(int x, int y) const {
    if (shown_(x, y) == Shown::Hole) return false;
    return between(x, y, 1, 0) || between(x, y, 0, 1);
  }

 private:
  bool between(int x, int y, int dx, int dy) const {
    const Rect all = shown_.rect();
    if (!all.contains(x - dx, y - dy) || !all.contains(x + dx, y + dy)) return false;
    const Shown before = shown_(x - dx, y - dy);
    const Shown after = shown_(x + dx, y + dy);
    if (shown_(x, y) == Shown::Nothing) return before != Shown::Nothing && after != Shown::Nothing;
    if (before != Shown::Point || after != Shown::Point) return false;
    constexpr float far_behind = 4.0F;  // pixels
    const float depth = chart_.ids.depth(x, y) + far_behind * chart_.grid.pixel;
    const float a = chart_.ids.depth(x - dx, y - dy);
    const float b = chart_.ids.depth(x + dx, y + dy);
    return depth + std::abs(a - b) < std::min(a, b);
  }

  const EditingChart& chart_;
  const Image<Shown>& shown_;
};

void close_cracks(const EditingChart& chart, Image<Shown>& shown) {
  std::vector<std::vector<std::size_t>> found(static_cast<std::size_t>(shown.height()));
  const Cracks cracks(chart, shown);
  parallel_rows(shown.height(), [&](int y) {
    for (int x = 0; x < shown.width(); ++x) {
      if (cracks.at(x, y))
        found[static_cast<std::size_t>(y)].push_back(static_cast<std::size_t>(x));
    }
  });
  for (int y = 0; y < shown.height(); ++y) {
    for (const std::size_t x : found[static_cast<std::size_t>(y)]) shown.row(y)[x] = Shown::Hole;
  }
}

/// The chart's tiles, row after row, and how far their splats reach.
struct Tiles {
  Rect all;
  int columns;
  int rows;
  std::vector<int> reaches;

  explicit Tiles(const Rect& chart)
      : all(chart),
        columns((chart.x1 + splat_tile - 1) / splat_tile),
        rows((chart.y1 + splat_tile - 1) / splat_tile),
        reaches(static_cast<std::size_t>(columns * rows), 0) {}

  Rect rect(int i) const {
    const int x = i % columns * splat_tile;
    const int y = i / columns * splat_tile;
    return intersect({x, y, x + splat_tile, y + splat_tile}, all);
  }
  /// visit(other, its reach) for the tiles up to `around` tiles away.
  template <class Visit>
  void near(int i, int around, const Visit& visit) const {
    const int row = i / columns;
    const int column = i % columns;
    for (int r = std::max(row - around, 0); r <= std::min(row + around, rows - 1); ++r) {
      for (int c = std::max(column - around, 0); c <= std::min(column + around, columns - 1); ++c) {
        visit(r * columns + c, reaches[static_cast<std::size_t>(r * columns + c)]);
      }
    }
  }
};

void cover_tile(const Tiles& tiles, int i, int around, TileCover& task, Image<Shown>& shown) {
  const Rect tile = tiles.rect(i);
  int farthest = 0;
  tiles.near(i, around, [&](int, int reach) { farthest = std::max(farthest, reach); });
  if (farthest <= 1 && task.finish_plain(tile, shown)) return;
  task.begin(tile);
  tiles.near(i, around, [&](int other, int reach) {
    task.draw(intersect(tiles.rect(other), grow(tile, reach)));
  });
  task.finish(shown);
}

}  // namespace

Image<Shown> cover(const Mesh& mesh, const StorageAtlas& storage, const EditingChart& chart,
                   const Image<PointOffset>& offsets) {
  Tiles tiles(chart.ids.triangle.rect());
  const auto each_tile = [&](const auto& visit) {
    parallel_for(tiles.reaches.size(), 8, [&](std::size_t begin, std::size_t end) {
      TileCover task(mesh, storage, chart, offsets);
      for (std::size_t i = begin; i < end; ++i) visit(task, static_cast<int>(i));
    });
  };
  each_tile([&](TileCover& task, int i) {
    tiles.reaches[static_cast<std::size_t>(i)] = task.reach(tiles.rect(i));
  });
  const int farthest = *std::max_element(tiles.reaches.begin(), tiles.reaches.end());
  const int around = (farthest + splat_tile - 1) / splat_tile;
  Image<Shown> shown(tiles.all.x1, tiles.all.y1);
  each_tile([&](TileCover& task, int i) { cover_tile(tiles, i, around, task, shown); });
  close_cracks(chart, shown);
  return shown;
}

}  // namespace normalshop
