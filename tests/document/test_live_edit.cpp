#include <functional>

#include "document/edit_fixture.h"
#include "document/operator_cases.h"

#include "normalshop/core/error.h"
#include "normalshop/document/live_edit.h"

namespace normalshop {
namespace {

using namespace test;

int differing(const Document& a, const Document& b) {
  const NormalMap& p = map_of(a);
  const NormalMap& q = map_of(b);
  int count = 0;
  for (int y = 0; y < p.height(); ++y) {
    for (int x = 0; x < p.width(); ++x) {
      const bool same = p.edited(x, y) == q.edited(x, y) && p.vector(x, y) == q.vector(x, y);
      count += same ? 0 : 1;
    }
  }
  return count;
}

Edit without_strokes(Edit edit) {
  edit.strokes.clear();
  return edit;
}

Edit with_view_window(Edit edit) {
  edit.window = ChartWindow::View;
  return edit;
}

/// Draws an edit's strokes point by point, as a pointer does. `least`: points of each stroke.
void draw_by_points(const Edit& edit, std::size_t least, LiveEdit& live) {
  std::vector<UnitStroke> strokes;
  for (const UnitStroke& stroke : edit.strokes) {
    strokes.emplace_back(stroke.begin(), stroke.begin() + static_cast<std::ptrdiff_t>(
                                                              std::min(least, stroke.size())));
    for (std::size_t i = strokes.back().size(); i <= stroke.size(); ++i) {
      live.draw(strokes);
      if (i < stroke.size()) strokes.back().push_back(stroke[i]);
    }
  }
}

void expect_drawn_as_applied(const Edit& whole, Document applied) {
  Document drawn = applied;
  applied.apply(whole);
  const auto live = drawn.begin(without_strokes(whole));
  draw_by_points(whole, 1, *live);
  live->finish();
  EXPECT_EQ(differing(drawn, applied), 0);
  EXPECT_TRUE(map_of(drawn).has_edits());
}

std::string many_points() {
  std::string points = R"("strokes": [[)";
  for (int i = 0; i < 24; ++i) {
    const double t = 0.26 * i;
    points += (i > 0 ? ", [" : "[") + std::to_string(0.3 * std::cos(t)) + ", " +
              std::to_string(0.3 * std::sin(1.7 * t)) + ", " + std::to_string(0.5 + 0.02 * i) + "]";
  }
  return points + "]]";
}

TEST(LiveEdit, OfEveryOperatorIsWhatApplyMakesOfItsStrokes) {
  for (const OperatorCase& c : operator_cases(1.0)) {
    if (c.strokes.empty()) continue;
    SCOPED_TRACE(c.name);
    const Edit whole = with_view_window(edit_of(c));
    Document applied = document(plane_grid(2), noise_map(128, CodeType::U8));
    Document drawn = applied;
    const EditReport expected = applied.apply(whole);
    const auto live = drawn.begin(without_strokes(whole));
    draw_by_points(whole, 3, *live);
    const EditReport report = live->finish();
    EXPECT_EQ(differing(drawn, applied), 0);
    EXPECT_EQ(report.pushed.changed, expected.pushed.changed);
    EXPECT_GT(report.pushed.changed, 0U);
    EXPECT_EQ(drawn.log().size(), 1U);
  }
}

TEST(LiveEdit, LongStrokesAcrossSeamsAreThoseOfApply) {
  const std::string strokes = many_points();
  for (const std::string& fields :
       {std::string(R"("operator": "pen", "options": {"width": 0.2, "height": 0.03})"),
        std::string(R"("operator": "pen", "mode": "base", "details": "ignore",
                     "options": {"width": 0.1, "height": 0.02, "profile": "crease"})"),
        std::string(
            R"("operator": "pen", "options": {"width": 0.2, "height": 0.03, "taper": 0.3})"),
        std::string(R"("operator": "pen", "mode": {"along": [0.9, 0.5, -0.1]},
                     "options": {"width": 0.2, "height": 0.05})"),
        std::string(R"("operator": "smooth",
                     "options": {"sigma": 0.02, "area": "brush", "brush": 0.15})"),
        std::string(R"("operator": "denoise",
                     "options": {"sigma": 0.02, "area": "brush", "brush": 0.15})")}) {
    SCOPED_TRACE(fields);
    const Edit whole = edit(fields + R"(, "window": "view", "view": {"direction": [1, 0.3, 0.2],
        "center": [0, 0, 0], "width": 2, "height": 2}, )" +
                            strokes);
    expect_drawn_as_applied(whole, document(uv_sphere(24, 12), noise_map(128, CodeType::U16)));
  }
}

TEST(LiveEdit, StrengthAndSprayAreThoseOfApply) {
  const std::string strokes = many_points();
  for (const char* fields : {R"("strength": 0.4)", R"("spray": {"full": 20, "zero": 60})",
                             R"("strength": 0.7, "details": "ignore")"}) {
    SCOPED_TRACE(fields);
    const Edit whole =
        edit(R"("operator": "pen", "options": {"width": 0.2, "height": 0.03}, "window": "view",
                "view": {"direction": [1, 0.3, 0.2], "center": [0, 0, 0], "width": 2, "height": 2},
                )" +
             std::string(fields) + ", " + strokes);
    expect_drawn_as_applied(whole, document(uv_sphere(24, 12), noise_map(128, CodeType::U16)));
  }
}

// Many points to a piece of the curve that the pen follows.
TEST(LiveEdit, DensePointsAreThoseOfApply) {
  std::string points;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.03 * i;
    points += (i > 0 ? ", [" : "[") + std::to_string(0.4 * std::cos(t)) + ", " +
              std::to_string(0.4 * std::sin(t) - 0.2) + "]";
  }
  const Edit whole =
      edit(R"("operator": "pen", "options": {"width": 0.5, "height": 0.1}, "window": "view",
              "view": "front", "strokes": [[)" +
           points + "]]");
  expect_drawn_as_applied(whole, document(plane_grid(2), noise_map(64, CodeType::U8)));
}

TEST(LiveEdit, StrokesMayBecomeOthers) {
  Document drawn = flat_plane(128);
  Document applied = drawn;
  const Edit first = edit(
      R"("operator": "pen", "view": "front", "window": "view",
         "options": {"width": 0.1, "height": 0.02}, "strokes": [[[-0.3, 0], [0.3, 0.1]]])");
  Edit second = first;
  second.strokes = {{{{0.1F, -0.3F}}, {{0.0F, 0.3F}}, {{0.2F, 0.3F}}}};
  const auto live = drawn.begin(without_strokes(first));
  live->draw(first.strokes);
  EXPECT_FALSE(live->draw(second.strokes).empty());
  EXPECT_TRUE(live->draw(second.strokes).empty()) << "nothing has changed";
  live->finish();
  applied.apply(second);
  EXPECT_EQ(differing(drawn, applied), 0);
}

TEST(LiveEdit, CancelledOrLetGoOfIsNoEdit) {
  Document drawn = flat_plane(128);
  const Edit pen = edit(
      R"("operator": "pen", "view": "front", "options": {"width": 0.1, "height": 0.02},
         "strokes": [[[-0.3, 0], [0.3, 0.1]]])");
  for (const bool cancels : {true, false}) {
    const auto live = drawn.begin(without_strokes(pen));
    EXPECT_FALSE(live->draw(pen.strokes).empty());
    EXPECT_TRUE(map_of(drawn).has_edits());
    if (cancels) live->cancel();
  }
  EXPECT_FALSE(map_of(drawn).has_edits());
  EXPECT_TRUE(drawn.log().empty());
}

TEST(LiveEdit, MirrorImagesComeWithTheEnd) {
  const Edit pen = edit(
      R"("operator": "pen", "view": "front", "window": "view", "mirror": "x",
         "options": {"width": 0.2, "height": 0.03}, "strokes": [[[0.2, 0], [0.4, 0.3]]])");
  Document applied = document(uv_sphere(24, 12), noise_map(128, CodeType::U16));
  Document drawn = applied;
  applied.apply(pen);
  const auto live = drawn.begin(without_strokes(pen));
  live->draw(pen.strokes);
  live->finish();
  EXPECT_EQ(differing(drawn, applied), 0);
}

std::string message_from(const std::function<void()>& body) {
  try {
    body();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(LiveEdit, BadStrokesLeaveWhatWasDrawn) {
  Document drawn = flat_plane(64);
  const Edit closed = edit(
      R"("operator": "pen", "view": "front",
         "options": {"width": 0.1, "height": 0.02, "closed": true},
         "strokes": [[[-0.3, 0], [0.3, 0.1], [0.1, 0.3]]])");
  const auto live = drawn.begin(without_strokes(closed));
  live->draw(closed.strokes);
  const std::size_t count = map_of(drawn).edited_count();
  EXPECT_EQ(message_from([&] {
              live->draw({{{{0, 0}}, {{0.1F, 0}}}});
            }),
            "r.json: edits[0].strokes[0] must have at least 3 points, because the pen's stroke is "
            "closed");
  EXPECT_NE(message_from([&] { live->draw({{{{0, 0}}, {{1e6F, 0}}, {{0, 1}}}}); }), "");
  EXPECT_EQ(map_of(drawn).edited_count(), count);
  EXPECT_EQ(live->edit().strokes.size(), 1U);
  live->finish();
  EXPECT_EQ(drawn.log().size(), 1U);
}

TEST(LiveEdit, BesideTheModelIsAnErrorAndNoEdit) {
  Document drawn = flat_plane(64);
  const Edit pen = edit(
      R"("operator": "pen", "view": {"direction": [0, 0, 1], "center": [0.5, 0.5, 0], "width": 4},
         "options": {"width": 0.1, "height": 0.02}, "strokes": [[[1.5, 0], [1.6, 0.1]]])");
  const auto live = drawn.begin(without_strokes(pen));
  EXPECT_TRUE(live->draw(pen.strokes).empty());
  EXPECT_NE(message_from([&] { live->finish(); }).find("lies off the surface"), std::string::npos);
  EXPECT_FALSE(map_of(drawn).has_edits());
  EXPECT_TRUE(drawn.log().empty());
  const Edit surface =
      edit(R"("operator": "smooth", "view": "surface", "options": {"sigma": 0.1})");
  EXPECT_NE(message_from([&] { drawn.begin(surface); }).find("must be one view"),
            std::string::npos);
}

}  // namespace
}  // namespace normalshop
