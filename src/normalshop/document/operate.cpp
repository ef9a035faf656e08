#include "normalshop/document/operate.h"

#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/document/surface_check.h"

namespace normalshop {

namespace {

void scale(float factor, OperatorResult& result) {
  if (factor == 1.0F) return;
  for_pixels(result.region, [&](int x, int y) {
    result.change(x, y) *= factor;
    result.coverage(x, y) *= factor;
  });
}

/// body(x, y) for the pixels of marked blocks.
template <class Body>
void for_pixels(const PixelBlocks& blocks, const Body& body) {
  const Rect& all = blocks.blocks();
  normalshop::for_pixels(all, [&](int block_x, int block_y) {
    if (!blocks.marked(block_x, block_y)) return;
    const Rect pixels = blocks.pixels(block_x, block_y);
    for (int y = pixels.y0; y < pixels.y1; ++y) {
      for (int x = pixels.x0; x < pixels.x1; ++x) body(x, y);
    }
  });
}

}  // namespace

std::vector<Stroke> to_pixels(const std::vector<UnitStroke>& strokes, const ChartGrid& grid) {
  std::vector<Stroke> out;
  for (const UnitStroke& stroke : strokes) {
    Stroke pixels;
    for (const UnitPoint& p : stroke) {
      pixels.push_back({grid.to_pixel(p.position), p.pressure, p.along / grid.pixel,
                        p.rest / grid.pixel, p.across});
    }
    out.push_back(std::move(pixels));
  }
  return out;
}

Extent intersect(const Extent& a, const Extent& b) {
  return {a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
}

Extent widened(const Extent& extent, float by) {
  return {extent.low - Vec2f::Constant(by), extent.high + Vec2f::Constant(by)};
}

Rect changeable_pixels(const ChartGrid& grid, const Extent& extent) {
  return intersect(grow(pixel_rect(grid, extent), 2), Rect{0, 0, grid.width(), grid.height()});
}

OperatorInput make_input(const Edit& edit, const ChartGrid& grid, const EditPlace& place) {
  OperatorInput input;
  input.strokes = to_pixels(edit.strokes, grid);
  input.pixel = grid.pixel;
  input.view = pixel_rect(grid, place.view);
  input.view_center = grid.to_pixel(0.5F * (place.view.low + place.view.high));
  input.view_width = (place.view.high.x() - place.view.low.x()) / grid.pixel;
  input.model = pixel_rect(grid, place.model);
  input.region = changeable_pixels(grid, place.extent);
  return input;
}

SprayShare::SprayShare(const EffectiveAngles& angles)
    : facing_(EffectiveOptions{.full_angle = angles.full, .zero_angle = angles.zero}) {}

void multiply(MaskView factor, OperatorResult& result) {
  for_pixels(result.region, [&](int x, int y) {
    result.change(x, y) *= factor(x, y);
    result.coverage(x, y) *= factor(x, y);
  });
}

void multiply(MaskView factor, const PixelBlocks& drawn, OperatorResult& result) {
  for_pixels(drawn, [&](int x, int y) {
    result.change(x, y) *= factor(x, y);
    result.coverage(x, y) *= factor(x, y);
  });
}

OperatorResult empty_result(int width, int height) {
  return {SlopeImage(width, height, Vec2f(0.0F, 0.0F)), MaskImage(width, height, 0.0F), {}};
}

void run_operator(const Edit& edit, const OperatorInput& input, OperatorResult& result) {
  try {
    result.region = edit.operation->run(input, result.change, result.coverage);
  } catch (const InvalidInput& error) {
    throw InvalidInput(edit.path + ": " + error.what());
  }
  scale(edit.strength, result);
}

bool rerun_operator(const Edit& edit, const OperatorInput& input, const std::vector<Stroke>& before,
                    bool covers, OperatorResult& result, PixelBlocks& drawn) {
  const MaskSpan coverage = covers ? result.coverage.span() : MaskSpan();
  try {
    if (!edit.operation->rerun(input, before, result.change, coverage, drawn)) return false;
  } catch (const InvalidInput& error) {
    throw InvalidInput(edit.path + ": " + error.what());
  }
  if (edit.strength == 1.0F) return true;
  for_pixels(drawn, [&](int x, int y) {
    result.change(x, y) *= edit.strength;
    if (covers) result.coverage(x, y) *= edit.strength;
  });
  return true;
}

}  // namespace normalshop
