#include "normalshop/surface/subdivide.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "normalshop/core/error.h"

namespace normalshop {
namespace {

constexpr std::size_t max_triangles = 0xFFFFFFFFU / 3;

Vec2f middle(const Vec2f& a, const Vec2f& b) { return 0.5F * (a + b); }

Vec3f middle(const Vec3f& a, const Vec3f& b) {
  const Vec3f sum = a + b;
  const float length = sum.norm();
  return length > 1e-6F ? Vec3f(sum / length) : a;
}

Vec4f middle(const Vec4f& a, const Vec4f& b) {
  const Vec3f t = middle(Vec3f(a.head<3>()), Vec3f(b.head<3>()));
  return {t.x(), t.y(), t.z(), a[3]};
}

/// Corners a b c with midpoints ab bc ca: the corner triangles, then the one in the middle.
template <class T>
std::array<T, 12> split(const T& a, const T& b, const T& c, const T& ab, const T& bc, const T& ca) {
  return {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca};
}

template <class T>
std::vector<T> split_corners(const std::vector<T>& corners) {
  std::vector<T> result;
  result.reserve(4 * corners.size());
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const T& a = corners[i];
    const T& b = corners[i + 1];
    const T& c = corners[i + 2];
    const std::array<T, 12> parts = split<T>(a, b, c, middle(a, b), middle(b, c), middle(c, a));
    result.insert(result.end(), parts.begin(), parts.end());
  }
  return result;
}

void split_triangles(const Mesh& mesh, Mesh& result) {
  std::unordered_map<std::uint64_t, std::uint32_t> midpoints;
  midpoints.reserve(3 * mesh.triangle_count());
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto [place, is_new] =
        midpoints.try_emplace(key, static_cast<std::uint32_t>(result.positions.size()));
    if (is_new) result.positions.push_back(0.5F * (mesh.positions[a] + mesh.positions[b]));
    return place->second;
  };
  for (const Vec3u& t : mesh.triangles) {
    const auto parts = split<std::uint32_t>(t[0], t[1], t[2], midpoint(t[0], t[1]),
                                            midpoint(t[1], t[2]), midpoint(t[2], t[0]));
    for (std::size_t i = 0; i < parts.size(); i += 3) {
      result.triangles.emplace_back(parts[i], parts[i + 1], parts[i + 2]);
    }
  }
}

Mesh subdivide_once(const Mesh& mesh) {
  if (mesh.triangle_count() > max_triangles / 4) {
    throw InvalidInput("The mesh has too many triangles to be subdivided further.");
  }
  Mesh result;
  result.texture_set_names = mesh.texture_set_names;
  result.single_maps = mesh.single_maps;
  result.positions = mesh.positions;
  result.triangles.reserve(4 * mesh.triangle_count());
  split_triangles(mesh, result);
  result.normals = split_corners(mesh.normals);
  result.uvs = split_corners(mesh.uvs);
  result.tangents = split_corners(mesh.tangents);
  result.node_normals = mesh.node_normals;
  for (const std::uint32_t node : mesh.nodes) result.nodes.insert(result.nodes.end(), 4, node);
  for (const std::uint32_t set : mesh.texture_sets) {
    result.texture_sets.insert(result.texture_sets.end(), 4, set);
  }
  return result;
}

}  // namespace

Mesh subdivide(const Mesh& mesh, int times) {
  Mesh result = mesh;
  for (int i = 0; i < times; ++i) result = subdivide_once(result);
  return result;
}

}  // namespace normalshop
