#include "normalshop/chart/point_pull.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "normalshop/chart/nearest_fill.h"
#include "normalshop/chart/splat_cover.h"
#include "normalshop/chart/texel_walk.h"
#include "normalshop/core/error.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();

/// Where a batch's points fall.
struct Landing {
  PerLane<std::uint32_t> pixel;  ///< y * width + x
  PerLane<std::uint64_t> key;    ///< no_key outside the window
  PerLane<float> depth;          ///< of the point's plane at the pixel's centre
  PerLane<PointOffset> offset;   ///< of the point from the pixel's centre
};

/// Has the texel a neighbour that no triangle owns? Maps end at their sides.
bool at_border(const Image<std::uint32_t>& owner, std::uint32_t texel) {
  const TexelPlace at = texel_place(texel, owner.width());
  const Rect around{at.x - 1, at.y - 1, at.x + 2, at.y + 2};
  if (intersect(around, owner.rect()) != around) return true;
  bool free = false;
  for (int y = around.y0; y < around.y1; ++y) {
    const std::uint32_t* row = owner.row(y) + at.x;
    free = free || row[-1] == no_triangle || row[0] == no_triangle || row[1] == no_triangle;
  }
  return free;
}

class PointPull {
 public:
  PointPull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
            const PullOptions& options, EditingChart& chart)
      : mesh_(mesh), storage_(storage), options_(options), chart_(chart) {
    chart_.grid = grid;
  }
  void run();

 private:
  void number_points();
  void find_depth_steps();
  void find_candidates();
  void allocate();
  template <class Visit>
  void walk(const Visit& visit) const;
  void land(const TexelLanes& lanes, std::uint32_t first, Landing& out) const;
  void drop(const Landing& landing, int count);
  void show(std::size_t set, TexelLanes& lanes, const Landing& landing);
  void fill_holes();
  void clear(std::size_t pixel);
  void copy(std::size_t from, std::size_t to, TriangleCache<PushTriangle>& triangles);

  const Mesh& mesh_;
  const StorageAtlas& storage_;
  const PullOptions& options_;
  EditingChart& chart_;
  std::vector<std::uint32_t> first_;      // per set: number of its first texel's point
  std::vector<std::uint8_t> candidates_;  // per triangle: may it lie in the window?
  float nearest_ = 0.0F;                  // depth that no point is in front of
  float step_ = 1.0F;                     // in depth
  Image<std::uint64_t> keys_;             // of the points that the pixels show
  Image<PointOffset> offsets_;
};

/// Owned texels first, then the shared ones, set after set.
void PointPull::number_points() {
  std::uint64_t count = 0;
  for (const StorageSet& set : storage_.sets) {
    first_.push_back(static_cast<std::uint32_t>(count));
    count += set.texels.owner().size() + set.texels.shared().size();
    if (count >= std::numeric_limits<std::uint32_t>::max()) {
      throw InvalidInput("the maps have too many texels for transfer by points: up to 4 billion");
    }
  }
}

void PointPull::find_depth_steps() {
  const Bounds box = bounds(mesh_);
  const View& view = chart_.grid.view;
  const float middle = view.to_chart(box.center() - view.center).z();
  const float half = view.direction.cwiseAbs().dot(0.5F * (box.high - box.low));
  constexpr float steps_per_pixel = 2.0F;
  constexpr float steps = 16777215.0F;  // 24 bits
  nearest_ = middle + half + chart_.grid.pixel;
  step_ = std::max(chart_.grid.pixel / steps_per_pixel, 2.0F * (half + chart_.grid.pixel) / steps);
}

void PointPull::find_candidates() {
  candidates_.assign(mesh_.triangle_count(), 0);
  const auto right = static_cast<float>(chart_.grid.width());
  const auto bottom = static_cast<float>(chart_.grid.height());
  parallel_for(candidates_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f a = chart_.grid.project(mesh_.position(3 * i));
      const Vec3f b = chart_.grid.project(mesh_.position(3 * i + 1));
      const Vec3f c = chart_.grid.project(mesh_.position(3 * i + 2));
      const Vec3f low = a.cwiseMin(b).cwiseMin(c);
      const Vec3f high = a.cwiseMax(b).cwiseMax(c);
      candidates_[i] =
          low.x() < right && low.y() < bottom && high.x() > -1.0F && high.y() > -1.0F ? 1 : 0;
    }
  });
}

void PointPull::allocate() {
  const int width = chart_.grid.width();
  const int height = chart_.grid.height();
  keys_.resize(width, height);
  offsets_.resize(width, height);
  chart_.ids.triangle.resize(width, height);
  chart_.ids.depth.resize(width, height);
  chart_.texel.resize(width, height);
  chart_.base_normal.resize(width, height);
  chart_.normal.resize(options_.normals ? width : 0, options_.normals ? height : 0);
  chart_.albedo.resize(options_.albedo ? width : 0, options_.albedo ? height : 0);
  parallel_rows(height, [&](int y) {
    std::fill_n(keys_.row(y), width, no_key);
    std::fill_n(chart_.ids.triangle.row(y), width, no_triangle);
  });
}

/// visit(set, lanes, number of the first point of lanes' kind).
template <class Visit>
void PointPull::walk(const Visit& visit) const {
  const auto wanted = [&](std::uint32_t triangle) { return candidates_[triangle] != 0; };
  for (std::size_t i = 0; i < storage_.sets.size(); ++i) {
    const TexelMap& map = storage_.sets[i].texels;
    walk_owned(mesh_, chart_.grid, map, wanted,
               [&](TexelLanes& lanes) { visit(i, lanes, first_[i]); });
    const auto shared = first_[i] + static_cast<std::uint32_t>(map.owner().size());
    walk_shared(mesh_, chart_.grid, map, wanted,
                [&](TexelLanes& lanes) { visit(i, lanes, shared + lanes.first_shared); });
  }
}

void PointPull::land(const TexelLanes& lanes, std::uint32_t first, Landing& out) const {
  const TexelBatch& batch = lanes.batch;
  const auto right = static_cast<float>(chart_.grid.width());
  const auto bottom = static_cast<float>(chart_.grid.height());
  const float inverse = 1.0F / step_;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); ++i) {
    const float x = batch.point.x[i] + 0.5F;
    const float y = batch.point.y[i] + 0.5F;
    out.key[i] = no_key;
    if (!(x >= 0.0F && y >= 0.0F && x < right && y < bottom)) continue;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    const float dx = x - 0.5F - static_cast<float>(column);
    const float dy = y - 0.5F - static_cast<float>(row);
    const float depth = batch.point.z[i] - dx * batch.depth_dx[i] - dy * batch.depth_dy[i];
    const float steps = std::clamp((nearest_ - depth) * inverse, 0.0F, 16777215.0F);
    const auto off = static_cast<std::uint64_t>(510.0F * (dx * dx + dy * dy));
    const std::uint32_t point =
        lanes.listed ? first + static_cast<std::uint32_t>(i) : first + lanes.texels[i];
    out.pixel[i] = static_cast<std::uint32_t>(row * chart_.grid.width() + column);
    out.key[i] = static_cast<std::uint64_t>(steps) << 40U | off << 32U | point;
    out.depth[i] = depth;
    out.offset[i] = {static_cast<std::int8_t>(dx / PointOffset::unit),
                     static_cast<std::int8_t>(dy / PointOffset::unit), false};
  }
}

/// The smallest key stays, in whatever order they come.
void PointPull::drop(const Landing& landing, int count) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const std::uint64_t key = landing.key[i];
    if (key == no_key) continue;
    std::atomic_ref<std::uint64_t> place(keys_.data()[landing.pixel[i]]);
    std::uint64_t held = place.load(std::memory_order_relaxed);
    while (key < held && !place.compare_exchange_weak(held, key, std::memory_order_relaxed)) {
    }
  }
}

/// Writes the points that won their pixels: each pixel's is one.
void PointPull::show(std::size_t set, TexelLanes& lanes, const Landing& landing) {
  TexelBatch& batch = lanes.batch;
  const auto count = static_cast<std::size_t>(batch.count);
  PerLane<bool> wins;
  bool any = false;
  for (std::size_t i = 0; i < count; ++i) {
    wins[i] = landing.key[i] != no_key && keys_.data()[landing.pixel[i]] == landing.key[i];
    any = any || wins[i];
  }
  if (!any) return;
  const StorageSet& storage = storage_.sets[set];
  if (options_.normals) {
    const NormalSpace space = storage.normals.convention().space;
    fill_frames(mesh_, chart_.grid.view, space, lanes.triangles, batch);
    read_stored(storage.normals, lanes);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!wins[i]) continue;
    const std::size_t pixel = landing.pixel[i];
    const int lane = static_cast<int>(i);
    chart_.ids.triangle.data()[pixel] = lanes.triangles[i];
    chart_.ids.depth.data()[pixel] = landing.depth[i];
    chart_.texel.data()[pixel] = lanes.texels[i];
    offsets_.data()[pixel] = landing.offset[i];
    offsets_.data()[pixel].at_border = at_border(storage.texels.owner(), lanes.texels[i]);
    const Vec3f base = batch.base.get(lane).normalized();
    chart_.base_normal.data()[pixel] = base;
    if (options_.normals) {
      const Vec3f v = batch.stored.get(lane);
      const Vec3f n = batch.tangent.get(lane) * v.x() + batch.bitangent.get(lane) * v.y() +
                      batch.normal.get(lane) * v.z();
      chart_.normal.data()[pixel] = codes::direction_of(v).isZero() ? base : n.normalized();
    }
    if (options_.albedo) {
      const NormalMap& map = storage.normals;
      const TexelPlace at = texel_place(lanes.texels[i], map.width());
      chart_.albedo.data()[pixel] = storage.albedo.sample(
          {(static_cast<float>(at.x) + 0.5F) / static_cast<float>(map.width()),
           (static_cast<float>(at.y) + 0.5F) / static_cast<float>(map.height())});
    }
  }
}

void PointPull::clear(std::size_t pixel) {
  chart_.ids.triangle.data()[pixel] = no_triangle;
  chart_.ids.depth.data()[pixel] = -std::numeric_limits<float>::infinity();
  chart_.texel.data()[pixel] = 0;
  chart_.base_normal.data()[pixel].setZero();
  if (options_.normals) chart_.normal.data()[pixel].setZero();
  if (options_.albedo) chart_.albedo.data()[pixel].setZero();
}

void PointPull::copy(std::size_t from, std::size_t to, TriangleCache<PushTriangle>& triangles) {
  const TexelPlace there = texel_place(static_cast<std::uint32_t>(from), chart_.grid.width());
  const TexelPlace here = texel_place(static_cast<std::uint32_t>(to), chart_.grid.width());
  const Vec2f offset(static_cast<float>(here.x - there.x), static_cast<float>(here.y - there.y));
  const std::uint32_t triangle = chart_.ids.triangle.data()[from];
  chart_.ids.triangle.data()[to] = triangle;
  chart_.ids.depth.data()[to] =
      chart_.ids.depth.data()[from] + triangles.get(triangle).depth_step.dot(offset);
  chart_.texel.data()[to] = chart_.texel.data()[from];
  chart_.base_normal.data()[to] = chart_.base_normal.data()[from];
  if (options_.normals) chart_.normal.data()[to] = chart_.normal.data()[from];
  if (options_.albedo) chart_.albedo.data()[to] = chart_.albedo.data()[from];
}

void PointPull::fill_holes() {
  const Image<Shown> shown = cover(mesh_, storage_, chart_, offsets_);
  const Image<std::int32_t> nearest = nearest_points(shown);
  parallel_for(nearest.size(), 16384, [&](std::size_t begin, std::size_t end) {
    TriangleCache<PushTriangle> triangles(mesh_, chart_.grid);
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t from = nearest.data()[i];
      if (from < 0) {
        clear(i);
      } else if (static_cast<std::size_t>(from) != i) {
        copy(static_cast<std::size_t>(from), i, triangles);
      }
    }
  });
}

void PointPull::run() {
  number_points();
  find_depth_steps();
  find_candidates();
  allocate();
  walk([&](std::size_t, const TexelLanes& lanes, std::uint32_t first) {
    Landing landing;
    land(lanes, first, landing);
    drop(landing, lanes.batch.count);
  });
  walk([&](std::size_t set, TexelLanes& lanes, std::uint32_t first) {
    Landing landing;
    land(lanes, first, landing);
    show(set, lanes, landing);
  });
  keys_ = {};
  fill_holes();
}

}  // namespace

void pull_points(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                 const PullOptions& options, EditingChart& chart) {
  PointPull(mesh, storage, grid, options, chart).run();
}

EditingChart pull_points(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                         const PullOptions& options) {
  EditingChart chart;
  pull_points(mesh, storage, grid, options, chart);
  return chart;
}

}  // namespace normalshop
