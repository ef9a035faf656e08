/// Both transfers of the thesis and the updates of the atlas, compared on a head: time, what a
/// round trip without any edit does to the normals, texels that are lost, and how far seams open.
/// The head is used when the real data is on the machine, else a sphere of as many triangles.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/meshes.h"

#include "normalshop/chart/effective.h"
#include "normalshop/chart/point_pull.h"
#include "normalshop/chart/update_storage.h"
#include "normalshop/core/options.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/random.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/io/image_file.h"
#include "normalshop/io/model.h"
#include "normalshop/surface/seam_mismatch.h"
#include "normalshop/surface/tangents.h"

namespace normalshop {
namespace {

constexpr int map_side = 4096;

struct Scene {
  std::string name;
  Mesh mesh;
  StorageAtlas storage;
};

Scene load_scene() {
  Scene scene;
  StorageSet set;
  const auto model = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  const auto normals = test::data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg");
  if (model && normals) {
    scene.name = "head";
    ModelReadOptions options;
    options.flip_v = true;
    scene.mesh = read_model(*model, options).mesh;
    set.normals = resize(NormalMap(read_image(*normals), {}), map_side, map_side, CodeType::U8);
  } else {
    scene.name = "sphere (the head is not on this machine)";
    scene.mesh = test::uv_sphere(188, 48);
    RawImage codes(map_side, map_side, 3, CodeType::U8);
    for (int y = 0; y < map_side; ++y) {
      for (int x = 0; x < map_side; ++x) {
        std::uint8_t* p = codes.row<std::uint8_t>(y) + 3 * x;
        p[0] = static_cast<std::uint8_t>(128.0 + 30.0 * std::sin(0.05 * x));
        p[1] = static_cast<std::uint8_t>(128.0 + 30.0 * std::sin(0.04 * y));
        p[2] = 240;
      }
    }
    set.normals = NormalMap(std::move(codes), {});
  }
  if (scene.mesh.tangents.empty()) compute_tangents(scene.mesh);
  set.texels = TexelMap(scene.mesh, 0, map_side, map_side);
  scene.storage.sets.push_back(std::move(set));
  return scene;
}

/// Angles between the texels of two atlases that are edited in the second, in degrees.
struct RoundTrip {
  double mean = 0.0;
  double p99 = 0.0;
  std::size_t texels = 0;
};

RoundTrip round_trip(const StorageAtlas& before, const StorageAtlas& after) {
  std::vector<float> angles;
  const NormalMap& a = before.sets[0].normals;
  const NormalMap& b = after.sets[0].normals;
  double sum = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!b.edited(x, y)) continue;
      const float half = 0.5F * (a.normal(x, y) - b.normal(x, y)).norm();
      angles.push_back(2.0F * std::asin(std::min(half, 1.0F)) * 57.29578F);
      sum += static_cast<double>(angles.back());
    }
  }
  RoundTrip out;
  out.texels = angles.size();
  if (angles.empty()) return out;
  out.mean = sum / static_cast<double>(angles.size());
  const auto p99 = static_cast<std::ptrdiff_t>(angles.size() * 99 / 100);
  std::nth_element(angles.begin(), angles.begin() + p99, angles.end());
  out.p99 = static_cast<double>(angles[static_cast<std::size_t>(p99)]);
  return out;
}

ChartGrid grid_of(const Scene& scene, const Vec3f& direction, int side) {
  const View view = framing_view(scene.mesh, direction);
  return make_grid(view, std::max(view.width, view.height) / static_cast<float>(side));
}

void build(const Scene& scene, const ChartGrid& grid, Transfer transfer, Rasterizer& rasterizer,
           EditingChart& chart) {
  if (transfer == Transfer::Point) {
    pull_points(scene.mesh, scene.storage, grid, {}, chart);
  } else {
    pull(scene.mesh, scene.storage, grid, {}, rasterizer, chart);
  }
}

struct Times {
  double clock = 0.0;      // milliseconds, median
  double processor = 0.0;  // of all threads together: what a busy machine disturbs less
};

Times measure(int runs, const auto& work) {
  std::vector<double> wall;
  std::vector<double> processor;
  for (int i = 0; i < runs; ++i) {
    const std::clock_t used = std::clock();
    Stopwatch watch;
    work();
    wall.push_back(1e3 * watch.lap());
    processor.push_back(static_cast<double>(std::clock() - used) * 1e3 / CLOCKS_PER_SEC);
  }
  std::sort(wall.begin(), wall.end());
  std::sort(processor.begin(), processor.end());
  return {wall[wall.size() / 2], processor[processor.size() / 2]};
}

PushResult update(const Scene& scene, EditingChart& chart, const ChartEdit& edit, Update how,
                  StorageAtlas& storage) {
  if (how == Update::Gather) {
    return push(scene.mesh, chart, edit, storage);
  }
  if (chart.texel.empty()) find_texels(scene.mesh, storage, chart);
  return update_storage(scene.mesh, chart, edit, how, storage);
}

/// How far both sides of the seams differ before an edit.
struct SeamState {
  std::vector<SeamSample> samples;
  std::vector<float> angles;

  explicit SeamState(const Scene& scene) {
    const std::vector<const NormalMap*> maps{&scene.storage.sets[0].normals};
    samples = sample_seams(scene.mesh, find_seams(scene.mesh).edges, maps);
    angles = seam_angles(scene.mesh, samples, maps);
  }
  SeamMismatch growth(const Scene& scene, const StorageAtlas& storage) const {
    const std::vector<const NormalMap*> maps{&storage.sets[0].normals};
    return mismatch_growth(angles, seam_angles(scene.mesh, samples, maps),
                           edited_samples(scene.mesh, samples, maps));
  }
};

/// One row of the table.
void compare_update(const Scene& scene, const SeamState& seams, Transfer transfer, Update how,
                    const Times& chart_time, EditingChart& chart) {
  const SlopeImage none(chart.grid.width(), chart.grid.height(), Vec2f::Zero());
  const SlopeImage some(chart.grid.width(), chart.grid.height(), Vec2f(0.1F, -0.05F));
  ChartEdit edit;
  edit.change = none;
  edit.region = none.rect();
  StorageAtlas storage = scene.storage;
  update(scene, chart, edit, how, storage);
  const RoundTrip error = round_trip(scene.storage, storage);
  const std::size_t lost =
      how == Update::Gather ? 0 : lost_texels(scene.mesh, chart, edit.region, storage);
  // A real edit, and then once more with a clock, so that no first copies are timed.
  edit.change = some;
  storage = scene.storage;
  const std::size_t written = update(scene, chart, edit, how, storage).changed;
  const SeamMismatch growth = seams.growth(scene, storage);
  const Times time = measure(3, [&] {
    if (transfer == Transfer::Triangle) chart.texel = {};
    update(scene, chart, edit, how, storage);
  });
  std::printf("| %s | %s | %.0f / %.0f | %.0f / %.0f | %.2f | %.2f | %.2f | %.2f | %.2f | %.1f |\n",
              std::string(name_of(transfer)).c_str(), std::string(name_of(how)).c_str(),
              chart_time.clock, chart_time.processor, time.clock, time.processor,
              1e-6 * static_cast<double>(written), 1e-6 * static_cast<double>(lost), error.mean,
              error.p99, growth.mean, growth.p99);
}

void compare(const Scene& scene, int side) {
  const ChartGrid grid = grid_of(scene, Vec3f::UnitZ(), side);
  std::printf("%s, maps of %d x %d: charts of %d x %d, %d threads\n", scene.name.c_str(), map_side,
              map_side, grid.width(), grid.height(), thread_count());
  std::printf(
      "| transfer | update | chart, ms | update, ms | written, M | lost, M | error | p99 | ");
  std::printf("seams | p99 |\n");
  const SeamState seams(scene);
  const EffectiveOptions effective = effective_on(bounds(scene.mesh).diagonal());
  for (const Transfer transfer : {Transfer::Triangle, Transfer::Point}) {
    EditingChart chart;
    Rasterizer rasterizer;
    const Times time = measure(3, [&] { build(scene, grid, transfer, rasterizer, chart); });
    compute_weight(chart, effective);
    for (const Update how : {Update::Gather, Update::Point, Update::Area}) {
      compare_update(scene, seams, transfer, how, time, chart);
    }
  }
}

/// No-op edits from random views leave every texel as it is.
void repeat_nothing(const Scene& scene, Update how, int edits) {
  StorageAtlas storage = scene.storage;
  Random random(1);
  for (int i = 0; i < edits; ++i) {
    const float turn = random.uniform(0.0F, 6.2831853F);
    const float height = random.uniform(-1.0F, 1.0F);
    const float wide = std::sqrt(1.0F - height * height);
    const Vec3f direction(wide * std::sin(turn), height, wide * std::cos(turn));
    const ChartGrid grid = grid_of(scene, direction, 2048);
    EditingChart chart = pull(scene.mesh, storage, grid);
    compute_weight(chart, {});
    const SlopeImage none(grid.width(), grid.height(), Vec2f::Zero());
    ChartEdit edit;
    edit.change = none;
    edit.region = none.rect();
    update(scene, chart, edit, how, storage);
  }
  const RoundTrip error = round_trip(scene.storage, storage);
  std::printf("%d edits that change nothing, %s: %zu texels written, mean %.3f degrees, p99 %.3f\n",
              edits, std::string(name_of(how)).c_str(), error.texels, error.mean, error.p99);
}

/// A plane whose every texel is seen: 16 million of them.
void bench_plane() {
  Scene scene{"plane", test::plane_grid(8), {}};
  StorageSet set;
  set.normals = flat_normal_map(map_side, map_side, CodeType::U8);
  set.texels = TexelMap(scene.mesh, 0, map_side, map_side);
  scene.storage.sets.push_back(std::move(set));
  const View view = make_view(Vec3f::UnitZ(), Vec3f::UnitY(), Vec3f(0.5F, 0.5F, 0.0F), 1.0F, 1.0F);
  for (const float texels : {1.0F, 1.3F}) {
    const ChartGrid grid = make_grid(view, texels / static_cast<float>(map_side));
    EditingChart chart;
    Rasterizer rasterizer;
    for (const Transfer transfer : {Transfer::Point, Transfer::Triangle}) {
      const Times t = measure(3, [&] { build(scene, grid, transfer, rasterizer, chart); });
      std::printf("plane, 16.8 million texels, chart of %d x %d: %s %.0f ms (processor %.0f)\n",
                  grid.width(), grid.height(), std::string(name_of(transfer)).c_str(), t.clock,
                  t.processor);
    }
  }
}

}  // namespace
}  // namespace normalshop

int main() {
  using namespace normalshop;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  bench_plane();
  const Scene scene = load_scene();
  for (const int side : {2048, 4096, 8190}) compare(scene, side);
  repeat_nothing(scene, Update::Gather, 100);
  repeat_nothing(scene, Update::Point, 20);
  repeat_nothing(scene, Update::Area, 20);
}
