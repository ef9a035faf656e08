/// Dabs of a pen's stroke while it is drawn on a head: operator, push and the list of dirty tiles,
/// for brushes that reach 120,000 and 7,400 texels, small and large atlases, few and many
/// triangles. The peer is the same dab as an edit of its own. Without the real data a sphere takes
/// the head's place.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/meshes.h"

#include "normalshop/chart/resolution.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/live_edit.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/model.h"
#include "normalshop/surface/subdivide.h"

namespace normalshop {
namespace {

constexpr int dabs = 50;
constexpr float window_texels = 2400.0F;  // of the view, at most the model's

Mesh load_mesh() {
  const auto model = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  if (!model) {
    std::printf("the head is not on this machine: a sphere\n");
    return test::uv_sphere(188, 48);
  }
  ModelReadOptions options;
  options.flip_v = true;
  return read_model(*model, options).mesh;
}

Document document_of(const Mesh& mesh, int side) {
  std::vector<Document::Maps> maps;
  maps.push_back({flat_normal_map(side, side, CodeType::U8), {}});
  return {mesh, std::move(maps)};
}

struct Pen {
  Edit edit;
  float width;  ///< object units
  float view_width;
};

/// In a front view of so many texels, as wide as so many.
Pen make_pen(const Document& document, float width_texels) {
  const View view = named_view(document.mesh(), NamedView::Front);
  const Vec2f half(0.25F * view.width, 0.25F * view.height);
  const float texel = texel_pixel_size(document.mesh(), document.storage(), view, -half, half);
  const float extent = std::min(window_texels * texel, std::max(view.width, view.height));
  FileAssets assets(".");
  const auto number = [](float v) { return std::to_string(v); };
  const std::string json =
      R"({"version": 1, "edits": [{"operator": "pen", "view": {"direction": [0, 0, 1], "center": [)" +
      number(view.center.x()) + ", " + number(view.center.y()) + ", " + number(view.center.z()) +
      R"(], "width": )" + number(extent) + R"(}, "options": {"profile": "bump", "width": )" +
      number(width_texels * texel) + R"(, "height": )" + number(0.05F * width_texels * texel) +
      R"(}, "strokes": [[[0, 0]]]}]})";
  return {parse_recipe(json, "pen", assets).edits.at(0), width_texels * texel, extent};
}

/// Points a tenth of the brush apart on a figure of eight in the middle of the view.
UnitStroke figure_of_eight(float view_width, float brush) {
  UnitStroke stroke;
  const float size = 0.5F * view_width - 0.6F * brush;
  float t = 0.0F;
  for (int i = 0; i < dabs; ++i) {
    stroke.push_back({Vec2f(0.5F * size * std::sin(t), 0.4F * size * std::sin(2.0F * t))});
    const float speed = 0.5F * size * std::hypot(std::cos(t), std::cos(2.0F * t));
    t += 0.1F * brush / std::max(speed, 0.1F * size);
  }
  return stroke;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

/// How many texels a dab in the middle of the view changes.
std::size_t reached(Document& document, const Pen& pen) {
  Edit dab = pen.edit;
  dab.strokes = {{{Vec2f(0.0F, 0.0F)}}};
  return document.apply(dab).pushed.changed;
}

/// A pen whose dab reaches about so many texels.
Pen pen_of_reach(Document& document, double texels) {
  double width = std::sqrt(texels);
  for (int i = 0; i < 3; ++i) {
    const Pen pen = make_pen(document, static_cast<float>(width));
    width *= std::sqrt(texels / static_cast<double>(reached(document, pen)));
  }
  return make_pen(document, static_cast<float>(width));
}

void bench(Document& document, const char* name, double texels) {
  auto pen_and_size = pen_of_reach(document, texels);
  const float brush = pen_and_size.width;
  const float view_width = pen_and_size.view_width;
  Edit& pen = pen_and_size.edit;
  pen.strokes.clear();
  Stopwatch watch;
  const auto live = document.begin(pen);
  const double begin = 1e3 * watch.lap();
  const UnitStroke stroke = figure_of_eight(view_width, brush);
  std::vector<double> times;
  std::vector<UnitStroke> drawn(1);
  double first = 0.0;
  std::size_t tiles = 0;
  for (const UnitPoint& p : stroke) {
    drawn[0].push_back(p);
    watch.lap();
    tiles += live->draw(drawn).size();
    const double ms = 1e3 * watch.lap();
    if (drawn[0].size() == 1) first = ms;
    if (drawn[0].size() > 1) times.push_back(ms);
  }
  const int chart = live->grid().width();
  const EditReport report = live->finish();
  const double end = 1e3 * watch.lap();
  std::vector<double> sorted = times;
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> peer;
  std::size_t changed = 0;
  for (int i = 0; i < 3; ++i) {
    watch.lap();
    changed = reached(document, pen_and_size);
    peer.push_back(1e3 * watch.lap());
  }
  const double count = dabs;
  std::printf(
      "  %-12s %7zu texels a dab, %4.0f of %4d pixels: median %6.2f ms, 99 %% %6.2f, first %6.1f, "
      "begin %6.1f, end "
      "%6.1f "
      "(operator %5.2f, push %5.2f, tiles %4.1f); as an edit %7.1f ms, x%.0f\n",
      name, changed, static_cast<double>(brush / report.pixel), chart, median(times),
      sorted[sorted.size() * 99 / 100], first, begin, end, 1e3 * report.times.operate / count,
      1e3 * report.times.push / count, static_cast<double>(tiles) / count, median(peer),
      median(peer) / median(times));
}

void bench_all(const Mesh& mesh) {
  std::printf("%zu triangles, %d threads\n", mesh.triangle_count(), thread_count());
  for (const int side : {2048, 4096, 8192}) {
    Document document = document_of(mesh, side);
    const std::string name = std::to_string(side) + "^2, ";
    bench(document, (name + "large").c_str(), 120e3);
    bench(document, (name + "small").c_str(), 7.4e3);
  }
}

}  // namespace
}  // namespace normalshop

int main() {
  using namespace normalshop;
  const Mesh mesh = load_mesh();
  bench_all(mesh);
  bench_all(subdivide(mesh, 3));
}
