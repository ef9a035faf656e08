/// A Gaussian over all of a head at once, from the views that cover it: how far it is from the same
/// with twice as many views, from a dense reference (every texel filtered in a view of its own that
/// faces it), how well both sides of the seams agree, and what filtering the atlas as a picture
/// gives instead. Without the real data a sphere with noise takes the head's place.

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/meshes.h"

#include "normalshop/core/for_pixels.h"
#include "normalshop/core/random.h"
#include "normalshop/core/stopwatch.h"
#include "normalshop/document/prepare_edit.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/open_document.h"
#include "normalshop/rgbn/smooth.h"
#include "normalshop/surface/seam_mismatch.h"
#include "normalshop/surface/texel_density.h"

namespace normalshop {
namespace {

constexpr int references = 1500;
constexpr float sigma_texels = 5.0F;

Document load() {
  const auto model = test::data_file("lee_perry_smith/LeePerrySmith.glb");
  const auto map = test::data_file("lee_perry_smith/Infinite-Level_02_Tangent_SmoothUV.jpg");
  if (model && map) {
    OpenOptions options;
    options.model = *model;
    options.normal_maps = {map->string()};
    options.flip_v = true;
    return open_document(options).document;
  }
  std::printf("the head is not on this machine: a sphere\n");
  NormalMap normals = flat_normal_map(1024, 1024, CodeType::U16);
  Random random(1);
  for (int y = 0; y < 1024; ++y) {
    for (int x = 0; x < 1024; ++x) {
      normals.set_normal(
          x, y, normal_from_slope(Vec2f(random.uniform(-0.3F, 0.3F), random.uniform(-0.3F, 0.3F))));
    }
  }
  std::vector<Document::Maps> maps;
  maps.push_back({NormalMap(normals.encode(), normals.convention()), {}});
  return {test::uv_sphere(188, 48), std::move(maps)};
}

Edit smooth_edit(float sigma, const std::string& view) {
  FileAssets assets(".");
  return parse_recipe(
             R"({"version": 1, "edits": [{"operator": "smooth", "mode": "base", "view": )" + view +
                 R"(, "options": {"sigma": )" + std::to_string(sigma) + "}}]}",
             "smooth", assets)
      .edits.at(0);
}

struct Angles {
  double mean = 0.0;
  double p50 = 0.0;
  double p99 = 0.0;
};

Angles summary(std::vector<float> degrees) {
  if (degrees.empty()) return {};
  std::sort(degrees.begin(), degrees.end());
  double sum = 0.0;
  for (const float d : degrees) sum += static_cast<double>(d);
  const std::size_t count = degrees.size();
  return {sum / static_cast<double>(count), static_cast<double>(degrees[count / 2]),
          static_cast<double>(degrees[count * 99 / 100])};
}

const StorageSet& set_of(const Document& document) { return document.storage().sets[0]; }

Vec3f object_normal(const Document& document, const SurfacePoint& p, int x, int y) {
  const NormalMap& map = set_of(document).normals;
  return frame_at(document.mesh(), p, map.convention().space).object_normal(map.normal(x, y));
}

/// visit(x, y, surface point) for all covered texels.
template <class Visit>
void for_texels(const Document& document, const Visit& visit) {
  const TexelMap& texels = set_of(document).texels;
  for (int y = 0; y < texels.height(); ++y) {
    for (int x = 0; x < texels.width(); ++x) {
      const std::uint32_t owner = texels.owner()(x, y);
      if (owner != no_triangle) visit(x, y, texels.surface_point(owner, x, y));
    }
  }
}

Angles difference(const Document& a, const Document& b) {
  std::vector<float> degrees;
  for_texels(a, [&](int x, int y, const SurfacePoint& p) {
    degrees.push_back(
        static_cast<float>(angle_degrees(object_normal(a, p, x, y), object_normal(b, p, x, y))));
  });
  return summary(std::move(degrees));
}

/// A texel filtered in a view of its own.
struct Reference {
  int x;
  int y;
  SurfacePoint point;
  Vec3f normal;  ///< object space
};

/// The middle of a chart whose view faces the texel; false where that is hidden, or a depth step
/// near.
bool filter_alone(const Document& before, const Edit& edit, float sigma, Reference& texel) {
  const Mesh& mesh = before.mesh();
  const View view = make_view(base_normal_at(mesh, texel.point), Vec3f::UnitY(),
                              position_at(mesh, texel.point), 12.0F * sigma, 12.0F * sigma);
  const PreparedEdit prepared = prepare_edit(edit, view, mesh, before.storage());
  const Vec2f middle = prepared.chart.grid.to_pixel({0.0F, 0.0F});
  const auto x = static_cast<int>(middle.x());
  const auto y = static_cast<int>(middle.y());
  const float depth = prepared.chart.ids.depth(x, y);
  if (prepared.chart.weight(x, y) < 0.99F || std::abs(depth) > 0.1F * sigma) return false;
  const float fx = middle.x() - static_cast<float>(x);
  const float fy = middle.y() - static_cast<float>(y);
  Vec2f change(0.0F, 0.0F);
  float coverage = 0.0F;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const float weight = (i == 0 ? 1.0F - fx : fx) * (j == 0 ? 1.0F - fy : fy);
      change += weight * prepared.result.change(x + i, y + j);
      if (prepared.replaces) coverage += weight * prepared.result.coverage(x + i, y + j);
    }
  }
  const Vec3f own = view.to_chart(object_normal(before, texel.point, texel.x, texel.y));
  const Vec2f gradient = gradient_from_normal(own, Vec3f::UnitZ(), EditMode::Base);
  texel.normal = view.to_object(
      normal_from_gradient((1.0F - coverage) * gradient + change, Vec3f::UnitZ(), EditMode::Base));
  return true;
}

std::vector<Reference> dense_reference(const Document& before, const Edit& edit, float sigma) {
  std::vector<Reference> texels;
  for_texels(before, [&](int x, int y, const SurfacePoint& p) {
    texels.push_back({x, y, p, Vec3f::Zero()});
  });
  std::vector<Reference> out;
  for (std::size_t i = 0; i < references; ++i) {
    Reference texel = texels[i * (texels.size() / references)];
    if (filter_alone(before, edit, sigma, texel)) out.push_back(texel);
  }
  return out;
}

Angles difference(const Document& document, const std::vector<Reference>& reference) {
  std::vector<float> degrees;
  for (const Reference& r : reference) {
    const Vec3f own = object_normal(document, r.point, r.x, r.y);
    degrees.push_back(static_cast<float>(angle_degrees(own, r.normal)));
  }
  return summary(std::move(degrees));
}

/// The atlas filtered as if it were a picture: chart by chart, each in frames of its own.
Document filter_atlas(const Document& before) {
  const NormalMap& map = set_of(before).normals;
  SlopeImage slopes(map.width(), map.height());
  MaskImage covered(map.width(), map.height());
  for_pixels(slopes.rect(), [&](int x, int y) {
    slopes(x, y) = slope_from_normal(map.normal(x, y));
    covered(x, y) = set_of(before).texels.owner()(x, y) == no_triangle ? 0.0F : 1.0F;
  });
  SlopeImage filtered(map.width(), map.height());
  SmoothOptions options;
  options.sigma = sigma_texels;
  smooth(slopes, covered, filtered, slopes.rect(), options);
  NormalMap result = map;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      result.set_normal(x, y, normal_from_slope(filtered(x, y)));
    }
  }
  std::vector<Document::Maps> maps;
  maps.push_back({std::move(result), {}});
  return {before.mesh(), std::move(maps)};
}

SeamMismatch seams_of(const Document& document) {
  const std::vector<const NormalMap*> maps{&set_of(document).normals};
  return measure_seams(document.mesh(), document.seams(), maps);
}

void row(const char* what, const Document& document, const std::vector<Reference>& reference) {
  const Angles to_reference = difference(document, reference);
  const SeamMismatch seams = seams_of(document);
  std::printf("  %-28s %8.3f %8.3f %8.3f   %8.3f %8.3f %8.3f\n", what, to_reference.mean,
              to_reference.p50, to_reference.p99, seams.mean, seams.p50, seams.p99);
}

void compare() {
  const Document before = load();
  const NormalMap& map = set_of(before).normals;
  const auto texel =
      static_cast<float>(texel_density(before.mesh(), 0, map.width(), map.height()).area_median);
  const float sigma = sigma_texels * texel;
  Document once = before;
  Stopwatch watch;
  const EditReport report = once.apply(smooth_edit(sigma, R"("surface")"));
  const double seconds = watch.lap();
  Document twice = before;
  twice.apply(
      smooth_edit(sigma, R"({"surface": {"views": )" + std::to_string(2 * report.views) + "}}"));
  const std::vector<Reference> reference =
      dense_reference(before, smooth_edit(sigma, R"("front")"), sigma);
  std::printf("%d x %d texels, sigma %.4f (%.0f texels), %d views, largest %d x %d, %.2f s\n",
              map.width(), map.height(), static_cast<double>(sigma),
              static_cast<double>(sigma_texels), report.views, report.chart_width,
              report.chart_height, seconds);
  const Angles views = difference(once, twice);
  const Angles changed = difference(once, before);
  std::printf(
      "the filter turns texels by %.3f degrees (mean); twice as many views: %.3f (mean), "
      "%.3f (99 %%)\n",
      changed.mean, views.mean, views.p99);
  std::printf(
      "degrees to %zu texels of the dense reference: mean, median, 99 %%; at the seams: mean, "
      "median, 99 %%\n",
      reference.size());
  row("not filtered", before, reference);
  row("whole surface", once, reference);
  row("twice as many views", twice, reference);
  row("the atlas as a picture", filter_atlas(before), reference);
}

}  // namespace
}  // namespace normalshop

int main() { normalshop::compare(); }
