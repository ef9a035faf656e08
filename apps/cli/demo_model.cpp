#include "demo_model.h"

#include <algorithm>
#include <cmath>

#include "demo_details.h"
#include "demo_shape.h"

#include "normalshop/core/color_map.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/core/parallel.h"
#include "normalshop/io/gltf_export.h"
#include "normalshop/io/image_file.h"
#include "normalshop/surface/frames.h"
#include "normalshop/surface/shapes.h"
#include "normalshop/surface/tangents.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop::demo {

namespace {

constexpr int gutter = 16;

/// As an artist packs it: the face large, the sides turned to fit, the back and the bottom small.
const std::array<ChartSquare, 6>& charts() {
  static const std::array<ChartSquare, 6> all{{{{0.172F, 0.821F}, 0.325F, 90.0F},
                                               {{0.508F, 0.821F}, 0.325F, -90.0F},
                                               {{0.834F, 0.828F}, 0.272F, 9.0F},
                                               {{0.812F, 0.163F}, 0.240F, 21.0F},
                                               {{0.322F, 0.322F}, 0.620F, 0.0F},
                                               {{0.812F, 0.476F}, 0.258F, -12.0F}}};
  return all;
}

/// One texel to compute: the surface point that it stands for, and whose frame decodes it.
struct Texel {
  SurfacePoint source;
  SurfacePoint owner;
  int x;
};

std::uint8_t srgb_code(float linear) {
  return static_cast<std::uint8_t>(
      std::lround(255.0F * std::clamp(linear_to_srgb(linear), 0.0F, 1.0F)));
}

std::uint16_t normal_code(float component) {
  return static_cast<std::uint16_t>(std::lround(32767.5F * (component + 1.0F)));
}

class MapPainter {
 public:
  MapPainter(const Mesh& mesh, int size)
      : mesh_(mesh),
        texels_(mesh, 0, size, size, gutter),
        color_(size, size, 3, CodeType::U8),
        normals_(size, size, 3, CodeType::U16) {}

  void paint() {
    const auto rows = static_cast<std::size_t>(texels_.height());
    parallel_for(rows, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y) paint_row(static_cast<int>(y));
    });
  }

  RawImage take_color() { return std::move(color_); }
  RawImage take_normals() { return std::move(normals_); }

 private:
  void paint_row(int y) {
    for (int x = 0; x < texels_.width(); ++x) {
      set(x, y, Vec3f::UnitZ(), {0.40F, 0.35F, 0.28F});
      const std::uint32_t triangle = texels_.owner()(x, y);
      if (triangle == no_triangle) continue;
      const SurfacePoint point = texels_.surface_point(triangle, x, y);
      paint_texel(x, y, point, point);
    }
    const auto width = static_cast<std::uint32_t>(texels_.width());
    const auto& all = texels_.gutter();
    const std::uint32_t first = static_cast<std::uint32_t>(y) * width;
    const auto by_texel = [](const GutterTexel& g, std::uint32_t t) { return g.texel < t; };
    auto at = std::lower_bound(all.begin(), all.end(), first, by_texel);
    for (; at != all.end() && at->texel < first + width; ++at) {
      paint_texel(static_cast<int>(at->texel - first), y, at->source,
                  {at->owner, at->owner_b1, at->owner_b2});
    }
  }

  void paint_texel(int x, int y, const SurfacePoint& source, const SurfacePoint& owner) {
    const Vec3f base = base_normal_at(mesh_, source);
    const Detail detail = detail_at(position_at(mesh_, source), base);
    const Vec3f slope = detail.gradient - detail.gradient.dot(base) * base;
    const Vec3f normal = (base - slope).normalized();
    set(x, y, frame_at(mesh_, owner, NormalSpace::Tangent).map_normal(normal), detail.color);
  }

  void set(int x, int y, const Vec3f& normal, const Vec3f& color) {
    std::uint16_t* n = normals_.row<std::uint16_t>(y) + 3 * x;
    std::uint8_t* c = color_.row<std::uint8_t>(y) + 3 * x;
    for (Eigen::Index k = 0; k < 3; ++k) {
      n[k] = normal_code(normal[k]);
      c[k] = srgb_code(color[k]);
    }
  }

  const Mesh& mesh_;
  TexelMap texels_;
  RawImage color_;
  RawImage normals_;
};

}  // namespace

Mesh make_demo_mesh(const DemoModelOptions& options) {
  Mesh mesh = cube_sphere(options.cells, charts(), "head");
  std::vector<Vec3f> normals(mesh.positions.size());
  parallel_for(mesh.positions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const HeadPoint point = head_point(mesh.positions[v]);
      mesh.positions[v] = point.position;
      normals[v] = point.normal;
    }
  });
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    mesh.normals[corner] =
        normals[mesh.triangles[corner / 3][static_cast<Eigen::Index>(corner % 3)]];
  }
  compute_tangents(mesh);
  return mesh;
}

DemoModel make_demo_model(const DemoModelOptions& options) {
  DemoModel model;
  model.mesh = make_demo_mesh(options);
  MapPainter painter(model.mesh, options.map_size);
  painter.paint();
  model.color = painter.take_color();
  model.normals = painter.take_normals();
  return model;
}

std::filesystem::path write_demo_model(const DemoModel& model,
                                       const std::filesystem::path& folder) {
  // Each is compressed by one thread.
  parallel_for(2, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      write_image(folder / (i == 0 ? "head_color.png" : "head_normal.png"),
                  i == 0 ? model.color : model.normals);
    }
  });
  Mesh mesh = model.mesh;
  mesh.tangents.clear();  // MikkTSpace gives them back to every reader
  export_gltf(folder / "head.gltf", mesh, {{"head", "head_color.png", "head_normal.png"}});
  return folder / "head.gltf";
}

}  // namespace normalshop::demo
