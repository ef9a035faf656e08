#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "normalshop/chart/grid.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/texel_map.h"

/// A triangle in chart axes, private to floor 4: what its pixels and texels share.
namespace normalshop {

struct ChartTriangle {
  /// Sines and lengths below this make a frame whose inverse is noise: frame_at()'s.
  static constexpr float smallest_sine = 1e-4F;

  // Columns: corner 0, corner 1 - corner 0, corner 2 - corner 0, so that M * (1, b1, b2)
  // interpolates.
  Mat3f points = Mat3f::Zero();    ///< pixel x, pixel y, depth
  Mat3f normals = Mat3f::Zero();   ///< base normals
  Mat3f tangents = Mat3f::Zero();  ///< zero without tangents
  float sign = 1.0F;               ///< of the bitangent in chart axes
  Mat3f node = Mat3f::Identity();  ///< Mesh::node_frame()

  static Mat3f differences(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    Mat3f m;
    m.col(0) = a;
    m.col(1) = b - a;
    m.col(2) = c - a;
    return m;
  }

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
    const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
    const View& view = grid.view;
    const Vec3u& index = mesh.triangles[triangle];
    points =
        differences(grid.project(mesh.positions[index[0]]), grid.project(mesh.positions[index[1]]),
                    grid.project(mesh.positions[index[2]]));
    normals =
        differences(view.to_chart(mesh.normals[corner]), view.to_chart(mesh.normals[corner + 1]),
                    view.to_chart(mesh.normals[corner + 2]));
    node = mesh.node_frame(triangle);
    if (mesh.tangents.empty()) return;
    const auto tangent = [&](std::size_t i) {
      return view.to_chart(mesh.tangents[corner + i].head<3>());
    };
    tangents = differences(tangent(0), tangent(1), tangent(2));
    const float signs =
        mesh.tangents[corner].w() + mesh.tangents[corner + 1].w() + mesh.tangents[corner + 2].w();
    sign = (signs < 0.0F ? -1.0F : 1.0F) * view.handedness();
  }

  /// Map space to chart axes at weights (1, b1, b2): columns vT, vB, vN, not normalised, like
  /// frame_at(); `normal` = normals * weights.
  Mat3f frame(const Vec3f& weights, const Vec3f& normal, NormalSpace space,
              const View& view) const {
    Mat3f m;
    if (space == NormalSpace::Tangent) {
      const Vec3f tangent = tangents * weights;
      const Vec3f bitangent = sign * normal.cross(tangent);
      const float size = smallest_sine * smallest_sine * normal.squaredNorm();
      const float across = bitangent.squaredNorm();
      if (!(across > size && across > size * tangent.squaredNorm())) {
        return any_frame(normal.cast<double>());
      }
      m.col(0) = tangent;
      m.col(1) = bitangent;
      m.col(2) = normal;
    } else {
      m.row(0) = view.right.transpose();
      m.row(1) = view.up.transpose();
      m.row(2) = view.direction.transpose();
      if (space == NormalSpace::Object) m *= node;
    }
    return m;
  }
};

/// Fetches an address into the processor's caches; never fails. Not by __builtin_prefetch: GCC 12
/// takes functions that only prefetch for functions that do nothing, and drops the calls.
inline void prefetch([[maybe_unused]] const void* address) {
#if defined(__x86_64__) && defined(__GNUC__)
  asm volatile("prefetcht0 %0" : : "m"(*static_cast<const char*>(address)));
#endif
}

/// The last triangles that a task used, ready loaded. T: default-constructible with
/// load(mesh, grid, triangle).
template <class T>
class TriangleCache {
 public:
  TriangleCache(const Mesh& mesh, const ChartGrid& grid)
      : mesh_(mesh), grid_(grid), ids_(slots, no_triangle), triangles_(new T[slots]) {}

  /// Fetches what get() will read of a triangle into the processor's caches: first the mesh's
  /// attributes, then, once they are there, the positions.
  void announce_attributes(std::uint32_t triangle) const {
    if (ids_[triangle % slots] == triangle) return;
    const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
    prefetch(&mesh_.triangles[triangle]);
    prefetch(&mesh_.uvs[corner]);
    prefetch(&mesh_.normals[corner]);
    prefetch(&mesh_.normals[corner + 2]);
    if (mesh_.tangents.empty()) return;
    prefetch(&mesh_.tangents[corner]);
    prefetch(&mesh_.tangents[corner + 2]);
  }
  void announce_positions(std::uint32_t triangle) const {
    if (ids_[triangle % slots] == triangle) return;
    for (const std::uint32_t vertex : mesh_.triangles[triangle]) {
      prefetch(&mesh_.positions[vertex]);
    }
  }

  const T& get(std::uint32_t triangle) {
    const std::size_t slot = triangle % slots;
    if (ids_[slot] != triangle) {
      triangles_[slot].load(mesh_, grid_, triangle);
      ids_[slot] = triangle;
    }
    return triangles_[slot];
  }

 private:
  static constexpr std::size_t slots = 256;
  const Mesh& mesh_;
  const ChartGrid& grid_;
  std::vector<std::uint32_t> ids_;
  std::unique_ptr<T[]> triangles_;
};

}  // namespace normalshop
