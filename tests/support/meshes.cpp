#include "support/meshes.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace normalshop::test {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

/// n x n quads of corner(s, t), s and t in 0..1; counter-clockwise when s right, t up faces you.
template <class F>
void grid(MeshBuilder& builder, int columns, int rows, const F& corner) {
  const auto at = [&](int i, int j) {
    return corner(static_cast<float>(i) / static_cast<float>(columns),
                  static_cast<float>(j) / static_cast<float>(rows));
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      builder.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

/// Points of a unit circle at s in 0..1 that close exactly.
Vec2f circle(float s) {
  const float angle = s < 1.0F ? 2.0F * pi * s : 0.0F;
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

void MeshBuilder::triangle(const Corner& a, const Corner& b, const Corner& c) {
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (const Corner* corner : {&a, &b, &c}) {
    mesh_.positions.push_back(corner->position);
    mesh_.normals.push_back(corner->normal);
    mesh_.uvs.push_back(corner->uv);
  }
  mesh_.triangles.emplace_back(first, first + 1, first + 2);
  mesh_.texture_sets.push_back(0);
}

void MeshBuilder::quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  triangle(a, b, c);
  triangle(a, c, d);
}

Mesh MeshBuilder::finish() {
  mesh_.texture_set_names = {"map"};
  for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
    const Vec3f e1 = mesh_.position(3 * t + 1) - mesh_.position(3 * t);
    const Vec3f e2 = mesh_.position(3 * t + 2) - mesh_.position(3 * t);
    const Vec2f d1 = mesh_.uvs[3 * t + 1] - mesh_.uvs[3 * t];
    const Vec2f d2 = mesh_.uvs[3 * t + 2] - mesh_.uvs[3 * t];
    // v runs down: a counter-clockwise triangle that is not mirrored has a negative area in (u, v).
    const float area = d1.x() * d2.y() - d2.x() * d1.y();
    const float w = area > 0.0F ? -1.0F : 1.0F;
    const Vec3f along_u = (area < 0.0F ? -1.0F : 1.0F) * (d2.y() * e1 - d1.y() * e2);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& n = mesh_.normals[3 * t + k];
      const Vec3f tangent = (along_u - n.dot(along_u) * n).stableNormalized();
      mesh_.tangents.emplace_back(tangent.x(), tangent.y(), tangent.z(), w);
    }
  }
  return std::move(mesh_);
}

Mesh plane_grid(int n) {
  MeshBuilder builder;
  grid(builder, n, n, [](float s, float t) {
    return MeshBuilder::Corner{{s, t, 0.0F}, {0.0F, 0.0F, 1.0F}, {s, 1.0F - t}};
  });
  return builder.finish();
}

Mesh plane_two_charts(int n) {
  MeshBuilder builder;
  grid(builder, n, n, [](float s, float t) {
    return MeshBuilder::Corner{
        {0.5F * s, t, 0.0F}, {0.0F, 0.0F, 1.0F}, {0.1F + 0.4F * s, 0.9F - 0.8F * t}};
  });
  grid(builder, n, n, [](float s, float t) {
    return MeshBuilder::Corner{
        {0.5F + 0.5F * s, t, 0.0F}, {0.0F, 0.0F, 1.0F}, {0.6F + 0.3F * t, 0.2F + 0.15F * s}};
  });
  return builder.finish();
}

Mesh cube(int n) {
  // Normal, right, up of each face as seen from outside.
  const std::array<std::array<Vec3f, 3>, 6> faces = {{
      {Vec3f(0, 0, 1), Vec3f(1, 0, 0), Vec3f(0, 1, 0)},
      {Vec3f(0, 0, -1), Vec3f(-1, 0, 0), Vec3f(0, 1, 0)},
      {Vec3f(1, 0, 0), Vec3f(0, 0, -1), Vec3f(0, 1, 0)},
      {Vec3f(-1, 0, 0), Vec3f(0, 0, 1), Vec3f(0, 1, 0)},
      {Vec3f(0, 1, 0), Vec3f(1, 0, 0), Vec3f(0, 0, -1)},
      {Vec3f(0, -1, 0), Vec3f(1, 0, 0), Vec3f(0, 0, 1)},
  }};
  MeshBuilder builder;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Vec3f& normal = faces[f][0];
    const Vec3f& right = faces[f][1];
    const Vec3f& up = faces[f][2];
    const Vec2f corner(static_cast<float>(f % 3) / 3.0F + 0.04F,
                       static_cast<float>(f / 3) / 2.0F + 0.04F);
    const Vec2f extent(1.0F / 3.0F - 0.08F, 0.5F - 0.08F);
    grid(builder, n, n, [&](float s, float t) {
      // Exactly antisymmetric, so that neighbouring faces' positions are equal as numbers.
      const auto signed_place = [n](float a) {
        const auto count = static_cast<float>(n);
        return (2.0F * std::round(a * count) - count) / count;
      };
      const Vec3f position = normal + signed_place(s) * right + signed_place(t) * up;
      const Vec2f uv = corner + Vec2f(s, 1.0F - t).cwiseProduct(extent);
      return MeshBuilder::Corner{position, normal, uv};
    });
  }
  return builder.finish();
}

Mesh uv_sphere(int segments, int rings, float radius) {
  MeshBuilder builder;
  grid(builder, segments, rings, [&](float s, float t) {
    const bool pole = t <= 0.0F || t >= 1.0F;
    const float sine = pole ? 0.0F : std::sin(pi * t);
    const Vec2f c = circle(s);
    const Vec3f n(sine * c.y(),
                  t <= 0.0F   ? -1.0F
                  : t >= 1.0F ? 1.0F
                              : -std::cos(pi * t),
                  sine * c.x());
    return MeshBuilder::Corner{radius * n, n, {s, 1.0F - t}};
  });
  return builder.finish();
}

Mesh hemisphere(int rings, int segments) {
  MeshBuilder builder;
  const auto corner = [&](int ring, int segment) {
    const float t = static_cast<float>(ring) / static_cast<float>(rings);
    const Vec2f c = circle(static_cast<float>(segment) / static_cast<float>(segments));
    const float sine = std::sin(0.5F * pi * t);
    const float z = ring == rings ? 0.0F : std::cos(0.5F * pi * t);
    const Vec3f n(sine * c.x(), sine * c.y(), z);
    return MeshBuilder::Corner{n, n, Vec2f(0.5F + 0.4F * t * c.x(), 0.5F - 0.4F * t * c.y())};
  };
  for (int segment = 0; segment < segments; ++segment) {
    builder.triangle(corner(0, segment), corner(1, segment), corner(1, segment + 1));
    for (int ring = 1; ring < rings; ++ring) {
      builder.quad(corner(ring, segment), corner(ring + 1, segment), corner(ring + 1, segment + 1),
                   corner(ring, segment + 1));
    }
  }
  return builder.finish();
}

Mesh mirrored_pair(int n) {
  MeshBuilder builder;
  grid(builder, n, n, [](float s, float t) {
    return MeshBuilder::Corner{{s, t, 0.0F}, {0.0F, 0.0F, 1.0F}, {s, 1.0F - t}};
  });
  grid(builder, n, n, [](float s, float t) {
    return MeshBuilder::Corner{{s - 1.0F, t, 0.0F}, {0.0F, 0.0F, 1.0F}, {1.0F - s, 1.0F - t}};
  });
  return builder.finish();
}

}  // namespace normalshop::test
