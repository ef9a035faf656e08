#include <array>

#include "document/edit_fixture.h"
#include "document/picture_fixture.h"

#include "normalshop/core/error.h"
#include "normalshop/surface/seam_mismatch.h"
#include "normalshop/surface/shapes.h"

/// Edits of the surface that keep to some charts of the atlas.
namespace normalshop::test {
namespace {

constexpr int globe_texels = 112;

/// The unit sphere of six charts, +x, -x, +y, -y, +z, -z, with noise.
Document globe() {
  std::array<ChartSquare, 6> charts;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    charts[i].center = {0.18F + 0.32F * static_cast<float>(i % 3), i < 3 ? 0.25F : 0.72F};
    charts[i].side = 0.26F;
    charts[i].degrees = 20.0F * static_cast<float>(i);
  }
  return document(cube_sphere(12, charts, "map"), noise_map(globe_texels, CodeType::U16));
}

/// It knows the views that cover it already, which take long to find under sanitizers.
const Document& covered_globe() {
  static const Document known = [] {
    Document d = globe();
    d.apply(edit(R"("operator": "smooth", "view": "surface", "options": {"sigma": 0.05},
                    "strength": 0)"));
    return d;
  }();
  return known;
}

std::string smooth_part(const std::string& part) {
  return R"("operator": "smooth", "view": "surface", "options": {"sigma": 0.05}, "part": )" + part;
}

/// Which of the six charts the texel lies in, its gutter too; -1: in none.
std::vector<int> chart_of_texels(const Document& d) {
  const TexelMap& texels = d.storage().sets[0].texels;
  const auto triangles = static_cast<int>(d.mesh().triangle_count());
  std::vector<int> charts;
  for (std::size_t i = 0; i < texels.owner().size(); ++i) {
    const std::uint32_t owner = texels.owner().data()[i];
    charts.push_back(owner == no_triangle ? -1 : static_cast<int>(owner) * 6 / triangles);
  }
  for (const GutterTexel& g : texels.gutter()) {
    charts[g.texel] = static_cast<int>(g.owner) * 6 / triangles;
  }
  return charts;
}

struct PartCounts {
  std::array<int, 6> texels{};
  std::array<int, 6> edited{};
  int strange = 0;     ///< not edited, but other bits
  double apart = 0.0;  ///< mean degrees from another document's, of edited texels off the seams
};

/// Is the texel further from the chart's border than seams are read?
bool off_the_seams(const Document& d, int x, int y) {
  const auto& owner = d.storage().sets[0].texels.owner();
  for (const int k : {0, 1, 2, 3}) {
    const int i = x + (k % 2 == 0 ? -3 : 3);
    const int j = y + (k / 2 == 0 ? -3 : 3);
    if (!owner.rect().contains(i, j) || owner(i, j) == no_triangle) return false;
  }
  return true;
}

PartCounts count_parts(const Document& after, const Document& before, const Document& whole) {
  PartCounts counts;
  int compared = 0;
  const std::vector<int> charts = chart_of_texels(after);
  for (int y = 0; y < globe_texels; ++y) {
    for (int x = 0; x < globe_texels; ++x) {
      const bool edited = map_of(after).edited(x, y);
      const bool same = map_of(after).vector(x, y) == map_of(before).vector(x, y);
      counts.strange += !edited && !same ? 1 : 0;
      const int chart = charts[static_cast<std::size_t>(y * globe_texels + x)];
      if (chart < 0) {
        counts.strange += edited ? 1 : 0;
        continue;
      }
      ++counts.texels[static_cast<std::size_t>(chart)];
      counts.edited[static_cast<std::size_t>(chart)] += edited ? 1 : 0;
      if (edited && off_the_seams(after, x, y)) {
        ++compared;
        counts.apart += static_cast<double>(
            degrees_between(map_of(after).normal(x, y), map_of(whole).normal(x, y)));
      }
    }
  }
  counts.apart /= std::max(compared, 1);
  return counts;
}

TEST(SurfacePart, IsEditedAsTheWholeWouldBeAndNothingElse) {
  Document whole = covered_globe();
  whole.apply(edit(R"("operator": "smooth", "view": "surface", "options": {"sigma": 0.05})"));
  Document one = covered_globe();
  const EditReport report = one.apply(edit(smooth_part(R"({"charts_at": [[0, 0.1, 1]]})")));
  const PartCounts counts = count_parts(one, covered_globe(), whole);
  EXPECT_EQ(counts.strange, 0);
  for (std::size_t chart = 0; chart < 6; ++chart) {
    EXPECT_EQ(counts.edited[chart], chart == 4 ? counts.texels[chart] : 0) << chart;
  }
  EXPECT_GT(counts.texels[4], 1000);
  EXPECT_EQ(report.pushed.changed, static_cast<std::size_t>(counts.texels[4]));
  EXPECT_LT(counts.apart, 0.15);
  Document all = covered_globe();
  EXPECT_LT(report.views,
            all.apply(edit(smooth_part(
                          R"({"charts_at": [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1],
                                  [0, 0, -1]]})")))
                .views);
  EXPECT_LT(count_parts(all, covered_globe(), whole).apart, 1e-3);
}

/// Seams inside the part close, as without one; at its border the sides part.
TEST(SurfacePart, ClosesTheSeamsBetweenItsCharts) {
  Document two = covered_globe();
  const std::vector<const NormalMap*> maps{&map_of(two)};
  const auto mismatch = [&](bool inside) {
    const auto triangles = two.mesh().triangle_count();
    std::vector<SeamEdge> edges;
    for (const SeamEdge& e : two.seams()) {
      const bool a = e.triangle_a * 6 / triangles == 0 || e.triangle_a * 6 / triangles == 4;
      const bool b = e.triangle_b * 6 / triangles == 0 || e.triangle_b * 6 / triangles == 4;
      if (inside ? a && b : a != b) edges.push_back(e);
    }
    return measure_seams(two.mesh(), edges, maps).mean;
  };
  EXPECT_GT(mismatch(true), 5.0);
  two.apply(edit(smooth_part(R"({"charts_at": [[0, 0, 1], [1, 0, 0]]})")));
  EXPECT_LT(mismatch(true), 0.3);
  EXPECT_GT(mismatch(false), 3.0);
}

/// A stroke around the equator draws on one chart of the four that it crosses.
TEST(SurfacePart, LimitsStrokes) {
  const std::string around =
      R"("operator": "pen", "view": "surface", "options": {"width": 0.2, "height": 0.02,
         "profile": "bump"}, "strokes": [[[1, 0, 0], [0, 0, 1], [-1, 0, 0], [0, 0, -1]]])";
  Document all = globe();
  Document one = globe();
  all.apply(edit(around));
  one.apply(edit(around + R"(, "part": {"charts_at": [[0, 0, 1]]})"));
  const PartCounts whole = count_parts(all, globe(), all);
  const PartCounts part = count_parts(one, globe(), all);
  EXPECT_EQ(part.strange, 0);
  EXPECT_GT(part.edited[4], 200);
  EXPECT_EQ(part.edited[4], whole.edited[4]);
  EXPECT_EQ(part.edited[0] + part.edited[1] + part.edited[5], 0);
  EXPECT_GT(whole.edited[0], 100);
  EXPECT_LT(part.apart, 0.2);
}

std::string part_refusal(const std::string& fields) {
  Document d = covered_globe();
  try {
    d.apply(edit(fields));
  } catch (const InvalidInput& error) {
    EXPECT_FALSE(map_of(d).has_edits());
    return error.what();
  }
  return "no error";
}

TEST(SurfacePart, SaysWhatDoesNotFit) {
  EXPECT_EQ(part_refusal(R"("operator": "smooth", "view": "front", "options": {"sigma": 0.1},
                            "part": {"charts_at": [[0, 0, 1]]})"),
            "r.json: edits[0].part must be left out where the view is not \"surface\", not an "
            "object");
  EXPECT_NE(
      part_refusal(smooth_part("3")).find("edits[0].part must be an object with \"charts_at\""),
      std::string::npos);
  EXPECT_NE(part_refusal(smooth_part(R"({"charts_at": []})")).find("at least one point [x, y, z]"),
            std::string::npos);
  EXPECT_NE(part_refusal(smooth_part(R"({"charts": []})")).find("charts_at"), std::string::npos);
  EXPECT_NE(part_refusal(smooth_part(R"({"charts_at": [[0, 0, 1], [0, 0, 3]]})"))
                .find("edits[0].part.charts_at[1] must lie within 0.1732 object units"),
            std::string::npos);
  EXPECT_EQ(part_refusal(R"("operator": "pen", "view": "surface", "strokes": [[[0, 0, 1]]],
                            "options": {"width": 0.1, "height": 0.1},
                            "part": {"charts_at": [[0, 0, -1]]})"),
            "r.json: edits[0].part must hold surface with a front side that the strokes come near");
  ImageDocument flat = picture(waves(32, 32, 2, 0.3F));
  EXPECT_THROW(flat.apply(edit(smooth_part(R"({"charts_at": [[0, 0, 0]]})"))), InvalidInput);
}

TEST(SurfacePart, ComesBackFromItsJson) {
  const Recipe recipe = parse(R"({"version": 1, "edits": [{)" +
                              smooth_part(R"({"charts_at": [[0, 0.25, 1], [1, 0, 0]]})") + "}]}");
  const std::string text = to_json(to_value(recipe));
  EXPECT_EQ(to_json(to_value(parse(text))), text);
  EXPECT_EQ(recipe.edits[0].part->charts_at[0], Vec3f(0, 0.25F, 1));
  EXPECT_NE(text.find("charts_at"), std::string::npos);
}

}  // namespace
}  // namespace normalshop::test
