/// Building and pushing editing charts of a head, against Embree's orthographic rays in packets of
/// 16 on all cores followed by the same look-ups. The head itself is used when the real data is on
/// the machine, else a sphere of as many triangles. Prints medians; the ratio is peer / ours.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/meshes.h"
#include <embree3/rtcore.h>

#include "normalshop/chart/effective.h"
#include "normalshop/chart/pull.h"
#include "normalshop/chart/push.h"
#include "normalshop/core/options.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model.h"
#include "normalshop/surface/subdivide.h"
#include "normalshop/surface/tangents.h"

namespace normalshop {
namespace {

constexpr int chart_side = 2048;
constexpr int map_side = 4096;
constexpr int runs = 11;

struct Times {
  double median = 0.0;  // milliseconds
  double best = 0.0;
  double processor = 0.0;  // median, of all threads together: what a busy machine disturbs less
};

struct Lap {
  double wall = 0.0;
  double processor = 0.0;
  Lap operator+(const Lap& other) const { return {wall + other.wall, processor + other.processor}; }
};

Lap lap(const std::function<void()>& work) {
  const std::clock_t used = std::clock();
  const auto begin = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - begin;
  return {wall.count(), static_cast<double>(std::clock() - used) * 1e3 / CLOCKS_PER_SEC};
}

Times summary(const std::vector<Lap>& laps) {
  std::vector<double> wall;
  std::vector<double> processor;
  for (const Lap& l : laps) {
    wall.push_back(l.wall);
    processor.push_back(l.processor);
  }
  std::sort(wall.begin(), wall.end());
  std::sort(processor.begin(), processor.end());
  return {wall[wall.size() / 2], wall.front(), processor[wall.size() / 2]};
}

Times measure(const std::function<void()>& work) {
  work();
  std::vector<Lap> times;
  for (int i = 0; i < runs; ++i) times.push_back(lap(work));
  return summary(times);
}

void row(const char* what, const Times& t, const std::string& remark = {}) {
  std::printf("  %-34s %8.2f ms  (best %8.2f, processor %8.2f)  %s\n", what, t.median, t.best,
              t.processor, remark.c_str());
}

struct Scene {
  std::string name;
  Mesh mesh;
  StorageAtlas storage;
};

RawImage noise_codes(int channels) {
  RawImage codes(map_side, map_side, channels, CodeType::U8);
  for (int y = 0; y < map_side; ++y) {
    std::uint8_t* p = codes.row<std::uint8_t>(y);
    for (int x = 0; x < map_side; ++x, p += channels) {
      const std::uint32_t h = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 7);
      p[0] = static_cast<std::uint8_t>(112 + (h & 31U));
      p[1] = static_cast<std::uint8_t>(112 + ((h >> 8U) & 31U));
      p[2] = 250;
    }
  }
  return codes;
}

/// Nearest codes at another size: what the look-ups cost does not depend on how good they are.
RawImage enlarged(const RawImage& from) {
  RawImage to(map_side, map_side, from.channels(), CodeType::U8);
  for (int y = 0; y < map_side; ++y) {
    const std::uint8_t* in = from.row<std::uint8_t>(y * from.height() / map_side);
    std::uint8_t* out = to.row<std::uint8_t>(y);
    for (int x = 0; x < map_side; ++x) {
      std::memcpy(out + x * to.channels(), in + x * from.width() / map_side * from.channels(),
                  static_cast<std::size_t>(from.channels()));
    }
  }
  return to;
}

Scene load_scene() {
  Scene scene;
  StorageSet set;
  const auto model = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  const auto normals = test::data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg");
  const auto colors = test::data_file("lee_perry_smith/Map-COL.jpg");
  if (model && normals && colors) {
    scene.name = "head";
    ModelReadOptions options;
    options.flip_v = true;
    scene.mesh = read_model(*model, options).mesh;
    const NormalMap small(read_image(*normals), {});
    set.normals = resize(small, map_side, map_side, CodeType::U8);
    set.albedo = ColorMap(enlarged(read_image(*colors)));
  } else {
    scene.name = "sphere (the head is not on this machine)";
    scene.mesh = test::uv_sphere(188, 48);
    set.normals = NormalMap(noise_codes(3), {});
    set.albedo = ColorMap(noise_codes(3));
  }
  if (scene.mesh.tangents.empty()) compute_tangents(scene.mesh);
  scene.storage.sets.push_back(std::move(set));
  return scene;
}

ChartGrid front_grid(const Mesh& mesh) {
  View view = named_view(mesh, NamedView::Front);
  view.width = view.height = std::max(view.width, view.height);
  ChartGrid grid = make_grid(view, view.width / chart_side);
  grid.window = {-chart_side / 2, -chart_side / 2, chart_side / 2, chart_side / 2};
  return grid;
}

/// The peer: one orthographic ray a pixel.
class EmbreeRays {
 public:
  explicit EmbreeRays(const Mesh& mesh)
      : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(Vec3f), mesh.positions.size()));
    std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Vec3u),
                                mesh.triangles.size()));
    std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(Vec3u));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_NONE);
    rtcCommitScene(scene_);
  }
  EmbreeRays(const EmbreeRays&) = delete;
  EmbreeRays& operator=(const EmbreeRays&) = delete;
  ~EmbreeRays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void trace(const ChartGrid& grid, float nearest, IdBuffer& out) const {
    constexpr int tile = 64;
    out.triangle.resize(grid.width(), grid.height());
    out.depth.resize(grid.width(), grid.height());
    const int columns = (grid.width() + tile - 1) / tile;
    const int rows = (grid.height() + tile - 1) / tile;
    parallel_for(static_cast<std::size_t>(columns * rows), 1, [&](std::size_t a, std::size_t b) {
      for (std::size_t i = a; i < b; ++i) {
        const int x0 = static_cast<int>(i) % columns * tile;
        const int y0 = static_cast<int>(i) / columns * tile;
        for (int y = y0; y < std::min(y0 + tile, grid.height()); y += 4) {
          for (int x = x0; x < std::min(x0 + tile, grid.width()); x += 4) {
            packet(grid, nearest, x, y, out);
          }
        }
      }
    });
  }

 private:
  /// 4 x 4 pixels.
  void packet(const ChartGrid& grid, float nearest, int x, int y, IdBuffer& out) const {
    alignas(64) std::array<int, 16> valid;
    valid.fill(-1);
    RTCRayHit16 rays;
    const Vec3f d = -grid.view.direction;
    for (int k = 0; k < 16; ++k) {
      const Vec2f p = grid.to_units({static_cast<float>(x + k % 4), static_cast<float>(y + k / 4)});
      const Vec3f origin = grid.view.center + grid.view.to_object({p.x(), p.y(), nearest});
      rays.ray.org_x[k] = origin.x();
      rays.ray.org_y[k] = origin.y();
      rays.ray.org_z[k] = origin.z();
      rays.ray.dir_x[k] = d.x();
      rays.ray.dir_y[k] = d.y();
      rays.ray.dir_z[k] = d.z();
      rays.ray.tnear[k] = 0.0F;
      rays.ray.tfar[k] = std::numeric_limits<float>::infinity();
      rays.ray.time[k] = 0.0F;
      rays.ray.mask[k] = 0xFFFFFFFFU;
      rays.ray.flags[k] = 0;
      rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid.data(), scene_, &context, &rays);
    for (int k = 0; k < 16; ++k) {
      const bool hit = rays.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      out.triangle(x + k % 4, y + k / 4) = hit ? rays.hit.primID[k] : no_triangle;
      out.depth(x + k % 4, y + k / 4) =
          hit ? nearest - rays.ray.tfar[k] : -std::numeric_limits<float>::infinity();
    }
  }

  RTCDevice device_;
  RTCScene scene_;
};

double covered_share(const IdBuffer& ids) {
  const auto covered =
      static_cast<double>(ids.triangle.size()) -
      static_cast<double>(
          std::count(ids.triangle.data(), ids.triangle.data() + ids.triangle.size(), no_triangle));
  return covered / static_cast<double>(ids.triangle.size());
}

/// Share of pixels at which both found the same triangle, or the same depth within a pixel.
double agreement(const EditingChart& ours, const EditingChart& peer) {
  std::size_t same = 0;
  for (int y = 0; y < ours.grid.height(); ++y) {
    for (int x = 0; x < ours.grid.width(); ++x) {
      same += ours.ids.triangle(x, y) == peer.ids.triangle(x, y) ||
                      std::abs(ours.ids.depth(x, y) - peer.ids.depth(x, y)) < ours.grid.pixel
                  ? 1U
                  : 0U;
    }
  }
  return static_cast<double>(same) / static_cast<double>(ours.ids.triangle.size());
}

void bench_build(const Mesh& mesh, const StorageAtlas& storage) {
  // One look-up a pixel: the rays are compared with ours, not what is read where they end.
  const PullOptions options{.normals = true, .albedo = true, .means = false};
  const EffectiveOptions effective;
  EditingChart ours;
  EditingChart peer;
  ours.grid = peer.grid = front_grid(mesh);
  Rasterizer rasterizer;
  const EmbreeRays rays(mesh);
  const float nearest = 2.0F * bounds(mesh).diagonal();

  // The stages take turns, so that both sides see the same machine.
  std::vector<Lap> raster, trace, ours_total, peer_total, pulled, weighted;
  for (int i = 0; i <= runs; ++i) {
    const Lap r = lap([&] { rasterizer.rasterize(mesh, ours.grid, ours.ids); });
    const Lap p = lap([&] { pull_attributes(mesh, storage, ours, options); });
    const Lap w = lap([&] { compute_weight(ours, effective); });
    const Lap t = lap([&] { rays.trace(peer.grid, nearest, peer.ids); });
    const Lap look = lap([&] {
      pull_attributes(mesh, storage, peer, options);
      compute_weight(peer, effective);
    });
    if (i == 0) continue;  // fills buffers and caches
    raster.push_back(r);
    trace.push_back(t);
    pulled.push_back(p);
    weighted.push_back(w);
    ours_total.push_back(r + p + w);
    peer_total.push_back(t + look);
  }
  std::printf("  %.1f %% of the pixels see the surface; both agree on %.3f %%\n",
              100.0 * covered_share(ours.ids), 100.0 * agreement(ours, peer));
  row("ids and depth, ours", summary(raster));
  row("ids and depth, Embree", summary(trace),
      "x" + std::to_string(summary(trace).median / summary(raster).median));
  row("normals and albedo", summary(pulled));
  row("the same, means of texels",
      measure([&] { pull_attributes(mesh, storage, ours, {.normals = true, .albedo = true}); }));
  row("effective weight", summary(weighted));
  row("chart, ours", summary(ours_total));
  row("chart, Embree + same look-ups", summary(peer_total),
      "x" + std::to_string(summary(peer_total).median / summary(ours_total).median));
}

void bench_push(const Mesh& mesh, const StorageAtlas& storage, const EditDirection& direction) {
  EditingChart chart = pull(mesh, storage, front_grid(mesh), {.normals = false});
  compute_weight(chart, {});
  const SlopeImage change(chart.grid.width(), chart.grid.height(), Vec2f(0.02F, -0.01F));
  ChartEdit edit;
  edit.direction = direction;
  edit.change = change;
  edit.region = change.rect();
  PushResult result;
  StorageAtlas first = storage;
  const Times fresh = summary({lap([&] { push(mesh, chart, edit, first); })});
  const Times t = measure([&] { result = push(mesh, chart, edit, first); });
  const auto rate = [&](std::size_t texels, double ms) {
    return std::to_string(static_cast<double>(texels) / ms * 1e-3) + " M texels/s";
  };
  std::printf("  push, %s mode: %zu texels visited, %zu changed\n",
              std::string(name_of(direction.mode)).c_str(), result.visited, result.changed);
  row("push into an unedited map", fresh, rate(result.changed, fresh.median) + " changed");
  row("push again", t,
      rate(result.changed, t.median) + " changed, " + rate(result.visited, t.median) + " visited");
}

void bench(const std::string& name, const Mesh& mesh, StorageAtlas& storage) {
  std::printf("%s: %zu triangles, chart of %d x %d, maps of %d x %d, %d threads\n", name.c_str(),
              mesh.triangle_count(), chart_side, chart_side, map_side, map_side, thread_count());
  storage.sets[0].texels = TexelMap(mesh, 0, map_side, map_side);
  bench_build(mesh, storage);
  bench_push(mesh, storage, EditMode::View);
  bench_push(mesh, storage, EditMode::Base);
  bench_push(mesh, storage, EditDirection(Vec3f(0.3F, 0.2F, 0.9F)));
}

}  // namespace
}  // namespace normalshop

int main() {
  using namespace normalshop;
  Scene scene = load_scene();
  bench(scene.name, scene.mesh, scene.storage);
  scene.mesh = subdivide(scene.mesh, 3);
  bench(scene.name + ", subdivided", scene.mesh, scene.storage);
}
