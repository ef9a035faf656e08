#include "normalshop/rgbn/shade_lines.h"

#include <cmath>

#include "normalshop/core/sample.h"
#include "normalshop/rgbn/detail/check_options.h"
#include "normalshop/rgbn/detail/line_fields.h"
#include "normalshop/rgbn/smooth.h"

namespace normalshop {

namespace {

constexpr float ink = 0.012F;  // linear

int pixels(float length) { return static_cast<int>(std::ceil(length)); }

/// Pixels around an area in which lines must be known before clean() is right in it.
int clean_reach(const LineOptions& o) { return pixels(o.connect) + pixels(o.shortest) + 1; }

/// Numbers of the pixels `area` of the picture.
struct LocalMask {
  Rect area;
  MaskImage values;
  float& operator()(int x, int y) { return values(x - area.x0, y - area.y0); }
  float operator()(int x, int y) const { return values(x - area.x0, y - area.y0); }
};

/// How much of a line remains within about two sigma of the pixels in `mask`, which are ones in
/// rows a pixel wide.
LocalMask away_from(LocalMask mask, float sigma) {
  smooth(mask.values, {}, mask.values, mask.values.rect(), {.sigma = sigma});
  const float peak = 0.4F / sigma;  // of a blurred row of pixels
  for_each_row(mask.area, [&](int y) {
    for (int x = mask.area.x0; x < mask.area.x1; ++x) {
      mask(x, y) = 1.0F - smoothstep(0.1F, 0.4F, mask(x, y) / peak);
    }
  });
  return mask;
}

/// Weak ends are thinner and fainter, as under less pressure of the pen.
float stroke_cover(const LinePoint& p, float width) {
  const float pressure = smoothstep(weak_line, full_line, p.strength);
  return pressure * line_cover(p.distance, width * (0.4F + 0.6F * pressure));
}

/// Lines of one kind in the pixels `area` of the picture.
struct LineLayer {
  Rect area;
  Image<LinePoint> points;
  const LinePoint& operator()(int x, int y) const { return points(x - area.x0, y - area.y0); }
};

void fade(LineLayer& line, const LocalMask& keep) {
  for_each_row(line.area, [&](int y) {
    for (int x = line.area.x0; x < line.area.x1; ++x) {
      line.points(x - line.area.x0, y - line.area.y0).strength *= keep(x, y);
    }
  });
}

void clean(LineLayer& line, const LineOptions& options) {
  keep_connected(line.points, options.width, pixels(options.connect));
  drop_short(line.points, options.width, pixels(options.shortest));
}

/// Ones in the middle of the lines.
LocalMask middles(const LineLayer& line) {
  LocalMask out{line.area, MaskImage(line.area.width(), line.area.height())};
  for_each_row(line.area, [&](int y) {
    for (int x = line.area.x0; x < line.area.x1; ++x) {
      const LinePoint& p = line(x, y);
      out(x, y) = p.distance <= 0.5F && p.strength >= weak_line ? 1.0F : 0.0F;
    }
  });
  return out;
}

void write_line(const LineLayer& line, float width, MaskSpan target, const Rect& region) {
  if (target.empty()) return;
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) target(x, y) = stroke_cover(line(x, y), width);
  });
}

}  // namespace

Rect find_lines(ImageView<Vec3f> normals, const LineSpans& lines, Rect region,
                const LineOptions& options) {
  check_options("lines", options);
  region = intersect(region, normals.rect());
  if (region.empty()) return {};
  const NormalLayer layer(normals, grow(region, reach(options)));
  const Rect near_area = intersect(grow(region, clean_reach(options)), layer.rect());
  if (!lines.contours.empty()) {
    LineLayer contours{near_area, find_contours(layer, near_area, options)};
    clean(contours, options);
    write_line(contours, options.width, lines.contours, region);
  }
  if (lines.suggestive.empty() && lines.ridges.empty() && lines.valleys.empty()) return region;
  const NormalLayer smooth = layer.smoothed(options.sigma);
  const int blur = smoothing_reach(options.sigma);
  const Rect crease_area = intersect(grow(near_area, blur + clean_reach(options)), layer.rect());
  const Rect rim_area = intersect(grow(crease_area, blur), layer.rect());
  LocalMask rims{rim_area, find_rims(layer, rim_area, options)};
  const LocalMask off_rims = away_from(rims, options.sigma);
  Creases found = find_creases(smooth, crease_area, options);
  LineLayer ridges{crease_area, std::move(found.ridges)};
  LineLayer valleys{crease_area, std::move(found.valleys)};
  for (LineLayer* line : {&ridges, &valleys}) {
    fade(*line, off_rims);
    clean(*line, options);
  }
  write_line(ridges, options.width, lines.ridges, region);
  write_line(valleys, options.width, lines.valleys, region);
  if (lines.suggestive.empty()) return region;
  LineLayer suggestive{near_area, find_suggestive(smooth, near_area, options)};
  // Smoothing flattens what turns away at an outline, which would look like a suggestive contour.
  add_outline(layer, rim_area, rims.values);
  fade(suggestive, away_from(std::move(rims), options.sigma));
  fade(suggestive, away_from(middles(valleys), options.sigma));
  clean(suggestive, options);
  write_line(suggestive, options.width, lines.suggestive, region);
  return region;
}

Rect shade_lines(ImageView<Vec3f> normals, ColorSpan target, Rect region,
                 const LineOptions& options) {
  check_options("lines", options);
  assert(normals.rect() == target.rect());
  region = intersect(region, target.rect());
  if (region.empty()) return {};
  // One mask a kind, of the picture's size as find_lines() wants them; kinds without ink have none.
  const auto mask = [&](float darkness) {
    return darkness > 0.0F ? MaskImage(target.width(), target.height()) : MaskImage();
  };
  MaskImage contours = mask(options.contours);
  MaskImage suggestive = mask(options.suggestive);
  MaskImage ridges = mask(options.ridges);
  MaskImage valleys = mask(options.valleys);
  find_lines(normals, {contours, suggestive, ridges, valleys}, region, options);
  const auto left = [](const MaskImage& line, int x, int y, float darkness) {
    return line.empty() ? 1.0F : 1.0F - darkness * line(x, y);
  };
  for_each_row(region, [&](int y) {
    for (int x = region.x0; x < region.x1; ++x) {
      const float paper = left(contours, x, y, options.contours) *
                          left(suggestive, x, y, options.suggestive) *
                          left(ridges, x, y, options.ridges) * left(valleys, x, y, options.valleys);
      if (options.paper == LinePaper::White) target(x, y) = Vec3f::Ones();
      if (paper < 1.0F) target(x, y) = paper * target(x, y) + Vec3f::Constant((1.0F - paper) * ink);
    }
  });
  return region;
}

int reach(const LineOptions& options) {
  const int across = std::max(smoothing_reach(options.sigma), smoothing_reach(rim_blur(options)));
  return 2 * clean_reach(options) + smoothing_reach(options.sigma) + across + 4;
}

}  // namespace normalshop
