#include "normalshop/document/stroke_views.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "normalshop/core/error.h"
#include "normalshop/document/surface_trace.h"

namespace normalshop {

namespace {

/// Cosines: of the widest angle between a view and the way that it is made for; of where ways turn
/// away from a view, beyond any effective chart.
const float facing_cosine = std::cos(25.0F * 3.14159265F / 180.0F);
const float turned_cosine = std::cos(86.5F * 3.14159265F / 180.0F);
/// Of the surface around a stroke that its views show, in half widths of what it draws.
constexpr float shown_widths = 3.0F;
/// In parts of the model's size.
constexpr float least_step = 5e-4F;
constexpr float largest_step = 5e-3F;
constexpr float least_around = 0.01F;

/// Points first to last of a trace.
struct Part {
  std::size_t trace;
  std::size_t first;
  std::size_t last;
};

float distance_to_segment(const Vec3f& p, const Vec3f& a, const Vec3f& b) {
  const Vec3f along = b - a;
  const float squared = along.squaredNorm();
  const float t = squared > 0.0F ? std::clamp((p - a).dot(along) / squared, 0.0F, 1.0F) : 0.0F;
  return (p - a - t * along).norm();
}

class StrokeViews {
 public:
  StrokeViews(const Mesh& mesh, const Topology& topology, std::vector<Trace> traces, float radius)
      : mesh_(mesh), topology_(topology), traces_(std::move(traces)), radius_(radius) {
    for (const Trace& trace : traces_) served_.emplace_back(trace.size(), false);
  }

  std::vector<StrokeView> choose() {
    std::vector<StrokeView> views;
    for (std::size_t s = 0; s < traces_.size(); ++s) {
      for (std::size_t i = 0; i < traces_[s].size(); ++i) {
        if (served_[s][i]) continue;
        served_[s][i] = true;  // even where nothing of it can be drawn
        StrokeView view = look(s, i);
        if (!view.strokes.empty()) views.push_back(std::move(view));
      }
    }
    return views;
  }

 private:
  const TracePoint& at(std::size_t trace, std::size_t i) const { return traces_[trace][i]; }
  bool faces(const TracePoint& p, const Vec3f& direction) const {
    return p.normal.dot(direction) > turned_cosine;
  }

  /// The mean direction of the longest way from there on that faces it.
  Vec3f direction_from(std::size_t trace, std::size_t first) const {
    Vec3f sum = Vec3f::Zero();
    std::vector<Vec3f> held;
    for (std::size_t i = first; i < traces_[trace].size(); ++i) {
      const Vec3f& facing = at(trace, i).facing;
      const Vec3f next = (sum + facing).normalized();
      const bool holds = facing.dot(next) >= facing_cosine &&
                         at(trace, first).facing.dot(next) >= facing_cosine &&
                         std::all_of(held.begin(), held.end(),
                                     [&](const Vec3f& n) { return n.dot(next) >= facing_cosine; });
      if (!sum.isZero() && !holds) break;
      sum += facing;
      if (i % 4 == 0) held.push_back(facing);
    }
    return sum.normalized();
  }

  /// The part around a point that faces the direction.
  Part part_around(std::size_t trace, std::size_t i, const Vec3f& direction) const {
    Part part{trace, i, i};
    while (part.first > 0 && faces(at(trace, part.first - 1), direction)) --part.first;
    while (part.last + 1 < traces_[trace].size() && faces(at(trace, part.last + 1), direction)) {
      ++part.last;
    }
    return part;
  }

  StrokeView look(std::size_t trace, std::size_t first) {
    const Vec3f direction = direction_from(trace, first);
    StrokeView out;
    std::vector<Part> parts;
    if (faces(at(trace, first), direction)) {
      parts = parts_near(part_around(trace, first, direction), direction, out.triangles);
    }
    if (parts.empty()) return out;
    Vec3f low = Vec3f::Constant(3.4e38F);
    Vec3f high = -low;
    for (const Part& part : parts) {
      for (std::size_t i = part.first; i <= part.last; ++i) {
        const TracePoint& p = at(part.trace, i);
        low = low.cwiseMin(p.position);
        high = high.cwiseMax(p.position);
        if (p.facing.dot(direction) >= facing_cosine) served_[part.trace][i] = true;
      }
    }
    const float size = (high - low).norm() + 2.0F * radius_;
    out.view = make_view(direction, Vec3f::UnitY(), 0.5F * (low + high), size, size);
    for (const Part& part : parts) out.strokes.push_back(drawn(part, out.view));
    return out;
  }

  /// How much shorter the view shows lengths across the way: it shows areas smaller by n . d, and
  /// lengths along the way by |t - (t . d) d|.
  float across(std::size_t trace, std::size_t i, const View& view) const {
    constexpr float least = 0.1F;
    const Trace& points = traces_[trace];
    const std::size_t before = i > 0 ? i - 1 : i;
    const std::size_t after = i + 1 < points.size() ? i + 1 : i;
    const Vec3f way = points[after].position - points[before].position;
    const float length = way.norm();
    const float shown = view.to_chart(way).head<2>().norm();
    const float area = points[i].facing.dot(view.direction);
    return shown > least * length ? std::clamp(area * length / shown, least, 1.0F) : 1.0F;
  }

  UnitStroke drawn(const Part& part, const View& view) const {
    UnitStroke stroke;
    const float length = traces_[part.trace].back().along;
    for (std::size_t i = part.first; i <= part.last; ++i) {
      const TracePoint& p = at(part.trace, i);
      stroke.push_back({view.to_chart(p.position - view.center).head<2>(), p.pressure, p.along,
                        length - p.along, across(part.trace, i, view)});
    }
    return stroke;
  }

  /// That part and all others on the surface near it, and near these; with the triangles there.
  std::vector<Part> parts_near(const Part& start, const Vec3f& direction,
                               std::vector<std::uint32_t>& triangles) const {
    std::vector<bool> shown(mesh_.triangle_count(), false);
    std::vector<std::vector<bool>> taken;
    for (const Trace& trace : traces_) taken.emplace_back(trace.size(), false);
    std::vector<Part> parts;
    const auto take = [&](const Part& part) {
      parts.push_back(part);
      for (std::size_t i = part.first; i <= part.last; ++i) taken[part.trace][i] = true;
      show_around(part, shown, triangles);
    };
    take(start);
    for (bool more = true; more;) {
      more = false;
      for (std::size_t s = 0; s < traces_.size(); ++s) {
        for (std::size_t i = 0; i < traces_[s].size(); ++i) {
          const TracePoint& p = at(s, i);
          if (taken[s][i] || !shown[p.triangle] || !faces(p, direction)) continue;
          take(part_around(s, i, direction));
          more = true;
        }
      }
    }
    return parts;
  }

  /// Points of a part that stand for all of it, a quarter of the radius apart.
  std::vector<Vec3f> guides(const Part& part) const {
    std::vector<Vec3f> out;
    float last = 0.0F;
    for (std::size_t i = part.first; i <= part.last; ++i) {
      const TracePoint& p = at(part.trace, i);
      if (i > part.first && i < part.last && p.along - last < 0.25F * radius_) continue;
      last = p.along;
      out.push_back(p.position);
    }
    return out;
  }

  void show_around(const Part& part, std::vector<bool>& shown,
                   std::vector<std::uint32_t>& triangles) const {
    const std::vector<Vec3f> near = guides(part);
    std::vector<bool> seen(mesh_.triangle_count(), false);
    std::vector<std::uint32_t> open;
    const auto show = [&](std::uint32_t triangle) {
      if (seen[triangle]) return;
      seen[triangle] = true;
      open.push_back(triangle);
      if (shown[triangle]) return;
      shown[triangle] = true;
      triangles.push_back(triangle);
    };
    for (std::size_t i = part.first; i <= part.last; ++i) show(at(part.trace, i).triangle);
    while (!open.empty()) {
      const std::uint32_t triangle = open.back();
      open.pop_back();
      for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
        const std::uint32_t across = topology_.neighbor[edge];
        if (across == no_edge || seen[across / 3]) continue;
        const Vec3f& a = mesh_.position(edge);
        const Vec3f& b = mesh_.position(next_corner(edge));
        const bool reached = std::any_of(near.begin(), near.end(), [&](const Vec3f& p) {
          return distance_to_segment(p, a, b) <= 1.125F * radius_;
        });
        if (reached) show(across / 3);
      }
    }
  }

  const Mesh& mesh_;
  const Topology& topology_;
  std::vector<Trace> traces_;
  std::vector<std::vector<bool>> served_;
  float radius_;
};

}  // namespace

CoverView StrokeView::cover(const Mesh& mesh) const {
  auto shown = std::make_shared<Mesh>();
  shown->positions = mesh.positions;
  shown->triangles.assign(mesh.triangle_count(), Vec3u::Zero());
  for (const std::uint32_t t : triangles) shown->triangles[t] = mesh.triangles[t];
  const Vec2f half(0.5F * view.width, 0.5F * view.height);
  return {view, -half, half, std::move(shown)};
}

std::vector<StrokeView> view_strokes(const Edit& edit, const Mesh& mesh) {
  const float size = bounds(mesh).diagonal();
  const Extent dot = edit.operation->extent({{UnitPoint{Vec2f::Zero()}}});
  const float half_width = 0.5F * (dot.high - dot.low).maxCoeff();
  const float step = std::clamp(0.5F * half_width, least_step * size, largest_step * size);
  const float around = std::max(half_width, least_around * size);
  const float radius = shown_widths * std::max(half_width, least_step * size) +
                       edit.operation->reach(least_step * size);
  const Topology topology = make_topology(mesh);
  return StrokeViews(mesh, topology, trace_strokes(edit, mesh, topology, {step, around}), radius)
      .choose();
}

}  // namespace normalshop
