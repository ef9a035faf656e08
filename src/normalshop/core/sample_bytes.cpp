#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normalshop/core/sample_bytes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as Highway asks.
#include <hwy/highway.h>

#include "normalshop/core/sample_bytes.h"

HWY_BEFORE_NAMESPACE();
namespace normalshop {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, sample_padding>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;

/// As WrappedTaps does it.
HWY_INLINE void split(V at, int size, VI& first, VI& second, V& fraction) {
  const D d;
  const DI di;
  const auto sane = hn::Lt(hn::Abs(at), hn::Set(d, 1e9F));
  const V inside = hn::IfThenElseZero(sane, hn::Sub(at, hn::Floor(at)));
  const V place = hn::Sub(hn::Mul(inside, hn::Set(d, static_cast<float>(size))), hn::Set(d, 0.5F));
  const V left = hn::Floor(place);
  fraction = hn::Min(hn::Max(hn::Sub(place, left), hn::Zero(d)), hn::Set(d, 1.0F));
  const VI last = hn::Set(di, size - 1);
  const VI i = hn::ConvertTo(di, left);
  first = hn::IfThenElse(hn::Lt(i, hn::Zero(di)), last, hn::Min(i, last));
  const VI next = hn::Add(i, hn::Set(di, 1));
  second = hn::IfThenElseZero(hn::Lt(next, hn::Set(di, size)), next);
}

struct Weights {
  V w00;
  V w10;
  V w01;
  V w11;
};

struct Words {
  VI w00;
  VI w10;
  VI w01;
  VI w11;
};

/// Component `shift / 8` of a pixel.
template <int shift>
HWY_INLINE V component(VI word, const float* table) {
  const D d;
  const DI di;
  const VI code = hn::And(hn::ShiftRight<shift>(word), hn::Set(di, 255));
  return table != nullptr ? hn::GatherIndex(d, table, code) : hn::ConvertTo(d, code);
}

template <int shift>
HWY_INLINE V mean(const Words& p, const Weights& w, const float* table) {
  const V upper = hn::Add(hn::Mul(w.w00, component<shift>(p.w00, table)),
                          hn::Mul(w.w10, component<shift>(p.w10, table)));
  const V lower = hn::Add(hn::Mul(w.w01, component<shift>(p.w01, table)),
                          hn::Mul(w.w11, component<shift>(p.w11, table)));
  return hn::Add(upper, lower);
}

bool sample_all(const RawImage& image, const float* table, const float* u, const float* v,
                int count, float* out0, float* out1, float* out2) {
  const D d;
  const DI di;
  const VI channels = hn::Set(di, image.channels());
  const VI pitch = hn::Set(di, static_cast<int>(image.row_bytes()));
  const VI limit = hn::Set(di, static_cast<int>(image.size_bytes()) - 4);
  const auto* base = reinterpret_cast<const std::int32_t*>(image.data());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    VI x0;
    VI x1;
    VI y0;
    VI y1;
    V fx;
    V fy;
    split(hn::LoadU(d, u + i), image.width(), x0, x1, fx);
    split(hn::LoadU(d, v + i), image.height(), y0, y1, fy);
    x0 = hn::Mul(x0, channels);
    x1 = hn::Mul(x1, channels);
    y0 = hn::Mul(y0, pitch);
    y1 = hn::Mul(y1, pitch);
    if (!hn::AllFalse(di, hn::Gt(hn::Add(hn::Max(x0, x1), hn::Max(y0, y1)), limit))) return false;
    const Words p{
        hn::GatherOffset(di, base, hn::Add(x0, y0)), hn::GatherOffset(di, base, hn::Add(x1, y0)),
        hn::GatherOffset(di, base, hn::Add(x0, y1)), hn::GatherOffset(di, base, hn::Add(x1, y1))};
    Weights w;
    w.w11 = hn::Mul(fx, fy);
    w.w10 = hn::Sub(fx, w.w11);
    w.w01 = hn::Sub(fy, w.w11);
    w.w00 = hn::Sub(hn::Sub(hn::Set(d, 1.0F), fx), w.w01);
    hn::StoreU(mean<0>(p, w, table), d, out0 + i);
    hn::StoreU(mean<8>(p, w, table), d, out1 + i);
    hn::StoreU(mean<16>(p, w, table), d, out2 + i);
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace normalshop
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace normalshop {

HWY_EXPORT(sample_all);

bool sample_bytes(const RawImage& image, const float* table, const float* u, const float* v,
                  int count, float* out0, float* out1, float* out2) {
  const bool fits = image.size_bytes() >= 4 && image.size_bytes() < (std::size_t{1} << 31);
  if (!fits || image.channels() < 3 || image.type() != CodeType::U8) return false;
  return HWY_DYNAMIC_DISPATCH(sample_all)(image, table, u, v, count, out0, out1, out2);
}

}  // namespace normalshop
#endif
