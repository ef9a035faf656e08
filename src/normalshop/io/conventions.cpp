#include "normalshop/io/conventions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

constexpr int band_rows = 64;
constexpr int max_bands = 16;

/// First rows of the bands that are read: all of a small image, evenly spread ones of a large.
std::vector<int> bands_of(const RawImage& codes) {
  const int all = std::max(1, codes.height() / band_rows);
  const int count = std::min(all, max_bands);
  std::vector<int> bands;
  bands.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) bands.push_back(i * all / count * band_rows);
  return bands;
}

int rows_in(const RawImage& codes, int band) { return std::min(band_rows, codes.height() - band); }

/// visit(band index) on all cores.
template <class Visit>
void for_each_band(std::size_t count, Visit visit) {
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) visit(i);
  });
}

/// What one band says about the codes themselves.
struct CodeCounts {
  std::array<float, 3> min{};
  std::array<float, 3> max{};
  std::array<double, 3> sum{};
  std::array<std::size_t, 2> below{};   ///< codes just below the centre, red and green
  std::array<std::size_t, 2> centre{};  ///< codes 128 or 32768
  std::array<std::size_t, 2> above{};
  std::size_t gray = 0;
  std::size_t count = 0;
};

CodeCounts count_codes(const RawImage& codes, int band) {
  CodeCounts result;
  result.min.fill(std::numeric_limits<float>::max());
  result.max.fill(std::numeric_limits<float>::lowest());
  const float middle = codes.type() == CodeType::U8 ? 128.0F : 32768.0F;
  const int channels = std::min(codes.channels(), 3);
  for (int y = band; y < band + rows_in(codes, band); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      std::array<float, 3> c{};
      for (int i = 0; i < channels; ++i) {
        const auto k = static_cast<std::size_t>(i);
        c[k] = codes.code(x, y, i);
        if (!std::isfinite(c[k])) c[k] = 0.0F;
        result.min[k] = std::min(result.min[k], c[k]);
        result.max[k] = std::max(result.max[k], c[k]);
        result.sum[k] += static_cast<double>(c[k]);
        if (k == 2) continue;
        result.below[k] += c[k] == middle - 1.0F ? 1U : 0U;
        result.centre[k] += c[k] == middle ? 1U : 0U;
        result.above[k] += c[k] == middle + 1.0F ? 1U : 0U;
      }
      result.gray += c[0] == c[1] && c[1] == c[2] ? 1U : 0U;
      ++result.count;
    }
  }
  return result;
}

void merge(CodeCounts& into, const CodeCounts& from) {
  for (std::size_t k = 0; k < 3; ++k) {
    into.min[k] = std::min(into.min[k], from.min[k]);
    into.max[k] = std::max(into.max[k], from.max[k]);
    into.sum[k] += from.sum[k];
  }
  for (std::size_t k = 0; k < 2; ++k) {
    into.below[k] += from.below[k];
    into.centre[k] += from.centre[k];
    into.above[k] += from.above[k];
  }
  into.gray += from.gray;
  into.count += from.count;
}

CodeCounts count_codes(const RawImage& codes) {
  const std::vector<int> bands = bands_of(codes);
  std::vector<CodeCounts> parts(bands.size());
  for_each_band(bands.size(), [&](std::size_t i) { parts[i] = count_codes(codes, bands[i]); });
  for (std::size_t i = 1; i < parts.size(); ++i) merge(parts[0], parts[i]);
  return parts[0];
}

/// Flat areas make a spike at the code of zero; without one the question has no answer and matters
/// little.
bool is_centred(const CodeCounts& counts) {
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t beside = std::max(counts.below[k], counts.above[k]);
    if (2 * counts.centre[k] < 3 * beside || counts.centre[k] * 100 < counts.count) return false;
  }
  return true;
}

bool has_signed_floats(const CodeCounts& counts) {
  const double n = static_cast<double>(counts.count);
  if (counts.min[0] < -0.001F || counts.min[1] < -0.001F) return true;
  // A flat map: (0, 0, 1) instead of (0.5, 0.5, 1).
  return counts.sum[0] / n < 0.1 && counts.sum[1] / n < 0.1;
}

/// A constant blue that no normal towards the viewer has. With a constant 255 the three channels
/// still give a direction, and renderers take that one.
bool has_two_channels(const RawImage& codes, const CodeCounts& counts,
                      const NormalConvention& convention) {
  if (codes.channels() == 2) return true;
  const CodeRange range = code_range(codes.type(), convention);
  return counts.min[2] == counts.max[2] && counts.min[2] * range.scale + range.offset < 0.1F &&
         (counts.min[0] != counts.max[0] || counts.min[1] != counts.max[1]);
}

Vec3f decode(const RawImage& codes, const NormalConvention& convention, const CodeRange& range,
             int x, int y) {
  Vec3f n(codes.code(x, y, 0) * range.scale + range.offset,
          codes.code(x, y, 1) * range.scale + range.offset, 0.0F);
  n.z() = convention.two_channel ? std::sqrt(std::max(0.0F, 1.0F - n.squaredNorm()))
                                 : codes.code(x, y, 2) * range.scale + range.offset;
  return n;
}

struct Directions {
  double length_sum = 0.0;
  double length_min = 1e30;
  double length_max = 0.0;
  Vec3d sum = Vec3d::Zero();
  std::size_t negative = 0;
  std::size_t count = 0;
};

/// Slopes of the bands, one below the other; not a number where there is none.
struct Slopes {
  SlopeImage image;
  std::vector<int> rows;  ///< of each band
};

Directions read_band(const RawImage& codes, const NormalConvention& convention, int band,
                     SlopeImage& slopes, int target) {
  const CodeRange range = code_range(codes.type(), convention);
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  Directions d;
  for (int y = 0; y < rows_in(codes, band); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      const Vec3f n = decode(codes, convention, range, x, band + y);
      const float length = n.norm();
      const bool usable = length >= 0.25F && std::isfinite(length);
      const bool towards = usable && n.z() > 0.1F * length;
      slopes(x, target + y) = towards ? Vec2f(-n.x() / n.z(), -n.y() / n.z()) : Vec2f(none, none);
      if (!usable) continue;
      const auto exact = static_cast<double>(length);
      d.length_sum += exact;
      d.length_min = std::min(d.length_min, exact);
      d.length_max = std::max(d.length_max, exact);
      d.sum += n.cast<double>() / exact;
      d.negative += n.z() < -0.1F * length ? 1U : 0U;
      ++d.count;
    }
  }
  return d;
}

Directions read_directions(const RawImage& codes, const NormalConvention& convention,
                           Slopes& slopes) {
  const std::vector<int> bands = bands_of(codes);
  slopes.image.resize(codes.width(), static_cast<int>(bands.size()) * band_rows);
  std::vector<Directions> parts(bands.size());
  for (const int band : bands) slopes.rows.push_back(rows_in(codes, band));
  for_each_band(bands.size(), [&](std::size_t i) {
    parts[i] =
        read_band(codes, convention, bands[i], slopes.image, static_cast<int>(i) * band_rows);
  });
  Directions all;
  for (const Directions& part : parts) {
    all.length_sum += part.length_sum;
    all.length_min = std::min(all.length_min, part.length_min);
    all.length_max = std::max(all.length_max, part.length_max);
    all.sum += part.sum;
    all.negative += part.negative;
    all.count += part.count;
  }
  return all;
}

/// Mean slope of a block; not a number when any of its texels is none.
Vec2f block_mean(const SlopeImage& slopes, int x, int y, int scale) {
  Vec2f sum = Vec2f::Zero();
  for (int j = 0; j < scale; ++j) {
    for (int i = 0; i < scale; ++i) sum += slopes(x + i, y + j);
  }
  return sum / static_cast<float>(scale * scale);
}

/// The two halves of the curl, d p / d y (up) and d q / d x, per cell of 2 x 2 blocks.
std::vector<Vec2f> curl_halves(const Slopes& slopes, std::size_t band, int scale) {
  std::vector<Vec2f> cells;
  const int top = static_cast<int>(band) * band_rows;
  for (int y = 0; y + 2 * scale <= slopes.rows[band]; y += scale) {
    for (int x = 0; x + 2 * scale <= slopes.image.width(); x += scale) {
      const Vec2f a = block_mean(slopes.image, x, top + y, scale);
      const Vec2f b = block_mean(slopes.image, x + scale, top + y, scale);
      const Vec2f c = block_mean(slopes.image, x, top + y + scale, scale);
      const Vec2f d = block_mean(slopes.image, x + scale, top + y + scale, scale);
      const Vec2f cell(a.x() + b.x() - c.x() - d.x(), b.y() + d.y() - a.y() - c.y());
      if (std::isfinite(cell.x()) && std::isfinite(cell.y())) cells.push_back(cell);
    }
  }
  return cells;
}

/// log of (curl with q negated / curl with q), less the part that both have. Cells far steeper than
/// the mean (borders of charts) weigh no more than their share: noise there would drown the rest.
double log_curl_ratio(const Slopes& slopes, int scale) {
  std::vector<std::vector<Vec2f>> bands(slopes.rows.size());
  for_each_band(bands.size(), [&](std::size_t i) { bands[i] = curl_halves(slopes, i, scale); });
  double energy = 0.0;
  std::size_t count = 0;
  for (const auto& cells : bands) {
    for (const Vec2f& cell : cells) energy += static_cast<double>(cell.squaredNorm());
    count += cells.size();
  }
  if (count < 256 || !(energy > 0.0)) return 0.0;
  const double mean = energy / static_cast<double>(count);
  double as_is = 0.0;
  double negated = 0.0;
  for (const auto& cells : bands) {
    for (const Vec2f& cell : cells) {
      const auto p = static_cast<double>(cell.x());
      const auto q = static_cast<double>(cell.y());
      const double weight = 1.0 / (p * p + q * q + mean);
      // (p -+ q)^2 = (|p| - |q|)^2 + 2 (|pq| -+ pq): the first part is the same for both signs.
      as_is += weight * (std::abs(p * q) - p * q);
      negated += weight * (std::abs(p * q) + p * q);
    }
  }
  const double floor = 1e-6 * (as_is + negated);
  return std::log((negated + floor) / (as_is + floor));
}

/// Coarser scales are freer of noise from coding and compression: the clearest one counts.
double clearest_log_ratio(const Slopes& slopes) {
  double best = 0.0;
  for (const int scale : {1, 2, 4, 8, 16}) {
    const double ratio = log_curl_ratio(slopes, scale);
    if (std::abs(ratio) > std::abs(best)) best = ratio;
  }
  return best;
}

void guess_space(const Directions& d, ConventionGuess& guess) {
  if (guess.convention.two_channel || d.count == 0) {
    guess.space_confidence = d.count == 0 ? 0.0 : 1.0;
    return;
  }
  const double n = static_cast<double>(d.count);
  const double towards = d.sum.z() / n - 2.0 * static_cast<double>(d.negative) / n;
  constexpr double boundary = 0.35;
  if (towards < boundary) guess.convention.space = NormalSpace::Object;
  guess.space_confidence = std::min(1.0, std::abs(towards - boundary) / boundary);
}

void guess_green(const Slopes& slopes, ConventionGuess& guess) {
  const double ratio = clearest_log_ratio(slopes);
  guess.green_ratio = std::exp(std::abs(ratio));
  guess.green_confidence = 1.0 - 1.0 / guess.green_ratio;
  guess.convention.green_down = ratio < 0.0 && guess.green_ratio >= 2.0;
}

std::string sentence_of(const ConventionGuess& guess, std::optional<NormalSpace> looks_like) {
  const NormalConvention& c = guess.convention;
  std::array<char, 64> number{};
  std::string text = std::string(name_of(c.space)) + " space";
  std::snprintf(number.data(), number.size(), " (%.0f %% sure)", 100.0 * guess.space_confidence);
  if (!looks_like) {
    text += number.data();
  } else if (*looks_like != c.space) {
    text += " as given, though it looks like " + std::string(name_of(*looks_like)) + " space";
  }
  if (c.space == NormalSpace::Tangent && guess.green_ratio >= 2.0) {
    std::snprintf(number.data(), number.size(), "%.1f", std::min(guess.green_ratio, 999.0));
    text += c.green_down ? ", green down (DirectX)" : ", green up (OpenGL)";
    text += ": the other sign makes the curl " + std::string(number.data()) + " times larger";
  } else if (c.space == NormalSpace::Tangent) {
    text += ", green undecided: up (OpenGL) is assumed";
  }
  if (c.two_channel) text += "; two channels, z follows from them";
  if (c.centred_code) text += "; the middle code stands for 0";
  if (c.signed_float) text += "; signed floats";
  return text;
}

}  // namespace

ConventionGuess guess_convention(const RawImage& codes, std::optional<NormalSpace> known_space) {
  if (codes.empty() || codes.channels() < 2) {
    throw InvalidInput("a normal map needs 2 to 4 channels; this image has " +
                       std::to_string(codes.channels()));
  }
  ConventionGuess guess;
  const CodeCounts counts = count_codes(codes);
  const bool floats = codes.type() == CodeType::F32;
  guess.convention.signed_float = floats && has_signed_floats(counts);
  guess.convention.two_channel = has_two_channels(codes, counts, guess.convention);
  guess.convention.centred_code = !floats && is_centred(counts);
  Slopes slopes;
  const Directions directions = read_directions(codes, guess.convention, slopes);
  if (directions.count > 0) {
    guess.lengths = {directions.length_sum / static_cast<double>(directions.count),
                     directions.length_min, directions.length_max};
  }
  guess_space(directions, guess);
  std::optional<NormalSpace> looks_like;
  if (known_space) {
    looks_like = std::exchange(guess.convention.space, *known_space);
    guess.space_confidence = 1.0;
    // The guess knows no world space: it looks like object space.
    const bool alike =
        (*known_space == NormalSpace::Tangent) == (*looks_like == NormalSpace::Tangent);
    if (alike) looks_like = known_space;
  }
  if (guess.convention.space == NormalSpace::Tangent) guess_green(slopes, guess);
  guess.sentence = sentence_of(guess, looks_like);
  return guess;
}

bool looks_like_normal_map(const RawImage& codes) {
  if (codes.empty() || codes.channels() < 3) return false;
  const CodeCounts counts = count_codes(codes);
  if (counts.gray * 2 > counts.count) return false;
  NormalConvention convention;
  convention.signed_float = codes.type() == CodeType::F32 && has_signed_floats(counts);
  const CodeRange range = code_range(codes.type(), convention);
  std::size_t near_unit = 0;
  std::size_t count = 0;
  for (const int band : bands_of(codes)) {
    for (int x = 0; x < codes.width(); ++x, ++count) {
      const float length = decode(codes, convention, range, x, band).norm();
      near_unit += length > 0.8F && length < 1.2F ? 1U : 0U;
    }
  }
  return near_unit * 5 > count * 4;
}

}  // namespace normalshop
