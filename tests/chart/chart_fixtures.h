#pragma once

#include <functional>

#include "normalshop/chart/effective.h"
#include "normalshop/chart/push.h"
#include "normalshop/surface/mesh.h"

/// Storage atlases and edits for the tests of floor 4.
namespace normalshop::test {

/// A unit normal in chart axes or object space of a point in object space.
using NormalAt = std::function<Vec3f(const Vec3f& position)>;

/// uv_sphere() whose tangents are the sphere's own, equal on both sides of the seam.
Mesh smooth_sphere(int segments, int rings);

/// Codes of pseudo-random normals around the map's z, at most `tilt` away in x and y.
NormalMap noise_map(int size, CodeType type, std::uint32_t seed = 1, float tilt = 0.3F);

/// One texture set of that map, with texels of the mesh and a grey albedo.
StorageAtlas storage_of(const Mesh& mesh, NormalMap map);

/// Float map whose covered texels hold these object-space normals, in the given space.
StorageAtlas storage_of(const Mesh& mesh, int size, NormalSpace space, const NormalAt& normal);

/// Chart of the whole mesh seen from `direction`, about `side` pixels large, with its weight.
EditingChart chart_from(const Mesh& mesh, const StorageAtlas& storage, const Vec3f& direction,
                        int side, const EffectiveOptions& options = {});

/// Owns the pixels of an edit.
struct EditImages {
  SlopeImage change;
  MaskImage coverage;
  ChartEdit edit(const EditDirection& direction = EditMode::View) const;
};
/// The same change (and coverage, if above 0) everywhere in the chart.
EditImages constant_edit(const EditingChart& chart, const Vec2f& change, float coverage = 0.0F);

/// visit(x, y, surface point of the owner) for all covered texels of the first texture set.
void for_texels(const StorageAtlas& storage,
                const std::function<void(int, int, const SurfacePoint&)>& visit);

/// Object-space normal that a texel holds for its owner.
Vec3f stored_normal(const Mesh& mesh, const StorageAtlas& storage, int x, int y,
                    const SurfacePoint& point);

}  // namespace normalshop::test
