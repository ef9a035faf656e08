#include "normalshop/rgbn/sketch_warp.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/rgbn/detail/hermite_rbf.h"
#include "normalshop/rgbn/detail/stroke_samples.h"

namespace normalshop {

namespace {

constexpr std::size_t most_unknowns = 1500;
constexpr int most_steps = 8;
constexpr int most_corrections = 8;
/// Points are met this well, or, beside the boundary, not at all.
constexpr double wanted_miss = 1e-4;
constexpr double accepted_miss = 0.05;
/// Closer target points are one, pixels.
constexpr double one_point = 0.5;
/// Where the boundary encloses little, its points move closer until there are so many.
constexpr std::size_t least_fixed = 8;

std::string named(const Vec2d& p) {
  return "(" + std::to_string(std::lround(p.x())) + ", " + std::to_string(std::lround(p.y())) + ")";
}

/// A point of the target and what it shows.
struct Match {
  Vec2d target;
  Vec2d source;
};

void check(const Stroke& stroke, const char* what) {
  if (stroke.empty()) throw InvalidInput(std::string("sketch warp: ") + what + " has no points");
  for (const StrokePoint& p : stroke) {
    if (!p.position.allFinite() || p.position.cwiseAbs().maxCoeff() > 1e6F) {
      throw InvalidInput(std::string("sketch warp: ") + what + " must have points below 1e6");
    }
  }
}

void check(const Stroke& boundary, std::span<const SketchPair> pairs, const SketchWarpOptions& o) {
  if (!(o.spacing >= 1.0F && o.spacing <= 1e4F)) {
    throw InvalidInput("sketch warp: spacing must be a number from 1 to 1e4");
  }
  if (!(o.point_spacing >= 0.5F && o.point_spacing <= 1e6F)) {
    throw InvalidInput("sketch warp: point_spacing must be a number from 0.5 to 1e6");
  }
  if (!(o.least_area >= 1e-6F && o.least_area <= 1.0F)) {
    throw InvalidInput("sketch warp: least_area must be a number from 1e-6 to 1");
  }
  check(boundary, "the boundary");
  for (const SketchPair& pair : pairs) {
    check(pair.source, "a source stroke");
    check(pair.target, "a target stroke");
  }
}

/// Points on a pair, `spacing` apart on the longer of its strokes.
void add_matches(const SketchPair& pair, double spacing, std::vector<Match>& matches) {
  const PolylineByLength source(pair.source, pair.closed);
  const PolylineByLength target(pair.target, pair.closed);
  if ((source.length() > 0.0) != (target.length() > 0.0)) {
    throw InvalidInput("sketch warp: a stroke cannot be warped to the point " +
                       named((source.length() > 0.0 ? target : source).at(0.0)));
  }
  const double length = std::max(source.length(), target.length());
  const int pieces = static_cast<int>(std::ceil(std::min(length / spacing, 1e5)));
  const OutlineMatch outline = pair.closed && pieces > 0
                                   ? match_outlines(source, target, std::max(pieces, 3))
                                   : OutlineMatch{};
  const int count = pair.closed && pieces > 0 ? std::max(pieces, 3) : pieces + 1;
  for (int i = 0; i < count; ++i) {
    const double t = pieces == 0 ? 0.0 : static_cast<double>(i) / (pair.closed ? count : pieces);
    matches.push_back({target.at(t), source.at(outline.source_part(t))});
  }
}

/// Drops repeated points; throws where they contradict each other.
std::vector<Match> without_repeats(const std::vector<Match>& all) {
  std::vector<Match> kept;
  for (const Match& m : all) {
    bool repeated = false;
    for (const Match& other : kept) {
      const double distance = (m.target - other.target).norm();
      if (distance >= one_point) continue;
      if ((m.source - other.source).norm() > 4.0 * distance + 1.0) {
        throw InvalidInput("sketch warp: two strokes ask for different things at " +
                           named(m.target));
      }
      repeated = true;
      break;
    }
    if (!repeated) kept.push_back(m);
  }
  return kept;
}

/// The strokes as points, and the nodes that may move.
class Sketch {
 public:
  Sketch(const Stroke& boundary, std::span<const SketchPair> pairs, const SketchWarpOptions& o)
      : options_(o),
        boundary_(boundary, true),
        lattice_(area_of(boundary_), o.spacing),
        collar_(lattice_.spacing().norm()) {
    gather(pairs);
    check_places();
    find_free_nodes();
  }

  bool empty() const { return matches_.empty(); }
  const WarpLattice& identity() const { return lattice_; }

  /// The warp in so many steps, or where one of them folds.
  SketchWarp solve(int steps) const {
    SketchWarp result{lattice_, {}, steps, 0.0};
    for (int k = 1; k <= steps; ++k) {
      const HermiteRbf rbf(centers(k, steps), fixed_.size());
      WarpLattice step = lattice_;
      add(step, rbf.solve(offsets(k, steps), {}));
      result.least = least_area(step);
      if (folds(result)) return result;
      compose(result.lattice, step);
      if (k == steps) correct(result.lattice, rbf);
    }
    result.least = least_area(result.lattice);
    const Match& worst = worst_match(result.lattice, result.miss);
    if (result.miss > accepted_miss && !folds(result)) {
      refuse_near_boundary(worst);
    }
    return result;
  }

  bool folds(const SketchWarp& warp) const {
    return !(warp.least.determinant >= static_cast<double>(options_.least_area));
  }

 private:
  static Rect area_of(const PolylineByLength& boundary) {
    if (!(std::abs(boundary.enclosed_area()) >= 1.0)) {
      throw InvalidInput("sketch warp: the boundary must enclose an area");
    }
    const Rect box = boundary.bounds();
    return grow(box, 1);
  }

  /// Points along all strokes, so far apart that the system can be solved.
  void gather(std::span<const SketchPair> pairs) {
    double length = 3.0 * boundary_.length();
    for (const SketchPair& pair : pairs) {
      length += std::max(PolylineByLength(pair.source, pair.closed).length(),
                         PolylineByLength(pair.target, pair.closed).length());
    }
    double spacing = std::max<double>(options_.point_spacing, length / most_unknowns);
    for (int i = 0; pairs.size() <= most_unknowns && i < 50; ++i, spacing *= 1.25) {
      gather(pairs, spacing);
      if (matches_.size() + 3 * fixed_.size() + 3 <= most_unknowns) return;
    }
    throw InvalidInput("sketch warp: there are " + std::to_string(pairs.size()) +
                       " pairs of strokes, which is more than can be solved for");
  }

  void gather(std::span<const SketchPair> pairs, double spacing) {
    std::vector<Match> all;
    for (const SketchPair& pair : pairs) add_matches(pair, spacing, all);
    matches_ = without_repeats(all);
    for (double gap = spacing; gap >= one_point; gap *= 0.5) {
      fixed_ = boundary_.inset(collar_, gap);
      if (fixed_.size() >= least_fixed) return;
    }
  }

  void check_places() const {
    for (const Match& m : matches_) {
      if (boundary_.has_inside(m.target)) continue;
      throw InvalidInput("sketch warp: the target point " + named(m.target) +
                         " lies outside the boundary");
    }
    for (const Match& m : matches_) {
      const auto near = [&](const Vec2d& p) { return (p - m.target).norm() < one_point; };
      if (boundary_.distance(m.target) <= collar_ ||
          std::any_of(fixed_.begin(), fixed_.end(), near)) {
        refuse_near_boundary(m);
      }
    }
  }

  [[noreturn]] static void refuse_near_boundary(const Match& m) {
    throw InvalidInput("sketch warp: the target point " + named(m.target) +
                       " is too close to the boundary");
  }

  /// Nodes farther from the boundary than a cell is wide, so that cells which it crosses stay.
  void find_free_nodes() {
    const auto across = static_cast<std::size_t>(lattice_.columns());
    free_.assign(across * static_cast<std::size_t>(lattice_.rows()), 0);
    parallel_for(static_cast<std::size_t>(lattice_.rows()), 1, [&](std::size_t a, std::size_t b) {
      for (std::size_t k = a * across; k < b * across; ++k) {
        const Vec2d p = lattice_.place(static_cast<int>(k % across), static_cast<int>(k / across));
        free_[k] = boundary_.has_inside(p) && boundary_.distance(p) > collar_ ? 1 : 0;
      }
    });
  }

  std::size_t free_index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(lattice_.columns()) +
           static_cast<std::size_t>(column);
  }

  /// Where a point is after k of so many steps.
  static Vec2d between(const Match& m, int k, int steps) {
    if (k == steps) return m.target;
    return m.source + (m.target - m.source) * (static_cast<double>(k) / steps);
  }

  std::vector<Vec2d> centers(int k, int steps) const {
    std::vector<Vec2d> points = fixed_;
    for (const Match& m : matches_) points.push_back(between(m, k, steps));
    return points;
  }

  Eigen::MatrixX2d offsets(int k, int steps) const {
    Eigen::MatrixX2d values = no_offsets();
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      values.row(row_of(i)) =
          (between(matches_[i], k - 1, steps) - between(matches_[i], k, steps)).transpose();
    }
    return values;
  }

  Eigen::MatrixX2d no_offsets() const { return Eigen::MatrixX2d::Zero(row_of(matches_.size()), 2); }
  Eigen::Index row_of(std::size_t match) const {
    return static_cast<Eigen::Index>(fixed_.size() + match);
  }

  void add(WarpLattice& lattice, const HermiteRbfField& field) const {
    lattice.edit(lattice.all_nodes(), [&](int column, int row) {
      WarpLattice::Node node = lattice.node(column, row);
      if (free_[free_index(column, row)] == 0) return node;
      const HermiteRbfField::Value v = field.at(lattice.place(column, row));
      node.offset += v.value;
      node.dx += v.jacobian.col(0);
      node.dy += v.jacobian.col(1);
      return node;
    });
  }

  /// Between nodes the lattice is not quite the interpolation: what is missed at the points is
  /// added, as long as that helps.
  void correct(WarpLattice& lattice, const HermiteRbf& rbf) const {
    double miss = 0.0;
    worst_match(lattice, miss);
    for (int i = 0; i < most_corrections && miss > wanted_miss; ++i) {
      WarpLattice better = lattice;
      add(better, rbf.solve(missing(lattice), {}));
      double left = 0.0;
      worst_match(better, left);
      if (!(left < miss)) return;
      lattice = std::move(better);
      miss = left;
    }
  }

  Eigen::MatrixX2d missing(const WarpLattice& lattice) const {
    Eigen::MatrixX2d values = no_offsets();
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      const Vec2d reached = lattice.at(matches_[i].target).position;
      values.row(row_of(i)) = (matches_[i].source - reached).transpose();
    }
    return values;
  }

  const Match& worst_match(const WarpLattice& lattice, double& miss) const {
    std::size_t worst = 0;
    miss = 0.0;
    for (std::size_t i = 0; i < matches_.size(); ++i) {
      const double m = (lattice.at(matches_[i].target).position - matches_[i].source).norm();
      if (!(m > miss)) continue;
      worst = i;
      miss = m;
    }
    return matches_[worst];
  }

  SketchWarpOptions options_;
  PolylineByLength boundary_;
  WarpLattice lattice_;
  /// Up to this distance from the boundary all nodes stay: a cell's diagonal. The interpolation is
  /// the identity where the collar ends; were it so at the boundary, what it has gained from there
  /// would be made up for within the first cells, with several times its second derivative.
  double collar_;
  std::vector<Match> matches_;
  std::vector<Vec2d> fixed_;  ///< where the collar ends
  std::vector<unsigned char> free_;
};

}  // namespace

SketchWarp sketch_warp(const Stroke& boundary, std::span<const SketchPair> pairs,
                       const SketchWarpOptions& options) {
  check(boundary, pairs, options);
  const Sketch sketch(boundary, pairs, options);
  SketchWarp warp{sketch.identity(), {}, 1, 0.0};
  if (sketch.empty()) return warp;
  Vec2d fold;
  for (int steps = 1; steps <= most_steps; steps *= 2) {
    warp = sketch.solve(steps);
    if (!sketch.folds(warp)) return warp;
    if (steps == 1) fold = warp.least.place;
  }
  throw InvalidInput("sketch warp: the picture would fold over near " + named(fold) +
                     "; draw the strokes of a pair closer to each other there");
}

}  // namespace normalshop
