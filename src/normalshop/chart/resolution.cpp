#include "normalshop/chart/resolution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr float covered_share = 0.95F;
constexpr float facing_cosine = 0.2588F;  // cos 75 degrees

struct Density {
  float texels_per_unit;
  float area;
};

/// Largest stretch of the map from the view's plane to texels on a triangle.
float stretch(const Vec2f& p1, const Vec2f& p2, const Vec2f& t1, const Vec2f& t2) {
  const float area = p1.x() * p2.y() - p2.x() * p1.y();
  Mat2f view_edges;
  view_edges.col(0) = p1;
  view_edges.col(1) = p2;
  Mat2f adjugate;
  adjugate << view_edges(1, 1), -view_edges(0, 1), -view_edges(1, 0), view_edges(0, 0);
  Mat2f texel_edges;
  texel_edges.col(0) = t1;
  texel_edges.col(1) = t2;
  const Mat2f j = texel_edges * adjugate / area;
  // Larger singular value of a 2 x 2 matrix in closed form.
  const float e = 0.5F * (j(0, 0) + j(1, 1));
  const float f = 0.5F * (j(0, 0) - j(1, 1));
  const float g = 0.5F * (j(1, 0) + j(0, 1));
  const float h = 0.5F * (j(1, 0) - j(0, 1));
  return std::sqrt(e * e + h * h) + std::sqrt(f * f + g * g);
}

Vec2f texels_across(const StorageSet& set, CountedTexels counted) {
  Vec2f normals(static_cast<float>(set.normals.width()), static_cast<float>(set.normals.height()));
  if (counted == CountedTexels::Normals || set.albedo.empty()) return normals;
  const RawImage& colors = set.albedo.codes();
  return normals.cwiseMax(
      Vec2f(static_cast<float>(colors.width()), static_cast<float>(colors.height())));
}

/// An edge in axes of the triangle's own plane.
Vec2f turned(const Vec3f& edge, const Vec3f& first, const Vec3f& cross) {
  const Vec3f along = first.normalized();
  return {edge.dot(along), edge.dot(cross.cross(along).normalized())};
}

bool measure(const Mesh& mesh, const std::vector<Vec2f>& sizes, const View& view, const Vec2f& low,
             const Vec2f& high, TexelLength length, std::size_t triangle, Density& out) {
  std::array<Vec3f, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = view.to_chart(mesh.position(3 * triangle + k) - view.center);
  }
  const Vec3f least = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
  const Vec3f most = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  if (least.x() > high.x() || least.y() > high.y() || most.x() < low.x() || most.y() < low.y()) {
    return false;
  }
  const Vec3f cross = view.handedness() * (p[1] - p[0]).cross(p[2] - p[0]);
  if (!(cross.z() > facing_cosine * cross.norm())) return false;
  const Vec2f& size = sizes[mesh.texture_sets[triangle]];
  const auto texel = [&](std::size_t k) -> Vec2f {
    return (mesh.uvs[3 * triangle + k] - mesh.uvs[3 * triangle]).cwiseProduct(size);
  };
  const Vec3f first = p[1] - p[0];
  const Vec3f second = p[2] - p[0];
  const bool seen = length == TexelLength::Seen;
  out.texels_per_unit =
      stretch(seen ? Vec2f(first.head<2>()) : turned(first, first, cross),
              seen ? Vec2f(second.head<2>()) : turned(second, first, cross), texel(1), texel(2));
  // Only what lies in the window counts, roughly.
  const Vec2f inside_low = low.cwiseMax(least.head<2>());
  const Vec2f inside_high = high.cwiseMin(most.head<2>());
  const float box = (most - least).head<2>().prod();
  const float part = box > 0.0F ? (inside_high - inside_low).cwiseMax(0.0F).prod() / box : 0.0F;
  out.area = 0.5F * cross.z() * part;
  return std::isfinite(out.texels_per_unit) && out.texels_per_unit > 0.0F && out.area > 0.0F;
}

}  // namespace

float texel_pixel_size(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                       const Vec2f& low, const Vec2f& high, CountedTexels counted,
                       TexelLength length) {
  constexpr std::size_t run = 32768;
  std::vector<Vec2f> sizes;
  for (const StorageSet& set : storage.sets) sizes.push_back(texels_across(set, counted));
  std::vector<std::vector<Density>> parts((mesh.triangle_count() + run - 1) / run);
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t part = begin; part < end; ++part) {
      const std::size_t last = std::min(mesh.triangle_count(), (part + 1) * run);
      Density d{};
      for (std::size_t t = part * run; t < last; ++t) {
        if (measure(mesh, sizes, view, low, high, length, t, d)) parts[part].push_back(d);
      }
    }
  });
  std::vector<Density> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  if (all.empty()) return std::max(view.width, view.height) / 1024.0F;
  std::stable_sort(all.begin(), all.end(), [](const Density& a, const Density& b) {
    return a.texels_per_unit < b.texels_per_unit;
  });
  double total = 0.0;
  for (const Density& d : all) total += d.area;
  double sum = 0.0;
  for (const Density& d : all) {
    sum += d.area;
    if (sum >= covered_share * total) return 1.0F / d.texels_per_unit;
  }
  return 1.0F / all.back().texels_per_unit;
}

}  // namespace normalshop
