#include <algorithm>
#include <array>
#include <iostream>
#include <map>

#include "document/fake_assets.h"
#include "support/data.h"
#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "normalshop/chart/view.h"
#include "normalshop/io/open_document.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/subdivide.h"

/// Relief of known height on a real surface.
namespace normalshop::test {
namespace {

/// Normals that bend smoothly: the base surface's curvature must be that of a form, not of its
/// triangles.
void smooth_normals(Mesh& mesh, int times) {
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place(mesh.corner_count());
  for (std::size_t c = 0; c < place.size(); ++c) {
    const Vec3f& p = mesh.position(c);
    place[c] = places.emplace(std::array{p.x(), p.y(), p.z()}, places.size()).first->second;
  }
  for (int i = 0; i < times; ++i) {
    std::vector<Vec3f> sums(places.size(), Vec3f::Zero());
    for (std::size_t c = 0; c < place.size(); ++c) {
      for (std::size_t k = 0; k < 3; ++k) sums[place[c]] += mesh.normals[c - c % 3 + k];
    }
    for (std::size_t c = 0; c < place.size(); ++c) mesh.normals[c] = sums[place[c]].normalized();
  }
}

/// A cheek, and a bump of the pen in its middle.
constexpr double head_width = 0.8;
const std::string head_view = R"({"facing": [1.6, -0.6, 1.6], "width": 1.6})";

View cheek_view(const Mesh& mesh) { return facing_view(mesh, {1.6F, -0.6F, 1.6F}, 1.6F, 1.6F); }

struct HeadErrors {
  double mean = 0.0;
  double p99 = 0.0;
};

/// f_u x f_v of f = b + h N at every texel that is raised, N being the interpolated base normal.
HeadErrors head_errors(const Document& edited, double height) {
  const Mesh& mesh = edited.mesh();
  const View view = cheek_view(mesh);
  const StorageSet& set = edited.storage().sets[0];
  std::vector<double> errors;
  HeadErrors result;
  for (int y = 0; y < set.normals.height(); ++y) {
    for (int x = 0; x < set.normals.width(); ++x) {
      const std::uint32_t owner = set.texels.owner()(x, y);
      if (owner == no_triangle || !set.normals.edited(x, y)) continue;
      const SurfacePoint at = set.texels.surface_point(owner, x, y);
      Eigen::Matrix3d points;
      Eigen::Matrix3d normals;
      for (int k = 0; k < 3; ++k) {
        const std::size_t c =
            3 * static_cast<std::size_t>(at.triangle) + static_cast<std::size_t>(k);
        points.col(k) = view.to_chart(mesh.position(c) - view.center).cast<double>();
        normals.col(k) = view.to_chart(mesh.normals[c]).cast<double>();
      }
      const Vec3d weights(1.0 - static_cast<double>(at.b1) - static_cast<double>(at.b2),
                          static_cast<double>(at.b1), static_cast<double>(at.b2));
      const Vec3d p = points * weights;
      const double u = p.head<2>().norm() / (0.5 * head_width);
      if (u >= 1.0 || std::abs(p.z()) > 0.5) continue;
      Eigen::Matrix3d affine = points;
      affine.row(2).setOnes();
      const Eigen::Matrix3d gradient = normals * affine.inverse();  // columns: d/dx, d/dy
      const Vec3d n = normals * weights;
      const Vec3d unit = n.normalized();
      const double h = height * std::pow(1.0 - u * u, 3.0);
      const double slope =
          -6.0 * height * std::pow(1.0 - u * u, 2.0) / std::pow(0.5 * head_width, 2);
      const auto tangent = [&](int k) -> Vec3d {
        const Vec3d bend = (gradient.col(k) - unit * unit.dot(gradient.col(k))) / n.norm();
        return Vec3d(k == 0 ? 1 : 0, k == 1 ? 1 : 0, -unit[k] / unit.z()) + slope * p[k] * unit +
               h * bend;
      };
      const Vec3d truth = tangent(0).cross(tangent(1));
      const Vec3f found = view.to_chart(
          frame_at(mesh, at, NormalSpace::Tangent).object_normal(set.normals.normal(x, y)));
      errors.push_back(angle_degrees(found, truth.cast<float>()));
      result.mean += errors.back();
    }
  }
  EXPECT_GT(errors.size(), 1000U);
  result.mean /= static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  result.p99 = errors[errors.size() * 99 / 100];
  return result;
}

TEST(HeadRelief, KeepsTheCurvatureOfTheCheek) {
  const auto model = data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!model) GTEST_SKIP() << "the real data is not on this machine";
  OpenOptions options;
  options.model = *model;
  options.size = 64;
  Mesh mesh = subdivide(open_document(options).document.mesh(), 2);
  smooth_normals(mesh, 40);
  std::vector<Document::Maps> maps;
  maps.push_back({flat_normal_map(2048, 2048, CodeType::U16), {}});
  const Document before(std::move(mesh), std::move(maps));
  FakeAssets assets;
  for (const double height : {0.08, -0.08}) {
    std::array<HeadErrors, 2> errors;
    for (const bool keep : {false, true}) {
      const std::string recipe =
          R"({"version": 1, "edits": [{"operator": "pen", "mode": "base", "view": )" + head_view +
          R"(, "curvature": ")" + (keep ? "keep" : "drop") +
          R"(", "strokes": [[[0, 0]]], "options": {"profile": "bump", "width": )" +
          std::to_string(head_width) + R"(, "height": )" + std::to_string(height) + "}}]}";
      Document edited = before;
      const EditReport told = edited.apply(parse_recipe(recipe, "head", assets).edits[0]);
      HeadErrors& e = errors[keep ? 1 : 0];
      e = head_errors(edited, height);
      std::cout << "height " << height << (keep ? ", kept" : ", dropped") << ": |h kappa| "
                << 100.0F * told.relief.largest << " %, mean " << e.mean << ", p99 " << e.p99
                << " degrees\n";
      EXPECT_GT(told.relief.largest, 0.02F);
      EXPECT_LT(told.relief.largest, 0.12F);
    }
    EXPECT_LT(errors[1].mean, 0.05);
    EXPECT_LT(errors[1].p99, 0.05);
    EXPECT_GT(errors[0].p99, 4.0 * errors[1].p99);
  }
}

}  // namespace
}  // namespace normalshop::test
