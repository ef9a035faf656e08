#include "normalshop/document/image_document.h"

#include <cmath>
#include <mutex>

#include "normalshop/chart/details.h"
#include "normalshop/chart/effective.h"
#include "normalshop/chart/extend.h"
#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/operate.h"
#include "normalshop/document/surface_check.h"

namespace normalshop {

namespace {

/// Part of a picture: its middle and size in pixels, from the picture's middle, y up.
View front_view(const Edit& edit, int width, int height) {
  View view;
  view.width = static_cast<float>(width);
  view.height = static_cast<float>(height);
  const auto part = [&](float w, float h) {
    if (w > 0.0F) view.width = view.height = w;
    if (h > 0.0F) view.height = h;
  };
  bool front = false;
  if (const auto* named = std::get_if<NamedView>(&edit.view)) {
    front = *named == NamedView::Front;
  } else if (const auto* free = std::get_if<FreeView>(&edit.view)) {
    constexpr float straight = 0.999999F;
    front = free->direction.normalized().z() > straight &&
            free->up.head<2>().normalized().y() > straight;
    if (free->center) view.center = *free->center;
    part(free->width, free->height);
  } else if (const auto* facing = std::get_if<FacingView>(&edit.view)) {
    front = true;
    view.center = facing->point;
    part(facing->width, facing->height);
  } else {
    front = true;  // all of the surface is all of the picture
  }
  if (front) return view;
  throw InvalidInput(
      edit.path +
      ".view must look at a picture from the front: \"front\" or \"surface\", or an object with "
      "\"facing\", or with the \"direction\" [0, 0, 1] and the \"up\" [0, 1, 0]");
}

/// Where the lattice of whole pixels has its origin, in pixels from the picture's middle, y up:
/// half a pixel beside it where a side is odd.
Vec2f lattice_origin(int width, int height) {
  return {width % 2 == 0 ? 0.0F : -0.5F, height % 2 == 0 ? 0.0F : 0.5F};
}

Extent moved(const Extent& e, const Vec2f& by) { return {e.low + by, e.high + by}; }

bool meet(const Extent& a, const Extent& b) { return !intersect(a, b).empty(); }

/// In a tile: copies of the strokes in the eight tiles around, where they reach into this one.
void repeat_strokes(Edit& edit, const Extent& tile) {
  const Vec2f size = tile.high - tile.low;
  const bool points = edit.operation->stroke_use() == StrokeUse::Points;
  std::vector<UnitStroke> all = edit.strokes;
  const auto add = [&](const UnitStroke& stroke) {
    const Extent reached = edit.operation->extent({stroke});
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const Vec2f by = size.cwiseProduct(Vec2f(static_cast<float>(i), static_cast<float>(j)));
        if ((i == 0 && j == 0) || !meet(moved(reached, by), tile)) continue;
        all.push_back(stroke);
        for (UnitPoint& p : all.back()) p.position += by;
      }
    }
  };
  for (const UnitStroke& stroke : edit.strokes) {
    if (!points) add(stroke);
    for (std::size_t i = 0; points && i < stroke.size(); ++i) add({stroke[i]});
  }
  edit.strokes = std::move(all);
}

/// The pixels that an edit needs: what it changes, and what it reads around.
Rect choose_window(const EditOperator& operation, const Rect& changed, Border border,
                   const Rect& picture) {
  const int reach = static_cast<int>(std::min(std::ceil(operation.reach(1.0F)), 1e6F)) + 2;
  const Rect read = grow(changed, reach);
  const Rect inside = intersect(read, picture);
  const bool leaves = inside.width() < read.width() || inside.height() < read.height();
  // Beyond the side of a tile the operator must find the other side.
  return leaves && border == Border::Wrap && operation.reads() ? picture : inside;
}

/// An edit on the lattice of whole pixels.
struct Placed {
  Edit edit;  ///< points count from the lattice's origin; in a tile, with repeated strokes
  EditDirection direction;
  EditPlace place;  ///< likewise
  Extent picture;   ///< as the user counts it, for messages
  Rect window;      ///< pixels of the picture
  ChartGrid grid;   ///< the same window on the lattice
};

/// The base surface is the plane of the picture: its normal is the viewing direction.
EditDirection direction_of(const Edit& edit) {
  if (edit.mode != EditMode::Along) return EditMode::View;
  return EditDirection(edit.along);
}

/// How far an edit arrives in the plane.
float facing_of(const Edit& edit, const EditDirection& direction) {
  if (direction.mode != EditMode::Along) return 1.0F;
  const float facing =
      FacingWeight({edit.effective.full, edit.effective.zero})(direction.along.z());
  if (facing > 0.0F) return facing;
  throw InvalidInput(edit.path +
                     ".mode.along must point out of the picture: its z must be above 0, and the "
                     "angle to [0, 0, 1] below " +
                     std::to_string(std::lround(edit.effective.zero)) + " degrees");
}

Placed place(const Edit& edit, const ImageDocument::Images& images) {
  const int width = images.normals.width();
  const int height = images.normals.height();
  const View view = front_view(edit, width, height);
  check_near_view(edit, view);
  const Vec2f center = view.center.head<2>();
  const Vec2f origin = lattice_origin(width, height) - center;
  const Vec2f half_view(0.5F * view.width, 0.5F * view.height);
  const Vec2f half(0.5F * static_cast<float>(width), 0.5F * static_cast<float>(height));

  Placed out{edit, direction_of(edit), {}, {-half - center, half - center}, {}, {}};
  for (UnitStroke& stroke : out.edit.strokes) {
    for (UnitPoint& p : stroke) p.position -= origin;
  }
  out.place.view = moved({-half_view, half_view}, -origin);
  out.place.model = moved(out.picture, -origin);
  const bool tile = images.border == Border::Wrap;
  const bool wraps = tile && edit.operation->repeats_itself();
  if (tile && !wraps) repeat_strokes(out.edit, out.place.model);
  out.place.extent = edit.operation->extent(out.edit.strokes);
  if (out.place.extent.empty()) out.place.extent = out.place.view;
  const Extent inside = intersect(out.place.extent, out.place.model);
  const bool leaves = inside.low != out.place.extent.low || inside.high != out.place.extent.high;
  out.place.extent = wraps && leaves ? out.place.model : inside;
  if (out.place.extent.empty()) {
    fail_off_surface(edit.path + (edit.strokes.empty() ? ".view" : ".strokes"), out.picture);
  }
  out.grid.window = {-(width / 2), -(height / 2), width - width / 2, height - height / 2};
  const Rect all{0, 0, width, height};
  const Rect changed = intersect(grow(pixel_rect(out.grid, out.place.extent), 2), all);
  out.window = choose_window(*edit.operation, changed, images.border, all);
  out.grid.window = shift(out.window, -(width / 2), -(height / 2));
  return out;
}

/// A chart that holds nothing but the window's grid and weight.
EditingChart pull_weight(const ImageDocument::Images& images, const Placed& placed) {
  const Rect& window = placed.window;
  EditingChart chart;
  chart.grid = placed.grid;
  chart.weight.resize(window.width(), window.height());
  const bool masked = !images.mask.empty();
  const float facing = facing_of(placed.edit, placed.direction);
  for_pixels(chart.weight.rect(), [&](int x, int y) {
    const Vec3f n = images.normals.normal(window.x0 + x, window.y0 + y);
    const float mask = masked ? images.mask(window.x0 + x, window.y0 + y) : 1.0F;
    chart.weight(x, y) = n.isZero() ? 0.0F : std::min(mask, facing);
  });
  return chart;
}

/// The slopes of the window, continued where they don't count; without details those of the plane.
SlopeImage pull_slopes(const NormalMap& normals, const Placed& placed, DetailsRule details,
                       MaskView weight) {
  const Rect& window = placed.window;
  SlopeImage slopes(window.width(), window.height(), Vec2f(0.0F, 0.0F));
  if (details == DetailsRule::Ignore) return slopes;
  for_pixels(slopes.rect(), [&](int x, int y) {
    const Vec3f n = normals.normal(window.x0 + x, window.y0 + y);
    slopes(x, y) = gradient_from_normal(n, Vec3f::UnitZ(), placed.direction);
  });
  extend(weight, slopes);
  return slopes;
}

struct Pushed {
  std::size_t changed = 0;
  float farthest = 0.0F;  ///< squared, between unit normals before and after
};

/// texel' = texel + weight * (change - coverage * texel), as chart/push.h has it; the base is flat.
Pushed push_row(const OperatorResult& result, MaskView weight, bool covers, int y,
                const Placed& placed, NormalMap& normals) {
  const Rect& window = placed.window;
  Pushed pushed;
  for (int x = result.region.x0; x < result.region.x1; ++x) {
    const Vec2f change = result.change(x, y);
    const float coverage = covers ? result.coverage(x, y) : 0.0F;
    if (weight(x, y) <= 0.0F || (change.isZero(0.0F) && coverage == 0.0F)) continue;
    const Vec3f before = normals.normal(window.x0 + x, window.y0 + y);
    const Vec2f slope = gradient_from_normal(before, Vec3f::UnitZ(), placed.direction);
    const Vec2f after = slope + weight(x, y) * (change - coverage * slope);
    if (after == slope || !after.allFinite()) continue;
    const Vec3f n = normal_from_gradient(after, Vec3f::UnitZ(), placed.direction);
    normals.set_normal(window.x0 + x, window.y0 + y, n);
    ++pushed.changed;
    pushed.farthest = std::max(pushed.farthest, (n - before).squaredNorm());
  }
  return pushed;
}

float angle_of_chord(float squared) {
  return 2.0F * std::asin(std::min(1.0F, 0.5F * std::sqrt(squared))) * 57.2957795F;
}

/// Rows of tiles are independent of each other.
PushResult push_window(const OperatorResult& result, MaskView weight, bool covers,
                       const Placed& placed, NormalMap& normals) {
  const Rect& window = placed.window;
  const Rect& region = result.region;
  PushResult all;
  if (region.empty()) return all;
  all.visited =
      static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height());
  const int first = (window.y0 + region.y0) / NormalMap::tile_size;
  const int last = (window.y0 + region.y1 - 1) / NormalMap::tile_size;
  std::mutex mutex;
  parallel_for(static_cast<std::size_t>(last - first + 1), 1, [&](std::size_t a, std::size_t b) {
    const int top = (first + static_cast<int>(a)) * NormalMap::tile_size - window.y0;
    const int bottom = (first + static_cast<int>(b)) * NormalMap::tile_size - window.y0;
    Pushed sum;
    for (int y = std::max(top, region.y0); y < std::min(bottom, region.y1); ++y) {
      const Pushed row = push_row(result, weight, covers, y, placed, normals);
      sum.changed += row.changed;
      sum.farthest = std::max(sum.farthest, row.farthest);
    }
    const std::lock_guard lock(mutex);
    all.changed += sum.changed;
    all.largest_change = std::max(all.largest_change, angle_of_chord(sum.farthest));
  });
  return all;
}

template <class T>
ImageView<T> part_of(const Image<T>& image, const Rect& window) {
  if (image.empty()) return {};
  return {image.row(window.y0) + window.x0, window.width(), window.height(), image.width()};
}

/// Colours move by `strength` and the weight towards what the operator makes of them. Returns how
/// many pixels changed.
std::size_t apply_colors(const Edit& edit, const OperatorInput& input, MaskView weight,
                         const Rect& window, ColorImage& colors) {
  ColorImage result(window.width(), window.height());
  const Rect region = edit.operation->run_colors(input, result);
  std::size_t changed = 0;
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) {
      Vec3f& color = colors(window.x0 + x, window.y0 + y);
      const Vec3f before = color;
      color += (edit.strength * weight(x, y)) * (result(x, y) - color);
      if (color != before) ++changed;
    }
  }
  return changed;
}

/// Of the pixels of a window.
MaskImage spray_shares(const NormalMap& normals, const Rect& window,
                       const EffectiveAngles& angles) {
  MaskImage shares(window.width(), window.height());
  const SprayShare share(angles);
  for_pixels(shares.rect(), [&](int x, int y) {
    shares(x, y) = share(normals.normal(window.x0 + x, window.y0 + y).z());
  });
  return shares;
}

void check_sizes(int width, int height, const NormalMap& normals, const char* what) {
  if (width == normals.width() && height == normals.height()) return;
  throw InvalidInput("the " + std::string(what) + " must have the size of the normals, " +
                     std::to_string(normals.width()) + " x " + std::to_string(normals.height()) +
                     " pixels, not " + std::to_string(width) + " x " + std::to_string(height));
}

}  // namespace

ImageDocument::ImageDocument(Images images) : images_(std::move(images)) {
  const NormalMap& normals = images_.normals;
  if (normals.empty()) throw InvalidInput("the picture has no pixels");
  if (normals.convention().space != NormalSpace::Tangent) {
    throw InvalidInput("a picture's normals must be in tangent space, not in " +
                       std::string(name_of(normals.convention().space)) + " space");
  }
  if (!images_.colors.empty()) {
    check_sizes(images_.colors.width(), images_.colors.height(), normals, "colours");
  }
  if (!images_.mask.empty()) {
    check_sizes(images_.mask.width(), images_.mask.height(), normals, "mask");
  }
}

EditReport ImageDocument::apply(const Edit& edit) {
  if (!edit.surface_strokes.empty()) {
    throw InvalidInput(edit.path +
                       ".view must be \"front\", and points [x, y]: a picture has no surface that "
                       "strokes could follow");
  }
  if (edit.mirror) throw InvalidInput(edit.path + ".mirror must be left out for a picture");
  if (edit.part) throw InvalidInput(edit.path + ".part must be left out for a picture");
  Stopwatch watch;
  const Placed placed = place(edit, images_);
  EditReport report;
  OperatorInput input = make_input(placed.edit, placed.grid, placed.place);
  const EditingChart chart = pull_weight(images_, placed);
  const MaskView weight = chart.weight;
  // Strokes must meet the picture; those that were repeated need not.
  const auto own = input.strokes.begin() + static_cast<std::ptrdiff_t>(edit.strokes.size());
  check_on_surface(placed.edit, {input.strokes.begin(), own}, chart, input.region, placed.picture);
  SlopeImage slopes;
  if (edit.operation->reads()) {
    slopes = pull_slopes(images_.normals, placed, edit.details, weight);
    input.source = slopes;
    input.validity = weight;
  }
  SlopeImage seen;
  if (edit.operation->picks()) {
    const bool shared = !slopes.empty() && edit.details == DetailsRule::Keep;
    if (!shared) seen = pull_slopes(images_.normals, placed, DetailsRule::Keep, weight);
    input.seen = shared ? slopes.view() : seen.view();
    input.validity = weight;
  }
  SlopeImage base;  // the plane of the picture
  if (edit.operation->reads_base()) {
    base = SlopeImage(placed.grid.width(), placed.grid.height(), Vec2f(0.0F, 0.0F));
    input.base = base;
  }
  // Within a part of the picture the other side is not there, and out of reach.
  if (placed.window == Rect{0, 0, images_.normals.width(), images_.normals.height()})
    input.border = images_.border;
  if (edit.operation->reads_colors()) input.colors = part_of(images_.colors, placed.window);
  report.times.pull = watch.lap();
  OperatorResult result = empty_result(placed.grid.width(), placed.grid.height());
  run_operator(placed.edit, input, result);
  if (edit.spray) {
    multiply(spray_shares(images_.normals, placed.window, *edit.spray), result);
  }
  report.times.operate = watch.lap();
  if (edit.strength > 0.0F) {
    const bool covers = edit.details == DetailsRule::Ignore;
    if (!input.colors.empty() && edit.operation->moves_colors())
      report.colors_changed = apply_colors(edit, input, weight, placed.window, images_.colors);
    report.pushed = push_window(result, weight, covers, placed, images_.normals);
  }
  report.times.push = watch.lap();
  report.views = 1;
  report.chart_width = placed.grid.width();
  report.chart_height = placed.grid.height();
  report.pixel = 1.0F;
  log_.push_back(edit);
  return report;
}

PictureSlopes slopes_of(const ImageDocument& document) {
  const NormalMap& normals = document.normals();
  const MaskImage& mask = document.mask();
  PictureSlopes out{SlopeImage(normals.width(), normals.height()),
                    MaskImage(normals.width(), normals.height())};
  for_pixels(out.slopes.rect(), [&](int x, int y) {
    const Vec3f n = normals.normal(x, y);
    const bool inside = mask.empty() || mask(x, y) > 0.0F;
    out.slopes(x, y) = slope_from_normal(n);
    out.validity(x, y) = inside && !n.isZero() ? 1.0F : 0.0F;
  });
  return out;
}

}  // namespace normalshop
