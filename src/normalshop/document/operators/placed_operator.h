#pragma once

#include "normalshop/core/error.h"
#include "normalshop/document/edit_operator.h"
#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/combine.h"

namespace normalshop {

/// Throws InvalidInput for a scale_x or scale_y of 0.
void check_scales(const FieldReader& options);

/// Base of operators that lay something down at every point of the strokes: stamps and text.
class PlacedOperator : public EditOperator {
 public:
  bool reads() const override { return false; }
  bool is_local() const override { return true; }
  StrokeUse stroke_use() const override { return StrokeUse::Points; }

  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    if (strokes.empty())
      throw InvalidInput(path + " must have at least one point [x, y] for a copy to be placed at");
  }

  /// Copies add up; coverage is that of the strongest.
  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const override {
    Rect written;
    for (const Stroke& stroke : input.strokes) {
      for (const StrokePoint& point : stroke) {
        written = unite(written, add_copy(input, point.position, change, coverage));
      }
    }
    return written;
  }

 protected:
  /// Pixels around a point that one copy may change.
  virtual int copy_reach(float pixel) const = 0;
  virtual Rect place(const OperatorInput& input, SlopeSpan details, MaskSpan coverage, Rect region,
                     const Vec2f& position) const = 0;

 private:
  Rect add_copy(const OperatorInput& input, const Vec2f& position, SlopeSpan change,
                MaskSpan coverage) const;
};

}  // namespace normalshop
