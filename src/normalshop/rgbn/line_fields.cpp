#include "normalshop/rgbn/detail/line_fields.h"

#include <cmath>
#include <vector>

#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/principal_curvature.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

/// n3 of what counts as seen from the side.
constexpr float contour_n3 = 0.1F;
/// A step between surfaces makes a contour if one of them is as steep as a rim.
constexpr float rim_n3 = 0.6F;
/// Below this tilt n1^2 + n2^2 the direction of the tilt means nothing; from twice that on it does.
constexpr float least_tilt = 0.02F;

/// Derivative in picture axes, y up, of an image with a border of at least one pixel.
Vec2f gradient(const MaskImage& f, int i, int j) {
  return {0.5F * (f(i + 1, j) - f(i - 1, j)), 0.5F * (f(i, j - 1) - f(i, j + 1))};
}

bool is_rim(const NormalLayer& layer, int x, int y, float least_cosine) {
  const Vec3f& n = layer(x, y);
  if (!has_direction(n) || n.z() > rim_n3) return false;
  const auto at = [&](int i, int j) -> Vec3f {
    return layer.rect().contains(i, j) ? layer(i, j) : Vec3f(Vec3f::Zero());
  };
  const auto jumps = [&](const Vec3f& a, const Vec3f& b) {
    return has_direction(a) && has_direction(b) && a.dot(b) < least_cosine;
  };
  // A step may take two pixels where a picture was antialiased.
  const auto steps_down = [&](int dx, int dy) {
    const Vec3f near = at(x + dx, y + dy);
    if (jumps(n, near)) return n.z() < near.z();
    const Vec3f far = at(x + 2 * dx, y + 2 * dy);
    return jumps(n, far) && n.z() < far.z() && has_direction(near) && !jumps(near, far);
  };
  return steps_down(-1, 0) || steps_down(1, 0) || steps_down(0, -1) || steps_down(0, 1);
}

/// The pixel of the layer that stands for one beside it.
Vec2i continued(const NormalLayer& layer, int x, int y) {
  const Rect& r = layer.rect();
  return {std::clamp(x, r.x0, r.x1 - 1), std::clamp(y, r.y0, r.y1 - 1)};
}

/// Fills value(x, y) for `area` grown by one pixel; pixels beyond the layer continue it.
template <class Value>
MaskImage bordered(const NormalLayer& layer, const Rect& area, const Value& value) {
  const Rect all = grow(area, 1);
  MaskImage out(all.width(), all.height());
  for_each_row(all, [&](int y) {
    for (int x = all.x0; x < all.x1; ++x) {
      const Vec2i p = continued(layer, x, y);
      out(x - all.x0, y - all.y0) = value(p.x(), p.y());
    }
  });
  return out;
}

/// The image at (i + dx, j + dy) for |dx|, |dy| <= 1, rounded alike wherever (i, j) is.
float sample_beside(const MaskImage& f, int i, int j, float dx, float dy) {
  const int x = dx < 0.0F ? i - 1 : i;
  const int y = dy < 0.0F ? j - 1 : j;
  const float fx = dx < 0.0F ? 1.0F + dx : dx;
  const float fy = dy < 0.0F ? 1.0F + dy : dy;
  const auto across = [&](int row) {
    // At a fraction of 0 the next pixel may lie beyond the image.
    return fx > 0.0F ? f(x, row) + fx * (f(x + 1, row) - f(x, row)) : f(x, row);
  };
  return fy > 0.0F ? across(y) + fy * (across(y + 1) - across(y)) : across(y);
}

/// A crest with these heights at -1, 0 and 1 across it, as a Gaussian, which it is where a crease
/// was smoothed.
struct Crest {
  float distance;
  float height;
  float sharpness;  ///< 1 / variance
};

Crest crest_of(float before, float here, float after) {
  if (!(here > 0.0F)) return {1e9F, 0.0F, 0.0F};
  const float slope = 0.5F * (after - before) / here;
  const float sharpness = slope * slope - (before - 2.0F * here + after) / here;
  if (!(sharpness > 0.0F)) return {1e9F, 0.0F, 0.0F};
  const float distance = std::abs(slope) / sharpness;
  const float rise = 0.5F * distance * std::abs(slope);
  return {distance, here * (1.0F + rise + 0.5F * rise * rise), sharpness};
}

bool on_line(const LinePoint& p, float width, float limit) {
  return p.strength >= limit && line_cover(p.distance, width) > 0.0F;
}

/// visit(x, y) for the pixels around p, and p itself.
template <class Visit>
void for_each_neighbor(const Rect& image, const Vec2i& p, const Visit& visit) {
  for (int y = std::max(image.y0, p.y() - 1); y <= std::min(image.y1 - 1, p.y() + 1); ++y) {
    for (int x = std::max(image.x0, p.x() - 1); x <= std::min(image.x1 - 1, p.x() + 1); ++x) {
      visit(x, y);
    }
  }
}

}  // namespace

MaskImage find_rims(const NormalLayer& layer, const Rect& area, const LineOptions& options) {
  const float least_cosine = guard_cosine(options.jump);
  MaskImage out(area.width(), area.height());
  for_each_row(area, [&](int y) {
    for (int x = area.x0; x < area.x1; ++x) {
      out(x - area.x0, y - area.y0) = is_rim(layer, x, y, least_cosine) ? 1.0F : 0.0F;
    }
  });
  return out;
}

void add_outline(const NormalLayer& layer, const Rect& area, MaskImage& mask) {
  const auto is_gap = [&](int x, int y) {
    return layer.rect().contains(x, y) && !has_direction(layer(x, y));
  };
  for_each_row(area, [&](int y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const bool beside =
          is_gap(x - 1, y) || is_gap(x + 1, y) || is_gap(x, y - 1) || is_gap(x, y + 1);
      if (beside && !is_gap(x, y)) mask(x - area.x0, y - area.y0) = 1.0F;
    }
  });
}

Image<LinePoint> find_contours(const NormalLayer& layer, const Rect& area,
                               const LineOptions& options) {
  const float blur = rim_blur(options);
  const Rect wide = intersect(grow(area, smoothing_reach(blur) + 1), layer.rect());
  MaskImage marks = find_rims(layer, wide, options);
  add_outline(layer, wide, marks);
  for_each_row(wide, [&](int y) {
    for (int x = wide.x0; x < wide.x1; ++x) {
      const Vec3f& n = layer(x, y);
      if (has_direction(n) && n.z() < contour_n3) marks(x - wide.x0, y - wide.y0) = 1.0F;
    }
  });
  smooth(marks, {}, marks, marks.rect(), {.sigma = blur});
  const MaskImage height =
      bordered(layer, area, [&](int x, int y) { return marks(x - wide.x0, y - wide.y0); });
  const float full = 0.4F / blur;  // height of a row of marks
  Image<LinePoint> out(area.width(), area.height(), no_line);
  for_each_row(out.rect(), [&](int j) {
    for (int i = 0; i < out.width(); ++i) {
      const float here = height(i + 1, j + 1);
      if (here < 0.01F * full) continue;
      // Across a blurred row, a Gaussian whatever its density, which depends on the row's angle.
      const float slope = gradient(height, i + 1, j + 1).norm() / here;
      const float distance = blur * blur * slope;
      const float rise = 0.5F * distance * slope;
      const float middle = here * (1.0F + rise * (1.0F + rise * (0.5F + rise / 6.0F)));
      out(i, j) = {distance, full_line * smoothstep(0.4F, 0.6F, middle / full)};
    }
  });
  return out;
}

Image<LinePoint> find_suggestive(const NormalLayer& smooth, const Rect& area,
                                 const LineOptions& options) {
  // Minus the radial curvature times n1^2 + n2^2: the derivative of n3 along (n1, n2), times n3.
  const float joined = guard_cosine(180.0F);
  const MaskImage f = bordered(smooth, area, [&](int x, int y) {
    const Vec2f w = smooth(x, y).head<2>();
    const Mat2f j = normal_jacobian(smooth, links_at(smooth, x, y, joined), x, y);
    return -w.dot(j * w);
  });
  Image<LinePoint> out(area.width(), area.height(), no_line);
  for_each_row(area, [&](int y) {
    for (int x = area.x0; x < area.x1; ++x) {
      const Vec3f& n = smooth(x, y);
      const Vec2f w = n.head<2>();
      const float tilt = w.squaredNorm();
      if (!has_direction(n) || tilt < least_tilt) continue;
      const int i = x - area.x0;
      const int j = y - area.y0;
      const Vec2f slope = gradient(f, i + 1, j + 1);
      const float steepness = slope.norm();
      const float sharp = options.sigma * options.sigma * w.dot(slope) / tilt;
      if (!(sharp > 0.0F) || !(steepness > 0.0F)) continue;
      const float sure = smoothstep(least_tilt, 2.0F * least_tilt, tilt);
      out(i, j) = {std::abs(f(i + 1, j + 1)) / steepness,
                   sure * sharp / std::max(options.dip, 1e-6F)};
    }
  });
  return out;
}

Creases find_creases(const NormalLayer& smooth, const Rect& area, const LineOptions& options) {
  const float joined = guard_cosine(180.0F);
  const auto at = [&](int x, int y) {
    const Mat2f j = normal_jacobian(smooth, links_at(smooth, x, y, joined), x, y);
    return principal_curvature(j, smooth(x, y));
  };
  const Rect all = grow(area, 1);
  MaskImage high(all.width(), all.height());
  MaskImage low(all.width(), all.height());
  for_each_row(all, [&](int y) {
    for (int x = all.x0; x < all.x1; ++x) {
      const Vec2i p = continued(smooth, x, y);
      const bool there = has_direction(smooth(p.x(), p.y()));
      const Curvature bend = there ? at(p.x(), p.y()) : Curvature{};
      high(x - all.x0, y - all.y0) = bend.k1;
      low(x - all.x0, y - all.y0) = -bend.k2;
    }
  });
  // A crease of angle t, smoothed, bends by t / (sigma sqrt(2 pi)) at its sharpest.
  constexpr float radians = 3.14159265F / 180.0F;
  const float limit = std::max(options.crease, 1e-3F) * radians / (2.5066283F * options.sigma);
  Creases out = {{area.width(), area.height(), no_line}, {area.width(), area.height(), no_line}};
  for_each_row(area, [&](int y) {
    for (int x = area.x0; x < area.x1; ++x) {
      if (!has_direction(smooth(x, y))) continue;
      const int i = x - area.x0;
      const int j = y - area.y0;
      const float up = high(i + 1, j + 1);
      const float down = low(i + 1, j + 1);
      const bool ridge = up >= down;
      if (std::max(up, down) < 0.25F * limit) continue;
      const Curvature bend = at(x, y);
      const Vec2f e = ridge ? bend.e1 : bend.e2;
      const MaskImage& k = ridge ? high : low;
      const auto sample = [&](float t) {
        return sample_beside(k, i + 1, j + 1, t * e.x(), -t * e.y());
      };
      const Crest crest = crest_of(sample(-1.0F), sample(0.0F), sample(1.0F));
      const float crisp = smoothstep(0.02F, 0.1F, crest.sharpness * options.sigma * options.sigma);
      (ridge ? out.ridges : out.valleys)(i, j) = {crest.distance, crisp * crest.height / limit};
    }
  });
  return out;
}

float rim_blur(const LineOptions& options) { return std::max(0.7F, 0.42F * options.width); }

void keep_connected(Image<LinePoint>& line, float width, int steps) {
  Image<unsigned char> kept(line.width(), line.height(), 0);
  std::vector<Vec2i> front;
  for (int y = 0; y < line.height(); ++y) {
    for (int x = 0; x < line.width(); ++x) {
      if (!on_line(line(x, y), width, 1.0F)) continue;
      kept(x, y) = 1;
      front.emplace_back(x, y);
    }
  }
  for (int step = 0; step < steps && !front.empty(); ++step) {
    std::vector<Vec2i> next;
    for (const Vec2i& p : front) {
      for_each_neighbor(line.rect(), p, [&](int x, int y) {
        if (kept(x, y) != 0 || !on_line(line(x, y), width, weak_line)) return;
        kept(x, y) = 1;
        next.emplace_back(x, y);
      });
    }
    front = std::move(next);
  }
  for_each_row(line.rect(), [&](int y) {
    for (int x = 0; x < line.width(); ++x) {
      if (kept(x, y) == 0) line(x, y).strength = 0.0F;
    }
  });
}

void drop_short(Image<LinePoint>& line, float width, int shortest) {
  Image<unsigned char> seen(line.width(), line.height(), 0);
  std::vector<Vec2i> piece;
  for (int y0 = 0; y0 < line.height(); ++y0) {
    for (int x0 = 0; x0 < line.width(); ++x0) {
      if (seen(x0, y0) != 0 || !on_line(line(x0, y0), width, weak_line)) continue;
      piece.assign(1, Vec2i(x0, y0));
      seen(x0, y0) = 1;
      Rect box = {x0, y0, x0 + 1, y0 + 1};
      for (std::size_t i = 0; i < piece.size(); ++i) {
        const Vec2i p = piece[i];
        box = unite(box, {p.x(), p.y(), p.x() + 1, p.y() + 1});
        for_each_neighbor(line.rect(), p, [&](int x, int y) {
          if (seen(x, y) != 0 || !on_line(line(x, y), width, weak_line)) return;
          seen(x, y) = 1;
          piece.emplace_back(x, y);
        });
      }
      const bool leaves =
          box.x0 == 0 || box.y0 == 0 || box.x1 == line.width() || box.y1 == line.height();
      if (leaves || std::max(box.width(), box.height()) >= shortest) continue;
      for (const Vec2i& p : piece) line(p.x(), p.y()).strength = 0.0F;
    }
  }
}

}  // namespace normalshop
