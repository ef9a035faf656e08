#include "normalshop/rgbn/segment.h"

#include <cmath>
#include <string>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/rgbn/detail/edge_list.h"
#include "normalshop/rgbn/detail/segment_forest.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

constexpr std::size_t rows_per_task = 32;
/// The graph serves coarsenesses from this share of its own on. Lower ones leave it more edges.
constexpr float finest_share = 0.05F;

template <class Body>
void for_rows(int height, const Body& body) {
  parallel_for(static_cast<std::size_t>(height), rows_per_task,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t y = begin; y < end; ++y) body(static_cast<int>(y));
               });
}

void check(float value, const char* name) {
  if (value >= 0.0F && value <= 1e6F) return;
  throw InvalidInput(std::string("segment: ") + name + " must be a number from 0 to 1000000");
}

void check_size(int min_size) {
  if (min_size < 0) throw InvalidInput("segment: min_size must be at least 0");
}

/// What pixels are compared by. Empty images don't count.
struct Features {
  ImageView<Vec3f> normals;
  ColorView color;
  float normal_weight;
  float color_weight;

  float weight(int x0, int y0, int x1, int y1) const {
    float sum = 0.0F;
    if (!normals.empty()) {
      sum = normal_weight * (normals(x0, y0) - normals(x1, y1)).squaredNorm();
    }
    if (!color.empty()) sum += color_weight * (color(x0, y0) - color(x1, y1)).squaredNorm();
    return std::sqrt(sum);
  }
};

/// How far each pixel counts when smoothing; 0: in no segment.
MaskImage find_validity(const RgbnView& image, bool use_slopes, bool use_color) {
  MaskImage validity(image.slopes.width(), image.slopes.height());
  for_rows(validity.height(), [&](int y) {
    for (int x = 0; x < validity.width(); ++x) {
      float valid = image.validity.empty() ? 1.0F : image.validity(x, y);
      if (use_slopes && !image.slopes(x, y).allFinite()) valid = 0.0F;
      if (use_color && !image.color(x, y).allFinite()) valid = 0.0F;
      validity(x, y) = valid > 0.0F ? valid : 0.0F;
    }
  });
  return validity;
}

/// Each pixel for which is_valid is a node.
template <class T, class IsValid>
Segments pixel_nodes(const Image<T>& image, const IsValid& is_valid) {
  Segments out{Image<std::uint32_t>(image.width(), image.height()), 0};
  for (std::size_t i = 0; i < image.size(); ++i) {
    out.labels.data()[i] = is_valid(image.data()[i]) ? out.count++ : no_label;
  }
  return out;
}

Image<Vec3f> smooth_normals(SlopeView slopes, MaskView weights, const SmoothOptions& options,
                            Border border) {
  SlopeImage smoothed(slopes.width(), slopes.height());
  smooth(slopes, weights, smoothed, slopes.rect(), options, border);
  Image<Vec3f> normals(slopes.width(), slopes.height());
  for_rows(slopes.height(), [&](int y) {
    for (int x = 0; x < slopes.width(); ++x) normals(x, y) = normal_from_slope(smoothed(x, y));
  });
  return normals;
}

void weigh_row(const Features& features, const Image<std::uint32_t>& pixels, Border border, int y,
               std::uint16_t* codes) {
  const bool wraps = border == Border::Wrap;
  for (int x = 0; x < pixels.width(); ++x) {
    for (std::size_t way = 0; way < 4; ++way) {
      int x1 = x + edge_dx[way];
      int y1 = y + edge_dy[way];
      if (wraps) x1 = border_pixel(x1, pixels.width(), border).index;
      if (wraps) y1 = border_pixel(y1, pixels.height(), border).index;
      const bool exists =
          pixels.rect().contains(x1, y1) && pixels(x, y) != no_label && pixels(x1, y1) != no_label;
      *codes++ = exists ? code_of_weight(features.weight(x, y, x1, y1))
                        : static_cast<std::uint16_t>(no_edge);
    }
  }
}

struct PixelGraph {
  Segments pixels;
  EdgeCodes codes;
};

PixelGraph weigh(const RgbnView& image, const SegmentOptions& options, Border border) {
  const int width = image.slopes.width();
  const int height = image.slopes.height();
  if (static_cast<std::int64_t>(width) * height >= (std::int64_t{1} << 29)) {
    throw InvalidInput("segment: the image must have less than 2^29 pixels");
  }
  const bool use_slopes = options.normal_weight > 0.0F;
  const bool use_color = options.color_weight > 0.0F && !image.color.empty();
  const MaskImage validity = find_validity(image, use_slopes, use_color);
  PixelGraph graph{pixel_nodes(validity, [](float valid) { return valid > 0.0F; }),
                   EdgeCodes(4 * width, height)};
  const bool whole = image.validity.empty() && graph.pixels.count == validity.size();
  const MaskView weights = whole ? MaskView() : validity.view();
  const SmoothOptions smoothing{.sigma = options.sigma};
  Image<Vec3f> normals;
  if (use_slopes) normals = smooth_normals(image.slopes, weights, smoothing, border);
  ColorImage color;
  if (use_color) {
    color.resize(width, height);
    smooth(image.color, weights, color, color.rect(), smoothing, border);
  }
  const Features features{normals, color, options.normal_weight, options.color_weight};
  for_rows(height,
           [&](int y) { weigh_row(features, graph.pixels.labels, border, y, graph.codes.row(y)); });
  return graph;
}

Segments join(SegmentForest forest, const EdgeList& edges, const Image<std::uint32_t>& nodes,
              std::int32_t min_size) {
  forest.join_small(forest.join_alike(edges, min_size), min_size);
  return label(forest, nodes);
}

Segments join_pixels(const EdgeCodes& codes, const Segments& pixels, float coarseness,
                     std::int32_t min_size) {
  return join(SegmentForest(pixels.count, coarseness), sort_edges(codes, pixels.labels),
              pixels.labels, min_size);
}

void check(const SegmentOptions& options) {
  check(options.coarseness, "coarseness");
  check_size(options.min_size);
  check(options.color_weight, "color_weight");
  check(options.normal_weight, "normal_weight");
  check(options.sigma, "sigma");
}

}  // namespace

struct SegmentGraph::Data {
  EdgeCodes codes;
  float finest;    ///< from this coarseness on the nodes below are what to join, else pixels
  Segments nodes;  ///< which node each pixel is in
  NodeStates states;
  EdgeList edges;
};

SegmentGraph::SegmentGraph(const RgbnView& image, const SegmentOptions& options, Border border) {
  check(options);
  PixelGraph graph = weigh(image, options, border);
  auto data = std::make_shared<Data>();
  data->finest = options.coarseness * finest_share;
  SegmentForest forest(graph.pixels.count, data->finest);
  data->states = forest.join_certain(sort_edges(graph.codes, graph.pixels.labels));
  data->nodes = label(forest, graph.pixels.labels);
  data->edges = without_parallels(sort_edges(graph.codes, data->nodes.labels), data->nodes.count);
  data->codes = std::move(graph.codes);
  data_ = std::move(data);
}

Segments SegmentGraph::segment(float coarseness, int min_size) const {
  check(coarseness, "coarseness");
  check_size(min_size);
  if (coarseness >= data_->finest) {
    return join(SegmentForest(data_->states, coarseness), data_->edges, data_->nodes.labels,
                min_size);
  }
  const auto is_valid = [](std::uint32_t node) { return node != no_label; };
  return join_pixels(data_->codes, pixel_nodes(data_->nodes.labels, is_valid), coarseness,
                     min_size);
}

Segments segment(const RgbnView& image, const SegmentOptions& options, Border border) {
  check(options);
  const PixelGraph graph = weigh(image, options, border);
  return join_pixels(graph.codes, graph.pixels, options.coarseness, options.min_size);
}

}  // namespace normalshop
