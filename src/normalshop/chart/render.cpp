#include "normalshop/chart/render.h"

#include <algorithm>
#include <cmath>

#include "normalshop/chart/effective.h"
#include "normalshop/chart/resolution.h"
#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/sample.h"
#include "normalshop/rgbn/shade.h"
#include "normalshop/rgbn/smooth.h"
#include "normalshop/surface/seams.h"

namespace normalshop {

namespace {

constexpr int band_rows = 128;  // of the picture, at a time
constexpr int fewest_samples = 3;
constexpr int most_samples = 4;

/// What all bands share.
struct Scene {
  const Mesh& mesh;
  const StorageAtlas& storage;
  const RenderOptions& options;
  View view;
  float pixel;  // of the picture, object units
  int samples;  // a pixel's side
  ColorImage background;
  MaskImage occlusion;  // picture size; empty unless lit
  MaskImage shadow;
  std::vector<std::uint32_t> chart;  // per triangle, for Charts
};

View fit(View view, int width, int height) {
  const float shape = static_cast<float>(width) / static_cast<float>(height);
  if (view.width < view.height * shape) {
    view.width = view.height * shape;
  } else {
    view.height = view.width / shape;
  }
  return view;
}

/// Lattice rows [y0, y1) of the picture at `samples` per pixel.
ChartGrid band_grid(const Scene& scene, int y0, int y1) {
  const int w = scene.options.width * scene.samples;
  const int top = -(scene.options.height * scene.samples) / 2;
  ChartGrid grid;
  grid.view = scene.view;
  grid.pixel = scene.pixel / static_cast<float>(scene.samples);
  grid.window = {-(w / 2), top + y0 * scene.samples, -(w / 2) + w, top + y1 * scene.samples};
  return grid;
}

/// Lattice pixels of the whole model at the picture's size.
Rect model_window(const Scene& scene) {
  const View frame = framing_view(scene.mesh, scene.view.direction, scene.view.up);
  const Vec3f offset = scene.view.to_chart(frame.center - scene.view.center) / scene.pixel;
  const float w = 0.5F * frame.width / scene.pixel;
  const float h = 0.5F * frame.height / scene.pixel;
  constexpr float far = 1e6F;
  const auto at = [&](float v) { return static_cast<int>(std::clamp(v, -far, far)); };
  return {at(offset.x() - w), at(-offset.y() - h), at(offset.x() + w), at(-offset.y() + h)};
}

MaskImage crop(const MaskImage& mask, int x, int y, int width, int height) {
  MaskImage out(width, height);
  for (int j = 0; j < height; ++j) std::copy_n(mask.row(y + j) + x, width, out.row(j));
  return out;
}

/// Ambient occlusion and the key light's soft shadow, from depths at picture size. What lies
/// outside the picture casts shadows into it too.
void occlude(Scene& scene) {
  const int width = scene.options.width;
  const int height = scene.options.height;
  const auto size = static_cast<float>(std::min(width, height));
  const float reach = 0.35F * size;
  Scene coarse{scene.mesh, scene.storage, scene.options, scene.view, scene.pixel, 1, {}, {}, {},
               {}};
  ChartGrid grid = band_grid(coarse, 0, height);
  const Rect picture = grid.window;
  grid.window =
      unite(picture, intersect(grow(picture, static_cast<int>(reach)), model_window(scene)));
  IdBuffer ids;
  Rasterizer().rasterize(scene.mesh, grid, ids);
  MaskImage seen(grid.width(), grid.height());
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      ids.depth(x, y) /= scene.pixel;
      seen(x, y) = ids.triangle(x, y) == no_triangle ? 0.0F : 1.0F;
    }
  }
  MaskImage occlusion(grid.width(), grid.height());
  MaskImage shadow(grid.width(), grid.height());
  ambient_occlusion(ids.depth, 0.06F * size, occlusion);
  cast_shadow(ids.depth, scene.options.light, reach, shadow);
  // Both are sampled with jitter; a narrow blur takes the grain away.
  SmoothOptions blur;
  blur.sigma = 1.5F;
  smooth(occlusion, seen, occlusion, occlusion.rect(), blur);
  smooth(shadow, seen, shadow, shadow.rect(), blur);
  const int x = picture.x0 - grid.window.x0;
  const int y = picture.y0 - grid.window.y0;
  scene.occlusion = crop(occlusion, x, y, width, height);
  scene.shadow = crop(shadow, x, y, width, height);
}

MaskImage enlarge(const MaskImage& mask, int y0, int y1, int samples) {
  MaskImage out(mask.width() * samples, (y1 - y0) * samples);
  const float step = 1.0F / static_cast<float>(samples);
  parallel_for(static_cast<std::size_t>(out.height()), 16, [&](std::size_t a, std::size_t b) {
    for (int y = static_cast<int>(a); y < static_cast<int>(b); ++y) {
      const float v = static_cast<float>(y0) + (static_cast<float>(y) + 0.5F) * step - 0.5F;
      for (int x = 0; x < out.width(); ++x) {
        out(x, y) = sample_bilinear(mask.view(), (static_cast<float>(x) + 0.5F) * step - 0.5F, v);
      }
    }
  });
  return out;
}

Vec3f chart_color(std::uint32_t chart) {
  const auto part = [&](std::uint32_t seed) {
    return 0.12F + 0.75F * static_cast<float>(hash(chart, 7, seed) >> 8U) * 0x1p-24F;
  };
  return {part(1), part(2), part(3)};
}

EffectiveOptions weight_options(const Scene& scene) {
  EffectiveOptions effective = effective_on(bounds(scene.mesh).diagonal());
  effective.full_angle = scene.options.full_angle;
  effective.zero_angle = scene.options.zero_angle;
  return effective;
}

/// Rows of the picture above and below a band that its pixels depend on.
int margin_rows(const Scene& scene) {
  const RenderStyle style = scene.options.style;
  if (style != RenderStyle::Weight && style != RenderStyle::Effective) return 0;
  // A depth step lowers the weight within the falloff, which is at least 2 of the chart's pixels.
  const float rows = weight_options(scene).step_falloff / scene.pixel;
  return static_cast<int>(std::min(std::ceil(rows), 16384.0F)) + 2;
}

/// Replaces the albedo by what the style shows on the lit surface.
void paint_style(const Scene& scene, EditingChart& chart) {
  if (scene.options.style == RenderStyle::Charts) {
    for (int y = 0; y < chart.grid.height(); ++y) {
      for (int x = 0; x < chart.grid.width(); ++x) {
        const std::uint32_t t = chart.ids.triangle(x, y);
        if (t != no_triangle) chart.albedo(x, y) = chart_color(scene.chart[t]);
      }
    }
  }
  if (scene.options.style == RenderStyle::Weight) {
    compute_weight(chart, weight_options(scene));
    for (int y = 0; y < chart.grid.height(); ++y) {
      for (int x = 0; x < chart.grid.width(); ++x) {
        const float w = chart.weight(x, y);
        chart.albedo(x, y) =
            (1.0F - w) * Vec3f(0.30F, 0.27F, 0.27F) + w * Vec3f(0.16F, 0.62F, 0.22F);
      }
    }
  }
}

/// Tints what is lit by how far an edit would act, and what keeps it from that.
void paint_effective(const Scene& scene, EditingChart& chart, ColorSpan lit) {
  constexpr float opacity = 0.6F;
  const Vec3f acts(0.25F, 1.3F, 0.4F);
  const Vec3f averted(1.7F, 0.3F, 0.25F);
  const Vec3f beside_step(0.3F, 0.65F, 2.2F);
  const EffectiveOptions effective = weight_options(scene);
  compute_weight(chart, effective);
  const FacingWeight facing(effective);
  for (int y = 0; y < chart.grid.height(); ++y) {
    for (int x = 0; x < chart.grid.width(); ++x) {
      if (chart.ids.triangle(x, y) == no_triangle) continue;
      const float turned = facing(chart.base_normal(x, y).z());
      const float weight = chart.weight(x, y);
      const Vec3f tint =
          weight * acts + (1.0F - turned) * averted + (turned - weight) * beside_step;
      const float brightness = lit(x, y).dot(Vec3f(0.2126F, 0.7152F, 0.0722F));
      lit(x, y) = (1.0F - opacity) * lit(x, y) + opacity * brightness * tint;
    }
  }
}

/// The band's colours at full sampling, over what `target` holds.
void color_band(const Scene& scene, int y0, int y1, EditingChart& chart, ColorSpan target) {
  if (scene.options.style == RenderStyle::Albedo) {
    for (int y = 0; y < target.height(); ++y) {
      for (int x = 0; x < target.width(); ++x) {
        if (chart.ids.triangle(x, y) != no_triangle) target(x, y) = chart.albedo(x, y);
      }
    }
    return;
  }
  if (scene.options.style == RenderStyle::Normals) {
    normal_colors(chart.normal, target);  // codes: made linear so that the file holds them
    for (int y = 0; y < target.height(); ++y) {
      for (int x = 0; x < target.width(); ++x) {
        if (chart.ids.triangle(x, y) == no_triangle) continue;
        target(x, y) = target(x, y).unaryExpr([](float c) { return srgb_to_linear(c); });
      }
    }
    return;
  }
  paint_style(scene, chart);
  ShadeOptions shading;
  shading.lights = ShadeOptions::studio_lights(scene.options.light);
  shade(chart.normal, chart.albedo, enlarge(scene.occlusion, y0, y1, scene.samples),
        enlarge(scene.shadow, y0, y1, scene.samples), target, shading);
  if (scene.options.style == RenderStyle::Effective) paint_effective(scene, chart, target);
}

/// Rows y0 to y1 of the picture.
void draw_band(const Scene& scene, int y0, int y1, Rasterizer& rasterizer, EditingChart& chart,
               ColorSpan picture) {
  const int margin = margin_rows(scene);
  const int first = std::max(y0 - margin, 0);
  const int last = std::min(y1 + margin, picture.height());
  chart.grid = band_grid(scene, first, last);
  rasterizer.rasterize(scene.mesh, chart.grid, chart.ids);
  PullOptions pulled;
  pulled.albedo = true;
  pull_attributes(scene.mesh, scene.storage, chart, pulled);
  const int n = scene.samples;
  ColorImage fine(chart.grid.width(), chart.grid.height());
  for (int y = 0; y < fine.height(); ++y) {
    for (int x = 0; x < fine.width(); ++x) fine(x, y) = scene.background(x / n, first + y / n);
  }
  color_band(scene, first, last, chart, fine);
  const float share = 1.0F / static_cast<float>(n * n);
  for (int y = y0; y < y1; ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      Vec3f sum = Vec3f::Zero();
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) sum += fine(x * n + i, (y - first) * n + j);
      }
      picture(x, y) = sum * share;
    }
  }
}

}  // namespace

ColorImage render(const Mesh& mesh, const StorageAtlas& storage, const View& view,
                  const RenderOptions& options) {
  const auto fits = [](int side) { return side >= 1 && side <= 16384; };
  if (!fits(options.width) || !fits(options.height)) {
    throw InvalidInput("a picture's sides must be from 1 to 16384 pixels");
  }
  if (!options.light.allFinite() || options.light.isZero()) {
    throw InvalidInput("light must be three finite numbers, not all 0");
  }
  if (!(options.full_angle >= 0.0F && options.full_angle < options.zero_angle &&
        options.zero_angle <= 90.0F)) {
    throw InvalidInput(
        "angles must be from 0 to 90 degrees, that of full strength below the other");
  }
  Scene scene{
      mesh, storage, options, fit(view, options.width, options.height), 0.0F, fewest_samples, {},
      {},   {},      {}};
  scene.pixel = scene.view.height / static_cast<float>(options.height);
  const Vec2f half(0.5F * view.width, 0.5F * view.height);
  const float texel = texel_pixel_size(mesh, storage, view, -half, half);
  scene.samples =
      std::clamp(static_cast<int>(std::ceil(scene.pixel / texel)), fewest_samples, most_samples);
  scene.background.resize(options.width, options.height);
  studio_background(scene.background);
  if (options.style != RenderStyle::Normals && options.style != RenderStyle::Albedo) {
    occlude(scene);
  }
  if (options.style == RenderStyle::Charts) scene.chart = find_seams(mesh).chart;
  ColorImage picture(options.width, options.height);
  Rasterizer rasterizer;
  EditingChart chart;
  for (int y = 0; y < options.height; y += band_rows) {
    draw_band(scene, y, std::min(y + band_rows, options.height), rasterizer, chart, picture);
  }
  return picture;
}

}  // namespace normalshop
