#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "normalshop/chart/details.h"
#include "normalshop/chart/set_push.h"

/// What an edit does to texels that several triangles show, looked at texel by texel.
namespace normalshop::test {

/// Stores as push() does, and counts how often each texel is written.
struct CountingTarget {
  static constexpr auto facing = NormalEditor::Facing::Left;
  NormalMap& normals;
  Image<std::uint8_t> counts{normals.width(), normals.height(), std::uint8_t{0}};
  void put(int x, int y, const TexelWrite& write) {
    ++counts(x, y);
    normals.set_normal(x, y, write.value);
  }
};

/// The triangles that cover a texel, the owner first.
inline std::vector<std::uint32_t> covering(const TexelMap& texels, int x, int y) {
  std::vector<std::uint32_t> all{texels.owner()(x, y)};
  const std::uint32_t index = texel_index(x, y, texels.width());
  const auto& shared = texels.shared();
  auto s = std::partition_point(shared.begin(), shared.end(),
                                [&](const SharedTexel& t) { return t.texel < index; });
  for (; s != shared.end() && s->texel == index; ++s) all.push_back(s->triangle);
  return all;
}

/// Cosine to the viewing direction from which on surface is edited.
constexpr float squarely = 0.4F;

/// How far depth may change from a point to the pixels around it, in pixels.
inline float depth_slack(const EditingChart& chart, const Mesh& mesh, const SurfacePoint& p) {
  const View& view = chart.grid.view;
  const std::size_t corner = 3 * static_cast<std::size_t>(p.triangle);
  const Vec3f a = mesh.position(corner);
  const Vec3f plane =
      view.to_chart((mesh.position(corner + 1) - a).cross(mesh.position(corner + 2) - a));
  float steepest = 0.0F;
  for (const Vec3f& n : {plane, view.to_chart(base_normal_at(mesh, p))}) {
    const float steepness = n.head<2>().norm() / std::abs(n.z());
    if (!(steepness < 20.0F)) return 63.0F;
    steepest = std::max(steepest, steepness);
  }
  return 3.0F * steepest + 3.0F;
}

/// Does a pixel around the point show it, or surface that may be the same?
inline bool shows(const EditingChart& chart, const Mesh& mesh, const SurfacePoint& p) {
  if (!(chart.grid.view.to_chart(base_normal_at(mesh, p)).z() > 0.0F)) return false;
  const Vec3f at = chart.grid.project(position_at(mesh, p));
  const float slack = chart.grid.pixel * depth_slack(chart, mesh, p);
  for (int k = 0; k < 9; ++k) {
    const int x = static_cast<int>(std::lround(at.x())) - 1 + k % 3;
    const int y = static_cast<int>(std::lround(at.y())) - 1 + k / 3;
    if (!chart.weight.rect().contains(x, y) || !(chart.weight(x, y) > 0.0F)) continue;
    if (std::abs(chart.ids.depth(x, y) - at.z()) < slack) return true;
  }
  return false;
}

/// What became of the texels that triangles cover, after a change of the slopes over the base
/// normals by `change` times the chart's weight.
struct WholeTexels {
  std::size_t written = 0;
  std::size_t shared = 0;    ///< of the written, covered by several triangles
  std::size_t strange = 0;   ///< written: in no shown triangle's frame a part of the change
  std::size_t unshown = 0;   ///< written although no triangle there is shown
  std::size_t repeated = 0;  ///< written more than once
  std::size_t touched = 0;   ///< not written, but not as before bit for bit
};

inline WholeTexels check_texels(const Mesh& mesh, const TexelMap& texels, const NormalMap& before,
                                const CountingTarget& after, const EditingChart& chart,
                                const Vec2f& change) {
  const View& view = chart.grid.view;
  const NormalSpace space = before.convention().space;
  const auto details = [&](const SurfacePoint& p, const Vec3f& stored) {
    const Vec3f base = view.to_chart(base_normal_at(mesh, p));
    const Vec3f normal = view.to_chart(frame_at(mesh, p, space).object_normal(stored));
    return gradient_from_normal(normal, base, EditMode::Base);
  };
  WholeTexels found;
  for (int y = 0; y < before.height(); ++y) {
    for (int x = 0; x < before.width(); ++x) {
      const int count = after.counts(x, y);
      const Vec3f was = before.vector(x, y);
      const Vec3f is = after.normals.vector(x, y);
      found.repeated += count > 1 ? 1 : 0;
      found.touched += count == 0 && is != was ? 1 : 0;
      if (count == 0 || texels.owner()(x, y) == no_triangle) continue;
      const std::vector<std::uint32_t> triangles = covering(texels, x, y);
      ++found.written;
      found.shared += triangles.size() > 1 ? 1 : 0;
      bool shown = false;
      bool whole = false;
      for (const std::uint32_t t : triangles) {
        const SurfacePoint p = texels.surface_point(t, x, y);
        if (!shows(chart, mesh, p)) continue;
        shown = true;
        const Vec2f old = details(p, was);
        const Vec2f grown = details(p, is) - old;
        const float part = std::clamp(grown.dot(change) / change.squaredNorm(), 0.0F, 1.0F);
        whole = whole || (grown - part * change).norm() < 2e-3F * (1.0F + old.squaredNorm());
      }
      found.unshown += shown ? 0 : 1;
      found.strange += shown && !whole ? 1 : 0;
    }
  }
  return found;
}

/// That edit of one texture set, in a chart whose weight is 1 wherever surface is seen squarely.
inline WholeTexels push_and_check(const Mesh& mesh, StorageSet& set, std::uint32_t index,
                                  EditingChart& chart, const Vec2f& change, PushResult& result) {
  chart.weight = MaskImage(chart.grid.width(), chart.grid.height(), 0.0F);
  for (std::size_t i = 0; i < chart.weight.size(); ++i) {
    const bool faces = chart.base_normal.data()[i].z() > squarely;
    chart.weight.data()[i] = chart.ids.triangle.data()[i] != no_triangle && faces ? 1.0F : 0.0F;
  }
  const SlopeImage slopes(chart.grid.width(), chart.grid.height(), change);
  const ChartEdit edit{EditMode::Base, slopes, {}, slopes.rect()};
  const EditSampler sampler(chart, edit);
  const NormalMap before = set.normals;
  CountingTarget target{set.normals};
  SetPush push(mesh, sampler, set, index, target);
  result = result_of(push.run());
  return check_texels(mesh, set.texels, before, target, chart, change);
}

}  // namespace normalshop::test
