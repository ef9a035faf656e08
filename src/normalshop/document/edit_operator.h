#pragma once

#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "normalshop/core/border.h"
#include "normalshop/core/pixel_blocks.h"
#include "normalshop/document/assets.h"
#include "normalshop/document/field_reader.h"
#include "normalshop/rgbn/stroke.h"

namespace normalshop {

/// A point of a recipe's stroke: object units from the view's centre, x right, y up.
struct UnitPoint {
  Vec2f position;
  float pressure = 1.0F;
  float along = -1.0F;  ///< as in StrokePoint
  float rest = -1.0F;
  float across = 1.0F;
};
using UnitStroke = std::vector<UnitPoint>;

/// Part of a view in object units from its centre, y up.
struct Extent {
  Vec2f low = Vec2f::Constant(3.4e38F);
  Vec2f high = Vec2f::Constant(-3.4e38F);
  bool empty() const { return !(low.x() <= high.x() && low.y() <= high.y()); }
};
/// The box around the strokes, widened; empty without points.
Extent extent_of(const std::vector<UnitStroke>& strokes, float margin);
enum class StrokeEnds;
/// The same around the smooth curves through the strokes' points (rgbn/pen.h).
Extent smooth_extent_of(const std::vector<UnitStroke>& strokes, float margin, StrokeEnds ends);

/// Of strokes that have become others, as they were and as they are, what lies beyond the points
/// that both have in common, and a little before that: where the smooth curves differ, and what
/// lies `back` object units before them.
std::vector<UnitStroke> changed_parts(const std::vector<UnitStroke>& before,
                                      const std::vector<UnitStroke>& after, float back);

/// What an operator sees of an editing chart: pixels, and two numbers in each.
struct OperatorInput {
  SlopeView source;  ///< before the edit (with details ignored: the base surface); extended past
                     ///< borders; empty unless the operator reads()
  SlopeView base;    ///< the base surface's numbers, likewise; empty unless reads_base()
  SlopeView seen;  ///< the details before the edit, whatever becomes of them; empty unless picks()
  MaskView validity;  ///< the weight of the effective chart: how far source counts; empty unless
                      ///< the operator reads() or picks()
  ColorView colors;   ///< linear; empty unless the operator reads_colors() and there are any
  Border border = Border::Clamp;      ///< what source and colors do beyond their sides
  Rect region;                        ///< where the result is wanted; the rest stays as it is
  Rect view;                          ///< the view's whole extent in pixels of this chart
  Rect model;                         ///< a box around the whole model, likewise
  Vec2f view_center = Vec2f::Zero();  ///< the middle of the view, between pixels too
  float view_width = 1.0F;            ///< in pixels, not rounded
  float pixel = 1.0F;                 ///< object units per pixel
  std::vector<Stroke> strokes;        ///< in pixels
};

/// How an operator uses its strokes: what of them must meet the surface.
enum class StrokeUse {
  Path,    ///< the line
  Loop,    ///< the line, closed
  Inside,  ///< the closed line and what lies inside it
  Points,  ///< each point alone, with what it places or picks there
};

/// An operator with its options: the link between floors 2 and 4. It knows neither mesh nor UI.
class EditOperator {
 public:
  EditOperator() = default;
  EditOperator(const EditOperator&) = delete;
  EditOperator& operator=(const EditOperator&) = delete;
  virtual ~EditOperator() = default;

  virtual std::string_view name() const = 0;
  virtual Value options() const = 0;
  /// Throws InvalidInput (with `path` in front) when these strokes don't fit the operator.
  virtual void check_strokes(const std::vector<UnitStroke>& strokes,
                             const std::string& path) const = 0;
  virtual StrokeUse stroke_use() const { return StrokeUse::Path; }
  /// Can its strokes be lines on the surface, each view showing parts of them?
  virtual bool follows_surface() const { return false; }
  /// Does it read the details under it?
  virtual bool reads() const = 0;
  /// Does it tell the base surface from the details on it? Only for operators that read.
  virtual bool reads_base() const { return false; }
  /// How far it takes away what is finer than pixels of that length can show, 0 to 1: low-pass
  /// filters. Others leave such details as they are.
  virtual float removes_finer(float /*pixel*/) const { return 0.0F; }
  /// Does it look for its place in what is there before the edit?
  virtual bool picks() const { return false; }
  /// Does it read the colours too?
  virtual bool reads_colors() const { return picks() || moves_colors(); }
  /// Does it move them along with the normals?
  virtual bool moves_colors() const { return false; }
  /// In a picture that is a tile: does it find the other side by input.border alone? Others get
  /// their strokes repeated beyond the sides.
  virtual bool repeats_itself() const { return false; }
  /// Loads what the option asset_field() names.
  virtual void load(Assets&) {}
  virtual std::string_view asset_field() const { return {}; }
  /// Where it may change something, to within two pixels; empty: the whole view.
  virtual Extent extent(const std::vector<UnitStroke>& strokes) const = 0;
  /// Whatever holds extent(), found quickly.
  virtual Extent bounds(const std::vector<UnitStroke>& strokes) const { return extent(strokes); }
  /// Where a stroke goes on to others, does it make the same of what lies so many object units
  /// before that, outside of the extent() of the rest? Infinite where it may change anywhere.
  virtual float looks_back() const { return std::numeric_limits<float>::infinity(); }
  /// Object units read beyond the extent, in a chart whose pixels are that long.
  virtual float reach(float /*pixel*/) const { return 0.0F; }
  /// Does each pixel of its result depend on nothing but the strokes and what lies within reach()?
  /// Then a view may be cut into tiles.
  virtual bool is_local() const { return false; }
  /// Fills change and coverage (both zero before) and returns where they are not zero.
  virtual Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan coverage) const = 0;
  /// Makes what run() made of the strokes `before`, with all else as it is, what it makes of
  /// input.strokes in drawn.region(), and marks the blocks that it wrote: all others stay. Coverage
  /// may be empty. False: it does not do that, and has written nothing. Only for operators that do
  /// not read.
  virtual bool rerun(const OperatorInput& /*input*/, const std::vector<Stroke>& /*before*/,
                     SlopeSpan /*change*/, MaskSpan /*coverage*/, PixelBlocks& /*drawn*/) const {
    return false;
  }
  /// An operator that moves_colors() writes what they become, and returns where.
  virtual Rect run_colors(const OperatorInput&, ColorSpan) const { return {}; }
};

/// An entry of the registry.
struct OperatorType {
  std::string_view name;
  std::string_view summary;
  std::string_view strokes;  ///< what its strokes mean
  Value::Array (*fields)();
  std::unique_ptr<EditOperator> (*make)(const FieldReader& options);
};
/// All operators, in the order of the documentation.
const std::vector<OperatorType>& operator_types();

/// The operators and their options, for `describe` and later the studio.
Value describe_operators();

}  // namespace normalshop
