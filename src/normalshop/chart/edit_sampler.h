#pragma once

#include "normalshop/chart/push.h"
#include "normalshop/chart/texel_batch.h"

/// Reading an edit at surface points, private to floor 4.
namespace normalshop {

/// Tells what an edit does at points of the surface. Blocks of pixels without effect are skipped.
class EditSampler {
 public:
  EditSampler(const EditingChart& chart, const ChartEdit& edit);

  const ChartGrid& grid() const { return chart_.grid; }
  EditMode mode() const { return edit_.mode; }
  /// Can any point within this box of chart pixels be changed?
  bool reaches(float x0, float y0, float x1, float y1) const;
  /// Fills weight, change_x, change_y and covered of the batch's points. False, and not all is
  /// filled, when nothing happens at any of them.
  bool read(TexelBatch& batch) const;

 private:
  bool acts(int x, int y) const;
  float coverage_at(float x, float y) const;

  const EditingChart& chart_;
  const ChartEdit& edit_;
  Rect region_;  ///< within the chart
  Image<std::int32_t> blocks_;
};

}  // namespace normalshop
