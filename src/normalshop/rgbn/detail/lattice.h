#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/line_kernels.h"

/// Wide Gaussians by way of a few points of the plane; private to this floor.
namespace normalshop {

/// A wide Gaussian along one axis as three: a narrow one, of whose result the points at multiples
/// of `step` are kept; the rest, between those; and a narrow one that joins the points. A wave
/// comes back at other frequencies, too fine for the points or seen as the points, with less than
/// 1e-5 and 5e-5 of its amplitude.
///
/// Points lie at absolute places, so that every region sees the same ones. step 1: all is rest.
struct Lattice {
  Lattice(double sigma, int point_step);

  int step;
  std::vector<double> narrow;  ///< weights of the first Gaussian to both sides
  double rest;                 ///< sigma of what is left, in steps
  int before = 0;  ///< points that are joined for a pixel: from so many before the one at or
  int after = 0;   ///< before it to so many after that
  std::vector<std::vector<float>> joins;  ///< their weights, by the pixel's place after its point

  int point_of(int pixel) const { return (pixel - phase_of(pixel)) / step; }
  int phase_of(int pixel) const { return ((pixel % step) + step) % step; }
  /// For each phase the sum over what a JoinLines holds.
  std::vector<WeightedSum> sums(std::ptrdiff_t stride) const;
  /// Points from the first pixel that a point reads to the point itself.
  int margin() const { return (radius() + step - 1) / step; }
  int radius() const { return static_cast<int>(narrow.size()); }
};

struct Lattices {
  Lattice x;
  Lattice y;
  /// The points that are joined for `region`.
  Rect points_for(const Rect& region) const {
    return {x.point_of(region.x0) - x.before, y.point_of(region.y0) - y.before,
            x.point_of(region.x1 - 1) + x.after + 1, y.point_of(region.y1 - 1) + y.after + 1};
  }
};

/// C numbers that belong together, in images between filters.
template <int C>
using Numbers = std::array<float, static_cast<std::size_t>(C)>;

/// Points of a band, which one task works on.
inline constexpr int band_points = 64;

/// work(first, last) for bands of [0, count).
template <class Work>
void for_bands(int count, int band, const Work& work) {
  parallel_for(static_cast<std::size_t>((count + band - 1) / band), 1,
               [&](std::size_t a, std::size_t b) {
                 for (int i = static_cast<int>(a); i < static_cast<int>(b); ++i) {
                   work(i * band, std::min((i + 1) * band, count));
                 }
               });
}

/// The first Gaussian along rows of the plane, at the points [first, last).
template <class Rows>
class AlongRows {
 public:
  static constexpr int C = Rows::channels;

  AlongRows(const Rows& rows, const Lattice& x, int first, int last)
      : rows_(rows),
        x_(x),
        count_(last - first),
        margin_(x.margin()),
        width_(count_ + 2 * margin_),
        x0_((first - margin_) * x.step),
        row_(width_ * x.step * C, 1),
        phases_(width_ * C, x.step) {
    for (int k = x.radius(); k >= 1; --k) {
      sum_.add(offset(-k), offset(k), x.narrow[static_cast<std::size_t>(k - 1)]);
    }
  }
  void run(int y, float* out) {
    // What lies in memory is not copied first.
    const int a = std::clamp((x_.step - 1 - x0_) / x_.step, 0, width_);
    const int b = std::clamp((rows_.width() - x0_) / x_.step, a, width_);
    const float* inside = rows_.direct(x0_ + a * x_.step, x0_ + b * x_.step, y);
    if (inside == nullptr) {
      spread_copy(0, width_, y);
    } else {
      spread_copy(0, a, y);
      spread(a, b, inside);
      spread_copy(b, width_, y);
    }
    pairs_around(phases_.data() + margin_ * C, count_ * C, sum_, out);
  }

 private:
  /// The pixels of points [a, b) to their phases.
  void spread(int a, int b, const float* pixels) {
    for (int p = 0; p < x_.step; ++p) {
      const float* from = pixels + p * C;
      float* to = phases_.row(p) + a * C;
      for (int i = a; i < b; ++i, from += x_.step * C, to += C) {
        std::memcpy(to, from, C * sizeof(float));
      }
    }
  }
  void spread_copy(int a, int b, int y) {
    rows_.read(x0_ + a * x_.step, x0_ + b * x_.step, y, row_.data());
    spread(a, b, row_.data());
  }
  /// Of a pixel so far from a point, from phase to phase of the row.
  std::ptrdiff_t offset(int pixel) const {
    return (x_.phase_of(pixel) * width_ + x_.point_of(pixel)) * C;
  }

  const Rows& rows_;
  const Lattice& x_;
  int count_;
  int margin_;
  int width_;  ///< pixels of one phase
  int x0_;
  Image<float> row_;
  Image<float> phases_;
  WeightedPairs sum_;
};

/// The plane after the first Gaussian at `points`.
template <class Rows>
Image<Numbers<Rows::channels>> take_points(const Rows& rows, const Lattices& lattices,
                                           const Rect& points) {
  constexpr int C = Rows::channels;
  const Lattice& y = lattices.y;
  const int radius = y.radius();
  const int numbers = points.width() * C;
  const WeightedPairs down = line_pairs(y.narrow, numbers);
  Image<Numbers<C>> result(points.width(), points.height());
  for_bands(points.height(), std::max(band_points, points.height() / 8), [&](int a, int b) {
    const int top = (points.y0 + a) * y.step - radius;
    AlongRows<Rows> along(rows, lattices.x, points.x0, points.x1);
    Image<float> band(numbers, (b - a - 1) * y.step + 2 * radius + 1);
    for (int i = 0; i < band.height(); ++i) along.run(top + i, band.row(i));
    for (int j = a; j < b; ++j) {
      pairs_around(band.row((j - a) * y.step + radius), numbers, down, result.row(j)->data());
    }
  });
  return result;
}

/// Some points side by side, and how their neighbours to both sides differ from them: what is
/// joined keeps constants to the last bit.
class JoinLines {
 public:
  JoinLines(const Lattice& lattice, int most)
      : lattice_(lattice),
        lines_(most + 16, lattice.before + lattice.after + 1),
        sums_(lattice.sums(most + 16)) {}
  /// `count` numbers; neighbours are `stride` apart.
  void take(const float* at, int count, std::ptrdiff_t stride) {
    count_ = count;
    std::copy_n(at, count, lines_.row(0));
    int line = 0;
    for (int k = -lattice_.before; k <= lattice_.after; ++k) {
      if (k != 0) difference(at + k * stride, at, count, lines_.row(++line));
    }
  }
  void join(int phase, float* out) const {
    weighted_sum(lines_.data(), count_, sums_[static_cast<std::size_t>(phase)], out);
  }

 private:
  const Lattice& lattice_;
  Image<float> lines_;
  std::vector<WeightedSum> sums_;
  int count_ = 0;
};

/// The last Gaussian along a row of points, the first of which is `first`: the pixels [x0, x1) of
/// the plane.
template <int C>
void join_along(const Numbers<C>* values, int first, const Lattice& x, int x0, int x1,
                JoinLines& lines, Image<float>& memory, float* to) {
  const int begin = x.point_of(x0);
  const int end = x.point_of(x1 - 1) + 1;
  lines.take(values[begin - first].data(), (end - begin) * C, C);
  for (int p = 0; p < x.step; ++p) {
    lines.join(p, memory.data());
    for (int i = begin; i < end; ++i) {
      const int pixel = i * x.step + p;
      if (pixel < x0 || pixel >= x1) continue;
      std::memcpy(to + (pixel - x0) * C, memory.data() + (i - begin) * C, C * sizeof(float));
    }
  }
}

/// The last Gaussian, into the pixels of `region`, of the points that are joined for it.
template <int C, class Store>
void join_points(const Image<Numbers<C>>& values, const Lattices& lattices, const Rect& region,
                 const Store& store) {
  constexpr int strip = 512 / C;
  const Lattice& x = lattices.x;
  const Lattice& y = lattices.y;
  const Rect points = lattices.points_for(region);
  for_bands(region.height(), band_points * y.step, [&](int a, int b) {
    const int begin = y.point_of(region.y0 + a);
    const int end = y.point_of(region.y0 + b - 1) + 1;
    const int top = begin - y.before;
    Image<float> band(region.width() * C, end + y.after - top);
    Image<float> memory(std::max(points.width(), strip) * C, 1);
    JoinLines along(x, points.width() * C);
    for (int j = 0; j < band.height(); ++j) {
      join_along<C>(values.row(top + j - points.y0), points.x0, x, region.x0, region.x1, along,
                    memory, band.row(j));
    }
    JoinLines down(y, strip * C);
    for (int x0 = region.x0; x0 < region.x1; x0 += strip) {
      const int x1 = std::min(x0 + strip, region.x1);
      for (int point = begin; point < end; ++point) {
        down.take(band.row(point - top) + (x0 - region.x0) * C, (x1 - x0) * C, band.width());
        const int last = std::min((point + 1) * y.step, region.y0 + b);
        for (int row = std::max(point * y.step, region.y0 + a); row < last; ++row) {
          float* out = store.begin(x0, row, memory.data());
          down.join(row - point * y.step, out);
          store.end(x0, x1, row, out);
        }
      }
    }
  });
}

}  // namespace normalshop
