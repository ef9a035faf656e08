#include "normalshop/document/surface_trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "normalshop/core/error.h"
#include "normalshop/surface/nearest_point.h"

namespace normalshop {

namespace {

/// Of the model's size: how far points may lie from the surface.
constexpr float farthest_share = 0.05F;
constexpr double most_points = 1e6;

std::string length_text(float number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", static_cast<double>(number));
  return text.data();
}

float weight_of(const Mesh& mesh, std::uint32_t triangle, int corner, const Vec3f& p) {
  const std::size_t first = 3 * static_cast<std::size_t>(triangle);
  const auto at = [&](int k) {
    return Vec3f(mesh.position(first + static_cast<std::size_t>((corner + k) % 3)));
  };
  const Vec3f all = (at(1) - at(0)).cross(at(2) - at(0));
  const float squared = all.squaredNorm();
  return squared > 0.0F ? (at(1) - p).cross(at(2) - p).dot(all) / squared : 0.0F;
}

/// Base normal of a triangle at a place on it.
Vec3f normal_at(const Mesh& mesh, std::uint32_t triangle, const Vec3f& p) {
  return base_normal_at(
      mesh, {triangle, weight_of(mesh, triangle, 1, p), weight_of(mesh, triangle, 2, p)});
}

/// Pieces of the path, cut to the step, and without points that lie closer than a quarter of it.
Trace sample_path(const Mesh& mesh, const SurfacePath& path, const SurfaceStroke& stroke,
                  float step) {
  Trace out;
  std::size_t leg = 0;
  const auto pressure_at = [&](double along) {
    while (leg + 2 < path.given.size() && along > path.lengths[path.given[leg + 1]]) ++leg;
    if (leg + 1 >= path.given.size()) return stroke.front().pressure;
    const double a = path.lengths[path.given[leg]];
    const double b = path.lengths[path.given[leg + 1]];
    const auto t = static_cast<float>(b > a ? std::clamp((along - a) / (b - a), 0.0, 1.0) : 0.0);
    return stroke[leg].pressure + t * (stroke[leg + 1].pressure - stroke[leg].pressure);
  };
  const auto add = [&](const Vec3d& position, std::uint32_t triangle, double along) {
    const Vec3f p = position.cast<float>();
    const Vec3f normal = normal_at(mesh, triangle, p);
    out.push_back({p, normal, normal, triangle, pressure_at(along), static_cast<float>(along)});
  };
  const auto is_given = [&](std::size_t i) {
    return std::binary_search(path.given.begin(), path.given.end(), i);
  };
  add(path.positions[0], path.points[0].triangle, 0.0);
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const double length = path.lengths[i + 1] - path.lengths[i];
    const auto pieces = static_cast<int>(
        std::clamp(std::ceil(length / static_cast<double>(step)), 1.0, most_points));
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      const double along = path.lengths[i] + t * length;
      const bool close =
          along - static_cast<double>(out.back().along) < 0.25 * static_cast<double>(step);
      if (close && !is_given(i + 1)) continue;
      const bool ends = k == pieces;
      add(path.positions[i] + t * (path.positions[i + 1] - path.positions[i]),
          path.points[ends ? i + 1 : i].triangle, along);
    }
  }
  return out;
}

void face(Trace& trace, float around) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < trace.size(); ++i) {
    while (trace[first].along < trace[i].along - around) ++first;
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = first; k < trace.size() && trace[k].along <= trace[i].along + around;
         ++k) {
      const std::size_t before = k > 0 ? k - 1 : k;
      const std::size_t after = k + 1 < trace.size() ? k + 1 : k;
      const float counts = std::max(1e-6F * around, trace[after].along - trace[before].along);
      sum += counts * trace[k].normal;
    }
    trace[i].facing = sum.norm() > 0.0F ? Vec3f(sum.normalized()) : trace[i].normal;
  }
}

}  // namespace

SurfacePoint surface_point_near(const Mesh& mesh, const Vec3f& position, const std::string& field) {
  const float limit = farthest_share * bounds(mesh).diagonal();
  const SurfacePoint point = nearest_surface_point(mesh, position);
  const float distance = (position_at(mesh, point) - position).norm();
  if (distance <= limit) return point;
  throw InvalidInput(field + " must lie within " + length_text(limit) +
                     " object units (a twentieth of the model's size) of the surface, not " +
                     length_text(distance));
}

std::vector<Trace> trace_strokes(const Edit& edit, const Mesh& mesh, const Topology& topology,
                                 const TraceOptions& options) {
  std::vector<Trace> traces;
  for (std::size_t i = 0; i < edit.surface_strokes.size(); ++i) {
    const std::string field = edit.path + ".strokes[" + std::to_string(i) + "]";
    const SurfaceStroke& stroke = edit.surface_strokes[i];
    std::vector<SurfacePoint> points;
    for (std::size_t j = 0; j < stroke.size(); ++j) {
      points.push_back(
          surface_point_near(mesh, stroke[j].position, field + "[" + std::to_string(j) + "]"));
    }
    try {
      traces.push_back(sample_path(mesh, geodesic(mesh, topology, points), stroke, options.step));
    } catch (const InvalidInput& error) {
      throw InvalidInput(field + ": " + error.what());
    }
    face(traces.back(), options.around);
  }
  return traces;
}

}  // namespace normalshop
