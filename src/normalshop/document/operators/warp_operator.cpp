#include <algorithm>
#include <optional>

#include "normalshop/core/error.h"
#include "normalshop/core/parallel.h"
#include "normalshop/document/operators/filter_area.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/document/option_values.h"
#include "normalshop/rgbn/sketch_warp.h"
#include "normalshop/rgbn/warp_brush.h"

namespace normalshop {

namespace {

enum class WarpKind { Sketch, Push, Grab, Pinch, Twirl };
constexpr auto names_of(WarpKind) {
  return std::array<std::string_view, 5>{"sketch", "push", "grab", "pinch", "twirl"};
}

enum class WarpColors { Move, Stay };
constexpr auto names_of(WarpColors) { return std::array<std::string_view, 2>{"move", "stay"}; }

struct WarpEditOptions {
  WarpKind kind = WarpKind::Sketch;
  float radius = 0.0F;
  float amount = 1.0F;
  WarpHeights heights = WarpHeights::Keep;
  OnFold on_fold = OnFold::Limit;
  WarpColors colors = WarpColors::Move;

  static constexpr auto fields() {
    using Own = WarpEditOptions;
    return std::tuple{
        field("kind", &Own::kind,
              "Pairs of strokes, or a brush: push smears along its strokes, grab takes what is "
              "under a stroke's start to its end, pinch and twirl act at every point"),
        field<Own, float>("radius", &Own::radius, "length", 0.0, 1e6,
                          "How far from its centre a brush acts; above 0 for brushes"),
        field<Own, float>(
            "amount", &Own::amount, "1", -10.0, 10.0,
            "Of a brush. Push and grab: part of the motion; pinch: how many times the "
            "size halves, negative inflates; twirl: quarter turns counter-clockwise"),
        field("heights", &Own::heights,
              "Whether heights keep or grow where the picture is enlarged; keep flattens there"),
        field("on_fold", &Own::on_fold,
              "Whether a brush is limited or refused where the picture would fold over"),
        field("colors", &Own::colors, "Whether colours move along or stay where they are")};
  }
};

constexpr float finest_cell = 1.0F;
constexpr float coarsest_cell = 4.0F;

/// A stroke that ends where it begins is an outline.
bool is_outline(const Stroke& stroke) {
  return stroke.size() > 3 && (stroke.front().position - stroke.back().position).norm() < 0.01F;
}

WarpLattice sketched(const OperatorInput& input) {
  std::vector<SketchPair> pairs;
  for (std::size_t i = 1; i + 1 < input.strokes.size(); i += 2) {
    SketchPair pair{input.strokes[i], input.strokes[i + 1], false};
    pair.closed = is_outline(pair.source) && is_outline(pair.target);
    pairs.push_back(std::move(pair));
  }
  SketchWarpOptions options;
  options.spacing = coarsest_cell;
  options.point_spacing = 2.0F * coarsest_cell;
  return sketch_warp(input.strokes.front(), pairs, options).lattice;
}

void act(WarpLattice& lattice, const Stroke& stroke, WarpKind kind,
         const WarpBrushOptions& options) {
  if (kind == WarpKind::Grab) {
    grab(lattice, stroke.front().position, stroke.back().position, options);
    return;
  }
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    WarpBrushOptions dab = options;
    dab.strength *= stroke[i].pressure;
    const Vec2f& here = stroke[i].position;
    if (kind == WarpKind::Push && i > 0) push(lattice, stroke[i - 1].position, here, dab);
    if (kind == WarpKind::Pinch) pinch(lattice, here, dab);
    if (kind == WarpKind::Twirl) twirl(lattice, here, dab);
  }
}

/// Rectangle of pixels that the chart must have for the warp; the lattice may be larger.
WarpLattice brushed(const OperatorInput& input, const WarpEditOptions& options, const Rect& area) {
  WarpBrushOptions brush;
  brush.radius = options.radius;
  brush.strength = options.amount;
  brush.on_fold = options.on_fold;
  const float cell = std::clamp(options.radius / 8.0F, finest_cell, coarsest_cell);
  const bool repeats = input.border == Border::Wrap;
  WarpLattice lattice(area, cell, repeats ? LatticeEdge::Repeat : LatticeEdge::Continue);
  for (const Stroke& stroke : input.strokes) act(lattice, stroke, options.kind, brush);
  return lattice;
}

class WarpOperator : public EditOperator {
 public:
  explicit WarpOperator(const FieldReader& options)
      : options_(read_options<WarpEditOptions>(options)) {
    if (options_.kind != WarpKind::Sketch && !(options_.radius > 0.0F)) {
      options.required("radius").fail("a number above 0 for a brush");
    }
  }
  std::string_view name() const override { return "warp"; }
  Value options() const override { return options_value(options_); }
  bool reads() const override { return true; }
  bool moves_colors() const override { return options_.colors == WarpColors::Move; }
  bool repeats_itself() const override { return true; }
  StrokeUse stroke_use() const override {
    return options_.kind == WarpKind::Sketch ? StrokeUse::Inside : StrokeUse::Path;
  }

  void check_strokes(const std::vector<UnitStroke>& strokes,
                     const std::string& path) const override {
    if (options_.kind == WarpKind::Sketch) return check_pairs(strokes, path);
    if (strokes.empty()) {
      throw InvalidInput(path + " must have at least one list of points [x, y] for the brush");
    }
    const bool moves = options_.kind == WarpKind::Push || options_.kind == WarpKind::Grab;
    for (std::size_t i = 0; moves && i < strokes.size(); ++i) {
      if (strokes[i].size() >= 2) continue;
      throw InvalidInput(path + "[" + std::to_string(i) +
                         "] must have at least 2 points: where the motion begins and ends");
    }
  }

  Extent extent(const std::vector<UnitStroke>& strokes) const override {
    return extent_of(strokes, options_.kind == WarpKind::Sketch ? 0.0F : options_.radius);
  }
  float reach(float /*pixel*/) const override { return options_.radius; }

  Rect run(const OperatorInput& input, SlopeSpan change, MaskSpan) const override {
    return warp_into(input, {change, {}});
  }
  Rect run_colors(const OperatorInput& input, ColorSpan colors) const override {
    return warp_into(input, {{}, colors});
  }

 private:
  static void check_pairs(const std::vector<UnitStroke>& strokes, const std::string& path) {
    if (strokes.size() >= 3 && strokes.size() % 2 == 1 && strokes.front().size() >= 3) return;
    throw InvalidInput(path +
                       " must have an odd number of lists of points: the outline outside of which "
                       "nothing moves (at least 3 points), then pairs, from where and to where");
  }

  Rect warp_into(const OperatorInput& input, const RgbnSpan& target) const {
    const WarpEditOptions scaled = scale_lengths(options_, 1.0F / input.pixel);
    const bool sketch = scaled.kind == WarpKind::Sketch;
    const WarpLattice lattice =
        sketch ? sketched(input) : brushed(input, scaled, input.source.rect());
    WarpOptions options;
    options.heights = scaled.heights;
    options.border = input.border;
    const Rect region = warp({input.source, input.colors, input.validity}, target, input.region,
                             map_of(lattice), options);
    if (!target.slopes.empty()) subtract(input.source, target.slopes, region);
    return region;
  }

  WarpEditOptions options_;
};

}  // namespace

OperatorType warp_operator() {
  return {"warp", "Moves details, and the colours with them",
          "Of \"sketch\": an outline outside of which nothing moves, then pairs of strokes, from "
          "where and to where; a pair that ends where it begins is one of outlines. Of brushes: "
          "their ways or places",
          describe_fields<WarpEditOptions>,
          [](const FieldReader& options) -> std::unique_ptr<EditOperator> {
            return std::make_unique<WarpOperator>(options);
          }};
}

}  // namespace normalshop
