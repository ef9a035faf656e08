#pragma once

#include "normalshop/chart/pull.h"
#include "normalshop/document/edit.h"

namespace normalshop {

/// Throws InvalidInput, naming the field, for points so far outside the view that pixels cannot
/// count them.
void check_near_view(const Edit& edit, const View& view);

/// What messages say about where strokes may lie. `model`: the box around the model in the view.
[[noreturn]] void fail_off_surface(const std::string& field, const Extent& model);

/// Which of an edit's strokes meet surface that charts of its view show.
class SurfaceCheck {
 public:
  /// Of the first `strokes` of them.
  SurfaceCheck(const Edit& edit, std::size_t strokes);
  /// By the weight of a chart, `strokes` in its pixels; without strokes, any in `region` (pixels).
  void look(const std::vector<Stroke>& strokes, const EditingChart& chart, const Rect& region);
  /// Throws InvalidInput, naming the field, unless all have met surface.
  void demand(const Extent& model) const;

 private:
  bool by_points() const { return edit_.operation->stroke_use() == StrokeUse::Points; }

  const Edit& edit_;
  std::vector<std::vector<bool>> met_;  ///< by stroke, and point of those that count one by one
  bool any_ = false;
};

/// The check by one chart.
void check_on_surface(const Edit& edit, const std::vector<Stroke>& strokes,
                      const EditingChart& chart, const Rect& region, const Extent& model);

/// The pixels that an extent touches.
Rect pixel_rect(const ChartGrid& grid, const Extent& extent);

}  // namespace normalshop
