#include <algorithm>
#include <cmath>
#include <vector>

#include "normalshop/core/error.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"
#include "normalshop/core/slope.h"

namespace normalshop {

namespace {

constexpr std::size_t resized_rows_per_task = 64;
constexpr int padding = 2;  ///< cubic taps reach this far beyond the border

/// Sources and weights of the targets along one axis: 4 cubic taps each when growing, the covered
/// span when shrinking. Sources may lie up to `padding` outside.
class Taps {
 public:
  Taps(int from, int to) : per_target_(from <= to ? 4 : from / to + 2) {
    first_.resize(static_cast<std::size_t>(to));
    weights_.assign(first_.size() * static_cast<std::size_t>(per_target_), 0.0F);
    const double step = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i) {
      if (from <= to) {
        set_cubic(i, (i + 0.5) * step - 0.5);
      } else {
        set_area(i, i * step, step, from);
      }
    }
  }
  int count() const { return per_target_; }
  int first(int i) const { return first_[static_cast<std::size_t>(i)]; }
  const float* weights(int i) const { return &weights_[static_cast<std::size_t>(i * per_target_)]; }

 private:
  float* weights(int i) { return &weights_[static_cast<std::size_t>(i * per_target_)]; }
  void set_cubic(int i, double centre) {
    const int base = static_cast<int>(std::floor(centre));
    first_[static_cast<std::size_t>(i)] = base - 1;
    std::ranges::copy(cubic_weights(static_cast<float>(centre - base)), weights(i));
  }
  void set_area(int i, double begin, double step, int from) {
    // Counted from the end near the border, so that all taps lie inside.
    const int first = std::min(static_cast<int>(begin), from - per_target_);
    first_[static_cast<std::size_t>(i)] = std::max(0, first);
    for (int k = 0; k < per_target_; ++k) {
      const double j = this->first(i) + k;
      const double covered = std::min(begin + step, j + 1.0) - std::max(begin, j);
      weights(i)[k] = static_cast<float>(std::max(0.0, covered) / step);
    }
  }

  int per_target_;
  std::vector<int> first_;
  std::vector<float> weights_;
};

/// What is resampled, one plane a number: slopes in tangent space (details stay slopes), unit
/// vectors elsewhere.
int plane_count(const NormalMap& map) {
  return map.convention().space == NormalSpace::Tangent ? 2 : 3;
}

using Plane = std::vector<float>;

/// Source rows, resampled along x. Keeps the last rows that the cubic or the area needs.
class RowCache {
 public:
  RowCache(const NormalMap& map, const Taps& taps, int width, int rows)
      : map_(map),
        taps_(taps),
        width_(width),
        normals_(static_cast<std::size_t>(map.width())),
        source_(static_cast<std::size_t>(map.width() + 2 * padding)),
        rows_(static_cast<std::size_t>(rows)) {
    for (Row& row : rows_) {
      row.values.resize(static_cast<std::size_t>(width * plane_count(map)));
    }
  }
  /// All planes of source row y, one behind the other. Stays valid for the cache's number of rows.
  const float* row(int y) {
    const int inside = std::clamp(y, 0, map_.height() - 1);
    Row& row = rows_[static_cast<std::size_t>(inside) % rows_.size()];
    if (row.y != inside) fill(row, inside);
    return row.values.data();
  }

 private:
  struct Row {
    int y = -1;
    Plane values;
  };

  void fill(Row& row, int y) {
    row.y = y;
    map_.read_normals(y, normals_.data());
    const int planes = plane_count(map_);
    if (planes == 2) {
      for (Vec3f& n : normals_) {
        const Vec2f slope = slope_from_normal(n);
        n = {slope.x(), slope.y(), 1.0F};
      }
    }
    for (int p = 0; p < planes; ++p) {
      load(p);
      resample(row.values.data() + static_cast<std::ptrdiff_t>(p) * width_);
    }
  }
  void load(int plane) {
    float* inside = source_.data() + padding;
    for (int x = 0; x < map_.width(); ++x) inside[x] = normals_[static_cast<std::size_t>(x)][plane];
    std::fill_n(source_.data(), padding, inside[0]);
    std::fill_n(inside + map_.width(), padding, inside[map_.width() - 1]);
  }
  void resample(float* target) const {
    for (int x = 0; x < width_; ++x) {
      const float* from = source_.data() + padding + taps_.first(x);
      const float* weights = taps_.weights(x);
      float sum = 0.0F;
      for (int k = 0; k < taps_.count(); ++k) sum += weights[k] * from[k];
      target[x] = sum;
    }
  }

  const NormalMap& map_;
  const Taps& taps_;
  int width_;
  std::vector<Vec3f> normals_;
  Plane source_;
  std::vector<Row> rows_;
};

/// Columns (rows) of the nearest source of each target.
std::vector<int> nearest(int from, int to) {
  std::vector<int> sources(static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    sources[static_cast<std::size_t>(i)] =
        static_cast<int>((2 * static_cast<std::int64_t>(i) + 1) * from / (2 * to));
  }
  return sources;
}

void weigh_rows(RowCache& rows, const Taps& taps, int y, Plane& sum) {
  std::ranges::fill(sum, 0.0F);
  for (int k = 0; k < taps.count(); ++k) {
    const float weight = taps.weights(y)[k];
    if (weight == 0.0F) continue;
    const float* row = rows.row(taps.first(y) + k);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * row[i];
  }
}

void to_normals(const Plane& planes, std::vector<Vec3f>& normals) {
  const std::size_t width = normals.size();
  const float* x = planes.data();
  const float* y = x + width;
  if (planes.size() == 2 * width) {
    for (std::size_t i = 0; i < width; ++i) normals[i] = normal_from_slope({x[i], y[i]});
    return;
  }
  const float* z = y + width;
  for (std::size_t i = 0; i < width; ++i) normals[i] = Vec3f(x[i], y[i], z[i]).normalized();
}

}  // namespace

NormalMap resize(const NormalMap& map, int width, int height, CodeType type) {
  if (width < 1 || height < 1 || map.empty()) {
    throw InvalidInput("a map can only be resized from and to at least 1 x 1 texels");
  }
  const NormalConvention& convention = map.convention();
  const Taps across(map.width(), width);
  const Taps down(map.height(), height);
  const std::vector<int> columns = nearest(map.width(), width);
  const std::vector<int> sources = nearest(map.height(), height);
  RawImage image(width, height, map.codes().channels(), type);
  parallel_for(
      static_cast<std::size_t>(height), resized_rows_per_task, [&](std::size_t a, std::size_t b) {
        RowCache rows(map, across, width, down.count());
        Plane sum(static_cast<std::size_t>(width * plane_count(map)));
        std::vector<Vec3f> normals(static_cast<std::size_t>(width));
        for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
          weigh_rows(rows, down, y, sum);
          to_normals(sum, normals);
          codes::encode_texels(normals.data(), width, convention, image, 0, y);
          codes::copy_other_channels(map.codes(), sources[static_cast<std::size_t>(y)], columns,
                                     image, y, codes::normal_channels(convention));
        }
      });
  return {std::move(image), convention};
}

}  // namespace normalshop
