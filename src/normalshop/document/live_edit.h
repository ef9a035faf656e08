#pragma once

#include <memory>
#include <vector>

#include "normalshop/chart/live_push.h"
#include "normalshop/document/document.h"

namespace normalshop {

/// An edit while its strokes are being drawn: the document shows at any time what apply() would
/// make of the strokes so far, each call at the price of what has changed since the last one. Goes
/// by Document::begin(). Until finish() or cancel(), after which there is nothing more to ask of
/// it, the document takes no other edit and must not move or end; an edit that is let go of without
/// either is cancelled.
///
/// Seams are brought together, colours moved, the curvature term kept and mirror images made by
/// finish() alone.
class LiveEdit {
 public:
  ~LiveEdit();
  LiveEdit(const LiveEdit&) = delete;
  LiveEdit& operator=(const LiveEdit&) = delete;

  /// Makes these the edit's strokes; those of the last call may have grown, or be others. Returns
  /// the tiles of the maps that may look different now. Throws InvalidInput where the operator
  /// refuses them; what was drawn before stays.
  const std::vector<MapTile>& draw(std::vector<UnitStroke> strokes);
  /// Makes the strokes so far an edit of the document, bit for bit what apply() would. Throws
  /// InvalidInput when they do not meet the surface, or there are none and the operator needs some;
  /// the edit is cancelled then.
  EditReport finish();
  /// Takes all back.
  void cancel();

  /// With the strokes so far.
  const Edit& edit() const;
  /// Of the chart that the edit happens in.
  const ChartGrid& grid() const;

 private:
  friend class Document;
  LiveEdit(Document& document, Edit edit);
  void redraw(const std::vector<UnitStroke>* before);
  void redraw_all();
  const std::vector<MapTile>& push(const Rect& region, const std::vector<UnitStroke>* before);
  EditReport complete();
  Rect changed_region(const std::vector<UnitStroke>& before) const;
  Rect region_of(const Extent& extent) const;

  struct State;
  std::unique_ptr<State> state_;  // null once it is over
  std::vector<MapTile> none_;
};

}  // namespace normalshop
