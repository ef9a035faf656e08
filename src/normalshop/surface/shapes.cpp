#include "normalshop/surface/shapes.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

constexpr double pi = 3.14159265358979323846;

/// Axes of a face: its normal, and what is right and up in its chart.
struct Face {
  Eigen::Vector3i normal;
  Eigen::Vector3i right;
  Eigen::Vector3i up;
};

const std::array<Face, 6>& faces() {
  static const std::array<Face, 6> all{{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                        {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                        {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
                                        {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                        {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                        {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}}};
  return all;
}

class Builder {
 public:
  Builder(int cells, const std::string& name) : cells_(cells) { mesh_.texture_set_names = {name}; }

  void add(const Face& face, const ChartSquare& chart) {
    for (int j = 0; j < cells_; ++j) {
      for (int i = 0; i < cells_; ++i) {
        const std::array<Vec2i, 4> c{Vec2i(i, j), Vec2i(i + 1, j), Vec2i(i + 1, j + 1),
                                     Vec2i(i, j + 1)};
        // The diagonal points to the middle of the face, which keeps its triangles alike.
        const bool falling = (2 * i < cells_) != (2 * j < cells_);
        const int first = falling ? 1 : 0;
        for (const int k : {0, 2}) {
          for (const int corner : {first, first + k / 2 + 1, first + k / 2 + 2}) {
            add_corner(face, chart, c[static_cast<std::size_t>(corner % 4)]);
          }
        }
      }
    }
  }

  Mesh finish() {
    mesh_.texture_sets.assign(mesh_.triangles.size(), 0);
    return std::move(mesh_);
  }

 private:
  /// Exactly odd in its argument, so that faces agree on their shared edges.
  double coordinate(int i) const { return std::tan((2.0 * i - cells_) / cells_ * (pi / 4.0)); }

  void add_corner(const Face& face, const ChartSquare& chart, const Vec2i& at) {
    // Integer coordinates on the cube's surface name the vertex.
    const Eigen::Vector3i key =
        face.normal * cells_ + face.right * (2 * at.x() - cells_) + face.up * (2 * at.y() - cells_);
    const auto [found, is_new] =
        vertices_.try_emplace({key.x(), key.y(), key.z()}, mesh_.positions.size());
    if (is_new) mesh_.positions.push_back(direction(key));
    const std::uint32_t vertex = static_cast<std::uint32_t>(found->second);
    if (corner_ == 0) mesh_.triangles.emplace_back();
    mesh_.triangles.back()[corner_] = vertex;
    corner_ = (corner_ + 1) % 3;
    mesh_.normals.push_back(mesh_.positions[vertex]);
    mesh_.uvs.push_back(place(chart, at));
  }

  Vec3f direction(const Eigen::Vector3i& key) const {
    Vec3d p;
    for (Eigen::Index k = 0; k < 3; ++k) p[k] = coordinate((key[k] + cells_) / 2);
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (std::abs(key[k]) == cells_) p[k] = key[k] > 0 ? 1.0 : -1.0;
    }
    return p.normalized().cast<float>();
  }

  Vec2f place(const ChartSquare& chart, const Vec2i& at) const {
    const double x = (static_cast<double>(at.x()) / cells_ - 0.5) * chart.side;
    const double y = (static_cast<double>(at.y()) / cells_ - 0.5) * chart.side;
    const double c = std::cos(chart.degrees * pi / 180.0);
    const double s = std::sin(chart.degrees * pi / 180.0);
    return {static_cast<float>(chart.center.x() + c * x - s * y),
            static_cast<float>(chart.center.y() - s * x - c * y)};
  }

  int cells_;
  Eigen::Index corner_ = 0;
  std::map<std::tuple<int, int, int>, std::size_t> vertices_;
  Mesh mesh_;
};

}  // namespace

Mesh cube_sphere(int cells, const std::array<ChartSquare, 6>& charts, const std::string& name) {
  if (cells < 1 || cells > 2048) {
    throw InvalidInput("a cube sphere has 1 to 2048 cells a side, not " + std::to_string(cells));
  }
  Builder builder(cells, name);
  for (std::size_t f = 0; f < charts.size(); ++f) builder.add(faces()[f], charts[f]);
  return builder.finish();
}

}  // namespace normalshop
