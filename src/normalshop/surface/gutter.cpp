#include "normalshop/surface/detail/gutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/surface_walk.h"

namespace normalshop {
namespace {

constexpr std::uint32_t no_candidate = 0xFFFFFFFFU;

/// A border of the covered part of the atlas, in the grid.
struct BorderEdge {
  std::uint32_t edge = 0;
  Vec2d first{0.0, 0.0};
  Vec2d along{0.0, 0.0};
  double squared_length = 0.0;
  Vec2d outward{0.0, 0.0};  ///< unit
  std::uint32_t part = 0;   ///< see Gutter::number_parts()

  double parameter(const Vec2d& p) const {
    return std::clamp((p - first).dot(along) / squared_length, 0.0, 1.0);
  }
  Vec2d end() const { return first + along; }
  Vec2d nearest(const Vec2d& p) const { return first + parameter(p) * along; }
};

/// Feet on borders that lie on each other are no further apart than this, in texels.
constexpr double same_place = 0.125;
/// Cosine between the directions of such borders.
constexpr double same_direction = 0.95;

/// The nearest border edge of a texel so far, or a further one that lies on it.
struct Candidate {
  std::uint32_t texel;
  std::uint32_t border;
  double squared_distance;
  /// Decides at corners, where both edges' nearest point is the corner: the edge that the texel
  /// lies more squarely beyond.
  double beyond;
  Vec2d place;  ///< the texel's centre in the grid
  bool further = false;
};

class Gutter {
 public:
  Gutter(const GutterGround& ground, int reach)
      : mesh_(ground.mesh),
        topology_(ground.topology),
        affines_(ground.affines),
        owner_(ground.owner),
        repeats_(ground.repeats),
        overlaps_(ground.overlaps),
        reach_(reach),
        period_{owner_.width(), owner_.height()} {
    collect_borders();
    if (overlaps_) number_parts();
  }

  std::vector<GutterTexel> grow() const {
    std::vector<GridRange> rows(borders_.size());
    std::transform(borders_.begin(), borders_.end(), rows.begin(),
                   [&](const BorderEdge& b) { return rows_near(b); });
    const Bands bands(rows, period_.height);
    std::vector<std::vector<GutterTexel>> parts(band_count(period_.height));
    parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> index(
          static_cast<std::size_t>(band_rows) * static_cast<std::size_t>(period_.width),
          no_candidate);
      for (std::size_t band = begin; band < end; ++band) {
        parts[band] = grow_band(static_cast<int>(band), bands.items(band), index);
      }
    });
    std::vector<GutterTexel> all;
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    all.reserve(count);
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

 private:
  Vec2d texels(std::uint32_t corner) const { return period_.texels(mesh_.uvs[corner]); }

  /// Area in the atlas, of either sign; 0 for a triangle that owns no texel.
  double signed_area(std::uint32_t triangle) const {
    if (affines_[triangle].degenerate) return 0.0;
    const Vec2d a = texels(3 * triangle);
    const Vec2d e1 = texels(3 * triangle + 1) - a;
    const Vec2d e2 = texels(3 * triangle + 2) - a;
    return e1.x() * e2.y() - e2.x() * e1.y();
  }

  /// Nothing of the same chart lies beyond: no neighbour there, or one that is folded back.
  bool is_border(std::uint32_t edge, double area) const {
    if (topology_.kind[edge] != EdgeKind::Interior) return true;
    return signed_area(topology_.neighbor[edge] / 3) * area <= 0.0;
  }

  void collect_borders() {
    for (std::uint32_t triangle = 0; triangle < affines_.size(); ++triangle) {
      const double area = signed_area(triangle);
      if (area == 0.0) continue;
      for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
        if (is_border(edge, area)) add_border(edge, area);
      }
    }
  }

  void add_border(std::uint32_t edge, double area) {
    BorderEdge b;
    b.edge = edge;
    b.first = texels(edge);
    b.along = texels(next_corner(edge)) - b.first;
    b.squared_length = b.along.squaredNorm();
    b.outward = Vec2d(b.along.y(), -b.along.x()) / std::sqrt(b.squared_length);
    if (area < 0.0) b.outward = -b.outward;
    if (b.squared_length > 0.0) borders_.push_back(b);
  }

  /// Numbers the parts of charts that are not folded, in file order, and marks the borders.
  void number_parts() {
    constexpr std::uint32_t unknown = 0xFFFFFFFFU;
    std::vector<std::uint32_t> part(affines_.size(), unknown);
    std::vector<std::uint32_t> open;
    std::uint32_t count = 0;
    for (std::uint32_t first = 0; first < part.size(); ++first) {
      if (part[first] != unknown) continue;
      part[first] = count++;
      open.push_back(first);
      while (!open.empty()) {
        const std::uint32_t triangle = open.back();
        open.pop_back();
        const double area = signed_area(triangle);
        for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
          if (is_border(edge, area)) continue;
          const std::uint32_t next = topology_.neighbor[edge] / 3;
          if (part[next] != unknown) continue;
          part[next] = part[triangle];
          open.push_back(next);
        }
      }
    }
    for (BorderEdge& b : borders_) b.part = part[b.edge / 3];
  }

  GridRange rows_near(const BorderEdge& b) const {
    const double low = std::min(b.first.y(), b.end().y());
    const double high = std::max(b.first.y(), b.end().y());
    return {static_cast<std::int64_t>(std::floor(low - reach_ - 0.5)),
            static_cast<std::int64_t>(std::ceil(high + reach_ + 0.5))};
  }

  /// Columns of a row that can be within reach.
  GridRange columns_near(const BorderEdge& b, double y) const {
    double t0 = 0.0;
    double t1 = 1.0;
    if (b.along.y() != 0.0) {
      const double ta = (y - reach_ - b.first.y()) / b.along.y();
      const double tb = (y + reach_ - b.first.y()) / b.along.y();
      t0 = std::clamp(std::min(ta, tb), 0.0, 1.0);
      t1 = std::clamp(std::max(ta, tb), 0.0, 1.0);
    }
    const double xa = b.first.x() + t0 * b.along.x();
    const double xb = b.first.x() + t1 * b.along.x();
    return {static_cast<std::int64_t>(std::floor(std::min(xa, xb) - reach_ - 0.5)),
            static_cast<std::int64_t>(std::ceil(std::max(xa, xb) + reach_ + 0.5))};
  }

  /// `index`: a band of no_candidate, left so again.
  std::vector<GutterTexel> grow_band(int band, std::span<const std::uint32_t> items,
                                     std::vector<std::uint32_t>& index) const {
    std::vector<Candidate> candidates;
    offer_band(band, items, index,
               [&](std::uint32_t item, std::uint32_t texel, const Vec2d& p, std::uint32_t& found) {
                 offer(item, texel, p, found, candidates);
               });
    const std::size_t nearest_count = candidates.size();
    if (overlaps_) {
      offer_band(
          band, items, index,
          [&](std::uint32_t item, std::uint32_t texel, const Vec2d& p, std::uint32_t& nearest) {
            offer_further(item, texel, p, nearest, candidates);
          });
    }
    const std::size_t origin =
        static_cast<std::size_t>(band) * band_rows * static_cast<std::size_t>(period_.width);
    for (std::size_t i = 0; i < nearest_count; ++i) {
      index[candidates[i].texel - origin] = no_candidate;
    }
    sort(candidates);
    std::vector<GutterTexel> result(candidates.size());
    std::transform(candidates.begin(), candidates.end(), result.begin(),
                   [&](const Candidate& c) { return resolve(c); });
    return result;
  }

  /// By texel, the nearest first; of the further borders of one part, which meet at a corner or
  /// continue each other, one.
  void sort(std::vector<Candidate>& candidates) const {
    const auto part = [&](const Candidate& c) { return borders_[c.border].part; };
    const auto key = [&](const Candidate& c) {
      return std::tuple(c.texel, c.further, c.further ? part(c) : 0, c.squared_distance, c.border);
    };
    std::sort(candidates.begin(), candidates.end(),
              [&](const Candidate& a, const Candidate& b) { return key(a) < key(b); });
    const auto last = std::unique(
        candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
          return a.texel == b.texel && a.further && b.further && part(a) == part(b);
        });
    candidates.erase(last, candidates.end());
  }

  /// offer(border, texel, its place in the grid, its entry of `index`) for what each border of the
  /// band may reach.
  template <class Offer>
  void offer_band(int band, std::span<const std::uint32_t> items, std::vector<std::uint32_t>& index,
                  const Offer& offer) const {
    const int first = band * band_rows;
    const int last = std::min(first + band_rows, period_.height);
    for (const std::uint32_t item : items) {
      const GridRange rows = rows_near(borders_[item]);
      for (int y = first; y < last; ++y) {
        std::uint32_t* index_row =
            index.data() + static_cast<std::ptrdiff_t>(y - first) * period_.width;
        for (std::int64_t row = first_at_or_after(rows.begin, y, period_.height); row < rows.end;
             row += period_.height) {
          if (!repeats_ && row != y) continue;
          offer_row(item, y, row, index_row, offer);
        }
      }
    }
  }

  template <class Offer>
  void offer_row(std::uint32_t item, int y, std::int64_t row, std::uint32_t* index_row,
                 const Offer& offer) const {
    const BorderEdge& b = borders_[item];
    const std::uint32_t* owner_row = owner_.row(y);
    const double py = static_cast<double>(row) + 0.5;
    const GridRange columns = columns_near(b, py);
    std::int64_t x = wrap(columns.begin, period_.width);
    for (std::int64_t column = columns.begin; column < columns.end; ++column) {
      if (owner_row[x] == no_triangle && (repeats_ || x == column)) {
        const auto texel = static_cast<std::uint32_t>(x + std::int64_t{y} * period_.width);
        offer(item, texel, Vec2d(static_cast<double>(column) + 0.5, py), index_row[x]);
      }
      if (++x == period_.width) x = 0;
    }
  }

  void offer(std::uint32_t item, std::uint32_t texel, const Vec2d& p, std::uint32_t& index,
             std::vector<Candidate>& candidates) const {
    const BorderEdge& b = borders_[item];
    const double t = b.parameter(p);
    // The corner itself at the far end, so that both edges of a corner find the same distance.
    const Vec2d nearest = t < 1.0 ? Vec2d(b.first + t * b.along) : texels(next_corner(b.edge));
    const double d = (p - nearest).squaredNorm();
    if (d > static_cast<double>(reach_) * reach_) return;
    const Candidate offered{texel, item, d, b.outward.dot(p - b.first), p, false};
    if (index == no_candidate) {
      index = static_cast<std::uint32_t>(candidates.size());
      candidates.push_back(offered);
      return;
    }
    Candidate& best = candidates[index];
    if (d < best.squared_distance || (d == best.squared_distance && offered.beyond > best.beyond)) {
      best = offered;
    }
  }

  /// Adds a border of another part that lies on the nearest one.
  void offer_further(std::uint32_t item, std::uint32_t texel, const Vec2d& p, std::uint32_t nearest,
                     std::vector<Candidate>& candidates) const {
    if (nearest == no_candidate) return;
    const Candidate& best = candidates[nearest];
    const BorderEdge& there = borders_[best.border];
    const BorderEdge& b = borders_[item];
    if (b.part == there.part || b.outward.dot(there.outward) < same_direction) return;
    const Vec2d out = p - b.nearest(p);
    const Vec2d best_out = best.place - there.nearest(best.place);
    if ((out - best_out).norm() > same_place) return;
    candidates.push_back({texel, item, out.squaredNorm(), b.outward.dot(p - b.first), p, true});
  }

  /// Weights of a triangle's corners at a place in the grid, in double.
  std::array<double, 3> weights_at(std::uint32_t triangle, const Vec2d& p) const {
    const Vec2d a = texels(3 * triangle);
    const Vec2d e1 = texels(3 * triangle + 1) - a;
    const Vec2d e2 = texels(3 * triangle + 2) - a;
    const Vec2d d = p - a;
    const double area = e1.x() * e2.y() - e2.x() * e1.y();
    const double b1 = (d.x() * e2.y() - e2.x() * d.y()) / area;
    const double b2 = (e1.x() * d.y() - d.x() * e1.y()) / area;
    return {1.0 - b1 - b2, b1, b2};
  }

  GutterTexel resolve(const Candidate& c) const {
    const BorderEdge& b = borders_[c.border];
    const std::uint32_t triangle = b.edge / 3;
    const std::array<double, 3> w = weights_at(triangle, c.place);
    const double t = b.parameter(c.place);
    std::array<double, 3> foot{};
    foot[b.edge % 3] = 1.0 - t;
    foot[next_corner(b.edge) % 3] = t;
    // Not further out than the triangle is large: a frame extrapolated beyond that means nothing.
    double share = 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (w[k] < -1.0) share = std::min(share, (foot[k] + 1.0) / (foot[k] - w[k]));
    }
    GutterTexel g;
    g.texel = c.texel;
    g.owner = triangle;
    g.owner_b1 = static_cast<float>(foot[1] + share * (w[1] - foot[1]));
    g.owner_b2 = static_cast<float>(foot[2] + share * (w[2] - foot[2]));
    g.border_b1 = static_cast<float>(foot[1]);
    g.border_b2 = static_cast<float>(foot[2]);
    g.hard_edge = is_hard(b.edge, t);
    g.source = walk(mesh_, topology_, way_out(b, w, t));
    if (!std::isfinite(g.source.b1 + g.source.b2)) {  // positions that are no numbers
      g.source = {triangle, g.border_b1, g.border_b2};
    }
    return g;
  }

  /// Do both sides' base normals differ at this place of an edge?
  bool is_hard(std::uint32_t edge, double t) const {
    const std::uint32_t across = topology_.neighbor[edge];
    if (across == no_edge) return false;
    const Vec3f here = base_normal_at(mesh_, point_on_edge(edge, t));
    const Vec3f there = base_normal_at(mesh_, point_on_edge(across, 1.0 - t));
    return angle_degrees(here, there) >= static_cast<double>(hard_edge_degrees);
  }

  /// From the nearest point of the border to where the triangle's plane puts the texel.
  SurfaceWalk way_out(const BorderEdge& b, const std::array<double, 3>& w, double t) const {
    const auto edge_vector = [&](std::uint32_t corner) {
      return Vec3d(mesh_.position(corner).cast<double>() - mesh_.position(b.edge).cast<double>());
    };
    const Vec3d along = edge_vector(next_corner(b.edge));
    const Vec3d inward = edge_vector(previous_corner(b.edge));
    const Vec3d axis = along.stableNormalized();
    const double along_w = w[next_corner(b.edge) % 3];
    const double inward_w = w[previous_corner(b.edge) % 3];
    const double height = (inward - inward.dot(axis) * axis).norm();
    return {b.edge, t, {along_w * along.norm() + inward_w * inward.dot(axis), -inward_w * height}};
  }

  const Mesh& mesh_;
  const Topology& topology_;
  const std::vector<TexelAffine>& affines_;
  const Image<std::uint32_t>& owner_;
  bool repeats_;
  bool overlaps_;
  int reach_;
  Period period_;
  std::vector<BorderEdge> borders_;
};

}  // namespace

std::vector<GutterTexel> grow_gutter(const GutterGround& ground, int reach) {
  return Gutter(ground, reach).grow();
}

}  // namespace normalshop
