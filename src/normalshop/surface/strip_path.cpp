#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <unordered_map>

#include <Eigen/Geometry>

#include "normalshop/surface/detail/strip.h"

namespace normalshop {

namespace {

/// Angles nearer to pi than this are straight.
constexpr double straight_angle = 1e-7;
/// A pass that shortens the way by less than this part of it found nothing but rounding.
constexpr double least_gain = 1e-14;
constexpr int most_passes = 100000;

enum class Side { Left, Right };

/// Where the shortest way in a strip turns: at the first (left) or second (right) corner of an edge
/// of the strip.
struct Bend {
  std::size_t edge;
  Side side;
};

struct Unfolded {
  Vec2d start;
  Vec2d end;
  std::vector<UnfoldedEdge> edges;
};

struct Way {
  std::vector<Bend> bends;
  StripPath path;
};

Vec2d place_in(const std::array<Vec2d, 3>& corners, const SurfacePoint& p) {
  const auto b1 = static_cast<double>(p.b1);
  const auto b2 = static_cast<double>(p.b2);
  return corners[0] * (1.0 - b1 - b2) + corners[1] * b1 + corners[2] * b2;
}

Unfolded unfold(const Mesh& mesh, const Crossings& crossings, const Strip& strip) {
  Unfolded out;
  const std::uint32_t leave = strip.edges.front();
  const Vec3d along = (mesh.position(next_corner(leave)) - mesh.position(leave)).cast<double>();
  UnfoldedEdge e{leave, {0.0, 0.0}, {along.norm(), 0.0}};
  // The triangle that is left lies on the other side: as seen backwards.
  std::array<Vec2d, 3> corners;
  corners[leave % 3] = e.first;
  corners[next_corner(leave) % 3] = e.second;
  corners[previous_corner(leave) % 3] = unfold_apex(mesh, leave, {leave, e.second, e.first});
  out.start = place_in(corners, strip.start);
  for (std::size_t i = 0;; ++i) {
    out.edges.push_back(e);
    const std::uint32_t across = crossings.across(e.edge);
    const Vec2d apex = unfold_apex(mesh, across, e);
    if (i + 1 == strip.edges.size()) {
      corners[across % 3] = e.second;
      corners[next_corner(across) % 3] = e.first;
      corners[previous_corner(across) % 3] = apex;
      out.end = place_in(corners, strip.end);
      return out;
    }
    const std::uint32_t next = strip.edges[i + 1];
    e = next == previous_corner(across) ? UnfoldedEdge{next, apex, e.second}
                                        : UnfoldedEdge{next, e.first, apex};
  }
}

/// The funnel that all straight ways from its apex through the edges so far lie in.
struct Funnel {
  Vec2d apex;
  Vec2d left;
  Vec2d right;
  std::size_t left_edge = 0;
  std::size_t right_edge = 0;

  explicit Funnel(const Vec2d& at, std::size_t edge = 0)
      : apex(at), left(at), right(at), left_edge(edge), right_edge(edge) {}

  bool narrows_right(const Vec2d& p) const { return cross(right - apex, p - apex) >= 0.0; }
  bool narrows_left(const Vec2d& p) const { return cross(left - apex, p - apex) <= 0.0; }
  bool beyond_left(const Vec2d& p) const {
    return apex != right && apex != left && cross(left - apex, p - apex) > 0.0;
  }
  bool beyond_right(const Vec2d& p) const {
    return apex != left && apex != right && cross(right - apex, p - apex) < 0.0;
  }
};

std::vector<Bend> pull_string(const Unfolded& strip) {
  std::vector<Bend> bends;
  Funnel funnel(strip.start);
  const std::size_t count = strip.edges.size();
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec2d& left = i < count ? strip.edges[i].first : strip.end;
    const Vec2d& right = i < count ? strip.edges[i].second : strip.end;
    if (funnel.narrows_right(right)) {
      if (funnel.beyond_left(right)) {
        bends.push_back({funnel.left_edge, Side::Left});
        i = funnel.left_edge;
        funnel = Funnel(funnel.left, i);
        continue;
      }
      funnel.right = right;
      funnel.right_edge = i;
    }
    if (funnel.narrows_left(left)) {
      if (funnel.beyond_right(left)) {
        bends.push_back({funnel.right_edge, Side::Right});
        i = funnel.right_edge;
        funnel = Funnel(funnel.right, i);
        continue;
      }
      funnel.left = left;
      funnel.left_edge = i;
    }
  }
  return bends;
}

/// Where a straight piece crosses an edge, 0 to 1 along it.
double edge_share(const UnfoldedEdge& e, const Vec2d& from, const Vec2d& to) {
  const Vec2d direction = to - from;
  const double first = cross(direction, e.first - from);
  const double second = cross(direction, e.second - from);
  if (first != second) return std::clamp(first / (first - second), 0.0, 1.0);
  const Vec2d along = e.second - e.first;
  const double squared = along.squaredNorm();
  return squared > 0.0 ? std::clamp((from - e.first).dot(along) / squared, 0.0, 1.0) : 0.0;
}

Way shortest_in(const Mesh& mesh, const Crossings& crossings, const Strip& strip) {
  const Unfolded unfolded = unfold(mesh, crossings, strip);
  Way way{pull_string(unfolded), {}};
  Vec2d from = unfolded.start;
  std::size_t edge = 0;
  const auto lead_to = [&](const Vec2d& to, std::size_t end) {
    for (; edge < end; ++edge) {
      way.path.crossings.push_back(edge_share(unfolded.edges[edge], from, to));
    }
    way.path.length += (to - from).norm();
    from = to;
  };
  for (const Bend& bend : way.bends) {
    const bool left = bend.side == Side::Left;
    const UnfoldedEdge& e = unfolded.edges[bend.edge];
    lead_to(left ? e.first : e.second, bend.edge);
    way.path.crossings.push_back(left ? 0.0 : 1.0);
    ++edge;
  }
  lead_to(unfolded.end, unfolded.edges.size());
  return way;
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The other way round a vertex at which a path bends.
struct Detour {
  std::size_t begin;  ///< edges of the strip that it replaces
  std::size_t end;
  std::vector<std::uint32_t> edges;
  double angle;  ///< on that side, where below pi
};

class Detours {
 public:
  Detours(const Mesh& mesh, const Crossings& crossings, const Strip& strip, const Way& way)
      : mesh_(mesh), crossings_(crossings), strip_(strip), way_(way) {}

  /// All that shorten the way, in order, no two of them in one triangle.
  std::vector<Detour> find() const {
    std::vector<Detour> found;
    for (const Bend& bend : way_.bends) {
      Detour detour = around(bend);
      if (detour.edges.empty()) continue;
      const bool apart = found.empty() || detour.begin > found.back().end;
      if (apart) {
        found.push_back(std::move(detour));
      } else if (detour.angle < found.back().angle) {
        const bool still_apart = found.size() < 2 || detour.begin > found[found.size() - 2].end;
        if (still_apart) found.back() = std::move(detour);
      }
    }
    return found;
  }

 private:
  Vec3d at(std::uint32_t corner) const { return mesh_.position(corner).cast<double>(); }
  Vec3d crossed(std::size_t i) const {
    const std::uint32_t edge = strip_.edges[i];
    const double t = way_.path.crossings[i];
    return (1.0 - t) * at(edge) + t * at(next_corner(edge));
  }
  /// The next edge of the strip has the vertex, too.
  bool turns(std::size_t i, Side side) const {
    const std::uint32_t across = crossings_.across(strip_.edges[i]);
    const std::uint32_t next = strip_.edges[i + 1];
    return side == Side::Left ? next == next_corner(across) : next == previous_corner(across);
  }

  /// Without edges: there is none, or it is no shorter.
  Detour around(const Bend& bend) const {
    std::size_t first = bend.edge;
    std::size_t last = bend.edge;
    while (first > 0 && turns(first - 1, bend.side)) --first;
    while (last + 1 < strip_.edges.size() && turns(last, bend.side)) ++last;
    const bool left = bend.side == Side::Left;
    const std::uint32_t leave = strip_.edges[first];
    const std::uint32_t goal = crossings_.across(strip_.edges[last]) / 3;
    const Vec3d vertex = at(left ? leave : next_corner(leave));
    const Vec3d before =
        (first > 0 ? crossed(first - 1) : position_at(mesh_, strip_.start).cast<double>()) - vertex;
    const Vec3d after =
        (last + 1 < strip_.edges.size() ? crossed(last + 1)
                                        : position_at(mesh_, strip_.end).cast<double>()) -
        vertex;
    Detour detour{first, last + 1, {}, 0.0};
    Detour none = detour;
    if (before.isZero() || after.isZero()) return none;
    constexpr double limit = std::numbers::pi - straight_angle;
    std::uint32_t edge = left ? previous_corner(leave) : next_corner(leave);
    Vec3d from = before;
    while (true) {
      const Vec3d spoke = at(left ? edge : next_corner(edge)) - vertex;
      detour.angle += angle_between(from, spoke);
      const std::uint32_t across = crossings_.across(edge);
      if (!(detour.angle < limit) || across == no_edge || across / 3 == leave / 3) return none;
      detour.edges.push_back(edge);
      from = spoke;
      if (across / 3 == goal) break;
      edge = left ? previous_corner(across) : next_corner(across);
    }
    detour.angle += angle_between(from, after);
    return detour.angle < limit ? detour : none;
  }

  const Mesh& mesh_;
  const Crossings& crossings_;
  const Strip& strip_;
  const Way& way_;
};

Strip with_detours(const Strip& strip, std::span<const Detour> detours) {
  Strip out{strip.start, strip.end, {}};
  std::size_t i = 0;
  const auto copy_to = [&](std::size_t end) {
    for (; i < end; ++i) out.edges.push_back(strip.edges[i]);
  };
  for (const Detour& detour : detours) {
    copy_to(detour.begin);
    out.edges.insert(out.edges.end(), detour.edges.begin(), detour.edges.end());
    i = detour.end;
  }
  copy_to(strip.edges.size());
  return out;
}

/// A triangle that is entered twice is crossed straight.
bool cut_loops(const Crossings& crossings, Strip& strip) {
  std::unordered_map<std::uint32_t, std::size_t> last;  // edges before the last visit
  last[strip.start.triangle] = 0;
  for (std::size_t i = 0; i < strip.edges.size(); ++i) {
    last[crossings.across(strip.edges[i]) / 3] = i + 1;
  }
  std::vector<std::uint32_t> kept;
  std::uint32_t triangle = strip.start.triangle;
  for (std::size_t i = last[triangle]; i < strip.edges.size(); i = last[triangle]) {
    kept.push_back(strip.edges[i]);
    triangle = crossings.across(strip.edges[i]) / 3;
  }
  const bool cut = kept.size() < strip.edges.size();
  strip.edges = std::move(kept);
  return cut;
}

double straight_length(const Mesh& mesh, const Strip& strip) {
  return (position_at(mesh, strip.end) - position_at(mesh, strip.start)).cast<double>().norm();
}

}  // namespace

StripPath straighten(const Mesh& mesh, const Crossings& crossings, Strip& strip) {
  cut_loops(crossings, strip);
  if (strip.edges.empty()) return {{}, straight_length(mesh, strip)};
  Way way = shortest_in(mesh, crossings, strip);
  for (int pass = 0; pass < most_passes; ++pass) {
    const std::vector<Detour> detours = Detours(mesh, crossings, strip, way).find();
    if (detours.empty()) break;
    Strip next = with_detours(strip, detours);
    cut_loops(crossings, next);
    if (next.edges.empty()) {
      strip = next;
      return {{}, straight_length(mesh, strip)};
    }
    Way shorter = shortest_in(mesh, crossings, next);
    if (!(shorter.path.length < way.path.length * (1.0 - least_gain))) break;
    strip = std::move(next);
    way = std::move(shorter);
  }
  return way.path;
}

}  // namespace normalshop
