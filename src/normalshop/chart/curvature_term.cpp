#include "normalshop/chart/curvature_term.h"

#include <cassert>
#include <cmath>
#include <vector>

#include "normalshop/chart/slope_height.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/core/parallel.h"

namespace normalshop {

namespace {

/// Neighbouring normals that are farther apart lie on two sides of a hard edge.
constexpr float hard_edge = 0.25F;
/// How near to a centre of curvature heights go.
constexpr float nearest_centre = 0.5F;
/// Pixels each way that integrate a height.
constexpr int fine_height = 1024;
constexpr int rough_height = 96;
/// Of the pixels of a relief, those that do not count for its reach.
constexpr double left_out = 0.01;

struct Bends {
  float most;   ///< larger amount of both eigenvalues
  float least;  ///< the smaller one of h times them
};

Bends bends_of(const Eigen::Matrix2f& bend, float height) {
  const float half = 0.5F * bend.trace();
  const float root = std::sqrt(std::max(0.0F, half * half - bend.determinant()));
  return {std::max(std::abs(half + root), std::abs(half - root)),
          std::min(height * (half + root), height * (half - root))};
}

float kept_before_centre(const Eigen::Matrix2f& bend, float height) {
  const float least = bends_of(bend, height).least;
  return least < -nearest_centre ? height * (nearest_centre / -least) : height;
}

/// (I + h W)^-1 slope
Vec2f unbent(const Eigen::Matrix2f& bend, float height, const Vec2f& slope) {
  const Eigen::Matrix2f shape =
      Eigen::Matrix2f::Identity() + kept_before_centre(bend, height) * bend;
  return Vec2f(shape(1, 1) * slope.x() - shape(0, 1) * slope.y(),
               shape(0, 0) * slope.y() - shape(1, 0) * slope.x()) /
         shape.determinant();
}

/// Gathers what a ReliefReach is made of, row by row.
class ReachTally {
 public:
  explicit ReachTally(int rows) : rows_(static_cast<std::size_t>(rows)) {}

  void add(int row, const Eigen::Matrix2f& bend, float height) {
    const Bends bends = bends_of(bend, height);
    Row& r = rows_[static_cast<std::size_t>(row)];
    r.reach.push_back(std::abs(height) * bends.most);
    if (bends.least <= -1.0F) ++r.folds;
  }
  ReliefReach result() const {
    std::vector<float> all;
    std::size_t folds = 0;
    for (const Row& r : rows_) {
      all.insert(all.end(), r.reach.begin(), r.reach.end());
      folds += r.folds;
    }
    if (all.empty()) return {};
    const auto spare = static_cast<std::size_t>(left_out * static_cast<double>(all.size()));
    const auto place = all.end() - 1 - static_cast<std::ptrdiff_t>(spare);
    std::nth_element(all.begin(), place, all.end());
    return {*place, folds > spare};
  }

 private:
  struct Row {
    std::vector<float> reach;
    std::size_t folds = 0;
  };
  std::vector<Row> rows_;
};

bool all_zero(SlopeView slopes) {
  for (int y = 0; y < slopes.height(); ++y) {
    for (int x = 0; x < slopes.width(); ++x) {
      if (!slopes(x, y).isZero(0.0F)) return false;
    }
  }
  return true;
}

}  // namespace

CurvatureTerm::CurvatureTerm(ImageView<Vec3f> base_normals, MaskView weight)
    : normals_(base_normals), weight_(weight) {
  assert(base_normals.rect() == weight.rect());
}

/// Mean step of the normal to both neighbours, as far as they are of the same surface.
Vec2f CurvatureTerm::step_along(int x, int y, int dx, int dy) const {
  Vec2f sum(0.0F, 0.0F);
  float count = 0.0F;
  for (const int way : {-1, 1}) {
    const int nx = x + way * dx;
    const int ny = y + way * dy;
    if (!weight_.rect().contains(nx, ny) || !shows(nx, ny)) continue;
    const Vec3f step = normals_(nx, ny) - normals_(x, y);
    if (!(step.norm() < hard_edge)) continue;
    sum += static_cast<float>(way) * step.head<2>();
    count += 1.0F;
  }
  return count > 0.0F ? Vec2f(sum / count) : sum;
}

Eigen::Matrix2f CurvatureTerm::bend_at(int x, int y) const {
  Eigen::Matrix2f bend = Eigen::Matrix2f::Zero();
  if (!shows(x, y)) return bend;
  bend.row(0) = step_along(x, y, 1, 0).transpose();
  bend.row(1) = step_along(x, y, 0, -1).transpose();
  return bend;
}

/// grad h = g + h W g by fixed-point sweeps, each of which adds the digits of 1 / |h kappa|.
void CurvatureTerm::restore(SlopeSpan details, const Rect& region) {
  numbers_ = {};
  height_ = {};
  if (all_zero(details)) return;
  const Rect all = details.rect();
  numbers_.resize(all.width(), all.height());
  height_.resize(all.width(), all.height());
  for_pixels(all, [&](int x, int y) { numbers_(x, y) = details(x, y); });
  const auto shown = [&](int x, int y) { return shows(x, y); };
  for (int sweep = 0; sweep < 3; ++sweep) {
    SlopeHeight height(details, weight_, all, fine_height);
    height.level(intersect(region, all), shown);
    for_pixels(all, [&](int x, int y) {
      const Eigen::Matrix2f bend = bend_at(x, y);
      height_(x, y) = kept_before_centre(bend, height.at(x, y));
      details(x, y) = numbers_(x, y) + height_(x, y) * (bend * numbers_(x, y));
    });
  }
}

CurvatureTerm::Relief CurvatureTerm::relief_at(int x, int y, float kept) const {
  Relief relief{Vec2f(0.0F, 0.0F), Vec2f(0.0F, 0.0F), 0.0F};
  if (height_.empty()) return relief;
  relief.numbers = kept * numbers_(x, y);
  relief.slope = relief.numbers + height_(x, y) * (bend_at(x, y) * relief.numbers);
  relief.height = kept * height_(x, y);
  return relief;
}

ReliefReach CurvatureTerm::convert(const Rect& region, MaskView coverage, SlopeSpan change) const {
  const Rect inside = intersect(region, weight_.rect());
  if (inside.empty()) return {};
  const Rect around = intersect(grow(inside, 1), weight_.rect());
  SlopeHeight rise(change, weight_, around, fine_height);
  rise.level(around, [&](int x, int y) { return change(x, y).isZero(0.0F); });
  // Where the edit does nothing, what the solver leaves there must not, either.
  const float nothing = 1e-3F * rise.largest();
  ReachTally tally(inside.height());
  parallel_rows(inside.height(), [&](int row) {
    const int y = inside.y0 + row;
    for (int x = inside.x0; x < inside.x1; ++x) {
      if (!shows(x, y)) continue;
      Vec2f& moved = change(x, y);
      const float covered = coverage.empty() ? 0.0F : coverage(x, y);
      const float risen = rise.at(x, y);
      if (moved.isZero(0.0F) && covered == 0.0F && std::abs(risen) <= nothing) continue;
      const Eigen::Matrix2f bend = bend_at(x, y);
      const Relief relief = relief_at(x, y, 1.0F - covered);
      const float height = relief.height + risen;
      tally.add(row, bend, height);
      const Vec2f after = unbent(bend, height, relief.slope + moved);
      if (after.allFinite()) moved = after - relief.numbers;
    }
  });
  return tally.result();
}

ReliefReach CurvatureTerm::measure(const Rect& region, SlopeView change) const {
  const Rect around = intersect(grow(region, 1), weight_.rect());
  if (around.empty()) return {};
  SlopeHeight rise(change, weight_, around, rough_height);
  rise.level(around, [&](int x, int y) { return change(x, y).isZero(0.0F); });
  const float nothing = 1e-3F * rise.largest();
  const int step = rise.step();
  const int rows = (around.height() + step - 1) / step;
  ReachTally tally(rows);
  parallel_rows(rows, [&](int row) {
    const int y = around.y0 + row * step;
    for (int x = around.x0; x < around.x1; x += step) {
      const float risen = rise.at(x, y);
      if (shows(x, y) && std::abs(risen) > nothing) tally.add(row, bend_at(x, y), risen);
    }
  });
  return tally.result();
}

}  // namespace normalshop
