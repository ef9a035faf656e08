#include "normalshop/rgbn/detail/domain_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/domain_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Every lane is a line of its own and no multiply-add is fused, so all targets give the same bits.
HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using LineTag = hn::CappedTag<float, domain_lanes>;
using V = hn::Vec<LineTag>;

/// One step of P planes, which are `place` floats on; what they become is stored.
template <int P>
HWY_INLINE void Step(float* const* planes, std::ptrdiff_t place, const float* weights,
                     int squarings, V* state) {
  const LineTag d;
  V weight = hn::LoadU(d, weights);
  for (int i = 0; i < squarings; ++i) weight = hn::Mul(weight, weight);
  for (int p = 0; p < P; ++p) {
    const V own = hn::LoadU(d, planes[p] + place);
    state[p] = hn::Add(own, hn::Mul(weight, hn::Sub(state[p], own)));
    hn::StoreU(state[p], d, planes[p] + place);
  }
}

template <int P>
void Lanes(float* const* planes, const float* weights, std::ptrdiff_t stride, int count,
           int squarings) {
  const LineTag d;
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t lane = 0; lane < domain_lanes; lane += step) {
    V state[P];
    for (int p = 0; p < P; ++p) state[p] = hn::LoadU(d, planes[p] + lane);
    for (int i = 1; i < count; ++i) {
      const std::ptrdiff_t place = i * stride + lane;
      Step<P>(planes, place, weights + place, squarings, state);
    }
    for (int i = count - 2; i >= 0; --i) {
      const std::ptrdiff_t place = i * stride + lane;
      Step<P>(planes, place, weights + place + stride, squarings, state);
    }
  }
}

void FilterLanes(float* const* planes, std::size_t plane_count, const float* weights,
                 std::ptrdiff_t stride, int count, int squarings) {
  const auto lanes = plane_count == 1 ? Lanes<1> : plane_count == 2 ? Lanes<2> : Lanes<3>;
  lanes(planes, weights, stride, count, squarings);
}

#if HWY_TARGET == HWY_SCALAR

void TransposeLanes(const float* from, std::ptrdiff_t stride, int rows, int count, float* to) {
  for (int r = 0; r < domain_lanes; ++r) {
    const float* row = from + std::min(r, rows - 1) * stride;
    for (int x = 0; x < count; ++x) to[domain_lanes * x + r] = row[x];
  }
}

void TransposeBack(const float* from, float* to, std::ptrdiff_t stride, int rows, int count) {
  for (int r = 0; r < rows; ++r) {
    for (int x = 0; x < count; ++x) to[r * stride + x] = from[domain_lanes * x + r];
  }
}

#else

using QuadTag = hn::FixedTag<float, 4>;
using Quad = hn::Vec<QuadTag>;

/// Rows become columns.
HWY_INLINE void Transpose(Quad* quads) {
  const QuadTag d;
  const Quad low_a = hn::InterleaveLower(d, quads[0], quads[1]);
  const Quad low_b = hn::InterleaveLower(d, quads[2], quads[3]);
  const Quad high_a = hn::InterleaveUpper(d, quads[0], quads[1]);
  const Quad high_b = hn::InterleaveUpper(d, quads[2], quads[3]);
  quads[0] = hn::ConcatLowerLower(d, low_b, low_a);
  quads[1] = hn::ConcatUpperUpper(d, low_b, low_a);
  quads[2] = hn::ConcatLowerLower(d, high_b, high_a);
  quads[3] = hn::ConcatUpperUpper(d, high_b, high_a);
}

void TransposeLanes(const float* from, std::ptrdiff_t stride, int rows, int count, float* to) {
  const QuadTag d;
  for (int r = 0; r < domain_lanes; r += 4) {
    const float* row[4];
    for (int i = 0; i < 4; ++i) row[i] = from + std::min(r + i, rows - 1) * stride;
    for (int x = 0; x < count; x += 4) {
      Quad quads[4];
      for (int i = 0; i < 4; ++i) quads[i] = hn::LoadU(d, row[i] + x);
      Transpose(quads);
      for (int i = 0; i < 4; ++i) hn::StoreU(quads[i], d, to + domain_lanes * (x + i) + r);
    }
  }
}

void TransposeBack(const float* from, float* to, std::ptrdiff_t stride, int rows, int count) {
  const QuadTag d;
  for (int r = 0; r < rows; r += 4) {
    const int written = std::min(rows - r, 4);
    for (int x = 0; x < count; x += 4) {
      Quad quads[4];
      for (int i = 0; i < 4; ++i) quads[i] = hn::LoadU(d, from + domain_lanes * (x + i) + r);
      Transpose(quads);
      for (int i = 0; i < written; ++i) hn::StoreU(quads[i], d, to + (r + i) * stride + x);
    }
  }
}

#endif

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cassert>

namespace normalshop {

HWY_EXPORT(FilterLanes);
HWY_EXPORT(TransposeLanes);
HWY_EXPORT(TransposeBack);

void filter_lanes(std::span<float* const> planes, const float* weights, std::ptrdiff_t stride,
                  int count, int squarings) {
  assert(!planes.empty() && planes.size() <= domain_planes);
  HWY_DYNAMIC_DISPATCH(FilterLanes)
  (planes.data(), planes.size(), weights, stride, count, squarings);
}

void transpose_lanes(const float* from, std::ptrdiff_t stride, int rows, int count, float* to) {
  assert(count % 4 == 0);
  HWY_DYNAMIC_DISPATCH(TransposeLanes)(from, stride, rows, count, to);
}

void transpose_back(const float* from, float* to, std::ptrdiff_t stride, int rows, int count) {
  assert(count % 4 == 0);
  HWY_DYNAMIC_DISPATCH(TransposeBack)(from, to, stride, rows, count);
}

}  // namespace normalshop
#endif
