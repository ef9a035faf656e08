#include "normalshop/core/for_pixels.h"
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

struct ProjectTool {
  using Options = ProjectEditOptions;
  static constexpr bool is_local = false;
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
    for_pixels(region, [&](int x, int y) {
      const Vec2f& before = input.source(x, y);
      target(x, y) = before + mask(x, y) * (target(x, y) - before);
    });
  }
};

}  // namespace

OperatorType project_operator() { return area_type<ProjectTool>(); }

}  // namespace normalshop
