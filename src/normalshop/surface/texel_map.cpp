#include "normalshop/surface/texel_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/surface/detail/gutter.h"
#include "normalshop/surface/detail/texel_bands.h"
#include "normalshop/surface/detail/texel_raster.h"
#include "normalshop/surface/topology.h"

namespace normalshop {
namespace {

constexpr int max_size = 65536;
/// UVs beyond this, and triangles over more maps than this, are no atlas but damage.
constexpr double max_uv = 1 << 20;
constexpr double max_maps = 1024.0;
/// Twice the smallest area, in texels, for which weights mean anything.
constexpr double min_area = 1e-12;

using Corners = std::array<Vec2d, 3>;

Corners texel_corners(const Mesh& mesh, const Period& period, std::size_t triangle) {
  return {period.texels(mesh.uvs[3 * triangle]), period.texels(mesh.uvs[3 * triangle + 1]),
          period.texels(mesh.uvs[3 * triangle + 2])};
}

bool usable(const Mesh& mesh, std::size_t triangle) {
  const auto uv = [&](std::size_t k) { return mesh.uvs[3 * triangle + k].cast<double>(); };
  const Vec2d low = uv(0).cwiseMin(uv(1)).cwiseMin(uv(2));
  const Vec2d high = uv(0).cwiseMax(uv(1)).cwiseMax(uv(2));
  // Written so that NaN fails.
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(uv(k).cwiseAbs().maxCoeff() <= max_uv)) return false;
  }
  return (high - low).maxCoeff() <= max_maps;
}

TexelAffine affine_of(const Corners& p, const Period& period) {
  TexelAffine affine;
  const Vec2d e1 = p[1] - p[0];
  const Vec2d e2 = p[2] - p[0];
  const double area = e1.x() * e2.y() - e1.y() * e2.x();
  affine.degenerate = !(std::abs(area) > min_area);
  if (affine.degenerate) return affine;
  const Vec2d low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
  const Vec2d high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  // The period in which the triangle begins.
  const Vec2d shift(std::floor(low.x() / period.width) * period.width,
                    std::floor(low.y() / period.height) * period.height);
  affine.wraps =
      static_cast<double>(TexelTriangle::first_centre(high.x())) > shift.x() + period.width ||
      static_cast<double>(TexelTriangle::first_centre(high.y())) > shift.y() + period.height;
  const Vec2d near(std::floor(p[0].x()), std::floor(p[0].y()));
  const Vec2d d = near + Vec2d(0.5, 0.5) - p[0];
  const Vec2d x_gradient(e2.y() / area, -e1.y() / area);
  const Vec2d y_gradient(-e2.x() / area, e1.x() / area);
  affine.x0 = static_cast<float>(near.x() - shift.x());
  affine.y0 = static_cast<float>(near.y() - shift.y());
  affine.origin_weights = (d.x() * x_gradient + d.y() * y_gradient).cast<float>();
  affine.db_dx = x_gradient.cast<float>();
  affine.db_dy = y_gradient.cast<float>();
  return affine;
}

/// Fills one band of owners and finds its shared texels.
class BandFiller {
 public:
  BandFiller(Image<std::uint32_t>& owner, int band)
      : owner_(owner),
        first_(band * band_rows),
        last_(std::min(first_ + band_rows, owner.height())) {
    for (int y = first_; y < last_; ++y) {
      std::fill_n(owner_.row(y), owner_.width(), no_triangle);
    }
  }

  void add(std::uint32_t index, const TexelTriangle& triangle) {
    const GridRange& rows = triangle.rows();
    if (rows.begin >= 0 && rows.end <= owner_.height()) {
      const auto end = static_cast<int>(std::min<std::int64_t>(rows.end, last_));
      for (int y = static_cast<int>(std::max<std::int64_t>(rows.begin, first_)); y < end; ++y) {
        add_row(index, y, triangle.columns(y));
      }
      return;
    }
    for (int y = first_; y < last_; ++y) add_wrapped_row(index, y, triangle);
  }

  std::vector<SharedTexel> shared() {
    const auto key = [](const SharedTexel& s) { return std::tuple(s.texel, s.triangle); };
    std::sort(shared_.begin(), shared_.end(),
              [&](const SharedTexel& a, const SharedTexel& b) { return key(a) < key(b); });
    const auto last =
        std::unique(shared_.begin(), shared_.end(),
                    [&](const SharedTexel& a, const SharedTexel& b) { return key(a) == key(b); });
    shared_.erase(last, shared_.end());
    return std::move(shared_);
  }

 private:
  void add_wrapped_row(std::uint32_t index, int y, const TexelTriangle& triangle) {
    const GridRange& rows = triangle.rows();
    for (std::int64_t row = first_at_or_after(rows.begin, y, owner_.height()); row < rows.end;
         row += owner_.height()) {
      const GridRange columns = triangle.columns(row);
      add_row(index, y, columns);
      if (columns.size() >= owner_.width()) return;
    }
  }

  void add_row(std::uint32_t index, int y, const GridRange& columns) {
    const std::int64_t width = owner_.width();
    if (columns.size() <= 0) return;
    if (columns.begin >= 0 && columns.end <= width) return add_span(index, y, columns);
    if (columns.size() >= width) return add_span(index, y, {0, width});
    const std::int64_t begin = wrap(columns.begin, width);
    const std::int64_t end = begin + columns.size();
    add_span(index, y, {begin, std::min(end, width)});
    add_span(index, y, {0, std::max<std::int64_t>(0, end - width)});
  }

  void add_span(std::uint32_t index, int y, const GridRange& columns) {
    std::uint32_t* row = owner_.row(y);
    const auto row_start =
        static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(owner_.width());
    for (std::int64_t x = columns.begin; x < columns.end; ++x) {
      if (row[x] == no_triangle) {
        row[x] = index;
      } else if (row[x] != index) {
        shared_.push_back({row_start + static_cast<std::uint32_t>(x), index});
      }
    }
  }

  Image<std::uint32_t>& owner_;
  int first_;
  int last_;
  std::vector<SharedTexel> shared_;
};

void check(const Mesh& mesh, int width, int height, int gutter) {
  if (mesh.uvs.size() != mesh.corner_count()) {
    throw InvalidInput("The mesh has no UVs (texture coordinates), which its map needs.");
  }
  if (width < 1 || height < 1 || width > max_size || height > max_size) {
    throw InvalidInput("A map of " + std::to_string(width) + " x " + std::to_string(height) +
                       " texels is not possible: 1 to 65536 a side are.");
  }
  if (gutter < 0 || gutter > 256) {
    throw InvalidInput("A gutter of " + std::to_string(gutter) +
                       " texels is not possible: 0 to 256 are.");
  }
}

}  // namespace

TexelMap::TexelMap(const Mesh& mesh, std::uint32_t texture_set, int width, int height, int gutter)
    : TexelMap(mesh, gutter > 0 ? make_topology(mesh) : Topology(), texture_set, width, height,
               gutter) {}

TexelMap::TexelMap(const Mesh& mesh, const Topology& topology, std::uint32_t texture_set, int width,
                   int height, int gutter)
    : texture_set_(texture_set) {
  check(mesh, width, height, gutter);
  owner_.resize(width, height);
  find_owners(mesh);
  if (gutter == 0) return;
  gutter_ = grow_gutter(
      {mesh, topology, affines_, owner_, mesh.repeats(texture_set), !shared_.empty()}, gutter);
}

void TexelMap::find_owners(const Mesh& mesh) {
  const Period period{width(), height()};
  affines_.resize(mesh.triangle_count());
  std::vector<GridRange> rows(mesh.triangle_count());
  parallel_for(mesh.triangle_count(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      affines_[t].degenerate = true;
      if (mesh.texture_sets[t] != texture_set_ || !usable(mesh, t)) continue;
      const Corners corners = texel_corners(mesh, period, t);
      affines_[t] = affine_of(corners, period);
      if (!affines_[t].degenerate) rows[t] = TexelTriangle(corners).rows();
    }
  });
  const Bands bands(rows, height());
  std::vector<std::vector<SharedTexel>> shared(band_count(height()));
  parallel_for(shared.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t band = begin; band < end; ++band) {
      BandFiller filler(owner_, static_cast<int>(band));
      for (const std::uint32_t t : bands.items(band)) {
        filler.add(t, TexelTriangle(texel_corners(mesh, period, t)));
      }
      shared[band] = filler.shared();
    }
  });
  for (const auto& part : shared) shared_.insert(shared_.end(), part.begin(), part.end());
}

namespace {

/// The middle of what a triangle holds of a row of the grid.
float middle_of_row(const TexelAffine& a, float y) {
  const Vec2f origin = a.at(0.0F, y);
  const Vec3f weights(1.0F - origin.x() - origin.y(), origin.x(), origin.y());
  const Vec3f steps(-a.db_dx.x() - a.db_dx.y(), a.db_dx.x(), a.db_dx.y());
  float low = -3e38F;
  float high = 3e38F;
  for (int k = 0; k < 3; ++k) {
    if (steps[k] > 0.0F) low = std::max(low, -weights[k] / steps[k]);
    if (steps[k] < 0.0F) high = std::min(high, -weights[k] / steps[k]);
  }
  return 0.5F * low + 0.5F * high;
}

/// Lower and upper end of a triangle's rows, from the inverse of its affine map.
Vec2f rows_of(const TexelAffine& a) {
  const float inverse = 1.0F / (a.db_dx.x() * a.db_dy.y() - a.db_dy.x() * a.db_dx.y());
  const float y0 =
      a.y0 + inverse * (a.origin_weights.x() * a.db_dx.y() - a.origin_weights.y() * a.db_dx.x());
  const float y1 = y0 - inverse * a.db_dx.y();
  const float y2 = y0 + inverse * a.db_dx.x();
  return {std::min({y0, y1, y2}), std::max({y0, y1, y2})};
}

}  // namespace

CoverageReader covered_texels(const TexelMap& texels) {
  return [&texels](int x, int count, int y, float* coverage) {
    const std::uint32_t* owner = texels.owner().row(y) + x;
    for (int i = 0; i < count; ++i) coverage[i] = owner[i] == no_triangle ? 0.0F : 1.0F;
  };
}

SurfacePoint TexelMap::surface_point(std::uint32_t triangle, int x, int y) const {
  const TexelAffine& a = affines_[triangle];
  const Vec2f here = a.at(static_cast<float>(x), static_cast<float>(y));
  if (!a.wraps) return {triangle, here.x(), here.y()};
  SurfacePoint best{triangle, here.x(), here.y()};
  float most_inside = std::min({here.x(), here.y(), 1.0F - here.x() - here.y()});
  const Vec2f rows = rows_of(a);
  const auto columns = static_cast<float>(width());
  // In each row the two repetitions around the middle are the most inside.
  for (int row = y; static_cast<float>(row) < rows.y() + 1.0F; row += height()) {
    const auto sy = static_cast<float>(row);
    if (sy < rows.x() - 1.0F) continue;
    const float maps = std::floor((middle_of_row(a, sy) - static_cast<float>(x)) / columns);
    for (const float shift : {maps, maps + 1.0F}) {
      const Vec2f b = a.at(static_cast<float>(x) + shift * columns, sy);
      const float inside = std::min({b.x(), b.y(), 1.0F - b.x() - b.y()});
      if (!(inside > most_inside)) continue;
      most_inside = inside;
      best = {triangle, b.x(), b.y()};
    }
  }
  return best;
}

}  // namespace normalshop
