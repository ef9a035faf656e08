/// Texel maps, tangents, normals and topology of a head-sized mesh (17,000 triangles) and of its
/// subdivision to 1.1 million. The head itself is used when the real data is on the machine.

#include <array>
#include <cstdint>
#include <utility>

#include "support/data.h"
#include "support/gltf_corners.h"
#include "support/meshes.h"
#include <benchmark/benchmark.h>

#include "normalshop/core/normal_levels.h"
#include "normalshop/surface/geodesic.h"
#include "normalshop/surface/nearest_point.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/subdivide.h"
#include "normalshop/surface/tangents.h"
#include "normalshop/surface/texel_map.h"
#include "normalshop/surface/topology.h"
#include "normalshop/surface/unwrap.h"
#include "normalshop/surface/vertex_normals.h"

namespace normalshop {
namespace {

enum Model { Cube, Sphere, Head };

Mesh load(Model model) {
  switch (model) {
    case Cube:
      return test::cube(38);
    case Sphere:
      return test::uv_sphere(188, 47);
    case Head:
      break;
  }
  const auto file = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  return file ? test::load_gltf_corners(*file) : Mesh();
}

/// range(0): the model, range(1): how often it is subdivided.
const Mesh& mesh_of(benchmark::State& state) {
  static Mesh mesh;
  static std::pair<std::int64_t, std::int64_t> current(-1, -1);
  const std::pair<std::int64_t, std::int64_t> wanted(state.range(0), state.range(1));
  if (wanted != current) {
    mesh = subdivide(load(static_cast<Model>(wanted.first)), static_cast<int>(wanted.second));
    current = wanted;
  }
  if (mesh.triangles.empty()) state.SkipWithError("the head is not on this machine");
  state.counters["triangles"] = static_cast<double>(mesh.triangle_count());
  return mesh;
}

/// From one side of the model to the other; range(0), range(1): the model, see mesh_of().
void geodesic_path(benchmark::State& state) {
  const Mesh& mesh = mesh_of(state);
  if (mesh.triangles.empty()) return;
  const Topology topology = make_topology(mesh);
  const Bounds box = bounds(mesh);
  const std::array<SurfacePoint, 2> points = {nearest_surface_point(mesh, box.low),
                                              nearest_surface_point(mesh, box.high)};
  for (auto _ : state) {
    const SurfacePath path = geodesic(mesh, topology, points);
    benchmark::DoNotOptimize(path.points.data());
    state.counters["pieces"] = static_cast<double>(path.points.size());
  }
}

void texel_map(benchmark::State& state) {
  const Mesh& mesh = mesh_of(state);
  const auto size = static_cast<int>(state.range(2));
  const auto gutter = static_cast<int>(state.range(3));
  for (auto _ : state) {
    const TexelMap map(mesh, 0, size, size, gutter);
    state.counters["gutter_texels"] = static_cast<double>(map.gutter().size());
    benchmark::DoNotOptimize(map.owner().data());
  }
}
BENCHMARK(texel_map)
    ->ArgNames({"model", "subdivided", "size", "gutter"})
    ->ArgsProduct({{Cube, Sphere, Head}, {0, 3}, {4096}, {0, 8}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// One core: the frame of a point, a map's normal to object space and back.
void frames(benchmark::State& state) {
  Mesh mesh = test::uv_sphere(188, 47);
  compute_tangents(mesh);
  const Vec3f normal = Vec3f(0.2F, -0.1F, 1.0F).normalized();
  std::uint32_t triangle = 0;
  for (auto _ : state) {
    const TangentFrame frame = frame_at(mesh, {triangle, 0.3F, 0.4F}, NormalSpace::Tangent);
    benchmark::DoNotOptimize(frame.map_normal(frame.object_normal(normal)));
    if (++triangle == mesh.triangle_count()) triangle = 0;
  }
}
BENCHMARK(frames);

void topology(benchmark::State& state) {
  const Mesh& mesh = mesh_of(state);
  for (auto _ : state) benchmark::DoNotOptimize(make_topology(mesh));
}

void tangents(benchmark::State& state) {
  Mesh mesh = mesh_of(state);
  for (auto _ : state) {
    compute_tangents(mesh);
    benchmark::DoNotOptimize(mesh.tangents.data());
  }
}

void normals(benchmark::State& state) {
  Mesh mesh = mesh_of(state);
  for (auto _ : state) {
    compute_normals(mesh);
    benchmark::DoNotOptimize(mesh.normals.data());
  }
}

/// A new atlas for the whole mesh.
void unwrap_mesh(benchmark::State& state) {
  Mesh mesh = mesh_of(state);
  UnwrapReport report;
  for (auto _ : state) report = unwrap(mesh);
  state.counters["charts"] = static_cast<double>(report.charts);
  state.counters["coverage"] = report.coverage;
  state.counters["stretch"] = report.mean_stretch;
}
BENCHMARK(unwrap_mesh)
    ->ArgNames({"model", "subdivided"})
    ->ArgsProduct({{Cube, Head}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// All mip levels of an 8-bit map with moments, and those above one tile of it.
void normal_levels(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const NormalMap map = flat_normal_map(size, size, CodeType::U8);
  NormalLevels levels(map);
  for (auto _ : state) {
    levels.update(map, state.range(1) == 0 ? Rect{0, 0, size, size} : Rect{640, 640, 704, 704});
  }
  state.counters["bytes_a_texel"] = static_cast<double>(levels.size_bytes()) / size / size;
}
BENCHMARK(normal_levels)
    ->ArgNames({"size", "tile"})
    ->ArgsProduct({{4096, 4095}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"model", "subdivided"})
      ->ArgsProduct({{Sphere, Head}, {0, 3}})
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
}
BENCHMARK(topology)->Apply(sizes);
BENCHMARK(geodesic_path)->Apply(sizes);
BENCHMARK(tangents)->Apply(sizes);
BENCHMARK(normals)->Apply(sizes);

}  // namespace
}  // namespace normalshop

BENCHMARK_MAIN();
