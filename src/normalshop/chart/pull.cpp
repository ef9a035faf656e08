#include "normalshop/chart/pull.h"

#include <algorithm>

#include "normalshop/chart/footprint.h"
#include "normalshop/core/normal_codes.h"
#include "normalshop/core/parallel.h"
#include "normalshop/core/sample.h"

namespace normalshop {

namespace {

/// Charts are pulled in squares of this side, which read a small part of the atlas each.
constexpr int pull_block = PixelRow::capacity;

/// The pull of one chart: the work of one task.
class Pull {
 public:
  Pull(const Mesh& mesh, const StorageAtlas& storage, const PullOptions& options,
       EditingChart& chart)
      : mesh_(mesh),
        storage_(storage),
        options_(options),
        chart_(chart),
        triangles_(mesh, chart.grid),
        footprints_(mesh, storage, triangles_) {
    for (const StorageSet& set : storage.sets) sizes_.push_back(sizes_of(set, options));
  }

  void fill(const Rect& rect) {
    for (int y = rect.y0 - 4; y < rect.y0; ++y) look_ahead(rect, y);
    for (int y = rect.y0; y < rect.y1; ++y) {
      look_ahead(rect, y);
      if (visible(y).count > 0) {
        interpolate(y, rect.x0, rect.width());
        fill_row(y, rect.x0, rect.width());
      } else {
        clear_row(y, rect.x0, rect.width());
      }
    }
  }

 private:
  struct VisibleRow {
    std::array<PixelRun, PixelRow::capacity> runs;
    std::size_t count = 0;
  };
  /// Pixels side by side that read one texture set.
  struct Run {
    int begin;
    int end;
    std::uint32_t texture_set;
    std::uint32_t node;  ///< of object-space normals
  };
  /// Sizes of a texture set's maps; 0 where none is read.
  struct MapSizes {
    Vec2f normals = Vec2f::Zero();
    Vec2f albedo = Vec2f::Zero();
  };
  static MapSizes sizes_of(const StorageSet& set, const PullOptions& options);

  VisibleRow& visible(int y) { return visible_[static_cast<std::size_t>(y) % visible_.size()]; }
  void find_visible(int y, int x0, int count);
  void look_ahead(const Rect& rect, int y);
  void interpolate(int y, int x0, int count);
  void note_minified(const PixelTriangle& triangle, const PixelRun& pixels);
  void fill_row(int y, int x0, int count);
  void clear_row(int y, int x0, int count);
  void read_maps(const Run& run);
  void turn_stored(const Run& run);
  void find_texels_ahead(const Run& run);
  std::pair<const float*, const float*> places(const Run& run, const RawImage& codes);
  void fetch(const RawImage& codes, const Run& run) const;
  Vec3f irregular_detail(std::size_t i) const;

  const Mesh& mesh_;
  const StorageAtlas& storage_;
  const PullOptions& options_;
  EditingChart& chart_;
  TriangleCache<PixelTriangle> triangles_;
  std::array<VisibleRow, 8> visible_;  // of the next rows
  std::vector<float> single_u_;
  std::vector<float> single_v_;
  PixelRow row_;
  std::array<float, PixelRow::capacity> u_before_{};  // of the row above
  std::array<float, PixelRow::capacity> v_before_{};
  std::array<float, PixelRow::capacity> u_ahead_{};
  std::array<float, PixelRow::capacity> v_ahead_{};
  std::array<Run, PixelRow::capacity> runs_;
  std::size_t run_count_ = 0;
  FootprintReader footprints_;
  std::vector<MapSizes> sizes_;
  std::array<PixelRun, PixelRow::capacity> minified_;
  std::size_t minified_count_ = 0;
};

Pull::MapSizes Pull::sizes_of(const StorageSet& set, const PullOptions& options) {
  MapSizes sizes;
  if (options.means && options.normals) sizes.normals = size_in_texels(set.normals.codes());
  if (options.means && options.albedo) sizes.albedo = size_in_texels(set.albedo.codes());
  return sizes;
}

void Pull::find_visible(int y, int x0, int count) {
  const std::uint32_t* ids = chart_.ids.triangle.row(y) + x0;
  VisibleRow& row = visible(y);
  row.count = 0;
  for (int x = 0; x < count;) {
    const int begin = x;
    const std::uint32_t id = ids[begin];
    while (x < count && ids[x] == id) ++x;
    if (id != no_triangle) row.runs[row.count++] = {begin, x, id};
  }
}

/// Has the triangles of the rows 2 and 4 below y fetched.
void Pull::look_ahead(const Rect& rect, int y) {
  if (y + 4 < rect.y1) {
    find_visible(y + 4, rect.x0, rect.width());
    const VisibleRow& row = visible(y + 4);
    for (std::size_t i = 0; i < row.count; ++i)
      triangles_.announce_attributes(row.runs[i].triangle);
  }
  if (y + 2 < rect.y0 || y + 2 >= rect.y1) return;
  const VisibleRow& row = visible(y + 2);
  for (std::size_t i = 0; i < row.count; ++i) triangles_.announce_positions(row.runs[i].triangle);
}

/// Interpolates the row and divides it by what it reads.
void Pull::interpolate(int y, int x0, int count) {
  const std::uint32_t* ids = chart_.ids.triangle.row(y) + x0;
  for (int x = 0; x < count; ++x) {
    row_.seen[static_cast<std::size_t>(x)] = ids[x] == no_triangle ? 0.0F : 1.0F;
  }
  run_count_ = 0;
  minified_count_ = 0;
  const VisibleRow& row = visible(y);
  for (std::size_t i = 0; i < row.count; ++i) {
    const auto& [begin, end, id] = row.runs[i];
    const PixelTriangle& triangle = triangles_.get(id);
    interpolate_run(triangle, x0, y, begin, end, row_);
    note_minified(triangle, row.runs[i]);
    Run* last = run_count_ > 0 ? &runs_[run_count_ - 1] : nullptr;
    const std::uint32_t node = mesh_.nodes.empty() ? 0 : mesh_.nodes[id];
    if (last != nullptr && last->end == begin && last->node == node &&
        last->texture_set == triangle.texture_set) {
      last->end = end;
    } else {
      runs_[run_count_++] = {begin, end, triangle.texture_set, node};
    }
  }
}

void Pull::note_minified(const PixelTriangle& triangle, const PixelRun& pixels) {
  if (sizes_.empty()) return;
  const MapSizes& sizes = sizes_[triangle.texture_set];
  if (!is_minified(triangle, sizes.normals.cwiseMax(sizes.albedo))) return;
  minified_[minified_count_++] = pixels;
}

void Pull::clear_row(int y, int x0, int count) {
  const Vec3f zero = Vec3f::Zero();
  std::fill_n(chart_.base_normal.row(y) + x0, count, zero);
  if (options_.normals) std::fill_n(chart_.normal.row(y) + x0, count, zero);
  if (options_.albedo) std::fill_n(chart_.albedo.row(y) + x0, count, zero);
}

void Pull::fill_row(int y, int x0, int count) {
  finish_base_normals(count, chart_.grid.view, row_);
  std::copy_n(row_.base_normals.data(), count, chart_.base_normal.row(y) + x0);
  for (std::size_t i = 0; i < run_count_; ++i) read_maps(runs_[i]);
  const std::span<const PixelRun> minified(minified_.data(), minified_count_);
  if (options_.normals) footprints_.normals(minified, x0, y, row_.stored);
  if (options_.albedo) footprints_.colors(minified, x0, y, row_.color);
  for (std::size_t i = 0; i < run_count_; ++i) turn_stored(runs_[i]);
  if (options_.albedo) {
    finish_colors(count, row_);
    std::copy_n(row_.colors.data(), count, chart_.albedo.row(y) + x0);
  }
  if (!options_.normals) return;
  finish_details(count, row_);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    if (row_.regular[i] == 0.0F) row_.details[i] = irregular_detail(i);
  }
  std::copy_n(row_.details.data(), count, chart_.normal.row(y) + x0);
}

/// Where the pixels some rows below will read, if the maps go on as they came.
void Pull::find_texels_ahead(const Run& run) {
  constexpr float rows = 3.0F;
  constexpr float farthest = 0.01F;  // from row to row: else they are another chart's
  for (auto i = static_cast<std::size_t>(run.begin); i < static_cast<std::size_t>(run.end); ++i) {
    const auto ahead = [&](float now, float& before) {
      const float step = now - before;
      before = now;
      const float there = now + rows * step;
      return std::abs(step) < farthest && there >= 0.0F && there < 1.0F ? there : 0.0F;
    };
    u_ahead_[i] = ahead(row_.u[i], u_before_[i]);
    v_ahead_[i] = ahead(row_.v[i], v_before_[i]);
  }
}

void Pull::fetch(const RawImage& codes, const Run& run) const {
  if (codes.empty()) return;
  const auto width = static_cast<float>(codes.width());
  const auto height = static_cast<float>(codes.height());
  const std::size_t bytes = codes.row_bytes() / static_cast<std::size_t>(codes.width());
  for (auto i = static_cast<std::size_t>(run.begin); i < static_cast<std::size_t>(run.end); ++i) {
    const auto x = static_cast<std::size_t>(u_ahead_[i] * width);
    const auto y = static_cast<std::size_t>(v_ahead_[i] * height);
    prefetch(codes.data() + y * codes.row_bytes() + x * bytes);
  }
}

/// u and v of a run, off the opposite border where the map does not repeat.
std::pair<const float*, const float*> Pull::places(const Run& run, const RawImage& codes) {
  const auto begin = static_cast<std::size_t>(run.begin);
  if (mesh_.repeats(run.texture_set) || codes.empty()) return {&row_.u[begin], &row_.v[begin]};
  const auto count = static_cast<std::size_t>(run.end - run.begin);
  single_u_.resize(std::max(single_u_.size(), count + sample_padding));
  single_v_.resize(single_u_.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2f place =
        reading_place(mesh_, run.texture_set, {row_.u[begin + i], row_.v[begin + i]}, codes.width(),
                      codes.height());
    single_u_[i] = place.x();
    single_v_[i] = place.y();
  }
  return {single_u_.data(), single_v_.data()};
}

void Pull::read_maps(const Run& run) {
  if (!options_.albedo && !options_.normals) return;
  const StorageSet& set = storage_.sets[run.texture_set];
  find_texels_ahead(run);
  if (options_.albedo) fetch(set.albedo.codes(), run);
  if (options_.normals) fetch(set.normals.codes(), run);
  const auto begin = static_cast<std::size_t>(run.begin);
  const int count = run.end - run.begin;
  if (options_.albedo) {
    const auto [u, v] = places(run, set.albedo.codes());
    set.albedo.sample(u, v, count, &row_.color.x[begin], &row_.color.y[begin],
                      &row_.color.z[begin]);
  }
  if (!options_.normals) return;
  const auto [u, v] = places(run, set.normals.codes());
  set.normals.sample(u, v, count, &row_.stored.x[begin], &row_.stored.y[begin],
                     &row_.stored.z[begin]);
}

/// Normals that are in no tangent space go into chart axes.
void Pull::turn_stored(const Run& run) {
  if (!options_.normals) return;
  const NormalSpace space = storage_.sets[run.texture_set].normals.convention().space;
  if (space == NormalSpace::Tangent) return;
  const bool in_node = space == NormalSpace::Object && !mesh_.nodes.empty();
  const Mat3f node = in_node ? mesh_.node_normals[run.node] : Mat3f(Mat3f::Identity());
  for (auto i = static_cast<std::size_t>(run.begin); i < static_cast<std::size_t>(run.end); ++i) {
    const Vec3f stored(row_.stored.x[i], row_.stored.y[i], row_.stored.z[i]);
    const Vec3f n = chart_.grid.view.to_chart(node * codes::direction_of(stored)).normalized();
    row_.stored.x[i] = n.x();
    row_.stored.y[i] = n.y();
    row_.stored.z[i] = n.z();
    row_.sign[i] = 0.0F;
  }
}

/// Where tangents say nothing any frame will do; where the map says nothing, the base normal.
Vec3f Pull::irregular_detail(std::size_t i) const {
  const Vec3f n(row_.normal.x[i], row_.normal.y[i], row_.normal.z[i]);
  const Vec3f stored(row_.stored.x[i], row_.stored.y[i], row_.stored.z[i]);
  const Vec3f direction = codes::direction_of(stored);
  if (direction.isZero() || row_.sign[i] == 0.0F) return row_.base_normals[i];
  return (any_frame(n.cast<double>()) * direction).normalized();
}

}  // namespace

void pull_attributes(const Mesh& mesh, const StorageAtlas& storage, EditingChart& chart,
                     const PullOptions& options) {
  const int width = chart.grid.width();
  const int height = chart.grid.height();
  chart.base_normal.resize(width, height);
  chart.normal.resize(options.normals ? width : 0, options.normals ? height : 0);
  chart.albedo.resize(options.albedo ? width : 0, options.albedo ? height : 0);
  const int columns = (width + pull_block - 1) / pull_block;
  const int rows = (height + pull_block - 1) / pull_block;
  const auto fill = [&](std::size_t begin, std::size_t end) {
    Pull pull(mesh, storage, options, chart);
    for (std::size_t i = begin; i < end; ++i) {
      const int x = static_cast<int>(i) % columns * pull_block;
      const int y = static_cast<int>(i) / columns * pull_block;
      pull.fill(intersect({x, y, x + pull_block, y + pull_block}, chart.ids.triangle.rect()));
    }
  };
  parallel_for(static_cast<std::size_t>(columns * rows), 16, fill);
}

void pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
          const PullOptions& options, Rasterizer& rasterizer, EditingChart& chart) {
  chart.grid = grid;
  rasterizer.rasterize(mesh, grid, chart.ids);
  pull_attributes(mesh, storage, chart, options);
}

EditingChart pull(const Mesh& mesh, const StorageAtlas& storage, const ChartGrid& grid,
                  const PullOptions& options) {
  EditingChart chart;
  Rasterizer rasterizer;
  pull(mesh, storage, grid, options, rasterizer, chart);
  return chart;
}

}  // namespace normalshop
