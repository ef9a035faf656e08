#include "normalshop/core/parallel.h"
#include "normalshop/document/operators/area_operator.h"
#include "normalshop/document/operators/operators.h"
#include "normalshop/rgbn/project.h"

namespace normalshop {

namespace {

struct ProjectEditOptions {
  HeightEnds ends = HeightEnds::Free;
  float fade = 0.0F;

  static constexpr auto fields() {
    using Own = ProjectEditOptions;
    return std::tuple{
        field("ends", &Own::ends,
              "Where the surface ends the height is free, or brought to 0 (\"zero\")"),
        field<Own, float>("fade", &Own::fade, "length", 0.0, 1e6,
                          "Width along such ends over which the height is faded to 0, and with it "
                          "the slopes; 0 does not fade")};
  }
};

/// target = source + mask * (target - source).
void blend(SlopeView source, MaskView mask, SlopeSpan target, const Rect& region) {
  parallel_for(static_cast<std::size_t>(region.height()), 32, [&](std::size_t a, std::size_t b) {
    for (int y = region.y0 + static_cast<int>(a); y < region.y0 + static_cast<int>(b); ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        target(x, y) = source(x, y) + mask(x, y) * (target(x, y) - source(x, y));
      }
    }
  });
}

struct ProjectTool {
  using Options = ProjectEditOptions;
  static constexpr std::string_view name = "project";
  static constexpr std::string_view summary =
      "Takes the curl away: the nearest slopes that are those of a surface";
  static void apply(const OperatorInput& input, MaskView mask, SlopeSpan target, Rect region,
                    const Options& options) {
    constexpr float widest = 1e4F;
    ProjectOptions chosen;
    chosen.ends = options.ends;
    chosen.fade = std::min(options.fade, widest);
    chosen.border = region == input.source.rect() ? input.border : Border::Clamp;
    project_to_integrable(input.source, input.validity, {target, {}}, region, chosen);
    blend(input.source, mask, target, region);
  }
};

}  // namespace

OperatorType project_operator() { return area_type<ProjectTool>(); }

}  // namespace normalshop
