#include "normalshop/surface/unwrap.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/surface/detail/atlas_chart.h"
#include "normalshop/surface/detail/atlas_packing.h"

namespace normalshop {

namespace {

using unwrapping::AtlasChart;
using unwrapping::FlatTriangle;
using unwrapping::Surface;

/// Overlaps less deep than this share of the map are rounding of UVs.
constexpr double uv_rounding = 1.5e-7;

std::string number_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

void check_options(const UnwrapOptions& options) {
  for_each_field<UnwrapOptions>([&](const auto& f) {
    const auto value = static_cast<double>(options.*f.member);
    if (f.min == f.max || (value >= f.min && value <= f.max)) return;
    throw InvalidInput("unwrap: " + std::string(f.name) + " must be from " + number_text(f.min) +
                       " to " + number_text(f.max));
  });
}

void check_mesh(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw InvalidInput("unwrap: the mesh has no triangles");
  for (const Vec3u& t : mesh.triangles) {
    if (t.maxCoeff() >= mesh.positions.size()) {
      throw InvalidInput("unwrap: a triangle names a position that the mesh does not have");
    }
  }
  for (const Vec3f& p : mesh.positions) {
    if (!p.allFinite()) throw InvalidInput("unwrap: the positions must be finite numbers");
  }
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.corner_count()) {
    throw InvalidInput("unwrap: the mesh needs normals at every corner or none");
  }
}

std::vector<AtlasChart> make_charts(const Surface& surface, const UnwrapOptions& options,
                                    const Progress& progress) {
  constexpr double radians = 0.017453292519943295;
  const unwrapping::ChartLimits limits{std::cos(radians * static_cast<double>(options.angle)),
                                       static_cast<double>(options.stretch)};
  progress.at(0.1, "growing charts");
  std::vector<AtlasChart> charts = unwrapping::partition(surface, limits);
  progress.at(0.3, "splitting and merging charts");
  // Twice: straight borders may split charts anew.
  for (int pass = 0; pass < 2; ++pass) {
    charts = unwrapping::straighten(surface, charts, limits);
    charts = unwrapping::make_valid(surface, std::move(charts), limits);
    charts = unwrapping::merge(surface, std::move(charts), limits);
  }
  return unwrapping::make_valid(surface, std::move(charts), limits);
}

/// Every chart has as large an area in its plane as on the surface.
std::vector<unwrapping::PackShape> make_shapes(const Surface& surface,
                                               const std::vector<AtlasChart>& charts) {
  std::vector<unwrapping::PackShape> shapes(charts.size());
  parallel_for(charts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const unwrapping::ChartPlane plane(charts[i].direction);
      double area = 0.0;
      double shown = 0.0;
      for (const std::uint32_t t : charts[i].triangles) {
        area += surface.area[t];
        shown += surface.area[t] * surface.normal[t].dot(charts[i].direction);
      }
      const double scale = std::sqrt(area / shown);
      for (const std::uint32_t t : charts[i].triangles) {
        for (std::size_t c = std::size_t{3} * t, end_corner = c + 3; c < end_corner; ++c) {
          shapes[i].corners.emplace_back(scale * plane(surface.points[c]));
        }
      }
    }
  });
  return shapes;
}

/// Triangles in no chart have no area: they lie in one point where a chart has a vertex of theirs.
void place_left_out(const Surface& surface, const std::vector<char>& placed,
                    std::vector<Vec2f>& uvs) {
  std::vector<std::uint32_t> corner_of(surface.vertex_count, unwrapping::none);
  for (std::uint32_t c = 0; c < uvs.size(); ++c) {
    if (placed[c / 3] != 0) corner_of[surface.vertex[c]] = c;
  }
  for (std::uint32_t t = 0; t < placed.size(); ++t) {
    if (placed[t] != 0) continue;
    for (std::uint32_t c = 3 * t; c < 3 * t + 3; ++c) {
      const std::uint32_t known = corner_of[surface.vertex[c]];
      if (known == unwrapping::none) continue;
      std::fill_n(uvs.begin() + std::ptrdiff_t{3} * t, 3, Vec2f(uvs[known]));
      break;
    }
  }
}

std::vector<Vec2f> place_charts(const Surface& surface, const std::vector<AtlasChart>& charts,
                                const UnwrapOptions& options) {
  const std::vector<unwrapping::PackShape> shapes = make_shapes(surface, charts);
  const unwrapping::Packing packing =
      unwrapping::pack(shapes, static_cast<double>(options.gutter) / options.size);
  std::vector<Vec2f> uvs(3 * surface.size(), Vec2f::Zero());
  std::vector<char> placed(surface.size(), 0);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const unwrapping::PackPlace& place = packing.places[i];
    auto from = shapes[i].corners.begin();
    for (const std::uint32_t t : charts[i].triangles) {
      placed[t] = 1;
      for (std::size_t c = std::size_t{3} * t, end = c + 3; c < end; ++c, ++from) {
        const Vec2d p = packing.scale * *from;
        const double u = place.turn.x() * p.x() - place.turn.y() * p.y() + place.offset.x();
        const double v = place.turn.y() * p.x() + place.turn.x() * p.y() + place.offset.y();
        uvs[c] = Vec2d(u, 1.0 - v).cwiseMax(0.0).cwiseMin(1.0).cast<float>();
      }
    }
  }
  place_left_out(surface, placed, uvs);
  return uvs;
}

/// Of what was written, not of what was meant.
UnwrapReport report_on(const Surface& surface, const std::vector<Vec2f>& uvs) {
  UnwrapReport report;
  report.triangles = surface.size();
  std::vector<FlatTriangle> flat;
  std::vector<double> shown(surface.size(), 0.0);
  double area = 0.0;
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    if (!surface.has_area(t)) {
      ++report.degenerate;
      continue;
    }
    FlatTriangle triangle{{}, t};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d uv = uvs[std::size_t{3} * t + k].cast<double>();
      triangle.corner[k] = {uv.x(), 1.0 - uv.y()};
    }
    shown[t] = 0.5 * cross(Vec2d(triangle.corner[1] - triangle.corner[0]),
                           Vec2d(triangle.corner[2] - triangle.corner[0]));
    area += surface.area[t];
    report.coverage += std::abs(shown[t]);
    if (shown[t] < 0.0) ++report.turned_over;
    if (shown[t] > 0.0) flat.push_back(triangle);
  }
  double sum = 0.0;
  for (std::uint32_t t = 0; t < surface.size(); ++t) {
    if (!(shown[t] > 0.0)) continue;
    const double ratio = shown[t] / surface.area[t] * (area / report.coverage);
    const double stretch = std::max(ratio, 1.0 / ratio);
    sum += surface.area[t] * stretch;
    report.largest_stretch = std::max(report.largest_stretch, stretch);
  }
  report.mean_stretch = sum / area;
  report.overlaps = unwrapping::overlapping_pairs(flat, uv_rounding).size();
  return report;
}

}  // namespace

UnwrapReport unwrap(Mesh& mesh, const UnwrapOptions& options, const Progress& progress) {
  check_options(options);
  check_mesh(mesh);
  progress.at(0.0, "reading the surface");
  const Surface surface = unwrapping::make_surface(mesh, !options.across_hard_edges);
  if (std::none_of(surface.area.begin(), surface.area.end(), [](double a) { return a > 0.0; })) {
    throw InvalidInput("unwrap: no triangle of the mesh has an area");
  }
  const std::vector<AtlasChart> charts = make_charts(surface, options, progress);
  progress.at(0.5, "packing charts");
  std::vector<Vec2f> uvs = place_charts(surface, charts, options);
  progress.at(0.9, "measuring the atlas");
  UnwrapReport report = report_on(surface, uvs);
  report.charts = charts.size();
  progress.at(1.0, "unwrapped");
  mesh.uvs = std::move(uvs);
  mesh.tangents.clear();
  mesh.texture_sets.assign(mesh.triangle_count(), 0);
  if (mesh.texture_set_names.size() != 1) mesh.texture_set_names = {"surface"};
  return report;
}

}  // namespace normalshop
