#pragma once

#include <cmath>
#include <mutex>
#include <vector>

#include "support/whole_texels.h"

#include "normalshop/chart/push.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/parallel.h"

/// Which texels an edit of all that a chart shows has changed, against what its pixels show.
namespace normalshop::test {

struct Bijection {
  std::size_t effective = 0;  ///< texels that all four pixels around show, with a weight
  std::size_t missed = 0;     ///< of these: not changed
  std::size_t pixels = 0;     ///< with a weight of at least 0.1
  std::size_t unlinked = 0;   ///< of these: they show the middle of a texel that is not changed
  std::size_t outside = 0;    ///< changed, but no pixel around shows them with a weight
  std::size_t behind = 0;     ///< changed, but the pixels around show surface that is not theirs

  void add(const Bijection& other) {
    effective += other.effective;
    missed += other.missed;
    pixels += other.pixels;
    unlinked += other.unlinked;
    outside += other.outside;
    behind += other.behind;
  }
};

/// Do all four pixels around a point show its triangle's plane, within half a pixel, with a weight?
inline bool shown_all_around(const EditingChart& chart, const Mesh& mesh, const SurfacePoint& p) {
  const View& view = chart.grid.view;
  if (!(view.to_chart(base_normal_at(mesh, p)).z() > 0.1F)) return false;
  const std::size_t corner = 3 * static_cast<std::size_t>(p.triangle);
  const Vec3f a = mesh.position(corner);
  const Vec3f plane =
      view.to_chart((mesh.position(corner + 1) - a).cross(mesh.position(corner + 2) - a));
  const Vec3f at = chart.grid.project(position_at(mesh, p));
  const int x0 = static_cast<int>(std::floor(at.x()));
  const int y0 = static_cast<int>(std::floor(at.y()));
  for (int k = 0; k < 4; ++k) {
    const int x = x0 + k % 2;
    const int y = y0 + k / 2;
    if (!chart.weight.rect().contains(x, y) || !(chart.weight(x, y) > 0.02F)) return false;
    const Vec2f away(static_cast<float>(x) - at.x(), at.y() - static_cast<float>(y));
    const float depth = at.z() - chart.grid.pixel * plane.head<2>().dot(away) / plane.z();
    if (!(std::abs(chart.ids.depth(x, y) - depth) < 0.5F * chart.grid.pixel)) return false;
  }
  return true;
}

/// Do triangles touch?
inline bool touch(const Mesh& mesh, std::uint32_t s, std::uint32_t t) {
  for (std::size_t i = 0; i < 9; ++i) {
    if (mesh.position(std::size_t{3} * s + i / 3) == mesh.position(std::size_t{3} * t + i % 3)) {
      return true;
    }
  }
  return false;
}

/// Does one of 5 x 5 pixels around a point show its triangle or one that touches it?
inline bool own_surface_near(const EditingChart& chart, const Mesh& mesh, const SurfacePoint& p) {
  const Vec3f at = chart.grid.project(position_at(mesh, p));
  const int x0 = static_cast<int>(std::lround(at.x())) - 2;
  const int y0 = static_cast<int>(std::lround(at.y())) - 2;
  for (int k = 0; k < 25; ++k) {
    const int i = (k + 12) % 25;  // from the middle
    const int x = x0 + i % 5;
    const int y = y0 + i / 5;
    if (!chart.weight.rect().contains(x, y)) continue;
    const std::uint32_t shown = chart.ids.triangle(x, y);
    if (shown == p.triangle) return true;
    if (shown != no_triangle && touch(mesh, shown, p.triangle)) return true;
  }
  return false;
}

/// Counts one texel and the triangles that cover it.
inline void look_at_texel(const Mesh& mesh, const EditingChart& chart, const TexelMap& texels,
                          bool edited, const std::vector<std::uint32_t>& triangles, int x, int y,
                          Bijection& found) {
  bool effective = false;
  bool near = false;
  bool own = false;
  for (const std::uint32_t t : triangles) {
    const SurfacePoint p = texels.surface_point(t, x, y);
    effective = effective || shown_all_around(chart, mesh, p);
    near = near || (edited && shows(chart, mesh, p));
    own = own || (edited && own_surface_near(chart, mesh, p));
  }
  found.effective += effective ? 1 : 0;
  found.missed += effective && !edited ? 1 : 0;
  found.outside += edited && !near ? 1 : 0;
  found.behind += edited && !own ? 1 : 0;
}

/// Edits all of a chart with its weight, and looks at the first texture set's map, which was not
/// edited before.
inline Bijection edit_all(const Mesh& mesh, StorageAtlas storage, EditingChart& chart) {
  const SlopeImage slopes(chart.grid.width(), chart.grid.height(), Vec2f(0.1F, 0.05F));
  find_texels(mesh, storage, chart);
  push(mesh, chart, {EditMode::Base, slopes, {}, slopes.rect()}, storage);
  const NormalMap& map = storage.sets[0].normals;
  const TexelMap& texels = storage.sets[0].texels;
  std::mutex mutex;
  Bijection all;
  parallel_for(static_cast<std::size_t>(map.height()), 16, [&](std::size_t begin, std::size_t end) {
    Bijection found;
    SharedCursor shared(texels.shared());
    std::vector<std::uint32_t> triangles(1);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        triangles.assign(1, texels.owner()(x, y));
        if (triangles[0] == no_triangle) continue;
        const bool several = shared.holds(texel_index(x, y, map.width()));
        const bool edited = map.edited(x, y);
        const bool averted = faces_away(mesh, triangles[0], chart.grid.view.direction);
        if (averted && !several && !edited) continue;
        if (several) triangles = covering(texels, x, y);
        look_at_texel(mesh, chart, texels, edited, triangles, x, y, found);
      }
    }
    const std::lock_guard lock(mutex);
    all.add(found);
  });
  for (std::size_t i = 0; i < chart.weight.size(); ++i) {
    if (!(chart.weight.data()[i] >= 0.1F)) continue;
    ++all.pixels;
    const auto [x, y] = texel_place(chart.texel.data()[i], map.width());
    const std::uint32_t owner = texels.owner()(x, y);
    if (owner == no_triangle || map.edited(x, y)) continue;
    // Pixels of steep surface may show texels whose middle lies behind its rim.
    const Vec3f middle = chart.grid.project(position_at(mesh, texels.surface_point(owner, x, y)));
    const TexelPlace pixel = texel_place(static_cast<std::uint32_t>(i), chart.grid.width());
    const Vec2f away(middle.x() - static_cast<float>(pixel.x),
                     middle.y() - static_cast<float>(pixel.y));
    all.unlinked += away.cwiseAbs().maxCoeff() <= 0.5F ? 1 : 0;
  }
  return all;
}

}  // namespace normalshop::test
