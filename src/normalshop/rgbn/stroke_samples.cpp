#include "normalshop/rgbn/detail/stroke_samples.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace normalshop {

namespace {

constexpr int starts_a_point = 8;
/// Of an inset's points, in parts of their spacing.
constexpr double candidate_step = 0.125;
constexpr double least_gap = 0.875;

std::vector<Vec2d> samples(const PolylineByLength& line, int count, bool reversed) {
  std::vector<Vec2d> points;
  Vec2d center = Vec2d::Zero();
  for (int i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / count;
    points.push_back(line.at(reversed ? -part : part));
    center += points.back();
  }
  center /= count;
  for (Vec2d& p : points) p -= center;
  return points;
}

double distance_to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const Vec2d along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

}  // namespace

PolylineByLength::PolylineByLength(const Stroke& stroke, bool closed) : closed_(closed) {
  assert(!stroke.empty());
  for (const StrokePoint& p : stroke) points_.push_back(p.position.cast<double>());
  if (closed) points_.push_back(points_.front());
  lengths_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    lengths_.push_back(lengths_.back() + (points_[i] - points_[i - 1]).norm());
  }
}

Vec2d PolylineByLength::at(double part) const {
  if (!(length() > 0.0)) return points_.front();
  const double inside = closed_ ? part - std::floor(part) : std::clamp(part, 0.0, 1.0);
  const double along = inside * length();
  // The first point beyond, so never one at the start of an empty segment.
  const auto beyond = std::upper_bound(lengths_.begin(), lengths_.end(), along);
  if (beyond == lengths_.end()) return points_.back();
  const auto i = static_cast<std::size_t>(beyond - lengths_.begin());
  const double t = (along - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
  return points_[i - 1] + t * (points_[i] - points_[i - 1]);
}

double PolylineByLength::enclosed_area() const {
  double twice = 0.0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    twice += cross(points_[i - 1] - points_.front(), points_[i] - points_.front());
  }
  return 0.5 * twice;
}

Rect PolylineByLength::bounds() const {
  Vec2d low = points_.front();
  Vec2d high = low;
  for (const Vec2d& p : points_) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())),
          static_cast<int>(std::ceil(high.x())) + 1, static_cast<int>(std::ceil(high.y())) + 1};
}

bool PolylineByLength::has_inside(const Vec2d& p) const {
  int winding = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Vec2d& a = points_[i - 1];
    const Vec2d& b = points_[i];
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const double side = cross(b - a, p - a);
    if (b.y() > a.y() && side > 0.0) ++winding;
    if (b.y() < a.y() && side < 0.0) --winding;
  }
  return winding != 0;
}

double PolylineByLength::distance(const Vec2d& p) const {
  double least = (p - points_.front()).norm();
  for (std::size_t i = 1; i < points_.size(); ++i) {
    least = std::min(least, distance_to_segment(p, points_[i - 1], points_[i]));
  }
  return least;
}

std::vector<Vec2d> PolylineByLength::inset(double depth, double spacing) const {
  std::vector<Vec2d> kept;
  const auto consider = [&](const Vec2d& p) {
    const double least = least_gap * spacing;
    for (const Vec2d& other : kept) {
      if ((p - other).squaredNorm() < least * least) return;
    }
    if (has_inside(p) && distance(p) >= depth * (1.0 - 1e-9)) kept.push_back(p);
  };
  const double step = candidate_step * spacing;
  Vec2d before = Vec2d::Zero();
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Vec2d side = points_[i] - points_[i - 1];
    if (!(side.norm() > 0.0)) continue;
    const Vec2d normal = Vec2d(-side.y(), side.x()) * (depth / side.norm());
    if (before.isZero(0.0)) before = -normal;  // the first corner: all around it
    // Around the corner as well, on whichever side of it the inside is.
    const double turn = std::atan2(cross(before, normal), before.dot(normal));
    const int turns = static_cast<int>(std::ceil(std::abs(turn) * depth / step));
    for (int k = 1; k <= turns; ++k) {
      const Vec2d arm = Eigen::Rotation2Dd(turn * k / (turns + 1)) * before;
      consider(points_[i - 1] + arm);
      consider(points_[i - 1] - arm);
    }
    const int pieces = static_cast<int>(std::ceil(side.norm() / step));
    for (int k = 0; k < pieces; ++k) {
      const Vec2d on = points_[i - 1] + side * (static_cast<double>(k) / pieces);
      consider(on + normal);
      consider(on - normal);
    }
    before = normal;
  }
  return kept;
}

OutlineMatch match_outlines(const PolylineByLength& source, const PolylineByLength& target,
                            int count) {
  OutlineMatch match;
  match.reversed = source.enclosed_area() * target.enclosed_area() < 0.0;
  const std::vector<Vec2d> points = samples(target, count, false);
  const std::vector<Vec2d> starts = samples(source, count * starts_a_point, match.reversed);
  double best = -1.0;
  for (std::size_t start = 0; start < starts.size(); ++start) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      sum += (points[i] - starts[(start + i * starts_a_point) % starts.size()]).squaredNorm();
    }
    if (best >= 0.0 && !(sum < best)) continue;
    best = sum;
    const double part = static_cast<double>(start) / static_cast<double>(starts.size());
    match.shift = match.reversed ? -part : part;
  }
  return match;
}

}  // namespace normalshop
