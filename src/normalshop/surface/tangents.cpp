#include "normalshop/surface/tangents.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/surface/topology.h"

namespace normalshop {
namespace {

constexpr std::size_t grain = 4096;
constexpr std::uint32_t no_group = 0xFFFFFFFFU;

bool not_zero(double x) { return std::abs(x) > static_cast<double>(FLT_MIN); }

Vec3d on_plane(const Vec3d& v, const Vec3d& n) {
  const Vec3d projected = v - n.dot(v) * n;
  const double length = projected.norm();
  return not_zero(length) ? Vec3d(projected / length) : projected;
}

/// Normal and UV of a corner as bits that are equal where the numbers are.
std::array<std::uint32_t, 5> attribute_key(const Mesh& mesh, std::uint32_t corner) {
  const Vec3f& n = mesh.normals[corner];
  const Vec2f& uv = mesh.uvs[corner];
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x + 0.0F); };
  return {bits(n.x()), bits(n.y()), bits(n.z()), bits(uv.x()), bits(uv.y())};
}

/// What a triangle gives to the tangents at its corners.
struct Derivatives {
  Vec3d tangent{0.0, 0.0, 0.0};  ///< unit dP/du
  bool preserving = false;       ///< not mirrored in the map
  bool any = true;               ///< no tangent of its own: joins any group
};

Derivatives derivatives_of(const Mesh& mesh, std::size_t triangle) {
  const std::size_t c = 3 * triangle;
  const Vec3d p = mesh.position(c).cast<double>();
  const Vec3d d1 = mesh.position(c + 1).cast<double>() - p;
  const Vec3d d2 = mesh.position(c + 2).cast<double>() - p;
  const Vec2d uv = mesh.uvs[c].cast<double>();
  const Vec2d e1 = mesh.uvs[c + 1].cast<double>() - uv;
  const Vec2d e2 = mesh.uvs[c + 2].cast<double>() - uv;
  // In (u, 1 - v): the vertical differences change their sign.
  const double t1 = -e1.y();
  const double t2 = -e2.y();
  const double area = e1.x() * t2 - t1 * e2.x();
  Derivatives d;
  d.preserving = area > 0.0;
  if (!not_zero(area)) return d;
  const Vec3d along_u = t2 * d1 - t1 * d2;
  const Vec3d along_v = e1.x() * d2 - e2.x() * d1;
  const double length = along_u.norm();
  if (not_zero(length)) d.tangent = (d.preserving ? 1.0 : -1.0) / length * along_u;
  d.any = !(not_zero(length / std::abs(area)) && not_zero(along_v.norm() / std::abs(area)));
  return d;
}

class TangentBuilder {
 public:
  explicit TangentBuilder(Mesh& mesh) : mesh_(mesh) {}

  void build() {
    weld();
    find_triangles();
    find_neighbors();
    find_groups();
    evaluate_groups();
    copy_to_degenerate();
  }

 private:
  bool degenerate(std::size_t triangle) const { return degenerate_[triangle] != 0; }

  /// vertex_: per corner, the first corner with equal position, normal and UV.
  void weld() {
    const Welding welding = weld_positions(mesh_);
    CornerLists lists = corners_of_vertices(welding.vertex, welding.vertex_count);
    vertex_.resize(mesh_.corner_count());
    parallel_for(welding.vertex_count, grain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::pair<std::array<std::uint32_t, 5>, std::uint32_t>> keys;
      for (std::size_t v = begin; v < end; ++v) {
        keys.clear();
        for (const std::uint32_t c : lists.of(v)) keys.emplace_back(attribute_key(mesh_, c), c);
        std::sort(keys.begin(), keys.end());
        for (std::size_t i = 0; i < keys.size(); ++i) {
          const bool same = i > 0 && keys[i].first == keys[i - 1].first;
          vertex_[keys[i].second] = same ? vertex_[keys[i - 1].second] : keys[i].second;
        }
      }
    });
    degenerate_.resize(mesh_.triangle_count());
    for (std::size_t t = 0; t < degenerate_.size(); ++t) {
      const std::uint32_t* v = welding.vertex.data() + 3 * t;
      degenerate_[t] = v[0] == v[1] || v[0] == v[2] || v[1] == v[2] ? 1 : 0;
    }
  }

  void find_triangles() {
    triangles_.resize(mesh_.triangle_count());
    parallel_for(triangles_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) triangles_[t] = derivatives_of(mesh_, t);
    });
  }

  void find_neighbors() {
    // pair_edges() leaves out triangles with equal vertices: that is how degenerate ones stay out.
    std::vector<std::uint32_t> ends(vertex_);
    for (std::size_t t = 0; t < degenerate_.size(); ++t) {
      if (degenerate(t)) ends[3 * t + 1] = ends[3 * t + 2] = ends[3 * t];
    }
    neighbor_ = pair_edges(ends, static_cast<std::uint32_t>(ends.size()));
  }

  void find_groups() {
    group_.assign(vertex_.size(), no_group);
    std::vector<std::uint32_t> stack;
    for (std::uint32_t corner = 0; corner < group_.size(); ++corner) {
      const Derivatives& triangle = triangles_[corner / 3];
      if (degenerate(corner / 3) || triangle.any || group_[corner] != no_group) continue;
      const std::uint32_t group = group_count_++;
      group_[corner] = group;
      stack.assign(1, corner);
      while (!stack.empty()) {
        const std::uint32_t c = stack.back();
        stack.pop_back();
        // The same vertex in the triangles across the two edges that meet at it.
        const std::uint32_t right = neighbor_[previous_corner(c)];
        const std::uint32_t left = neighbor_[c];
        if (right != no_edge) join(right, group, triangle.preserving, stack);
        if (left != no_edge) join(next_corner(left), group, triangle.preserving, stack);
      }
    }
  }

  void join(std::uint32_t corner, std::uint32_t group, bool preserving,
            std::vector<std::uint32_t>& stack) {
    if (group_[corner] != no_group) return;
    Derivatives& triangle = triangles_[corner / 3];
    const std::size_t first = corner - corner % 3;
    const bool untouched =
        group_[first] == no_group && group_[first + 1] == no_group && group_[first + 2] == no_group;
    // The first group to reach a triangle without a tangent decides how it is turned.
    if (triangle.any && untouched) triangle.preserving = preserving;
    if (triangle.preserving != preserving) return;
    group_[corner] = group;
    stack.push_back(corner);
  }

  void evaluate_groups() {
    mesh_.tangents.assign(mesh_.corner_count(), Vec4f(1.0F, 0.0F, 0.0F, -1.0F));
    for (std::uint32_t& group : group_) group = std::min(group, group_count_);
    const CornerLists members = corners_of_vertices(group_, group_count_ + 1);
    parallel_for(group_count_, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) {
        const Vec4f tangent = evaluate(members.of(g));
        for (const std::uint32_t corner : members.of(g)) mesh_.tangents[corner] = tangent;
      }
    });
  }

  Vec4f evaluate(std::span<const std::uint32_t> corners) const {
    const Vec3d n = mesh_.normals[corners[0]].cast<double>();
    Vec3d sum = Vec3d::Zero();
    for (const std::uint32_t corner : corners) {
      const Derivatives& triangle = triangles_[corner / 3];
      if (triangle.any) continue;
      const Vec3d p = mesh_.position(corner).cast<double>();
      const Vec3d a = on_plane(mesh_.position(previous_corner(corner)).cast<double>() - p, n);
      const Vec3d b = on_plane(mesh_.position(next_corner(corner)).cast<double>() - p, n);
      sum += std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * on_plane(triangle.tangent, n);
    }
    const double length = sum.norm();
    const Vec3f t = not_zero(length) ? Vec3f((sum / length).cast<float>()) : Vec3f(Vec3f::UnitX());
    return {t.x(), t.y(), t.z(), triangles_[corners[0] / 3].preserving ? 1.0F : -1.0F};
  }

  void copy_to_degenerate() {
    if (std::find(degenerate_.begin(), degenerate_.end(), 1) == degenerate_.end()) return;
    std::vector<std::uint32_t> model(vertex_.size(), no_edge);
    for (std::uint32_t corner = 0; corner < vertex_.size(); ++corner) {
      std::uint32_t& first = model[vertex_[corner]];
      if (!degenerate(corner / 3) && first == no_edge) first = corner;
    }
    for (std::uint32_t corner = 0; corner < vertex_.size(); ++corner) {
      const std::uint32_t from = model[vertex_[corner]];
      if (!degenerate(corner / 3) || from == no_edge) continue;
      mesh_.tangents[corner] = mesh_.tangents[from];
    }
  }

  Mesh& mesh_;
  std::vector<std::uint32_t> vertex_;
  std::vector<std::uint8_t> degenerate_;
  std::vector<Derivatives> triangles_;
  std::vector<std::uint32_t> neighbor_;
  std::vector<std::uint32_t> group_;
  std::uint32_t group_count_ = 0;
};

}  // namespace

void compute_tangents(Mesh& mesh) {
  if (mesh.uvs.size() != mesh.corner_count()) {
    throw InvalidInput("The mesh has no UVs (texture coordinates), which its tangents need.");
  }
  if (mesh.normals.size() != mesh.corner_count()) {
    throw InvalidInput("The mesh has no normals, which its tangents need.");
  }
  TangentBuilder(mesh).build();
}

}  // namespace normalshop
