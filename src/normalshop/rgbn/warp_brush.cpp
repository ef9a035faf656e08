#include "normalshop/rgbn/warp_brush.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

/// The falloff's steepest slope, times the radius.
constexpr double steepest = 1.7172;
/// A step of a motion bends the picture by at most this: det DW stays above 1 / (1 + this).
constexpr double most_bend = 0.5;
constexpr int most_steps = 4096;
constexpr int halvings = 6;

/// 1 at the centre, 0 from the radius on, with two continuous derivatives.
struct Falloff {
  double value = 0.0;
  Vec2d gradient = Vec2d::Zero();

  Falloff(const Vec2d& from_center, double radius) {
    const double s = 1.0 - from_center.squaredNorm() / (radius * radius);
    if (!(s > 0.0)) return;
    value = s * s * s;
    gradient = (-6.0 * s * s / (radius * radius)) * from_center;
  }
};

/// A small warp within a radius.
struct Dab {
  Vec2d center;
  double radius;
};

WarpPoint identity_at(const Vec2d& x) { return {x, Eigen::Matrix2d::Identity()}; }

/// x - motion w(x): the motion is that of the place where it ends.
WarpPoint push_dab(const Vec2d& x, const Dab& dab, const Vec2d& motion) {
  const Falloff w(x - dab.center, dab.radius);
  WarpPoint p = identity_at(x);
  p.position -= motion * w.value;
  p.jacobian -= motion * w.gradient.transpose();
  return p;
}

/// The inverse of y + motion w(y): the motion is that of the place where it starts. y lies on the
/// line x - s motion, and s - w(x - s motion) rises from s = 0 to s = 1.
WarpPoint grab_dab(const Vec2d& x, const Dab& dab, const Vec2d& motion) {
  double low = 0.0;
  double high = 1.0;
  double s = Falloff(x - dab.center, dab.radius).value;
  for (int i = 0; i < 60 && high - low > 1e-15; ++i) {
    const Falloff w(x - s * motion - dab.center, dab.radius);
    const double miss = s - w.value;
    (miss > 0.0 ? high : low) = s;
    const double newton = s - miss / (1.0 + w.gradient.dot(motion));
    const double next = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    if (std::abs(next - s) < 1e-14) break;
    s = next;
  }
  WarpPoint p = identity_at(x);
  p.position -= s * motion;
  const Falloff w(p.position - dab.center, dab.radius);
  // The inverse of I + motion gradient^T.
  p.jacobian -= motion * w.gradient.transpose() / (1.0 + w.gradient.dot(motion));
  return p;
}

WarpPoint pinch_dab(const Vec2d& x, const Dab& dab, double scale) {
  const Vec2d r = x - dab.center;
  const Falloff w(r, dab.radius);
  WarpPoint p = identity_at(x);
  p.position += (scale - 1.0) * w.value * r;
  p.jacobian +=
      (scale - 1.0) * (w.value * Eigen::Matrix2d::Identity() + r * w.gradient.transpose());
  return p;
}

/// Turns by angle w(x), counter-clockwise as seen with y down.
WarpPoint twirl_dab(const Vec2d& x, const Dab& dab, double angle) {
  const Vec2d r = x - dab.center;
  const Falloff w(r, dab.radius);
  const double c = std::cos(angle * w.value);
  const double s = std::sin(angle * w.value);
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  WarpPoint p;
  p.position = dab.center + turn * r;
  const Vec2d across = turn * Vec2d(-r.y(), r.x());  // the derivative of turn * r by the angle
  p.jacobian = turn + angle * across * w.gradient.transpose();
  return p;
}

void check(const WarpLattice& lattice, const Vec2f& a, const Vec2f& b, const WarpBrushOptions& o) {
  if (!a.allFinite() || !b.allFinite() || a.cwiseAbs().maxCoeff() > 1e8F ||
      b.cwiseAbs().maxCoeff() > 1e8F) {
    throw InvalidInput("warp brush: places must be numbers below 1e8");
  }
  if (!(o.radius >= 0.0F && o.radius <= 1e6F)) {
    throw InvalidInput("warp brush: radius must be a number from 0 to 1e6");
  }
  if (!(std::abs(o.strength) <= 10.0F)) {
    throw InvalidInput("warp brush: strength must be a number from -10 to 10");
  }
  if (!(o.least_area >= 1e-6F && o.least_area <= 1.0F)) {
    throw InvalidInput("warp brush: least_area must be a number from 1e-6 to 1");
  }
  const double radius = o.radius;
  if (radius > 0.0 && radius < 2.0 * lattice.spacing().maxCoeff()) {
    throw InvalidInput("warp brush: radius must be at least two cells of the lattice, " +
                       std::to_string(2.0 * lattice.spacing().maxCoeff()) + " pixels");
  }
  const int side = std::min(lattice.area().width(), lattice.area().height());
  if (lattice.edge() == LatticeEdge::Repeat && 2.0 * radius > side) {
    throw InvalidInput(
        "warp brush: where the lattice repeats, radius must be at most half of it, " +
        std::to_string(side / 2) + " pixels");
  }
}

int steps_for(double bend) {
  return std::clamp(static_cast<int>(std::ceil(std::min(bend, 1e6))), 1, most_steps);
}

/// One dab on the lattice; the nodes that it changed are added to `touched`.
template <class Inner>
void apply(WarpLattice& lattice, const Dab& dab, double reach, const Inner& inner, Rect& touched) {
  const Rect nodes = lattice.nodes_near(dab.center, reach);
  compose(lattice, nodes, [&](const Vec2d& x) { return inner(x, dab); });
  touched = unite(touched, nodes);
}

/// Nodes as they were: a copy of the whole lattice would cost more than most dabs.
class KeptNodes {
 public:
  KeptNodes(const WarpLattice& lattice, const Rect& nodes) : nodes_(nodes) {
    for (int row = nodes.y0; row < nodes.y1; ++row) {
      for (int column = nodes.x0; column < nodes.x1; ++column) {
        kept_.push_back(lattice.node(column, row));
      }
    }
  }
  void put_back(WarpLattice& lattice) const {
    lattice.edit(nodes_, [&](int column, int row) {
      return kept_[static_cast<std::size_t>(row - nodes_.y0) *
                       static_cast<std::size_t>(nodes_.width()) +
                   static_cast<std::size_t>(column - nodes_.x0)];
    });
  }

 private:
  Rect nodes_;
  std::vector<WarpLattice::Node> kept_;
};

/// The way of a brush: it changes nodes within the radius around it.
struct Way {
  Vec2d start;
  Vec2d whole;
};

Way dab_at(const Vec2f& center) { return {center.cast<double>(), Vec2d::Zero()}; }

/// Runs brush(strength, touched nodes) with less and less strength until nothing folds.
template <class Brush>
WarpDab with_fold_check(WarpLattice& lattice, const WarpBrushOptions& o, const Way& way,
                        const Brush& brush) {
  if (o.strength == 0.0F || o.radius == 0.0F) return {};
  // A pixel more, for what rounding may add.
  const double around = static_cast<double>(o.radius) + 0.5 * way.whole.norm() + 1.0;
  const KeptNodes before(lattice, lattice.nodes_near(way.start + 0.5 * way.whole, around));
  float strength = o.strength;
  for (int i = 0; i <= halvings; ++i, strength *= 0.5F) {
    Rect touched;
    brush(static_cast<double>(strength), touched);
    const LeastArea worst = least_area(lattice, grow(touched, 2));
    if (worst.determinant >= static_cast<double>(o.least_area)) {
      return {lattice.pixels_of(touched), strength};
    }
    before.put_back(lattice);
    if (o.on_fold == OnFold::Refuse) {
      throw InvalidInput("warp brush: the picture would fold over near (" +
                         std::to_string(std::lround(worst.place.x())) + ", " +
                         std::to_string(std::lround(worst.place.y())) +
                         "); take less strength or a larger radius");
    }
  }
  return {};
}

}  // namespace

WarpDab push(WarpLattice& lattice, const Vec2f& from, const Vec2f& to,
             const WarpBrushOptions& options) {
  check(lattice, from, to, options);
  const Vec2d start = from.cast<double>();
  const Vec2d way = to.cast<double>() - start;
  const double radius = options.radius;
  if (way.isZero(0.0)) return {};
  return with_fold_check(lattice, options, {start, way}, [&](double strength, Rect& touched) {
    const double bend = steepest * std::abs(strength) * way.norm() / (radius * most_bend);
    const int steps = steps_for(std::max(bend, 8.0 * way.norm() / radius));
    const Vec2d motion = strength * way / steps;
    for (int k = 1; k <= steps; ++k) {
      apply(
          lattice, {start + way * k / steps, radius}, radius,
          [&](const Vec2d& x, const Dab& dab) { return push_dab(x, dab, motion); }, touched);
    }
  });
}

WarpDab grab(WarpLattice& lattice, const Vec2f& from, const Vec2f& to,
             const WarpBrushOptions& options) {
  check(lattice, from, to, options);
  const Vec2d start = from.cast<double>();
  const Vec2d way = to.cast<double>() - start;
  const double radius = options.radius;
  if (way.isZero(0.0)) return {};
  const Way moved{start, static_cast<double>(options.strength) * way};
  return with_fold_check(lattice, options, moved, [&](double strength, Rect& touched) {
    const int steps = steps_for(steepest * std::abs(strength) * way.norm() / (radius * most_bend));
    const Vec2d motion = strength * way / steps;
    for (int k = 0; k < steps; ++k) {
      apply(
          lattice, {start + motion * k, radius}, radius,
          [&](const Vec2d& x, const Dab& dab) { return grab_dab(x, dab, motion); }, touched);
    }
  });
}

WarpDab pinch(WarpLattice& lattice, const Vec2f& center, const WarpBrushOptions& options) {
  check(lattice, center, center, options);
  const double radius = options.radius;
  return with_fold_check(lattice, options, dab_at(center), [&](double strength, Rect& touched) {
    const int steps = steps_for(2.0 * std::abs(strength));  // half a halving each
    const double scale = std::exp2(strength / steps);
    for (int k = 0; k < steps; ++k) {
      apply(
          lattice, {center.cast<double>(), radius}, radius,
          [&](const Vec2d& x, const Dab& dab) { return pinch_dab(x, dab, scale); }, touched);
    }
  });
}

WarpDab twirl(WarpLattice& lattice, const Vec2f& center, const WarpBrushOptions& options) {
  check(lattice, center, center, options);
  const double radius = options.radius;
  return with_fold_check(lattice, options, dab_at(center), [&](double strength, Rect& touched) {
    const double angle = strength * 1.57079632679489662;
    apply(
        lattice, {center.cast<double>(), radius}, radius,
        [&](const Vec2d& x, const Dab& dab) { return twirl_dab(x, dab, angle); }, touched);
  });
}

}  // namespace normalshop
