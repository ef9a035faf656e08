#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/chart/depth_steps.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <algorithm>
#include <array>
#include <limits>

#include <hwy/highway.h>

#include "normalshop/chart/depth_steps.h"
#include "normalshop/chart/detail/lanes-inl.h"
#include "normalshop/core/parallel.h"

#ifndef NORMALSHOP_DEPTH_STEPS_ONCE
#define NORMALSHOP_DEPTH_STEPS_ONCE
namespace normalshop {

/// Pixels side by side.
struct PixelRun {
  const std::uint32_t* ids;
  const float* depth;
  const Vec3f* normals;
};

enum class Neighbour { Right, Below };

/// Of a chart.
struct StepScale {
  float inverse;  ///< pixels per object unit
  float least;    ///< of a step, pixels
};

}  // namespace normalshop
#endif

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

/// Of some pixels: how much deeper the base surface gets from one to its neighbour, in pixels, and
/// whether it faces the viewer. Grazing normals count as 80 degrees.
struct Rise {
  V step;
  hn::Mask<D> front;
};

HWY_INLINE Rise rise_of(const Vec3f* normals, Neighbour neighbour) {
  const D d;
  V3 n;
  hn::LoadInterleaved3(d, reinterpret_cast<const float*>(normals), n.x, n.y, n.z);
  const V inverse = hn::Div(hn::Set(d, 1.0F), hn::Max(n.z, hn::Set(d, 0.17F)));
  const V across = neighbour == Neighbour::Right ? hn::Neg(n.x) : n.y;
  return {hn::Mul(across, inverse), hn::Gt(n.z, hn::Zero(d))};
}

/// Is there a depth step between two neighbouring pixels that see different triangles?
HWY_INLINE hn::Mask<D> steps_between(const PixelRun& a, const PixelRun& b, std::size_t i,
                                     Neighbour neighbour, const StepScale& scale) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  const auto same = hn::RebindMask(d, hn::Eq(hn::LoadU(du, a.ids + i), hn::LoadU(du, b.ids + i)));
  if (hn::AllTrue(d, same)) return hn::Not(same);
  const V nothing = hn::Set(d, -std::numeric_limits<float>::infinity());
  const V z0 = hn::LoadU(d, a.depth + i);
  const V z1 = hn::LoadU(d, b.depth + i);
  const auto seen = hn::And(hn::Gt(z0, nothing), hn::Gt(z1, nothing));
  const Rise r0 = rise_of(a.normals + i, neighbour);
  const Rise r1 = rise_of(b.normals + i, neighbour);
  const V expected = hn::Mul(hn::Set(d, 0.5F), hn::Add(r0.step, r1.step));
  const V off = hn::Abs(hn::Sub(hn::Mul(hn::Sub(z1, z0), hn::Set(d, scale.inverse)), expected));
  const V steepness = hn::Abs(expected);
  const V flat = hn::Sub(hn::Set(d, 1.0F), hn::Mul(hn::Set(d, 0.5F), steepness));
  const V least = hn::Max(hn::Set(d, 2.0F), hn::Mul(hn::Set(d, scale.least), flat));
  const auto deep = hn::Gt(off, hn::Add(least, steepness));
  const auto turned = hn::Xor(r0.front, r1.front);
  return hn::And(hn::AndNot(same, seen), hn::Or(deep, turned));
}

void mark_steps(const PixelRun& a, const PixelRun& b, int count, Neighbour neighbour,
                const StepScale& scale, std::uint8_t* out_a, std::uint8_t* out_b) {
  const D d;
  const auto mark = [&](std::size_t i) {
    const auto steps = steps_between(a, b, i, neighbour, scale);
    if (HWY_LIKELY(hn::AllFalse(d, steps))) return;
    std::array<float, lane_padding> found;
    hn::StoreU(hn::IfThenElseZero(steps, hn::Set(d, 1.0F)), d, found.data());
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
      if (found[k] == 0.0F) continue;
      if (out_a != nullptr) out_a[i + k] = 1;
      if (out_b != nullptr) out_b[i + k] = 1;
    }
  };
  const std::size_t lanes = hn::Lanes(d);
  const auto all = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i + lanes <= all; i += lanes) mark(i);
  if (all % lanes != 0) mark(all - lanes);
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

namespace {

HWY_EXPORT(mark_steps);

/// As many pixels as the widest vector has lanes.
constexpr int lane_room = 16;

/// A row shorter than that; what is missing sees nothing.
class ShortRow {
 public:
  ShortRow(const PixelRun& row, int count) {
    ids_.fill(no_triangle);
    depth_.fill(0.0F);
    normals_.fill(Vec3f::Zero());
    std::copy_n(row.ids, count, ids_.begin());
    std::copy_n(row.depth, count, depth_.begin());
    std::copy_n(row.normals, count, normals_.begin());
  }
  PixelRun run() const { return {ids_.data(), depth_.data(), normals_.data()}; }

 private:
  std::array<std::uint32_t, lane_room> ids_;
  std::array<float, lane_room> depth_;
  std::array<Vec3f, lane_room> normals_;
};

/// Marks the steps between the pixels of `a` and their neighbours, those of `b`, in both rows that
/// are not null.
void mark(const PixelRun& a, const PixelRun& b, int count, Neighbour neighbour,
          const StepScale& scale, std::uint8_t* out_a, std::uint8_t* out_b) {
  if (count >= lane_room) {
    HWY_DYNAMIC_DISPATCH(mark_steps)(a, b, count, neighbour, scale, out_a, out_b);
    return;
  }
  const ShortRow padded_a(a, count);
  const ShortRow padded_b(b, count);
  std::array<std::uint8_t, lane_room> marks{};
  HWY_DYNAMIC_DISPATCH(mark_steps)
  (padded_a.run(), padded_b.run(), lane_room, neighbour, scale, marks.data(), nullptr);
  for (int i = 0; i < count; ++i) {
    if (marks[static_cast<std::size_t>(i)] == 0) continue;
    if (out_a != nullptr) out_a[i] = 1;
    if (out_b != nullptr) out_b[i] = 1;
  }
}

/// Depth steps of the rows from `first` to `last`.
void find_in_rows(const EditingChart& chart, const StepScale& scale, int first, int last,
                  Image<std::uint8_t>& steps) {
  const int width = steps.width();
  const auto run = [&](int y, int x) {
    return PixelRun{chart.ids.triangle.row(y) + x, chart.ids.depth.row(y) + x,
                    chart.base_normal.row(y) + x};
  };
  for (int y = first; y < last; ++y) std::fill_n(steps.row(y), width, std::uint8_t{0});
  for (int y = std::max(first - 1, 0); y < std::min(last, steps.height()); ++y) {
    std::uint8_t* here = y >= first ? steps.row(y) : nullptr;
    if (here != nullptr) {
      mark(run(y, 0), run(y, 1), width - 1, Neighbour::Right, scale, here, here + 1);
    }
    if (y + 1 == steps.height()) break;
    std::uint8_t* below = y + 1 < last ? steps.row(y + 1) : nullptr;
    mark(run(y, 0), run(y + 1, 0), width, Neighbour::Below, scale, here, below);
  }
}

}  // namespace

void find_depth_steps(const EditingChart& chart, float least, Image<std::uint8_t>& steps) {
  constexpr float least_pixels = 2.0F;
  const float inverse = 1.0F / chart.grid.pixel;
  const StepScale scale{inverse, std::max(least_pixels, least * inverse)};
  steps.resize(chart.grid.width(), chart.grid.height());
  parallel_for(static_cast<std::size_t>(chart.grid.height()), 64,
               [&](std::size_t begin, std::size_t end) {
                 find_in_rows(chart, scale, static_cast<int>(begin), static_cast<int>(end), steps);
               });
}

}  // namespace normalshop
#endif
