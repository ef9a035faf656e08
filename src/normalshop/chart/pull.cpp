#include "normalshop/chart/pull.h"

#include "normalshop/chart/chart_triangle.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Charts are pulled in squares of this side, which read a small part of the atlas each.
constexpr int block = 32;

/// A triangle with everything else that its pixels share.
struct PixelTriangle : ChartTriangle {
  std::uint32_t texture_set = 0;
  Vec2f dx = Vec2f::Zero();  // of the weights of corners 1 and 2, per pixel from corner 0
  Vec2f dy = Vec2f::Zero();
  Vec2f uv = Vec2f::Zero();
  Vec2f uv1 = Vec2f::Zero();  // corner 1 - corner 0
  Vec2f uv2 = Vec2f::Zero();

  void load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle);
  Vec3f weights(int x, int y) const;
};

void PixelTriangle::load(const Mesh& mesh, const ChartGrid& grid, std::uint32_t triangle) {
  ChartTriangle::load(mesh, grid, triangle);
  const Vec3f ab = points.col(1);
  const Vec3f ac = points.col(2);
  const float area = ab.x() * ac.y() - ac.x() * ab.y();
  const float inverse = area != 0.0F ? 1.0F / area : 0.0F;
  dx = {ac.y() * inverse, -ab.y() * inverse};
  dy = {-ac.x() * inverse, ab.x() * inverse};
  const std::size_t corner = 3 * static_cast<std::size_t>(triangle);
  uv = mesh.uvs[corner];
  uv1 = mesh.uvs[corner + 1] - uv;
  uv2 = mesh.uvs[corner + 2] - uv;
  texture_set = mesh.texture_sets[triangle];
}

/// (1, b1, b2), pushed back into the triangle: a pixel centre may lie a rounding outside it.
Vec3f PixelTriangle::weights(int x, int y) const {
  const float px = static_cast<float>(x) - points(0, 0);
  const float py = static_cast<float>(y) - points(1, 0);
  const float b1 = std::clamp(px * dx.x() + py * dy.x(), 0.0F, 1.0F);
  const float b2 = std::clamp(px * dx.y() + py * dy.y(), 0.0F, 1.0F);
  const float sum = b1 + b2;
  return sum > 1.0F ? Vec3f(1.0F, b1 / sum, b2 / sum) : Vec3f(1.0F, b1, b2);
}

/// The pull of one chart.
class Pull {
 public:
  Pull(const StorageAtlas& storage, const PullOptions& options, EditingChart& chart)
      : storage_(storage), options_(options), chart_(chart) {}

  using Cache = TriangleCache<PixelTriangle>;
  void fill(const Rect& rect, Cache& triangles) const {
    for (int y = rect.y0; y < rect.y1; ++y) fill_row(y, rect.x0, rect.x1, triangles);
  }

 private:
  void fill_row(int y, int x0, int x1, Cache& triangles) const;
  void clear(int x, int y) const;
  void read(const PixelTriangle& triangle, int x, int y) const;

  const StorageAtlas& storage_;
  const PullOptions& options_;
  EditingChart& chart_;
};

void Pull::fill_row(int y, int x0, int x1, Cache& triangles) const {
  const std::uint32_t* ids = chart_.ids.triangle.row(y);
  std::uint32_t last = no_triangle;
  const PixelTriangle* triangle = nullptr;
  for (int x = x0; x < x1; ++x) {
    if (ids[x] == no_triangle) {
      clear(x, y);
      continue;
    }
    if (ids[x] != last) {
      last = ids[x];
      triangle = &triangles.get(last);
    }
    read(*triangle, x, y);
  }
}

void Pull::clear(int x, int y) const {
  chart_.base_normal(x, y).setZero();
  if (options_.normals) chart_.normal(x, y).setZero();
  if (options_.albedo) chart_.albedo(x, y).setZero();
}

void Pull::read(const PixelTriangle& triangle, int x, int y) const {
  const Vec3f weights = triangle.weights(x, y);
  const Vec3f n = triangle.normals * weights;
  const Vec2f uv = triangle.uv + weights.y() * triangle.uv1 + weights.z() * triangle.uv2;
  const Vec3f base = n * (1.0F / n.norm());
  chart_.base_normal(x, y) = base;
  const StorageSet& set = storage_.sets[triangle.texture_set];
  if (options_.normals) {
    const NormalSpace space = set.normals.convention().space;
    const Vec3f detail =
        triangle.frame(weights, n, space, chart_.grid.view) * set.normals.sample(uv);
    const float length = detail.norm();
    chart_.normal(x, y) = length > 1e-6F ? Vec3f(detail * (1.0F / length)) : base;
  }
  if (options_.albedo) chart_.albedo(x, y) = set.albedo.sample(uv);
}

}  // namespace

void pull_attributes(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart,
                     const PullOptions& options) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  chart.base_normal.resize(width, height);
  chart.normal.resize(options.normals ? width : 0, options.normals ? height : 0);
  chart.albedo.resize(options.albedo ? width : 0, options.albedo ? height : 0);
  const Pull pull(storage, options, chart);
  const int columns = (width + block - 1) / block;
  const int rows = (height + block - 1) / block;
  const auto fill = [&](std::size_t begin, std::size_t end) {
    Pull::Cache triangles(mesh, chart.grid);
    for (std::size_t i = begin; i < end; ++i) {
      const int x = static_cast<int>(i) % columns * block;
      const int y = static_cast<int>(i) / columns * block;
      pull.fill(intersect({x, y, x + block, y + block}, chart.ids.triangle.rect()), triangles);
    }
  };
  parallel_for(static_cast<std::size_t>(columns * rows), 16, fill);
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
