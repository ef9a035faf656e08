#include "normalshop/document/tile_plan.h"

#include <algorithm>
#include <cmath>

namespace normalshop {

namespace {

constexpr int tile_step = 64;

int steps_down(int pixels) { return pixels / tile_step * tile_step; }
int steps_up(int pixels) { return steps_down(pixels + tile_step - 1); }

bool may_be_cut(const Edit& edit, const TransferOptions& transfer) {
  const EditOperator& operation = *edit.operation;
  return operation.is_local() && !operation.picks() && !operation.moves_colors() &&
         edit.mode != EditMode::Base && !edit.mirror && edit.window == ChartWindow::Strokes &&
         transfer.transfer == Transfer::Triangle && transfer.update == Update::Gather;
}

/// Pixels around a tile that its own depend on.
int margin_of(const Edit& edit, const ChartPlan& plan) {
  constexpr float spare = 16.0F;
  constexpr float beyond_all = 1e6F;
  const float falloff = effective_options(edit.effective, plan.model_size).step_falloff;
  const float read = (edit.operation->reach(plan.texel) + falloff) / plan.texel + spare;
  return steps_up(static_cast<int>(std::ceil(std::min(read, beyond_all))));
}

/// Pixels along the side of what a tile is made for; 0 where the margin leaves too little.
int own_side(int largest_side, int margin) {
  for (const int side : {largest_side / 2, largest_side}) {
    const int own = steps_down(side - 2 * margin);
    if (own > 0 && own >= side / 2) return own;
  }
  return 0;
}

/// Of a span of pixels, in parts of equal length, at multiples of tile_step.
int part_of(int pixels, int longest) {
  const int parts = (pixels + longest - 1) / longest;
  return std::min(longest, steps_up((pixels + parts - 1) / parts));
}

}  // namespace

TilePlan plan_tiles(const Edit& edit, const View& view, const ChartPlan& plan,
                    const TransferOptions& transfer) {
  constexpr int kernel = 4;  // pixels around a point that push may read
  TilePlan out;
  if (!may_be_cut(edit, transfer)) return out;
  const float pixel = plan.texel;
  const Extent read = widened(
      intersect(widened(plan.shown, edit.operation->reach(pixel)), plan.place.model), 4.0F * pixel);
  const float longest = (read.high - read.low).maxCoeff() / pixel;
  const int side = std::min(transfer.largest_side, max_chart_side);
  // Charts that are far too large to count their pixels are refused where they are made.
  if (!(longest > static_cast<float>(side - 2) && longest < 1e6F)) return out;
  const int margin = margin_of(edit, plan);
  const int largest = own_side(side, margin);
  if (largest == 0) return out;
  out.grid = {view, pixel, lattice_window(pixel, read.low, read.high)};
  const Rect& window = out.grid.window;
  Rect all = intersect(grow(changeable_pixels(out.grid, plan.place.extent), kernel),
                       {0, 0, window.width(), window.height()});
  if (all.empty()) return out;
  all.x0 = steps_down(all.x0);
  all.y0 = steps_down(all.y0);
  const int width = part_of(all.width(), largest);
  const int height = part_of(all.height(), largest);
  for (int y = all.y0; y < all.y1; y += height) {
    for (int x = all.x0; x < all.x1; x += width) {
      const Rect own = shift(intersect({x, y, x + width, y + height}, all), window.x0, window.y0);
      out.tiles.push_back({own, intersect(grow(own, margin), window)});
    }
  }
  return out;
}

}  // namespace normalshop
