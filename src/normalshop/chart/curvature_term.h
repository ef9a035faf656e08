#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "normalshop/core/image.h"

namespace normalshop {

/// How a relief along the base normals compares with the curvature of the base surface.
struct ReliefReach {
  /// |h kappa|, height over the radius of curvature: of all pixels but the one in a hundred where
  /// it is largest, such as the folds of an eye's lid.
  float largest = 0.0F;
  /// More than one pixel in a hundred passes a centre of curvature: 1 - h kappa <= 0 (thesis 4.3).
  bool folds = false;

  void add(const ReliefReach& other) {
    largest = std::max(largest, other.largest);
    folds = folds || other.folds;
  }
};

/// The term h N_u that EditMode::Base drops. On a curved base surface f = b + h N has
///
///     grad h = (I + h W) g,    W = (N_u.x, N_u.y; N_v.x, N_v.y)
///
/// where g are the numbers of details.h and grad h is the gradient of the height over chart x, y.
/// With heights, operators can work on grad h, and what they make of it becomes numbers again: push
/// need not know of it. Heights come from integrating slopes over the chart, as weighted least
/// squares on about a million pixels at most; what is no slope of a height has none.
///
/// W is taken between neighbouring base normals that the chart's weight shows and no hard edge
/// parts. Elsewhere it is 0, so that the term is dropped. Heights that go farther towards a centre
/// of curvature than half of the way count as half. Sources: thesis 4.3; Blinn 1978.
class CurvatureTerm {
 public:
  /// Of a chart, which must outlive this; both are of its size.
  CurvatureTerm(ImageView<Vec3f> base_normals, MaskView weight);

  /// Turns the numbers of the details that exist, g, into grad h. Along the border of `region`
  /// their height is 0 in the mean.
  void restore(SlopeSpan details, const Rect& region);

  /// An edit leaves (1 - coverage) grad h + change of the restored details; without restore(), of a
  /// smooth base. Turns its change, within `region`, into that of the numbers g. The height of the
  /// change is 0 along the border of the region, where that is unchanged.
  ReliefReach convert(const Rect& region, MaskView coverage, SlopeSpan change) const;

  /// What convert() would tell of a change on a smooth base, in some milliseconds.
  ReliefReach measure(const Rect& region, SlopeView change) const;

 private:
  struct Relief {
    Vec2f numbers;  ///< g of what is left of the details
    Vec2f slope;    ///< grad h after the edit
    float height;
  };
  bool shows(int x, int y) const { return weight_(x, y) > 0.0F; }
  Eigen::Matrix2f bend_at(int x, int y) const;
  Vec2f step_along(int x, int y, int dx, int dy) const;
  Relief relief_at(int x, int y, float kept) const;

  ImageView<Vec3f> normals_;
  MaskView weight_;
  SlopeImage numbers_;  ///< g of the details; empty: 0
  MaskImage height_;    ///< theirs, in pixels
};

}  // namespace normalshop
