#include "normalshop/core/normal_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

constexpr int chunk = 256;  ///< targets at a time: what they read stays in the nearest cache
constexpr int most_taps = 3;
constexpr int most_planes = 6;
constexpr std::size_t level_rows_per_task = 8;

using Planes = std::array<const float*, most_planes>;
using TapWeights = std::array<float, most_taps>;

/// Coverage, means and moments.
int planes_of(NormalSpace space) { return space == NormalSpace::Tangent ? 6 : 4; }
int means_of(NormalSpace space) { return space == NormalSpace::Tangent ? 2 : 3; }

/// Texels of the level below that one of `to` covers along an axis; the first is 2 i.
int tap_count(int from) { return from == 1 ? 1 : 2 + from % 2; }

/// Their shares of its length: from / to of them fit, the outer ones in part where that is odd.
TapWeights tap_weights(int i, int from, int to) {
  if (from == 1) return {1.0F, 0.0F, 0.0F};
  if (from % 2 == 0) return {0.5F, 0.5F, 0.0F};
  const auto size = static_cast<float>(from);
  return {static_cast<float>(to - i) / size, static_cast<float>(to) / size,
          static_cast<float>(i + 1) / size};
}

/// Targets above sources begin to end - 1.
std::pair<int, int> targets_above(int begin, int end, int from, int to) {
  const int first = std::max(0, (begin - tap_count(from) + 2) / 2);
  return {std::min(first, to), std::min(to, (end + 1) / 2)};
}

/// Vectors as what is averaged; `coverage` falls to 0 where there is no direction.
void to_planes(const Vec3f* vectors, int count, bool slopes, float* coverage, float* x, float* y,
               float* z) {
  constexpr float shortest = codes::shortest_normal * codes::shortest_normal;
  constexpr float longest = codes::longest_normal * codes::longest_normal;
  for (int i = 0; i < count; ++i) {
    const float vx = vectors[i].x();
    const float vy = vectors[i].y();
    const float vz = vectors[i].z();
    const float squared = vx * vx + vy * vy + vz * vz;
    const bool directed = squared >= shortest && squared <= longest;  // NaN is not
    const float length = std::sqrt(squared);
    const float divisor = slopes ? -std::max(vz, min_cosine * length) : length;
    const float inverse = 1.0F / divisor;
    x[i] = directed ? vx * inverse : 0.0F;
    y[i] = directed ? vy * inverse : 0.0F;
    z[i] = directed ? vz * inverse : 0.0F;
    coverage[i] = directed ? coverage[i] : 0.0F;
  }
}

}  // namespace

class NormalLevels::Builder {
 public:
  Builder(NormalLevels& levels, const NormalMap& map, const CoverageReader& covered)
      : levels_(levels),
        map_(map),
        covered_(covered),
        means_(means_of(levels.space_)),
        moments_(planes_of(levels.space_) - 1 - means_) {}

  /// Recomputes what lies above `texels`.
  void run(Rect texels) {
    texels = intersect(texels, {0, 0, map_.width(), map_.height()});
    for (int level = 1; level <= levels_.last() && !texels.empty(); ++level) {
      Level& target = levels_.at(level);
      const int from_width = level == 1 ? map_.width() : levels_.width(level - 1);
      const int from_height = level == 1 ? map_.height() : levels_.height(level - 1);
      const auto [x0, x1] = targets_above(texels.x0, texels.x1, from_width, target.width);
      const auto [y0, y1] = targets_above(texels.y0, texels.y1, from_height, target.height);
      texels = {x0, y0, x1, y1};
      fill(level, texels, from_width, from_height);
    }
  }

 private:
  /// Room for what level 1 reads of the map.
  struct Scratch {
    static constexpr int size = 2 * chunk + 1;
    std::array<Vec3f, size> vectors;
    std::array<std::array<std::array<float, size>, 4>, most_taps> rows;
    std::array<float, size> zeros{};
    std::array<std::array<float, chunk>, most_taps> x_weights;
    std::array<float, chunk> weight;
  };
  struct Run {
    int begin;
    int count;
    int y;
    int taps_x;
    int taps_y;
    TapWeights y_weights;
  };

  void fill(int level, const Rect& region, int from_width, int from_height) {
    Level& target = levels_.at(level);
    parallel_for(
        static_cast<std::size_t>(region.height()), level_rows_per_task,
        [&](std::size_t a, std::size_t b) {
          Scratch scratch;
          for (int x = region.x0; x < region.x1; x += chunk) {
            Run run{
                x, std::min(chunk, region.x1 - x), 0, tap_count(from_width), tap_count(from_height),
                {}};
            for (int i = 0; i < run.count; ++i) {
              const TapWeights w = tap_weights(x + i, from_width, target.width);
              for (std::size_t k = 0; k < most_taps; ++k) {
                scratch.x_weights[k][static_cast<std::size_t>(i)] = w[k];
              }
            }
            for (std::size_t row = a; row < b; ++row) {
              run.y = region.y0 + static_cast<int>(row);
              run.y_weights = tap_weights(run.y, from_height, target.height);
              fill_run(level, run, scratch);
            }
          }
        });
  }

  void fill_run(int level, const Run& run, Scratch& scratch) {
    std::array<Planes, most_taps> sources{};
    for (int j = 0; j < run.taps_y; ++j) {
      sources[static_cast<std::size_t>(j)] =
          level == 1 ? read_map(run, j, scratch) : read_level(levels_.at(level - 1), run, j);
    }
    Level& target = levels_.at(level);
    std::array<float*, most_planes> out{};
    for (int p = 0; p < target.planes; ++p) {
      out[static_cast<std::size_t>(p)] = target.row(run.y, p) + run.begin;
      std::fill_n(out[static_cast<std::size_t>(p)], run.count, 0.0F);
    }
    for_taps(run, sources, scratch,
             [&](const Planes& s, int k, const float* w) { add_means(s, k, w, run.count, out); });
    divide(out, 1, means_, run.count);
    if (moments_ == 0) return;
    for_taps(run, sources, scratch,
             [&](const Planes& s, int k, const float* w) { add_moments(s, k, w, run.count, out); });
    divide(out, 1 + means_, moments_, run.count);
  }

  template <class Add>
  static void for_taps(const Run& run, const std::array<Planes, most_taps>& sources,
                       Scratch& scratch, const Add& add) {
    for (std::size_t j = 0; j < static_cast<std::size_t>(run.taps_y); ++j) {
      for (int k = 0; k < run.taps_x; ++k) {
        const float* share = scratch.x_weights[static_cast<std::size_t>(k)].data();
        const float* coverage = sources[j][0];
        const float row = run.y_weights[j];
        float* weight = scratch.weight.data();
        for (int i = 0; i < run.count; ++i) weight[i] = row * share[i] * coverage[2 * i + k];
        add(sources[j], k, weight);
      }
    }
  }

  void add_means(const Planes& source, int k, const float* weight, int count,
                 const std::array<float*, most_planes>& out) const {
    for (int i = 0; i < count; ++i) out[0][i] += weight[i];
    for (std::size_t p = 1; p <= static_cast<std::size_t>(means_); ++p) {
      const float* value = source[p] + k;
      float* sum = out[p];
      for (int i = 0; i < count; ++i) sum[i] += weight[i] * value[2 * i];
    }
  }

  /// Moments below, and those of the means below around the mean here.
  static void add_moments(const Planes& source, int k, const float* weight, int count,
                          const std::array<float*, most_planes>& out) {
    for (int i = 0; i < count; ++i) {
      const int from = 2 * i + k;
      const float dx = source[1][from] - out[1][i];
      const float dy = source[2][from] - out[2][i];
      out[3][i] += weight[i] * (source[3][from] + dx * dx);
      out[4][i] += weight[i] * (source[4][from] + dx * dy);
      out[5][i] += weight[i] * (source[5][from] + dy * dy);
    }
  }

  static void divide(const std::array<float*, most_planes>& out, int first, int planes, int count) {
    for (int p = first; p < first + planes; ++p) {
      float* sum = out[static_cast<std::size_t>(p)];
      for (int i = 0; i < count; ++i) sum[i] = out[0][i] > 0.0F ? sum[i] / out[0][i] : 0.0F;
    }
  }

  Planes read_level(const Level& from, const Run& run, int j) const {
    Planes planes{};
    for (int p = 0; p < from.planes; ++p) {
      planes[static_cast<std::size_t>(p)] = from.row(2 * run.y + j, p) + 2 * run.begin;
    }
    return planes;
  }

  Planes read_map(const Run& run, int j, Scratch& scratch) const {
    const int x = 2 * run.begin;
    const int y = 2 * run.y + j;
    const int count = 2 * (run.count - 1) + run.taps_x;
    auto& row = scratch.rows[static_cast<std::size_t>(j)];
    std::fill_n(row[0].data(), count, 1.0F);
    if (covered_) covered_(x, count, y, row[0].data());
    map_.read_vectors(x, count, y, scratch.vectors.data());
    to_planes(scratch.vectors.data(), count, moments_ > 0, row[0].data(), row[1].data(),
              row[2].data(), row[3].data());
    const float* none = scratch.zeros.data();
    if (moments_ > 0) return {row[0].data(), row[1].data(), row[2].data(), none, none, none};
    return {row[0].data(), row[1].data(), row[2].data(), row[3].data(), nullptr, nullptr};
  }

  NormalLevels& levels_;
  const NormalMap& map_;
  const CoverageReader& covered_;
  int means_;
  int moments_;
};

NormalLevels::NormalLevels(const NormalMap& map, const CoverageReader& covered)
    : space_(map.convention().space) {
  if (map.empty()) throw InvalidInput("a map has mip levels from 1 x 1 texels on");
  int columns = map.width();
  int rows = map.height();
  while (columns > 1 || rows > 1) {
    columns = std::max(1, columns / 2);
    rows = std::max(1, rows / 2);
    const int planes = planes_of(space_);
    levels_.push_back({columns, rows, planes, Image<float>(planes * columns, rows)});
  }
  update(map, {0, 0, map.width(), map.height()}, covered);
}

void NormalLevels::update(const NormalMap& map, const Rect& texels, const CoverageReader& covered) {
  Builder(*this, map, covered).run(texels);
}

Vec3f NormalLevels::normal(int level, int x, int y) const {
  while (coverage(level, x, y) == 0.0F) {
    if (level == last()) return Vec3f::Zero();
    ++level;
    x = std::min(x / 2, width(level) - 1);
    y = std::min(y / 2, height(level) - 1);
  }
  const Level& here = at(level);
  if (space_ == NormalSpace::Tangent) {
    return normal_from_slope({here.row(y, 1)[x], here.row(y, 2)[x]});
  }
  return Vec3f(here.row(y, 1)[x], here.row(y, 2)[x], here.row(y, 3)[x]).stableNormalized();
}

SlopeVariance NormalLevels::variance(int level, int x, int y) const {
  const Level& here = at(level);
  if (here.row(y, 0)[x] == 0.0F) return {};
  if (space_ == NormalSpace::Tangent) {
    return {here.row(y, 3)[x], here.row(y, 4)[x], here.row(y, 5)[x]};
  }
  const float length =
      std::min(1.0F, Vec3f(here.row(y, 1)[x], here.row(y, 2)[x], here.row(y, 3)[x]).norm());
  // Opposite directions cancel out: as steep as slopes get.
  const float variance = std::min((1.0F - length) / std::max(length, 1e-6F), max_slope * max_slope);
  return {variance, 0.0F, variance};
}

RawImage NormalLevels::encode(int level, CodeType type, const NormalConvention& convention) const {
  const int columns = width(level);
  RawImage image(columns, height(level), codes::normal_channels(convention), type);
  parallel_rows(height(level), [&](int y) {
    std::vector<Vec3f> normals(static_cast<std::size_t>(columns));
    for (int x = 0; x < columns; ++x) normals[static_cast<std::size_t>(x)] = normal(level, x, y);
    codes::encode_texels(normals.data(), columns, convention, image, 0, y);
  });
  return image;
}

std::size_t NormalLevels::size_bytes() const {
  std::size_t bytes = 0;
  for (const Level& level : levels_) bytes += level.values.size() * sizeof(float);
  return bytes;
}

float widened_roughness(float roughness, const SlopeVariance& variance) {
  const float alpha = roughness * roughness;
  const float squared = alpha * alpha + variance.xx + variance.yy;
  return std::min(1.0F, std::sqrt(std::sqrt(squared)));
}

RawImage roughness_map(const NormalLevels& levels, int level, float roughness, CodeType type) {
  if (level < 1 || level > levels.last()) {
    throw InvalidInput("the map has mip levels 1 to " + std::to_string(levels.last()) + ", not " +
                       std::to_string(level));
  }
  if (!(roughness >= 0.0F && roughness <= 1.0F)) {
    throw InvalidInput("a roughness is 0 (a mirror) to 1");
  }
  const int columns = levels.width(level);
  RawImage image(columns, levels.height(level), 1, type);
  const float full = RawImage::full_code(type);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < columns; ++x) {
      const float value = widened_roughness(roughness, levels.variance(level, x, y));
      const auto code = static_cast<std::uint32_t>(std::lround(full * value));
      if (type == CodeType::U8) image.row<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(code);
      if (type == CodeType::U16) image.row<std::uint16_t>(y)[x] = static_cast<std::uint16_t>(code);
      if (type == CodeType::F32) image.row<float>(y)[x] = value;
    }
  }
  return image;
}

}  // namespace normalshop
