#pragma once

#include "normalshop/chart/effective.h"
#include "normalshop/chart/grid.h"
#include "normalshop/document/edit.h"

/// The part of an edit that a mesh's editing chart and a picture share.
namespace normalshop {

/// Where an edit looks, in object units from the view's centre, y up.
struct EditPlace {
  Extent view;    ///< its whole extent
  Extent model;   ///< a box around the whole model
  Extent extent;  ///< where the edit may change something
};

Extent intersect(const Extent& a, const Extent& b);
Extent widened(const Extent& extent, float by);

/// The pixels of a chart that an edit with that extent may change.
Rect changeable_pixels(const ChartGrid& grid, const Extent& extent);

/// All of the input but the images.
OperatorInput make_input(const Edit& edit, const ChartGrid& grid, const EditPlace& place);

/// What an operator made of a chart, `strength` included. Both images have the chart's size.
struct OperatorResult {
  SlopeImage change;
  MaskImage coverage;
  Rect region;  ///< both are 0 outside
};
OperatorResult empty_result(int width, int height);
/// The strokes in pixels of a chart.
std::vector<Stroke> to_pixels(const std::vector<UnitStroke>& strokes, const ChartGrid& grid);
/// Fills `result`, which is 0 there, in input.region.
void run_operator(const Edit& edit, const OperatorInput& input, OperatorResult& result);

/// EditOperator::rerun() with `strength`. `covers`: whether coverage counts; else it stays.
bool rerun_operator(const Edit& edit, const OperatorInput& input, const std::vector<Stroke>& before,
                    bool covers, OperatorResult& result, PixelBlocks& drawn);

/// What Edit::spray makes of a unit normal whose z is the cosine of its angle to the viewer.
class SprayShare {
 public:
  explicit SprayShare(const EffectiveAngles& angles);
  float operator()(float cosine) const { return facing_(cosine); }

 private:
  FacingWeight facing_;
};
/// Multiplies the result in its region by a factor for each pixel.
void multiply(MaskView factor, OperatorResult& result);
/// The same in marked blocks.
void multiply(MaskView factor, const PixelBlocks& drawn, OperatorResult& result);

}  // namespace normalshop
