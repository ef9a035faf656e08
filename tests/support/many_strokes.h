#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "normalshop/core/random.h"
#include "normalshop/core/vec.h"

/// Many small strokes over each other, as edits of a recipe.
namespace normalshop::test {

/// A straight stroke of the pen, in a view's plane.
struct ShortStroke {
  Vec2f from;
  Vec2f to;
  float width;
  float height;
  const char* profile;

  /// Half widths from the middle; 1 at the border.
  float distance(const Vec2f& p) const {
    const Vec2f along = to - from;
    const float t = std::min(1.0F, std::max(0.0F, (p - from).dot(along) / along.squaredNorm()));
    return (p - from - t * along).norm() / (0.5F * width);
  }
  /// What stands in the braces of its edit, given the view's JSON; `sign` -1 takes back what 1
  /// adds.
  std::string edit(const std::string& view, float sign = 1.0F) const {
    const auto point = [](const Vec2f& p) {
      return "[" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + "]";
    };
    return R"("operator": "pen", "view": )" + view + R"(, "options": {"profile": ")" + profile +
           R"(", "width": )" + std::to_string(width) + R"(, "height": )" +
           std::to_string(sign * height) + R"(}, "strokes": [[)" + point(from) + ", " + point(to) +
           "]]";
  }
};

/// 50 strokes within `reach` of the view's middle, each about a third of it long.
inline std::vector<ShortStroke> fifty_strokes(float reach) {
  Random random(7);
  std::vector<ShortStroke> strokes;
  for (int i = 0; i < 50; ++i) {
    const auto within = [&] {
      return Vec2f{random.uniform(-reach, reach), random.uniform(-reach, reach)};
    };
    const Vec2f from = within();
    const Vec2f to = from + Vec2f(0.35F * within() + Vec2f(0.01F * reach, 0.0F));
    const float width = reach * random.uniform(0.15F, 0.3F);
    constexpr std::array profiles{"bump", "crease", "scratch"};
    strokes.push_back({from, to, width, width * random.uniform(-0.1F, 0.1F),
                       profiles[static_cast<std::size_t>(i) % profiles.size()]});
  }
  return strokes;
}

}  // namespace normalshop::test
