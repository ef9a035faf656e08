#include "normalshop/chart/splat.h"

#include <algorithm>
#include <cmath>

namespace normalshop {

namespace {

/// Stretches the plane so that nothing in `cell` (columns: its sides) is narrower than a pixel.
Mat2f widening(const Mat2f& cell) {
  const Mat2f a = cell * cell.transpose();
  const float middle = 0.5F * (a(0, 0) + a(1, 1));
  const float half = 0.5F * (a(0, 0) - a(1, 1));
  const float radius = std::sqrt(half * half + a(0, 1) * a(0, 1));
  Vec2f axis(half + radius, a(0, 1));  // the longer
  if (half < 0.0F) axis = {a(0, 1), radius - half};
  axis = radius > 0.0F ? Vec2f(axis.normalized()) : Vec2f(1.0F, 0.0F);
  const float area = std::abs(cell(0, 0) * cell(1, 1) - cell(0, 1) * cell(1, 0));
  const float longer = std::sqrt(middle + radius);
  const float along = std::max(1.0F, 1.0F / longer);
  const float across = std::max(1.0F, longer / area);
  return across * Mat2f::Identity() + (along - across) * axis * axis.transpose();
}

}  // namespace

void Splat::load(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                 std::uint32_t id) {
  *this = {};
  PushTriangle triangle;
  triangle.load(mesh, grid, id);
  const TexelAffine& affine = storage.sets[mesh.texture_sets[id]].texels.affines()[id];
  Mat2f cell;
  cell.col(0) = (triangle.points.rightCols<2>() * affine.db_dx).head<2>();
  cell.col(1) = (triangle.points.rightCols<2>() * affine.db_dy).head<2>();
  depth_step = triangle.depth_step;
  const float area = cell(0, 0) * cell(1, 1) - cell(0, 1) * cell(1, 0);
  if (!(std::abs(area) > 1e-4F * cell.squaredNorm())) return;  // edge-on: it covers no pixel
  Mat2f adjugate;
  adjugate << cell(1, 1), -cell(0, 1), -cell(1, 0), cell(0, 0);
  to_texel = adjugate / area;
  const Mat2f widen = widening(cell);
  const Mat2f wide = widen * cell;
  const float wide_area = wide(0, 0) * wide(1, 1) - wide(0, 1) * wide(1, 0);
  adjugate << wide(1, 1), -wide(0, 1), -wide(1, 0), wide(0, 0);
  to_wide = adjugate / wide_area;
  wide_back = 0.5F * triangle.steepness;
  widened = !widen.isIdentity(1e-3F);
  ring_back =
      std::abs(depth_step.dot(wide.col(0))) + std::abs(depth_step.dot(wide.col(1))) + grid.pixel;
  if (!to_texel.allFinite() || !to_wide.allFinite() || !std::isfinite(ring_back)) return;
  reach = (wide.col(0).cwiseAbs() + wide.col(1).cwiseAbs()).cwiseMin(largest_splat);
}

}  // namespace normalshop
