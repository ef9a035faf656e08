#include <algorithm>

#include "normalshop/rgbn/detail/polyline_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/rgbn/polyline_samples.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "normalshop/rgbn/detail/polyline-inl.h"
#include "normalshop/rgbn/detail/profile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop::HWY_NAMESPACE {

using Values = ProfileValues<V>;

/// The places of some of a cell's pixels, and what their segments hold.
struct Lanes {
  Lanes(const SegmentColumns& columns, const LinePlaces& places, std::size_t i)
      : segments(hn::Load(di, places.segment.data() + i)),
        at(hn::Load(d, places.at.data() + i)),
        half_width(hn::Load(d, places.half_width.data() + i)),
        distance(hn::Load(d, places.distance.data() + i)),
        x(hn::Load(d, places.x.data() + i)),
        y(hn::Load(d, places.y.data() + i)),
        same(hn::AllTrue(di, hn::Eq(segments, hn::Set(di, hn::GetLane(segments))))) {
    const V rate = Of(columns.fade_rate);
    fade = hn::Add(Of(columns.fade), hn::Mul(at, rate));
  }
  V Of(const std::vector<float>& column) const {
    if (same) return hn::Set(d, column[static_cast<std::size_t>(hn::GetLane(segments))]);
    return hn::GatherIndex(d, column.data(), segments);
  }
  Index Of(const std::vector<std::int32_t>& column) const {
    if (same) return hn::Set(di, column[static_cast<std::size_t>(hn::GetLane(segments))]);
    return hn::GatherIndex(di, column.data(), segments);
  }

  Index segments;
  V at, half_width, distance, x, y, fade;
  bool same;  ///< segment
};

struct Sample {
  V height, x, y, u;
};

class Sampler {
 public:
  Sampler(const SegmentColumns& segments, const LineProfile& profile, bool even)
      : segments_(segments),
        profile_(profile.profile),
        height_(profile.height),
        coverage_(profile.coverage),
        even_(even) {}

  void Add(const LinePlaces& places, std::size_t i, FieldCell& field) const {
    const Index place = hn::Load(di, places.place.data() + i);
    const M beside = hn::RebindMask(d, hn::Eq(place, hn::Set(di, line_beside)));
    const M cap = hn::RebindMask(d, hn::Eq(place, hn::Set(di, line_cap)));
    const M any = hn::Or(beside, cap);
    if (hn::AllFalse(d, any)) return;
    const Lanes lanes(segments_, places, i);
    Sample s;
    if (!hn::AllFalse(d, beside)) s = Beside(lanes, places, i);
    if (!hn::AllFalse(d, cap)) {
      const Sample round = Cap(lanes);
      if (hn::AllFalse(d, beside)) s = round;
      s = {hn::IfThenElse(cap, round.height, s.height), hn::IfThenElse(cap, round.x, s.x),
           hn::IfThenElse(cap, round.y, s.y), hn::IfThenElse(cap, round.u, s.u)};
    }
    const V height = hn::Load(d, field.height.data() + i);
    const M higher = hn::And(any, hn::Gt(hn::Abs(s.height), hn::Abs(height)));
    const auto put = [&](V value, CellLanes<float>& lane) {
      float* at = lane.data() + i;
      hn::Store(hn::IfThenElse(higher, value, hn::Load(d, at)), d, at);
    };
    put(s.height, field.height);
    put(s.x, field.slope_x);
    put(hn::Neg(s.y), field.slope_y);
    if (coverage_ == FieldCoverage::None) return;
    float* covered = field.coverage.data() + i;
    const V coverage = hn::IfThenElseZero(any, Coverage(s.u, lanes.fade));
    hn::Store(hn::Max(hn::Load(d, covered), coverage), d, covered);
  }

 private:
  Values Across(V u, V half_width) const {
    if (profile_.shape() == ProfileShape::Crease) {
      const V radius =
          hn::Min(hn::Div(hn::Set(d, jump_radius), half_width), hn::Set(d, largest_jump_share));
      return crease_at(d, u, radius);
    }
    if (profile_.shape() != ProfileShape::Custom) {
      return shape_at(d, profile_.shape(), profile_.level(), u);
    }
    alignas(64) std::array<float, most_lanes> at;
    alignas(64) std::array<float, most_lanes> slope;
    const M valid = hn::Le(hn::Abs(u), hn::Set(d, 1.0F));  // elsewhere nobody asks
    hn::Store(hn::IfThenElseZero(valid, u), d, at.data());
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
      const Profile::Value value = profile_.at(at[k]);
      at[k] = value.height;
      slope[k] = value.slope;
    }
    return {hn::Load(d, at.data()), hn::Load(d, slope.data())};
  }

  Sample Beside(const Lanes& lanes, const LinePlaces& places, std::size_t i) const {
    const V side = hn::Load(d, places.side.data() + i);
    const V u = hn::Div(hn::Mul(side, lanes.distance), lanes.half_width);
    const Values h = Across(u, lanes.half_width);
    const V amplitude = hn::Mul(hn::Set(d, height_), lanes.fade);
    const V rise = hn::Mul(amplitude, h.slope);
    const V steep = hn::Div(rise, lanes.half_width);
    Sample s{hn::Mul(amplitude, h.height), hn::Mul(steep, hn::Mul(side, lanes.x)),
             hn::Mul(steep, hn::Mul(side, lanes.y)), u};
    if (even_) return s;
    // Where width or fade change along the line.
    const V along_x = hn::Load(d, places.along_x.data() + i);
    const V along_y = hn::Load(d, places.along_y.data() + i);
    const V fading = hn::Mul(hn::Mul(hn::Set(d, height_), lanes.Of(segments_.fade_rate)), h.height);
    const V widening =
        hn::Div(hn::Mul(hn::Mul(rise, u), lanes.Of(segments_.half_width_rate)), lanes.half_width);
    const V rate = hn::Sub(fading, widening);
    const M even = hn::RebindMask(d, hn::Lt(lanes.Of(segments_.even), hn::Zero(di)));
    s.x = hn::IfThenElse(even, s.x, hn::Add(s.x, hn::Mul(rate, along_x)));
    s.y = hn::IfThenElse(even, s.y, hn::Add(s.y, hn::Mul(rate, along_y)));
    return s;
  }

  Sample Cap(const Lanes& lanes) const {
    const V half = hn::Set(d, 0.5F);
    const V u = hn::Div(lanes.distance, lanes.half_width);
    const Values l = Across(u, lanes.half_width);
    const Values r = Across(hn::Neg(u), lanes.half_width);
    const V even = hn::Mul(half, hn::Add(l.height, r.height));
    const V odd = hn::Mul(half, hn::Sub(l.height, r.height));
    const V even_slope = hn::Mul(half, hn::Sub(l.slope, r.slope));
    const V odd_slope = hn::Mul(half, hn::Add(l.slope, r.slope));
    // Left as seen, although y runs down.
    const V left_x = lanes.Of(segments_.dy);
    const V left_y = hn::Neg(lanes.Of(segments_.dx));
    const M away = hn::Gt(lanes.distance, hn::Set(d, 1e-5F));
    const V x = hn::Div(lanes.x, lanes.distance);
    const V y = hn::Div(lanes.y, lanes.distance);
    const V sine = hn::IfThenElseZero(away, Dot(x, y, left_x, left_y));
    const V middle = hn::Div(odd_slope, lanes.half_width);
    const V outward = hn::Div(hn::Add(even_slope, hn::Mul(sine, odd_slope)), lanes.half_width);
    const V around = hn::Div(odd, lanes.distance);
    const auto gradient = [&](V along, V left) {
      const V turned = hn::Mul(around, hn::Sub(left, hn::Mul(sine, along)));
      return hn::IfThenElse(away, hn::Add(hn::Mul(outward, along), turned), hn::Mul(middle, left));
    };
    const V amplitude = hn::Mul(hn::Set(d, height_), lanes.fade);
    return {hn::Mul(amplitude, hn::Add(even, hn::Mul(sine, odd))),
            hn::Mul(gradient(x, left_x), amplitude), hn::Mul(gradient(y, left_y), amplitude), u};
  }

  /// smoothstep() from `low` on, `span` wide.
  static V Smooth(V x, float low, float span) {
    const V zero = hn::Zero(d);
    const V one = hn::Set(d, 1.0F);
    const V share = hn::Div(hn::Sub(x, hn::Set(d, low)), hn::Set(d, span));
    const V t = hn::Min(hn::Max(share, zero), one);
    return hn::Mul(hn::Mul(t, t), hn::Sub(hn::Set(d, 3.0F), hn::Mul(hn::Set(d, 2.0F), t)));
  }

  V Coverage(V u, V fade) const {
    if (coverage_ == FieldCoverage::Inside) return Smooth(u, -1.0F, 1.0F);
    return hn::Mul(fade, hn::Sub(hn::Set(d, 1.0F), Smooth(hn::Abs(u), 0.7F, 1.0F - 0.7F)));
  }

  const SegmentColumns& segments_;
  const Profile& profile_;
  float height_;
  FieldCoverage coverage_;
  bool even_;
};

void AddLineOf(const SegmentColumns& segments, const LineProfile& profile, bool even,
               const LinePlaces& places, FieldCell& field) {
  const Sampler sampler(segments, profile, even);
  for (std::size_t i = 0; i < field.height.size(); i += hn::Lanes(d)) {
    sampler.Add(places, i, field);
  }
}

/// Rows of a whole cell.
void WriteSlopesOf(const FieldCell& cell, int x, int y, SlopeSpan details) {
  constexpr hn::CappedTag<float, cell_side> row;
  for (int j = 0; j < cell_side; ++j) {
    float* out = details.row(y + j)[x].data();
    for (std::size_t i = 0; i < cell_side; i += hn::Lanes(row)) {
      const std::size_t k = static_cast<std::size_t>(j * cell_side) + i;
      hn::StoreInterleaved2(hn::Load(row, &cell.slope_x[k]), hn::Load(row, &cell.slope_y[k]), row,
                            out + 2 * i);
    }
  }
}

}  // namespace normalshop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(AddLineOf);
HWY_EXPORT(WriteSlopesOf);

void add_line(const SegmentColumns& segments, const LineProfile& profile, bool even,
              const LinePlaces& places, FieldCell& field) {
  HWY_DYNAMIC_DISPATCH(AddLineOf)(segments, profile, even, places, field);
}

void write_cell(const Rect& pixels, int x, int y, const FieldCell& cell, SlopeSpan details,
                MaskSpan coverage) {
  const bool whole = pixels.width() == cell_side && pixels.height() == cell_side;
  if (whole) HWY_DYNAMIC_DISPATCH(WriteSlopesOf)(cell, x, y, details);
  for (int j = pixels.y0; j < pixels.y1; ++j) {
    const auto row = static_cast<std::size_t>((j - y) * cell_side);
    Vec2f* slopes = details.row(j);
    for (int i = pixels.x0; !whole && i < pixels.x1; ++i) {
      const std::size_t k = row + static_cast<std::size_t>(i - x);
      slopes[i] = Vec2f(cell.slope_x[k], cell.slope_y[k]);
    }
    if (coverage.empty()) continue;
    const float* covered = &cell.coverage[row];
    std::copy(covered + (pixels.x0 - x), covered + (pixels.x1 - x), coverage.row(j) + pixels.x0);
  }
}

}  // namespace normalshop
#endif
