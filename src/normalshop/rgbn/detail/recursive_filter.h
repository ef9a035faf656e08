#pragma once

#include <algorithm>
#include <cstring>

#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/filter_rows.h"
#include "normalshop/rgbn/detail/line_kernels.h"

/// The recursive Gaussian along both axes; private to this floor.
namespace normalshop {

/// How to filter the samples [begin, end) of lines of n.
struct LinePlan {
  LinePlan(int begin, int end, int n, double line_sigma, Border border);

  RecursiveKernel kernel;
  int begin;
  int end;
  int before = 0;     ///< samples before `begin` that are read
  int after = 0;      ///< samples from `end` on that are read
  bool rests = true;  ///< beyond those the last one counts for ever; else nothing does
  /// The samples of the line, extended by its border, that hold all that is read or what it is a
  /// copy of.
  int held_begin = 0;
  int held_end;
};

/// Takes lines through the filter. Lines has
///     block              samples that go through the filter at a time
///     lanes              how many lines there are
///     read(i, count)     the samples [i, i + count), until the next call
///     place(i)           room for results from i on
///     finish(i, count)   those results are ready.
template <class Lines>
void filter_lines(const LinePlan& plan, RecursiveLines& filter, float* spare, const Lines& lines) {
  const auto each_block = [&](int begin, int end, bool backward, bool wanted) {
    const int blocks = (end - begin + Lines::block - 1) / Lines::block;
    for (int k = 0; k < blocks; ++k) {
      const int i = begin + (backward ? blocks - 1 - k : k) * Lines::block;
      const int count = std::min(Lines::block, end - i);
      const ConstSamples in = lines.read(i, count);
      const Samples out = wanted ? lines.place(i) : Samples{spare, lines.lanes};
      if (backward) {
        filter.backward(in, out, count, lines.lanes);
        if (wanted) lines.finish(i, count);
      } else {
        filter.forward(in, out, count, lines.lanes);
      }
    }
  };
  const auto start = [&](int edge) {
    float* first = spare;
    float* last = spare + lines.lanes;
    std::copy_n(lines.read(plan.begin, 1).at, lines.lanes, first);
    std::copy_n(lines.read(edge, 1).at, lines.lanes, last);
    filter.start(first, plan.rests ? last : first, lines.lanes);
  };
  start(plan.begin - plan.before);
  each_block(plan.begin - plan.before, plan.begin, false, false);
  each_block(plan.begin, plan.end, false, true);
  start(plan.end + plan.after - 1);
  each_block(plan.end, plan.end + plan.after, true, false);
  each_block(plan.begin, plan.end, true, true);
}

/// Memory for the lines of one task.
struct LineBuffers {
  LineBuffers(const LinePlan& plan, int lanes, int block_samples, int results_samples)
      : filter(plan.kernel, lanes),
        block(lanes, block_samples, 0.0F),
        results(lanes, results_samples),
        spare(lanes, std::max(block_samples, 2)) {}
  RecursiveLines filter;
  Image<float> block;
  Image<float> results;
  Image<float> spare;
};

/// Neighbouring columns of the plane, filtered downwards into rows that are written one by one.
template <class Rows>
struct ColumnLines {
  static constexpr int block = 1;
  /// Numbers of a strip whose state the nearest cache holds.
  static int strip_of(const RecursiveKernel& kernel) { return kernel.wide ? 512 : 1024; }

  const Rows& rows;
  int x0;
  int x1;
  ImageSpan<float> to;  ///< to(0, 0) is the first number of pixel (x0, top)
  int top;
  float* memory;
  int lanes = (x1 - x0) * Rows::channels;

  ConstSamples read(int y, int /*count*/) const {
    const float* direct = rows.direct(x0, x1, y);
    if (direct != nullptr) return {direct, 0};
    rows.read(x0, x1, y, memory);
    return {memory, 0};
  }
  Samples place(int y) const { return {to.row(y - top), 0}; }
  void finish(int /*y*/, int /*count*/) const {}
};

/// Down the columns [x0, x1) of the plane; between(0, 0) is the first number of pixel (x0,
/// plan.begin).
template <class Rows>
void filter_columns(const Rows& rows, int x0, int x1, const LinePlan& plan,
                    ImageSpan<float> between) {
  using Lines = ColumnLines<Rows>;
  const int strip = Lines::strip_of(plan.kernel) / Rows::channels;
  const int strips = (x1 - x0 + strip - 1) / strip;
  const std::ptrdiff_t stride = between.height() > 1 ? between.row(1) - between.row(0) : 0;
  parallel_for(static_cast<std::size_t>(strips), 1, [&](std::size_t first, std::size_t last) {
    LineBuffers buffers(plan, strip * Rows::channels, 1, 0);
    for (int i = static_cast<int>(first); i < static_cast<int>(last); ++i) {
      const int a = x0 + i * strip;
      const int b = std::min(a + strip, x1);
      const ImageSpan<float> to(between.row(0) + (a - x0) * Rows::channels,
                                (b - a) * Rows::channels, between.height(), stride);
      const Lines lines{rows, a, b, to, plan.begin, buffers.block.data()};
      filter_lines(plan, buffers.filter, buffers.spare.data(), lines);
    }
  });
}

/// The rows that filter_columns made; number 0 belongs to pixel x0 of the plane.
struct BetweenRows {
  ImageView<float> numbers;
  int x0;
  int x1;
  int width;  ///< of the image
  Border border;

  /// The pixels [a, b) of row y to places that are `step` numbers apart.
  template <class Rows>
  void read(int a, int b, int y, float* to, std::ptrdiff_t step) const {
    const float* row = numbers.row(y);
    const auto copy = [&](int x) {
      std::memcpy(to, row + (x - x0) * Rows::channels, Rows::channels * sizeof(float));
      to += step;
    };
    const auto mapped = [&](int x) {
      const BorderPixel pixel = border_pixel(x, width, border);
      copy(pixel.index);
      if (pixel.flipped && Rows::pixel_channels == 2) to[-step] = -to[-step];
    };
    const int c = std::clamp(x0, a, b);
    const int d = std::clamp(x1, a, b);
    for (int x = a; x < c; ++x) mapped(x);
    for (int x = c; x < d; ++x) copy(x);
    for (int x = d; x < b; ++x) mapped(x);
  }
};

/// Neighbouring rows, filtered to the right. Blocks of them are turned, so that the samples of a
/// line lie one below the other.
template <class Rows, class Store>
struct RowLines {
  static constexpr int block = 16;
  static constexpr int lanes = 32;
  static constexpr int rows = lanes / Rows::channels;

  const BetweenRows& between;
  int y0;  ///< in `between`
  int y1;
  int left;
  int top;  ///< the row of the image that row 0 of `between` is
  const Store& store;
  LineBuffers& buffers;

  ConstSamples read(int x, int count) const {
    float* to = buffers.block.data();
    for (int y = y0; y < y1; ++y, to += Rows::channels) {
      between.read<Rows>(x, x + count, y, to, lanes);
    }
    return {buffers.block.data(), lanes};
  }
  Samples place(int x) const { return {buffers.results.row(x - left), lanes}; }
  void finish(int x, int count) const {
    const float* from = buffers.results.row(x - left);
    for (int y = y0; y < y1; ++y, from += Rows::channels) {
      store.spread(x, x + count, top + y, from, lanes);
    }
  }
};

/// Along all rows of `between`, the first of which is row `top` of the image.
template <class Rows, class Store>
void filter_rows(const BetweenRows& between, int top, const LinePlan& plan, const Store& store) {
  using Lines = RowLines<Rows, Store>;
  const int height = between.numbers.height();
  const int strips = (height + Lines::rows - 1) / Lines::rows;
  parallel_for(static_cast<std::size_t>(strips), 4, [&](std::size_t first, std::size_t last) {
    LineBuffers buffers(plan, Lines::lanes, Lines::block, plan.end - plan.begin);
    for (int i = static_cast<int>(first); i < static_cast<int>(last); ++i) {
      const int y0 = i * Lines::rows;
      const Lines lines{between, y0,     std::min(y0 + Lines::rows, height), plan.begin, top,
                        store,   buffers};
      filter_lines(plan, buffers.filter, buffers.spare.data(), lines);
    }
  });
}

}  // namespace normalshop
