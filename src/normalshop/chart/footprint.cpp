#include "normalshop/chart/footprint.h"

#include <algorithm>
#include <cmath>

#include "normalshop/core/normal_codes.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

int samples_along(const Vec2f& uv_step, const Vec2f& size) {
  const float texels = uv_step.cwiseProduct(size).norm();
  if (!(texels > fine_texels)) return 1;
  return static_cast<int>(std::ceil(std::min(texels, static_cast<float>(FootprintReader::most))));
}

float sample_offset(int i, int count) {
  return (static_cast<float>(i) + 0.5F) / static_cast<float>(count) - 0.5F;
}

int texel_of(float u, int size) {
  const float inside = u - static_cast<float>(floor_to_int(u));
  return std::clamp(static_cast<int>(inside * static_cast<float>(size)), 0, size - 1);
}

}  // namespace

void FootprintReader::add(const PixelRun& run, int x, int y) {
  const PixelTriangle& t = triangles_.get(run.triangle);
  const float py = static_cast<float>(y) - t.y0;
  for (int i = run.begin; i < run.end; ++i) {
    const auto k = static_cast<std::size_t>(count_++);
    const float px = static_cast<float>(x + i) - t.x0;
    const auto set = [k](Affine& a, float at, float dx, float dy) {
      a.at[k] = at;
      a.dx[k] = dx;
      a.dy[k] = dy;
    };
    const Vec2f b = px * t.dx + py * t.dy;
    const Vec2f uv = t.uv + b.x() * t.uv1 + b.y() * t.uv2;
    set(b1_, b.x(), t.dx.x(), t.dy.x());
    set(b2_, b.y(), t.dx.y(), t.dy.y());
    set(u_, uv.x(), t.uv_dx.x(), t.uv_dy.x());
    set(v_, uv.y(), t.uv_dx.y(), t.uv_dy.y());
    pixel_[k] = i;
    id_[k] = run.triangle;
    sum_.set(static_cast<int>(k), Vec3f::Zero());
    total_[k] = 0.0F;
  }
}

/// Does the chart of the atlas go on to `uv`, so that the view shows it at that place of the chart?
/// A triangle that owns the texel must itself say so, to half a pixel.
bool FootprintReader::goes_on(std::size_t lane, const Vec2f& uv, const Vec2f& pixel,
                              const Vec2f& size) {
  const Image<std::uint32_t>& owners = storage_.sets[set_].texels.owner();
  if (owners.empty() || !(std::abs(uv.x()) < 1e6F && std::abs(uv.y()) < 1e6F)) return false;
  const std::uint32_t owner =
      owners(texel_of(uv.x(), owners.width()), texel_of(uv.y(), owners.height()));
  if (owner == no_triangle) return false;
  if (owner == id_[lane]) return true;
  const PixelTriangle& other = triangles_.get(owner);
  const Vec2f b = (pixel.x() - other.x0) * other.dx + (pixel.y() - other.y0) * other.dy;
  Vec2f off = other.uv + b.x() * other.uv1 + b.y() * other.uv2 - uv;
  off -= Vec2f(std::round(off.x()), std::round(off.y()));  // maps repeat
  const float across = Vec2f(u_.dx[lane], v_.dx[lane]).cwiseProduct(size).squaredNorm();
  const float down = Vec2f(u_.dy[lane], v_.dy[lane]).cwiseProduct(size).squaredNorm();
  return off.cwiseProduct(size).squaredNorm() <= 0.25F * std::max(across, down);
}

/// Of a lane whose places are not both inside its triangle.
bool FootprintReader::both_go_on(std::size_t lane, const Vec2f& offset, const Vec2f& size) {
  const Vec2f middle(x_ + static_cast<float>(pixel_[lane]), y_);
  const auto goes = [&](float sign, float u, float v) {
    const Vec2f o = sign * offset;
    const float b1 = b1_.at[lane] + o.x() * b1_.dx[lane] + o.y() * b1_.dy[lane];
    const float b2 = b2_.at[lane] + o.x() * b2_.dx[lane] + o.y() * b2_.dy[lane];
    if (b1 >= 0.0F && b2 >= 0.0F && b1 + b2 <= 1.0F) return true;
    return goes_on(lane, {u, v}, middle + o, size);
  };
  return goes(1.0F, u0_[lane], v0_[lane]) && goes(-1.0F, u1_[lane], v1_[lane]);
}

/// The places at that offset from the pixels' middles, and those opposite.
void FootprintReader::find_places(const Vec2f& offset, const Vec2f& size) {
  const auto step = [&](const Affine& a, std::size_t k) {
    return offset.x() * a.dx[k] + offset.y() * a.dy[k];
  };
  const auto lanes = static_cast<std::size_t>(count_);
  for (std::size_t k = 0; k < lanes; ++k) {
    const float du = step(u_, k);
    const float dv = step(v_, k);
    const float db1 = step(b1_, k);
    const float db2 = step(b2_, k);
    u0_[k] = u_.at[k] + du;
    v0_[k] = v_.at[k] + dv;
    u1_[k] = u_.at[k] - du;
    v1_[k] = v_.at[k] - dv;
    const float least = std::min(b1_.at[k] - std::abs(db1), b2_.at[k] - std::abs(db2));
    const float most_sum = b1_.at[k] + b2_.at[k] + std::abs(db1 + db2);
    counts_[k] = std::min(least, 1.0F - most_sum) >= 0.0F ? 1.0F : 0.0F;
  }
  for (std::size_t k = 0; k < lanes; ++k) {
    if (counts_[k] > 0.0F) continue;
    if (both_go_on(k, offset, size)) {
      counts_[k] = 1.0F;
    } else {
      u0_[k] = u1_[k] = u_.at[k];
      v0_[k] = v1_[k] = v_.at[k];
    }
  }
}

void FootprintReader::keep_inside(std::uint32_t set, const Vec2f& size, Lane& u, Lane& v) const {
  if (mesh_.repeats(set)) return;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const Vec2f place = reading_place(mesh_, set, {u[k], v[k]}, static_cast<int>(size.x()),
                                      static_cast<int>(size.y()));
    u[k] = place.x();
    v[k] = place.y();
  }
}

/// sample(u, v) reads the lanes' places and adds what counts.
template <class Sample>
void FootprintReader::add_samples(const Counts& counts, const Vec2f& size, const Sample& sample) {
  const int last = counts.across * counts.down - 1;
  for (int i = 0; 2 * i <= last; ++i) {
    find_places({sample_offset(i % counts.across, counts.across),
                 sample_offset(i / counts.across, counts.down)},
                size);
    keep_inside(set_, size, u0_, v0_);
    sample(u0_.data(), v0_.data());
    if (2 * i == last) continue;
    keep_inside(set_, size, u1_, v1_);
    sample(u1_.data(), v1_.data());
  }
}

/// take(counts, size) fills sum_ and total_ of runs that take equally many samples, then finishes.
template <class SizeOf, class Take>
void FootprintReader::read(std::span<const PixelRun> runs, int x, int y, const SizeOf& size_of,
                           const Take& take) {
  std::array<Counts, PixelRow::capacity> counts;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const PixelTriangle& t = triangles_.get(runs[i].triangle);
    const Vec2f size = size_of(t.texture_set);
    counts[i] = {samples_along(t.uv_dx, size), samples_along(t.uv_dy, size), t.texture_set};
  }
  x_ = static_cast<float>(x);
  y_ = static_cast<float>(y);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Counts wanted = counts[i];
    if (wanted.across * wanted.down == 1) continue;  // fine, or done
    count_ = 0;
    set_ = wanted.texture_set;
    for (std::size_t j = i; j < runs.size(); ++j) {
      if (!(counts[j] == wanted)) continue;
      add(runs[j], x, y);
      counts[j] = {};
    }
    take(wanted, size_of(set_));
  }
}

void FootprintReader::add_slopes() {
  constexpr float shortest = codes::shortest_normal * codes::shortest_normal;
  constexpr float longest = codes::longest_normal * codes::longest_normal;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const float x = sample_.x[k];
    const float y = sample_.y[k];
    const float z = sample_.z[k];
    const float squared = x * x + y * y + z * z;
    const bool directed = counts_[k] > 0.0F && squared >= shortest && squared <= longest;
    const float inverse = 1.0F / std::max(z, min_cosine * std::sqrt(squared));
    sum_.x[k] += directed ? x * inverse : 0.0F;
    sum_.y[k] += directed ? y * inverse : 0.0F;
    sum_.z[k] += directed ? 1.0F : 0.0F;
    total_[k] += directed ? 1.0F : 0.0F;
  }
}

void FootprintReader::add_units() {
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const Vec3f n = codes::direction_of({sample_.x[k], sample_.y[k], sample_.z[k]});
    if (!(counts_[k] > 0.0F) || n.isZero()) continue;
    sum_.x[k] += n.x();
    sum_.y[k] += n.y();
    sum_.z[k] += n.z();
    total_[k] += 1.0F;
  }
}

void FootprintReader::add_colors() {
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    sum_.x[k] += counts_[k] * sample_.x[k];
    sum_.y[k] += counts_[k] * sample_.y[k];
    sum_.z[k] += counts_[k] * sample_.z[k];
    total_[k] += counts_[k];
  }
}

void FootprintReader::normals(std::span<const PixelRun> runs, int x, int y,
                              PixelRow::Vectors& stored) {
  const auto size_of = [&](std::uint32_t set) {
    return size_in_texels(storage_.sets[set].normals.codes());
  };
  read(runs, x, y, size_of, [&](const Counts& counts, const Vec2f& size) {
    const NormalMap& map = storage_.sets[set_].normals;
    const bool tangent = map.convention().space == NormalSpace::Tangent;
    add_samples(counts, size, [&](const float* u, const float* v) {
      map.sample(u, v, count_, sample_.x.data(), sample_.y.data(), sample_.z.data());
      tangent ? add_slopes() : add_units();
    });
    for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
      const Vec3f sum(sum_.x[k], sum_.y[k], sum_.z[k]);
      const float length = sum.norm();
      if (length > 1e-3F * total_[k]) stored.set(pixel_[k], sum / length);
    }
  });
}

void FootprintReader::colors(std::span<const PixelRun> runs, int x, int y,
                             PixelRow::Vectors& color) {
  const auto size_of = [&](std::uint32_t set) {
    return size_in_texels(storage_.sets[set].albedo.codes());
  };
  read(runs, x, y, size_of, [&](const Counts& counts, const Vec2f& size) {
    const ColorMap& map = storage_.sets[set_].albedo;
    add_samples(counts, size, [&](const float* u, const float* v) {
      map.sample(u, v, count_, sample_.x.data(), sample_.y.data(), sample_.z.data());
      add_colors();
    });
    for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
      const Vec3f sum(sum_.x[k], sum_.y[k], sum_.z[k]);
      if (total_[k] > 0.0F) color.set(pixel_[k], sum / total_[k]);
    }
  });
}

}  // namespace normalshop
