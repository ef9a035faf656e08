#include "document/edit_fixture.h"
#include "support/many_strokes.h"
#include "support/same_codes.h"
#include "support/sanitized.h"

#include "normalshop/core/slope.h"

/// Strokes over strokes: details stay, below them and beside them.
namespace normalshop::test {
namespace {

const std::string from_front = R"("front")";
constexpr int texels_across = 256;

struct Kept {
  int outside = 0;
  int changed_outside = 0;  ///< any bit of the normal
  int under = 0;
  double mean = 0.0;  ///< degrees of the details under the strokes once these are subtracted
};

/// Against a plane without details, which holds the strokes alone after the same edits.
Kept kept_details(const NormalMap& before, const NormalMap& after, const NormalMap& strokes_alone,
                  const std::vector<ShortStroke>& strokes) {
  Kept kept;
  for (int y = 0; y < texels_across; ++y) {
    for (int x = 0; x < texels_across; ++x) {
      const Vec2f p = plane_point(after, x, y);
      const auto meets = [&](const ShortStroke& s) {
        return (s.distance(p) - 1.0F) * 0.5F * s.width < 2.0F / texels_across;
      };
      if (std::none_of(strokes.begin(), strokes.end(), meets)) {
        ++kept.outside;
        const bool same = !after.edited(x, y) && after.vector(x, y) == before.vector(x, y);
        kept.changed_outside += same ? 0 : 1;
        continue;
      }
      const Vec2f rest =
          slope_from_normal(after.normal(x, y)) - slope_from_normal(strokes_alone.normal(x, y));
      ++kept.under;
      kept.mean +=
          static_cast<double>(degrees_between(normal_from_slope(rest), before.normal(x, y)));
    }
  }
  kept.mean /= kept.under;
  return kept;
}

TEST(ManyStrokes, LoseNoDetailBesideOrBelowThem) {
  NORMALSHOP_SKIP_FIGURES();
  const Document before = document(plane_grid(2), noise_map(texels_across, CodeType::U16));
  Document after = before;
  Document alone = flat_plane(texels_across);
  const std::vector<ShortStroke> strokes = fifty_strokes(0.25F);
  for (const ShortStroke& stroke : strokes) {
    after.apply(edit(stroke.edit(from_front)));
    alone.apply(edit(stroke.edit(from_front)));
  }
  const Kept kept = kept_details(map_of(before), map_of(after), map_of(alone), strokes);
  EXPECT_GT(kept.outside, 20000);
  EXPECT_GT(kept.under, 10000);
  EXPECT_EQ(kept.changed_outside, 0);
  EXPECT_LE(kept.mean, 0.05);
}

/// On curved surface strokes are taken back by strokes of the opposite height.
TEST(ManyStrokes, CanBeTakenBack) {
  const Document before = document(hemisphere(24, 48), noise_map(texels_across, CodeType::U16));
  Document after = before;
  const std::vector<ShortStroke> strokes = fifty_strokes(0.5F);
  for (const float sign : {1.0F, -1.0F}) {
    for (const ShortStroke& stroke : strokes) after.apply(edit(stroke.edit(from_front, sign)));
  }
  double sum = 0.0;
  for (int y = 0; y < texels_across; ++y) {
    for (int x = 0; x < texels_across; ++x) {
      if (!map_of(after).edited(x, y)) continue;
      sum += static_cast<double>(
          degrees_between(map_of(after).normal(x, y), map_of(before).normal(x, y)));
    }
  }
  const double mean = sum / static_cast<double>(map_of(after).edited_count());
  EXPECT_GT(map_of(after).edited_count(), 4000U);
  EXPECT_LE(mean, 0.05);
}

}  // namespace
}  // namespace normalshop::test
