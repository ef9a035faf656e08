#include <algorithm>
#include <functional>
#include <iostream>
#include <vector>

#include "document/edit_fixture.h"
#include <Eigen/Dense>

#include "normalshop/core/parallel.h"
#include "normalshop/core/slope.h"

/// Relief of known height on curved surfaces, against the normals of the displaced surface.
namespace normalshop::test {
namespace {

/// A surface over chart x, y with its unit normal, seen from the front, for |x|, |y| <= extent.
struct CurvedBase {
  std::string name;
  double extent;
  std::function<double(double, double)> z;
  std::function<Vec3d(const Vec3d&)> normal_at;

  Vec3d point(double x, double y) const { return {x, y, z(x, y)}; }
  Vec3d normal(double x, double y) const { return normal_at(point(x, y)); }
};

CurvedBase ball() {
  return {"sphere", 0.45, [](double x, double y) { return std::sqrt(1.0 - x * x - y * y); },
          [](const Vec3d& p) -> Vec3d { return p.normalized(); }};
}

/// A torus around the y axis, its tube of radius 1 at the distance 2: the outside, seen from
/// outside (side 1), or the far wall of the hole, a saddle (side -1).
CurvedBase ring(double side) {
  const auto z = [side](double x, double y) {
    const double from_axis = 2.0 + side * std::sqrt(1.0 - y * y);
    return side * std::sqrt(from_axis * from_axis - x * x);
  };
  const auto normal = [](const Vec3d& p) -> Vec3d {
    const double from_axis = std::hypot(p.x(), p.z());
    const double out = (from_axis - 2.0) / from_axis;
    return Vec3d(out * p.x(), p.y(), out * p.z()).normalized();
  };
  return {side > 0.0 ? "torus" : "saddle", 0.45, z, normal};
}

constexpr int relief_map = 128;

/// The base as a mesh without details.
Document smooth_document(const CurvedBase& base) {
  constexpr int quads = 48;
  MeshBuilder builder;
  const auto corner = [&](int i, int j) {
    const double s = static_cast<double>(i) / quads;
    const double t = static_cast<double>(j) / quads;
    const double x = base.extent * (2.0 * s - 1.0);
    const double y = base.extent * (2.0 * t - 1.0);
    return MeshBuilder::Corner{base.point(x, y).cast<float>(), base.normal(x, y).cast<float>(),
                               Vec2d(s, 1.0 - t).cast<float>()};
  };
  for (int j = 0; j < quads; ++j) {
    for (int i = 0; i < quads; ++i) {
      builder.quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  return document(builder.finish(), flat_normal_map(relief_map, relief_map, CodeType::F32));
}

using HeightAt = std::function<double(double, double)>;
using DirectionAt = std::function<Vec3d(double, double)>;

/// The normal of base + height * direction.
Vec3d displaced_normal(const CurvedBase& base, const HeightAt& height, const DirectionAt& direction,
                       double x, double y) {
  constexpr double step = 1e-4;
  const auto at = [&](double u, double v) -> Vec3d {
    return base.point(u, v) + height(u, v) * direction(u, v);
  };
  const Vec3d fu = at(x + step, y) - at(x - step, y);
  const Vec3d fv = at(x, y + step) - at(x, y - step);
  return fu.cross(fv).normalized();
}

/// The largest error that dropping the term makes there (antieigenvalue bound), and |h kappa|.
struct Bound {
  double degrees;
  double reach;
};

Bound bound_of(const CurvedBase& base, const HeightAt& height, double x, double y) {
  constexpr double step = 1e-4;
  Eigen::Matrix2d bend;
  bend.row(0) =
      (base.normal(x + step, y) - base.normal(x - step, y)).head<2>().transpose() / (2.0 * step);
  bend.row(1) =
      (base.normal(x, y + step) - base.normal(x, y - step)).head<2>().transpose() / (2.0 * step);
  const Eigen::Vector2cd bends = Eigen::EigenSolver<Eigen::Matrix2d>(bend).eigenvalues();
  const double h = height(x, y);
  const double a = h * bends[0].real();
  const double b = h * bends[1].real();
  const double most = std::max({1.0, 1.0 / (1.0 + a), 1.0 / (1.0 + b)});
  const double least = std::min({1.0, 1.0 / (1.0 + a), 1.0 / (1.0 + b)});
  return {std::asin((most - least) / (most + least)) * 57.29577951308232,
          std::max(std::abs(a), std::abs(b))};
}

struct Errors {
  double mean = 0.0;
  double p99 = 0.0;
  double most = 0.0;
  double over = -1.0;  ///< of an error over its bound
  double bound = 0.0;  ///< largest
  double reach = 0.0;  ///< largest |h kappa|
};

/// Over all texels that the relief raises, two texels from the border.
Errors errors_of(const Document& edited, const CurvedBase& base, const HeightAt& height,
                 const DirectionAt& direction) {
  const NormalMap& map = map_of(edited);
  const TexelMap& texels = edited.storage().sets[0].texels;
  std::vector<double> all;
  Errors errors;
  for (int y = 2; y < relief_map - 2; ++y) {
    for (int x = 2; x < relief_map - 2; ++x) {
      const SurfacePoint at = texels.surface_point(texels.owner()(x, y), x, y);
      const Vec3d p = position_at(edited.mesh(), at).cast<double>();
      if (height(p.x(), p.y()) == 0.0) continue;
      const Vec3d truth = displaced_normal(base, height, direction, p.x(), p.y());
      const Vec3f found =
          frame_at(edited.mesh(), at, NormalSpace::Tangent).object_normal(map.normal(x, y));
      const double error = angle_degrees(found, truth.cast<float>());
      const Bound bound = bound_of(base, height, p.x(), p.y());
      errors.over = std::max(errors.over, error - bound.degrees);
      errors.bound = std::max(errors.bound, bound.degrees);
      errors.reach = std::max(errors.reach, bound.reach);
      errors.mean += error;
      all.push_back(error);
    }
  }
  errors.mean /= static_cast<double>(all.size());
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(all.size()));
  std::nth_element(all.begin(), all.begin() + rank, all.end());
  errors.p99 = all[static_cast<std::size_t>(rank)];
  errors.most = *std::max_element(all.begin(), all.end());
  return errors;
}

/// The pen's bump of that height and width around the segment from a to b.
HeightAt bump_around(const Vec2d& a, const Vec2d& b, double height, double width) {
  return [=](double x, double y) {
    const Vec2d along = b - a;
    const double length = along.squaredNorm();
    const Vec2d p(x, y);
    const double t = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
    const double u = (p - a - t * along).norm() / (0.5 * width);
    return u < 1.0 ? height * std::pow(1.0 - u * u, 3.0) : 0.0;
  };
}

std::string pen_of(double height, double width, const std::string& stroke) {
  return R"("operator": "pen", "view": "front", "options": {"profile": "bump", "smooth": false,
            "height": )" +
         std::to_string(height) + R"(, "width": )" + std::to_string(width) + R"(}, "strokes": [)" +
         stroke + "]";
}

DirectionAt normals_of(const CurvedBase& base) {
  return [&base](double x, double y) { return base.normal(x, y); };
}

void tell(const std::string& what, const Errors& e) {
  std::cout << what << ": |h kappa| " << 100.0 * e.reach << " %, mean " << e.mean << ", p99 "
            << e.p99 << ", largest " << e.most << " degrees\n";
}

/// The base with details: a bump of known height along its normals.
Document document_with(const CurvedBase& base, const HeightAt& height) {
  const Document smooth = smooth_document(base);
  const TexelMap& texels = smooth.storage().sets[0].texels;
  RawImage codes(relief_map, relief_map, 3, CodeType::F32);
  for (int y = 0; y < relief_map; ++y) {
    for (int x = 0; x < relief_map; ++x) {
      const SurfacePoint at = texels.surface_point(texels.owner()(x, y), x, y);
      const Vec3f p = position_at(smooth.mesh(), at);
      const Vec2d q = p.head<2>().cast<double>();
      const Vec3f n = displaced_normal(base, height, normals_of(base), q.x(), q.y()).cast<float>();
      const TangentFrame frame = frame_at(smooth.mesh(), at, NormalSpace::Tangent);
      const Vec3f code = height(q.x(), q.y()) == 0.0 ? Vec3f(Vec3f::UnitZ()) : frame.map_normal(n);
      std::copy_n(code.data(), 3, codes.row<float>(y) + static_cast<std::ptrdiff_t>(3 * x));
    }
  }
  return document(smooth.mesh(), NormalMap(std::move(codes), {.signed_float = true}));
}

struct Relief {
  std::string stroke;
  Vec2d a;
  Vec2d b;
};
const std::vector<Relief>& reliefs() {
  static const std::vector<Relief> all{
      {"[[0.02, -0.01]]", {0.02, -0.01}, {0.02, -0.01}},
      {"[[-0.2, -0.15], [0.15, 0.2]]", {-0.2, -0.15}, {0.15, 0.2}}};
  return all;
}

class CurvedRelief : public testing::TestWithParam<int> {
 protected:
  CurvedBase base() const { return GetParam() == 0 ? ball() : ring(GetParam() == 1 ? 1.0 : -1.0); }
};
INSTANTIATE_TEST_SUITE_P(Bases, CurvedRelief, testing::Values(0, 1, 2));

/// Dropping the term costs what it may: asin((a - b) / (a + b)) of the stretches a >= b.
TEST_P(CurvedRelief, the_dropped_term_stays_within_its_bound) {
  const CurvedBase curved = base();
  const Document before = smooth_document(curved);
  for (const double height : {0.018, -0.07}) {
    for (const Relief& relief : reliefs()) {
      Document edited = before;
      const EditReport told =
          edited.apply(edit(pen_of(height, 0.3, relief.stroke) + R"(, "mode": "base")"));
      const HeightAt bump = bump_around(relief.a, relief.b, height, 0.3);
      const Errors errors = errors_of(edited, curved, bump, normals_of(curved));
      tell(curved.name + ", dropped", errors);
      EXPECT_LT(errors.over, 0.03);
      EXPECT_GT(errors.most, 0.1 * errors.bound);
      EXPECT_NEAR(static_cast<double>(told.relief.largest), errors.reach, 0.06 * errors.reach);
    }
  }
}

TEST_P(CurvedRelief, the_kept_term_makes_normals_right) {
  const CurvedBase curved = base();
  const Document before = smooth_document(curved);
  for (const double height : {0.07, -0.07}) {
    const Relief& relief = reliefs()[height > 0.0 ? 0 : 1];
    Document edited = before;
    const EditReport told = edited.apply(
        edit(pen_of(height, 0.3, relief.stroke) + R"(, "mode": "base", "curvature": "keep")"));
    const HeightAt bump = bump_around(relief.a, relief.b, height, 0.3);
    const Errors errors = errors_of(edited, curved, bump, normals_of(curved));
    tell(curved.name + ", kept", errors);
    EXPECT_LT(errors.mean, 0.01);
    EXPECT_LT(errors.p99, 0.05);
    EXPECT_NEAR(static_cast<double>(told.relief.largest), errors.reach, 0.05 * errors.reach);
    EXPECT_FALSE(told.relief.folds);
  }
}

/// Details that exist have a height, too: twice as high they are those of twice the height.
TEST_P(CurvedRelief, the_kept_term_knows_the_height_of_details) {
  const CurvedBase curved = base();
  const double height = 0.035;
  const HeightAt bump = bump_around({0.02, -0.01}, {0.02, -0.01}, height, 0.3);
  const HeightAt twice = [&](double x, double y) { return 2.0 * bump(x, y); };
  const Document before = document_with(curved, bump);
  EXPECT_LT(errors_of(before, curved, bump, normals_of(curved)).most, 1e-3);
  Errors errors[2];
  for (const bool keep : {false, true}) {
    Document edited = before;
    edited.apply(edit(
        std::string(R"("operator": "filter", "view": "front", "mode": "base", "curvature": ")") +
        (keep ? "keep" : "drop") + R"(", "options": {"kind": "scale", "amount": 2})"));
    errors[keep ? 1 : 0] = errors_of(edited, curved, twice, normals_of(curved));
    tell(curved.name + (keep ? ", doubled, kept" : ", doubled, dropped"), errors[keep ? 1 : 0]);
  }
  EXPECT_GT(errors[0].p99, 0.3);
  EXPECT_LT(errors[1].mean, 0.02);
  EXPECT_LT(errors[1].p99, 0.05);
}

/// A relief that reaches the centre of a hollow is told, and leaves normals that are some.
TEST(CurvedReliefLimits, heights_beyond_the_centre_fold) {
  const CurvedBase hollow{"hollow", 0.4,
                          [](double x, double y) { return -std::sqrt(1.0 - x * x - y * y); },
                          [](const Vec3d& p) -> Vec3d { return -p.normalized(); }};
  for (const double height : {0.5, 1.5}) {
    Document edited = smooth_document(hollow);
    const EditReport told = edited.apply(
        edit(pen_of(height, 0.7, "[[0, 0]]") + R"(, "mode": "base", "curvature": "keep")"));
    EXPECT_NEAR(static_cast<double>(told.relief.largest), height, 0.04 * height);
    EXPECT_EQ(told.relief.folds, height > 1.0);
    expect_unit_normals(map_of(edited));
  }
}

TEST(CurvedReliefLimits, what_changes_nothing_keeps_every_code) {
  const CurvedBase curved = ball();
  Document edited = document_with(curved, bump_around({0, 0}, {0.1, 0}, 0.03, 0.3));
  for (const char* fields :
       {R"("operator": "smooth", "options": {"sigma": 0})",
        R"("operator": "filter", "options": {"kind": "scale", "amount": 1})",
        R"("operator": "pen", "options": {"width": 0.1, "height": 0}, "strokes": [[[0, 0]]])",
        R"("operator": "smooth", "options": {"sigma": 0.1}, "strength": 0)"}) {
    edited.apply(
        edit(std::string(fields) + R"(, "view": "front", "mode": "base", "curvature": "keep")"));
    EXPECT_EQ(map_of(edited).edited_count(), 0U) << fields;
  }
  // Beside a small stroke nothing changes, either.
  edited.apply(edit(pen_of(0.01, 0.1, "[[0, 0]]") + R"(, "mode": "base", "curvature": "keep")"));
  EXPECT_GT(map_of(edited).edited_count(), 50U);
  EXPECT_LT(map_of(edited).edited_count(), 400U);
}

TEST(CurvedReliefLimits, threads_do_not_matter) {
  const CurvedBase curved = ball();
  const Edit one = edit(R"("operator": "smooth", "view": "front", "mode": "base",
                           "curvature": "keep", "options": {"sigma": 0.02})");
  Document many = document_with(curved, bump_around({0, 0}, {0.1, 0}, 0.03, 0.3));
  Document single = many;
  const EditReport told = many.apply(one);
  const ThreadLimit limit(1);
  EXPECT_EQ(single.apply(one).relief.largest, told.relief.largest);
  EXPECT_GT(map_of(many).edited_count(), 1000U);
  for (int y = 0; y < relief_map; ++y) {
    for (int x = 0; x < relief_map; ++x) {
      ASSERT_EQ(map_of(many).normal(x, y), map_of(single).normal(x, y)) << x << ", " << y;
    }
  }
}

TEST(CurvedReliefLimits, a_plane_has_no_such_term) {
  Document drop = document(plane_grid(2), noise_map(relief_map, CodeType::U16));
  Document keep = drop;
  const std::string pen = pen_of(0.1, 0.4, "[[-0.2, 0], [0.2, 0.1]]") + R"(, "mode": "base")";
  EXPECT_EQ(drop.apply(edit(pen)).relief.largest, 0.0F);
  EXPECT_EQ(keep.apply(edit(pen + R"(, "curvature": "keep")")).relief.largest, 0.0F);
  for (int y = 0; y < relief_map; ++y) {
    for (int x = 0; x < relief_map; ++x) {
      ASSERT_LT((map_of(drop).normal(x, y) - map_of(keep).normal(x, y)).norm(), 1e-6F);
    }
  }
}

/// Along a fixed direction there is no such term: the normals are right for any height.
TEST(CurvedReliefLimits, along_a_fixed_direction_is_exact) {
  for (const CurvedBase& base : {ball(), ring(-1.0)}) {
    Document edited = smooth_document(base);
    const double height = 0.2;
    edited.apply(
        edit(pen_of(height, 0.4, reliefs()[1].stroke) + R"(, "mode": {"along": [0.3, -0.2, 1]})"));
    const HeightAt bump = bump_around(reliefs()[1].a, reliefs()[1].b, height, 0.4);
    const Vec3d d = Vec3d(0.3, -0.2, 1).normalized();
    const Errors errors = errors_of(edited, base, bump, [d](double, double) { return d; });
    tell(base.name + ", along a direction", errors);
    EXPECT_LT(errors.mean, 0.02) << base.name;
    EXPECT_LT(errors.p99, 0.05) << base.name;
  }
}

}  // namespace
}  // namespace normalshop::test
