#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/visible_weight.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "normalshop/chart/visible_weight.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, TexelBatch::padding>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
using M = hn::Mask<D>;

/// Points of the front side, in marked blocks.
HWY_INLINE M active_points(const Image<std::int32_t>& blocks, const TexelBatch& batch,
                           std::size_t i) {
  const D d;
  const DI di;
  const V bx = hn::Load(d, &batch.base.x[i]);
  const V by = hn::Load(d, &batch.base.y[i]);
  const V bz = hn::Load(d, &batch.base.z[i]);
  const V squared = hn::Add(hn::Add(hn::Mul(bx, bx), hn::Mul(by, by)), hn::Mul(bz, bz));
  const M front = hn::And(
      hn::Gt(bz, hn::Zero(d)),
      hn::Gt(hn::Mul(bz, bz), hn::Mul(hn::Set(d, grazing_cosine * grazing_cosine), squared)));
  const V x = hn::Load(d, &batch.point.x[i]);
  const V y = hn::Load(d, &batch.point.y[i]);
  const V least = hn::Set(d, -1.0F);
  const M inside =
      hn::And(hn::And(hn::Gt(x, least), hn::Gt(y, least)),
              hn::And(hn::Lt(x, hn::Set(d, static_cast<float>(edit_block * blocks.width()))),
                      hn::Lt(y, hn::Set(d, static_cast<float>(edit_block * blocks.height())))));
  // Towards zero: what lies half a pixel outside belongs to the first block.
  constexpr int shift = 3;
  static_assert(edit_block == 1 << shift);
  const VI column = hn::ShiftRight<shift>(hn::ConvertTo(di, hn::IfThenElseZero(inside, x)));
  const VI row = hn::ShiftRight<shift>(hn::ConvertTo(di, hn::IfThenElseZero(inside, y)));
  const VI at = hn::Add(hn::Mul(row, hn::Set(di, blocks.width())), column);
  const VI marked = hn::GatherIndex(di, blocks.data(), at);
  return hn::And(hn::And(inside, front), hn::RebindMask(d, hn::Gt(marked, hn::Zero(di))));
}

struct Sum {
  V weight;
  V share;
};

/// One of the four pixels around the points.
HWY_INLINE void add_pixel(const EditingChart& chart, VI x, VI y, V expected, V tolerance, V share,
                          M active, Sum& sum) {
  const D d;
  const DI di;
  const VI zero = hn::Zero(di);
  const VI right = hn::Set(di, chart.ids.depth.width() - 1);
  const VI bottom = hn::Set(di, chart.ids.depth.height() - 1);
  const VI cx = hn::Min(hn::Max(x, zero), right);
  const VI cy = hn::Min(hn::Max(y, zero), bottom);
  const auto inside = hn::And(hn::Eq(cx, x), hn::Eq(cy, y));
  const VI at = hn::Add(hn::Mul(cy, hn::Set(di, chart.ids.depth.width())), cx);
  const V depth = hn::GatherIndex(d, chart.ids.depth.data(), at);
  const M shows = hn::And(hn::And(active, hn::RebindMask(d, inside)),
                          hn::Le(hn::Abs(hn::Sub(depth, expected)), tolerance));
  const V weight = hn::GatherIndex(d, chart.weight.data(), at);
  sum.weight = hn::Add(sum.weight, hn::IfThenElseZero(shows, hn::Mul(share, weight)));
  sum.share = hn::Add(sum.share, hn::IfThenElseZero(shows, share));
}

/// Depths this far off the plane still show the points.
HWY_INLINE V tolerated(float pixel, const TexelBatch& batch, std::size_t i, M active) {
  const D d;
  const V bx = hn::Load(d, &batch.base.x[i]);
  const V by = hn::Load(d, &batch.base.y[i]);
  const V bz = hn::Load(d, &batch.base.z[i]);
  const V one = hn::Set(d, 1.0F);
  const V length = hn::Sqrt(hn::Add(hn::Add(hn::Mul(bx, bx), hn::Mul(by, by)), hn::Mul(bz, bz)));
  const V cosine = hn::IfThenElse(active, bz, one);
  const V steepest = hn::Set(d, steepest_surface);
  const V bent = hn::Sub(hn::Min(hn::Div(length, cosine), steepest), one);
  const V pixels = hn::Set(d, pixel);
  return hn::Add(pixels, hn::Max(hn::Load(d, &batch.steepness[i]), hn::Mul(bent, pixels)));
}

HWY_INLINE V weight_around(const EditingChart& chart, const TexelBatch& batch, std::size_t i,
                           M active) {
  const D d;
  const DI di;
  const V x = hn::IfThenElseZero(active, hn::Load(d, &batch.point.x[i]));
  const V y = hn::IfThenElseZero(active, hn::Load(d, &batch.point.y[i]));
  const V left = hn::Floor(x);
  const V top = hn::Floor(y);
  const V fx = hn::Sub(x, left);
  const V fy = hn::Sub(y, top);
  const V dx = hn::Load(d, &batch.depth_dx[i]);
  const V dy = hn::Load(d, &batch.depth_dy[i]);
  const V tolerance = tolerated(chart.grid.pixel, batch, i, active);
  const V corner =
      hn::Sub(hn::Sub(hn::Load(d, &batch.point.z[i]), hn::Mul(fx, dx)), hn::Mul(fy, dy));
  // A point exactly on a pixel's border must not lose all its pixels.
  const V least = hn::Set(d, 1e-4F);
  const V one = hn::Set(d, 1.0F);
  const V across0 = hn::Add(hn::Sub(one, fx), least);
  const V across1 = hn::Add(fx, least);
  const V down0 = hn::Add(hn::Sub(one, fy), least);
  const V down1 = hn::Add(fy, least);
  const VI x0 = hn::ConvertTo(di, left);
  const VI y0 = hn::ConvertTo(di, top);
  const VI x1 = hn::Add(x0, hn::Set(di, 1));
  const VI y1 = hn::Add(y0, hn::Set(di, 1));
  const V below = hn::Add(corner, dy);
  Sum sum{hn::Zero(d), hn::Zero(d)};
  add_pixel(chart, x0, y0, corner, tolerance, hn::Mul(across0, down0), active, sum);
  add_pixel(chart, x1, y0, hn::Add(corner, dx), tolerance, hn::Mul(across1, down0), active, sum);
  add_pixel(chart, x0, y1, below, tolerance, hn::Mul(across0, down1), active, sum);
  add_pixel(chart, x1, y1, hn::Add(below, dx), tolerance, hn::Mul(across1, down1), active, sum);
  const M any = hn::Gt(sum.share, hn::Zero(d));
  return hn::IfThenElseZero(any, hn::Div(sum.weight, hn::IfThenElse(any, sum.share, one)));
}

bool weigh(const EditingChart& chart, const Image<std::int32_t>& blocks, TexelBatch& batch) {
  const D d;
  bool any = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(batch.count); i += hn::Lanes(d)) {
    const M active = active_points(blocks, batch, i);
    const bool none = hn::AllFalse(d, active);
    hn::Store(none ? hn::Zero(d) : weight_around(chart, batch, i, active), d, &batch.weight[i]);
    any = any || !none;
  }
  return any;
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(weigh);

bool read_visible_weight(const EditReach& reach, TexelBatch& batch) {
  return HWY_DYNAMIC_DISPATCH(weigh)(reach.chart(), reach.blocks(), batch);
}

}  // namespace normalshop
#endif
