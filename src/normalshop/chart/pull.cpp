#include "normalshop/chart/pull.h"

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Everything about a triangle that its pixels share.
struct PixelLookup {
  std::uint32_t triangle = no_triangle;
  const StorageSet* set = nullptr;
  ChartTriangle frame;
  Vec2f dx = Vec2f::Zero();  // of the weights of corners 1 and 2, per pixel from corner 0
  Vec2f dy = Vec2f::Zero();
  Eigen::Matrix<float, 2, 3> uvs = Eigen::Matrix<float, 2, 3>::Zero();
  NormalSpace space = NormalSpace::Tangent;

  void load(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid, std::uint32_t t);
  Vec2f weights(int x, int y) const;
};

void PixelLookup::load(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                       std::uint32_t t) {
  triangle = t;
  frame.load(mesh, grid, t);
  const Vec3f ab = frame.points.col(1);
  const Vec3f ac = frame.points.col(2);
  const float area = ab.x() * ac.y() - ac.x() * ab.y();
  const float inverse = area != 0.0F ? 1.0F / area : 0.0F;
  dx = {ac.y() * inverse, -ab.y() * inverse};
  dy = {-ac.x() * inverse, ab.x() * inverse};
  const std::size_t corner = 3 * static_cast<std::size_t>(t);
  uvs.col(0) = mesh.uvs[corner];
  uvs.col(1) = mesh.uvs[corner + 1] - mesh.uvs[corner];
  uvs.col(2) = mesh.uvs[corner + 2] - mesh.uvs[corner];
  set = &storage.sets[mesh.texture_sets[t]];
  space = set->normals.convention().space;
}

/// Pushed back into the triangle: a pixel centre may lie a rounding outside it.
Vec2f PixelLookup::weights(int x, int y) const {
  Vec2f w = (static_cast<float>(x) - frame.points(0, 0)) * dx +
            (static_cast<float>(y) - frame.points(1, 0)) * dy;
  w = w.cwiseMax(0.0F).cwiseMin(1.0F);
  const float sum = w.sum();
  return sum > 1.0F ? Vec2f(w / sum) : w;
}

void pull_pixel(const PixelLookup& look, int x, int y, const PullOptions& options,
                EditingChart& chart) {
  const Vec2f w = look.weights(x, y);
  const Vec3f weights(1.0F, w.x(), w.y());
  const Vec3f n = look.frame.normals * weights;
  const Vec2f uv = look.uvs * weights;
  const Vec3f base = n.normalized();
  chart.base_normal(x, y) = base;
  if (options.normals) {
    const Mat3f frame = look.frame.frame(weights, n, look.space, chart.grid.view);
    const Vec3f detail = frame * look.set->normals.sample(uv);
    const float length = detail.norm();
    chart.normal(x, y) = length > 1e-6F ? Vec3f(detail / length) : base;
  }
  if (options.albedo) chart.albedo(x, y) = look.set->albedo.sample(uv);
}

void pull_row(const Mesh& mesh, const StorageAtlas& storage, int y, const PullOptions& options,
              EditingChart& chart) {
  PixelLookup look;
  const std::uint32_t* ids = chart.ids.triangle.row(y);
  for (int x = 0; x < chart.grid.width(); ++x) {
    if (ids[x] == no_triangle) {
      chart.base_normal(x, y) = Vec3f::Zero();
      if (options.normals) chart.normal(x, y) = Vec3f::Zero();
      if (options.albedo) chart.albedo(x, y) = Vec3f::Zero();
      continue;
    }
    if (ids[x] != look.triangle) look.load(mesh, storage, chart.grid, ids[x]);
    pull_pixel(look, x, y, options, chart);
  }
}

}  // namespace

void pull_attributes(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart,
                     const PullOptions& options) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  chart.base_normal.resize(width, height);
  chart.normal.resize(options.normals ? width : 0, options.normals ? height : 0);
  chart.albedo.resize(options.albedo ? width : 0, options.albedo ? height : 0);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      pull_row(mesh, storage, static_cast<int>(y), options, chart);
    }
  });
}

void pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
          const PullOptions& options, Rasterizer& rasterizer, EditingChart& chart) {
  chart.grid = grid;
  rasterizer.rasterize(mesh, grid, chart.ids);
  pull_attributes(mesh, storage, chart, options);
}

EditingChart pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                  const PullOptions& options) {
  EditingChart chart;
  Rasterizer rasterizer;
  pull(mesh, storage, grid, options, rasterizer, chart);
  return chart;
}

}  // namespace normalshop
