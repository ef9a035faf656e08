#pragma once

#include "normalshop/chart/edit_reach.h"
#include "normalshop/chart/push.h"
#include "normalshop/chart/texel_batch.h"

/// Reading an edit at surface points, private to floor 4.
namespace normalshop {

/// Tells what an edit does at points of the surface. Blocks of pixels without effect are skipped.
class EditSampler {
 public:
  EditSampler(const EditingChart& chart, const ChartEdit& edit);
  /// For an edit that grows: its region is the chart, and it does nothing before update().
  static EditSampler growing(const EditingChart& chart, const ChartEdit& edit) {
    return {chart, edit, EditReach(chart)};
  }
  /// The edit has changed in marked blocks alone.
  void update(const PixelBlocks& changed);

  const EditReach& reach() const { return reach_; }
  const ChartGrid& grid() const { return reach_.grid(); }
  const EditDirection& direction() const { return edit_.direction; }
  /// Fills weight, change_x, change_y and covered of the batch's points. False, and not all is
  /// filled, when nothing happens at any of them.
  bool read(TexelBatch& batch) const;
  /// The same of points whose weight is there already.
  bool read_weighed(TexelBatch& batch) const;

 private:
  EditSampler(const EditingChart& chart, const ChartEdit& edit, EditReach reach);
  static bool acts(const ChartEdit& edit, int x, int y);
  void drop_averted(TexelBatch& batch) const;
  void drop_others(TexelBatch& batch) const;
  float coverage_at(float x, float y) const;

  const ChartEdit& edit_;
  EditReach reach_;
};

}  // namespace normalshop
