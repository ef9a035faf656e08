#include <algorithm>
#include <array>
#include <cmath>

#include "normalshop/rgbn/detail/polyline_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/polyline_near.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "normalshop/rgbn/detail/polyline-inl.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {

/// Reads columns for lanes that have to do with segments side by side.
struct SegmentsFrom {
  std::size_t first;
  V operator()(const std::vector<float>& column) const {
    return hn::LoadU(d, column.data() + first);
  }
};

template <class Of>
inline void OffsetsOf(const SegmentColumns& s, const Of& of, V px, V py, std::size_t i,
                      SegmentOffsets& out) {
  const Foot foot = FootOf(s, of, px, py);
  hn::StoreU(foot.x, d, out.x.data() + i);
  hn::StoreU(foot.y, d, out.y.data() + i);
  hn::StoreU(foot.squared, d, out.squared.data() + i);
}

void SegmentOffsetsOf(const SegmentColumns& segments, std::span<const std::uint32_t> list, float x,
                      float y, SegmentOffsets& out) {
  const std::size_t lanes = hn::Lanes(d);
  const V px = hn::Set(d, x);
  const V py = hn::Set(d, y);
  alignas(64) std::array<std::int32_t, most_lanes> indices{};
  for (std::size_t i = 0; i < list.size(); i += lanes) {
    const std::size_t count = std::min(lanes, list.size() - i);
    const std::uint32_t first = list[i];
    // Neighbours in the line mostly stand side by side.
    if (list[i + count - 1] - first == count - 1) {
      OffsetsOf(segments, SegmentsFrom{first}, px, py, i, out);
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) indices[k] = static_cast<std::int32_t>(list[i + k]);
    OffsetsOf(segments, ManySegments{hn::Load(di, indices.data())}, px, py, i, out);
  }
}

/// Beyond all squared distances that count.
constexpr float very_far = 1e30F;

/// The squared distance of the nearest of them, and which it is; `very_far` ones follow them.
struct Closest {
  float squared;
  std::size_t at;
};

inline Closest ClosestOf(const SegmentOffsets& offsets, std::size_t count) {
  const std::size_t lanes = hn::Lanes(d);
  V least = hn::Set(d, very_far);
  for (std::size_t i = 0; i < count; i += lanes) {
    const V squared = hn::LoadU(d, offsets.squared.data() + i);
    least = hn::IfThenElse(hn::Lt(squared, least), squared, least);  // never what is no number
  }
  const V all = hn::MinOfLanes(d, least);
  for (std::size_t i = 0;; i += lanes) {
    const intptr_t found =
        hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, offsets.squared.data() + i), all));
    if (found >= 0) return {hn::GetLane(all), i + static_cast<std::size_t>(found)};
  }
}

void NearestSegmentsOf(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                       const Circle& circle, float half_width, SegmentOffsets& offsets,
                       std::vector<std::uint32_t>& kept) {
  const std::size_t lanes = hn::Lanes(d);
  SegmentOffsetsOf(segments, list, circle.center.x(), circle.center.y(), offsets);
  std::fill_n(offsets.squared.begin() + static_cast<std::ptrdiff_t>(list.size()), lanes, very_far);
  const Closest closest = ClosestOf(offsets, list.size());
  const float least = std::sqrt(closest.squared);
  const float radius = circle.radius;
  if (!(least <= half_width + radius)) return;
  const V turn = hn::Set(d, least > 2.0F * radius ? radius / (least - radius) : 2.0F);
  const Vec2f away = offsets.at(closest.at) / std::max(least, 1e-6F);
  const float farthest = least + 2.0F * radius + 0.01F;
  std::size_t count = kept.size();
  kept.resize(count + list.size() + lanes);
  alignas(64) std::array<std::int32_t, most_lanes> places{};
  for (std::size_t i = 0; i < list.size(); i += lanes) {
    const V squared = hn::LoadU(d, offsets.squared.data() + i);
    const M near = hn::Le(squared, hn::Set(d, farthest * farthest));
    if (hn::AllFalse(d, near)) continue;
    const V distance = hn::Sqrt(squared);
    const V divisor = hn::Max(distance, hn::Set(d, 1e-6F));
    const V x = hn::Sub(hn::Div(hn::LoadU(d, offsets.x.data() + i), divisor), hn::Set(d, away.x()));
    const V y = hn::Sub(hn::Div(hn::LoadU(d, offsets.y.data() + i), divisor), hn::Set(d, away.y()));
    const V change = hn::Min(hn::Add(hn::Sqrt(Dot(x, y, x, y)), turn), hn::Set(d, 2.0F));
    const V limit =
        hn::Add(hn::Add(hn::Set(d, least), hn::Mul(change, hn::Set(d, radius))), hn::Set(d, 0.01F));
    const M keep = hn::And(near, hn::Le(distance, limit));
    const std::size_t more = hn::CompressStore(hn::Iota(di, static_cast<std::int32_t>(i)),
                                               hn::RebindMask(di, keep), di, places.data());
    for (std::size_t k = 0; k < more; ++k) {
      kept[count++] = list[static_cast<std::size_t>(places[k])];
    }
  }
  kept.resize(count);
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(SegmentOffsetsOf);
HWY_EXPORT(NearestSegmentsOf);

namespace {

void make_room(std::size_t count, SegmentOffsets& out) {
  const std::size_t padded = count + most_lanes;
  if (out.squared.size() >= padded) return;
  for (std::vector<float>* column : {&out.x, &out.y, &out.squared}) column->resize(padded);
}

}  // namespace

void segment_offsets(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                     const Vec2f& point, SegmentOffsets& out) {
  make_room(list.size(), out);
  HWY_DYNAMIC_DISPATCH(SegmentOffsetsOf)(segments, list, point.x(), point.y(), out);
}

void nearest_segments(const SegmentColumns& segments, std::span<const std::uint32_t> list,
                      const Circle& circle, float half_width, SegmentOffsets& offsets,
                      std::vector<std::uint32_t>& kept) {
  make_room(list.size(), offsets);
  HWY_DYNAMIC_DISPATCH(NearestSegmentsOf)(segments, list, circle, half_width, offsets, kept);
}

}  // namespace normalshop
#endif
