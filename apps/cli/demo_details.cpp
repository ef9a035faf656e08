#include "demo_details.h"

#include "demo_shape.h"
#include "noise.h"

namespace normalshop::demo {

namespace {

constexpr float pi = 3.14159265F;

/// Position on the head and the places that the ornaments refer to.
struct Place {
  JetPoint p;
  Jet level;   ///< along the band
  Jet around;  ///< angle around the vertical axis, 0 in front, positive towards +x
  Jet hair;    ///< 1 on the hair, 0 on the face
  Jet band;    ///< 1 on the band
  Vec3f normal;
};

Place place_of(const Vec3f& position, const Vec3f& normal) {
  Place at{JetPoint::at(position), {}, {}, {}, {}, normal};
  at.level = band_level(at.p);
  at.around = atan2(at.p.x, at.p.z + 0.05F);
  at.hair = smoothstep(band_high + 0.005F, band_high + 0.025F, at.level);
  at.band = smoothstep(band_low, band_low + 0.02F, at.level) *
            smoothstep(-band_high, -band_high + 0.02F, -at.level);
  return at;
}

/// Distance from the middle of the nearest of `count` equal parts of a turn, -0.5 to 0.5 of a part.
Jet repeat(const Jet& angle, float count, float shift) {
  const Jet turns = angle * (count / (2.0F * pi)) + shift;
  return turns - std::floor(turns.value() + 0.5F);
}

/// Rows of snail curls around the crown.
Jet curls(const Place& at) {
  if (at.hair.value() <= 0.0F) return {};
  constexpr float spacing = 0.165F;
  const JetPoint q = at.p - Vec3f(0.0F, 0.10F, -0.10F);
  const Jet polar = acos((q.y * 0.94F - q.z * 0.34F) / length(q));
  const Jet turn = atan2(q.x, q.z * 0.94F + q.y * 0.34F);
  const float row = std::floor(polar.value() / spacing);
  const float middle = (row + 0.5F) * spacing;
  const float circumference = 2.0F * pi * std::sin(middle);
  const float count = std::max(1.0F, std::round(circumference / spacing));
  const float shift = static_cast<int>(row) % 2 == 0 ? 0.0F : 0.5F;
  const Jet a = repeat(turn, count, shift) * (circumference / count);
  const Jet b = polar - middle;
  const Jet r = length(a, b) * (2.0F / spacing);
  if (r.value() >= 1.0F) return {};
  const float turning = turn.value() > 0.0F ? 1.0F : -1.0F;
  const Jet dome = Jet(1.0F) - r * r;
  const Jet turns = sin(r * 12.5F + atan2(b, a * turning));
  const Jet groove = turns * smoothstep(0.05F, 0.25F, r) * smoothstep(-0.95F, -0.75F, -r);
  return dome * 0.030F + groove * 0.0055F;
}

/// Rims, a row of beads below, and a zigzag that leaves room in front.
Jet band(const Place& at) {
  if (at.level.value() < band_low - 0.06F || at.level.value() > band_high + 0.02F) return {};
  const float middle = 0.5F * (band_low + band_high);
  const Jet rims =
      hill(at.level - (band_low + 0.012F), 0.016F) + hill(at.level - (band_high - 0.004F), 0.016F);
  const Jet u = repeat(at.around, 84.0F, 0.5F) * 0.066F;
  const Jet bead = length(u, at.level - (band_low - 0.026F));
  const Jet beads = hill(bead, 0.029F);
  const Jet side = smoothstep(0.80F, 0.86F, abs(at.around));
  const Jet zigzag = abs(repeat(at.around, 30.0F, 0.0F)) * 0.17F - 0.0425F;
  const Jet tooth = at.level - middle - zigzag;
  const Jet teeth = hill(tooth, 0.022F) * smoothstep(-0.075F, -0.060F, -abs(at.level - middle));
  const Jet knob =
      hill(length(repeat(at.around, 30.0F, 0.5F) * 0.16F, at.level - middle - 0.035F), 0.017F);
  return rims * 0.013F + beads * 0.014F + (teeth * 0.010F + knob * 0.007F) * side;
}

/// Heavy lids and the rim of an iris, on the front of the face only.
Jet eyes(const Place& at) {
  if (at.p.z.value() <= 0.3F || std::abs(at.p.y.value()) > 0.25F) return {};
  const Jet x = abs(at.p.x) - 0.285F;
  const Jet y = at.p.y - 0.008F - x * 0.12F;
  const Jet almond = max(length(x, y + 0.190F) - 0.256F, length(x, y - 0.250F) - 0.300F);
  const Jet lid = hill(almond - 0.012F, 0.022F) * 0.017F;
  const Jet fold =
      hill(length(x, y + 0.190F) - 0.256F - 0.052F, 0.016F) * -0.008F * smoothstep(0.0F, 0.03F, y);
  const Jet ball = smoothstep(-0.012F, 0.002F, -almond);
  const Jet iris = hill(length(x, y - 0.018F) - 0.052F, 0.010F) * -0.007F;
  return (lid + fold + ball * iris) * smoothstep(0.3F, 0.45F, at.p.z);
}

/// The rim of the ear and a knob in it.
Jet ears(const Place& at) {
  if (std::abs(at.p.x.value()) <= 0.72F) return {};
  const Jet y = at.p.y - 0.06F;
  const Jet z = (at.p.z + 0.07F) * 1.3F;
  const Jet r = length(y * 0.85F, z);
  const Jet rim = hill(r - 0.145F, 0.035F) * 0.018F;
  const Jet knob = hill(r, 0.06F) * 0.016F;
  const Jet drop = hill(length(at.p.y + 0.30F, at.p.z + 0.02F) - 0.045F, 0.02F) * 0.010F;
  return (rim + knob + drop) * smoothstep(0.72F, 0.80F, abs(at.p.x)) *
         smoothstep(-band_low, -band_low + 0.05F, -at.level);
}

Jet brows_and_mouth(const Place& at) {
  if (at.p.z.value() <= 0.35F) return {};
  const Jet x = abs(at.p.x);
  const Jet front = smoothstep(0.35F, 0.5F, at.p.z);
  const Jet arc = at.p.y - 0.205F + (x - 0.31F) * (x - 0.31F) * 1.2F;
  const Jet within = smoothstep(0.07F, 0.13F, x) * smoothstep(-0.56F, -0.48F, -x);
  const Jet hairs = sin((x * 0.85F - at.p.y * 1.2F) * 150.0F) * 0.0022F;
  const Jet brow = (hill(arc, 0.05F) * 0.010F + hill(arc, 0.05F) * hairs) * within;
  const Jet smile = at.p.y + 0.512F - x * x * 0.25F;
  const Jet seam = hill(smile, 0.018F) * -0.016F * smoothstep(-0.25F, -0.20F, -x);
  const Jet groove = hill(at.p.x, 0.035F) * -0.010F * hill(at.p.y + 0.365F, 0.06F);
  return (brow + seam + groove) * front;
}

/// Grooves in nested arcs over cheeks and chin, each with a ridge beside it.
Jet tattoo(const Place& at) {
  if (at.p.z.value() <= 0.05F) return {};
  const Jet x = abs(at.p.x);
  const Jet r = length(x - 0.16F, at.p.y + 0.40F);
  const Jet wave = sin((r - 0.25F) * 92.0F);
  const Jet ring = smoothstep(0.20F, 0.22F, r) * smoothstep(-0.46F, -0.44F, -r);
  const Jet angle = atan2(at.p.y + 0.40F, x - 0.16F);
  const Jet sector = smoothstep(-1.15F, -1.05F, angle) * smoothstep(-0.62F, -0.52F, -angle);
  return wave * ring * sector * smoothstep(0.05F, 0.2F, at.p.z) * 0.0062F;
}

Jet neck_rings(const Place& at) {
  const Jet low = smoothstep(0.98F, 1.02F, -at.p.y);
  return low * hill(repeat(at.p.y, 2.0F * pi / 0.07F, 0.0F), 0.5F) * 0.012F;
}

/// Fine cracks where a noise crosses zero, in some places only.
Jet crack(const JetPoint& p, float width, std::uint32_t seed) {
  const JetPoint bent{p.x + noise(p * 5.0F, seed + 7) * 0.05F,
                      p.y + noise(p * 5.0F, seed + 8) * 0.05F, p.z};
  const Jet where = smoothstep(0.18F, 0.34F, noise(p * 1.7F, seed + 3));
  if (where.value() == 0.0F) return {};
  return hill(noise(bent * 1.6F, seed), width) * where;
}

struct Weather {
  Jet height;
  float crack = 0.0F;
  float grain = 0.0F;
  float pits = 0.0F;
};

Weather weather(const Place& at) {
  Weather w;
  const Jet cracks = crack(at.p, 0.02F, 17U);
  const Jet worn = smoothstep(-0.25F, 0.35F, noise(at.p * 2.3F, 21U));
  const Jet large = pits(at.p * 11.0F, 0.20F, 31U);
  const Jet small = pits(at.p * 26.0F, 0.30F, 32U) * worn;
  const Jet tiny = pits(at.p * 61.0F, 0.35F, 33U) * worn;
  const Jet grain = fractal_noise(at.p * 26.0F, 3, 0.62F, 41U);
  const Jet tool = dishes(scaled(at.p, {10.0F, 17.0F, 10.0F}), 51U);
  w.height = cracks * -0.016F + large * 0.013F + small * 0.0075F + tiny * 0.003F + grain * 0.0011F +
             tool * 0.0065F;
  w.crack = cracks.value();
  w.grain = grain.value();
  w.pits = -large.value() - 0.6F * small.value();
  return w;
}

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return a + std::clamp(t, 0.0F, 1.0F) * (b - a);
}

/// What is left of the band's paint, and gold on its ridges.
Vec3f painted(const Place& at, const Vec3f& stone, float relief) {
  const float wear = fractal_noise(at.p * 6.0F, 4, 0.6F, 91U).value();
  const float paint = at.band.value() * smoothstep(-0.35F, 0.15F, wear + 20.0F * relief).value();
  const Vec3f c = mix(stone, {0.085F, 0.19F, 0.205F}, 0.75F * paint);
  const float ridge = smoothstep(0.004F, 0.011F, relief).value();
  const float gold = at.band.value() * ridge * smoothstep(-0.5F, 0.0F, wear).value();
  return mix(c, {0.50F, 0.34F, 0.13F}, 0.6F * gold);
}

/// Sandstone with darker recesses and lichen from above.
Vec3f color_of(const Place& at, const Weather& w, float relief) {
  const float large = fractal_noise(at.p * 1.9F, 3, 0.55F, 61U).value();
  Vec3f c = mix({0.36F, 0.31F, 0.245F}, {0.50F, 0.445F, 0.36F}, 0.5F + 0.8F * large);
  c = mix(c, {0.31F, 0.225F, 0.15F},
          0.75F * (fractal_noise(at.p * 3.1F, 2, 0.5F, 81U).value() - 0.1F));
  if (at.band.value() > 0.0F) c = painted(at, c, relief);
  const float hair = at.hair.value() * 0.55F;
  c = mix(c, {0.20F, 0.175F, 0.15F}, hair);
  const float recess = smoothstep(-0.001F, 0.016F, -relief).value();
  c = mix(c, {0.10F, 0.08F, 0.06F},
          0.55F * recess + 0.5F * w.crack + 0.4F * std::min(1.0F, w.pits));
  const float lichen = fractal_noise(at.p * 4.3F, 4, 0.65F, 101U).value() + 0.35F * at.normal.y();
  c = mix(c, {0.40F, 0.41F, 0.27F}, 0.7F * smoothstep(0.42F, 0.62F, lichen).value());
  return c * (1.0F + 0.16F * w.grain);
}

}  // namespace

Detail detail_at(const Vec3f& position, const Vec3f& base_normal) {
  const Place at = place_of(position, base_normal);
  const Jet carved = curls(at) * at.hair + band(at) + eyes(at) + ears(at) + brows_and_mouth(at) +
                     tattoo(at) + neck_rings(at);
  const Weather w = weather(at);
  const Jet height = carved + w.height * (1.0F - 0.35F * at.band.value());
  return {height.gradient(), color_of(at, w, carved.value())};
}

}  // namespace normalshop::demo
