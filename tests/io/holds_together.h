#pragma once

#include <algorithm>

#include "normalshop/io/model.h"

namespace normalshop::test {

/// Lists of one length, numbers that are finite, and indices that exist.
inline bool holds_together(const Model& model) {
  const Mesh& mesh = model.mesh;
  const std::size_t triangles = mesh.triangles.size();
  const auto finite = [](const auto& v) { return v.allFinite(); };
  const bool lengths = triangles > 0 && mesh.uvs.size() == 3 * triangles &&
                       mesh.normals.size() == 3 * triangles &&
                       mesh.texture_sets.size() == triangles &&
                       (mesh.tangents.empty() || mesh.tangents.size() == 3 * triangles) &&
                       mesh.texture_set_names.size() == model.texture_sets.size();
  const bool indices =
      std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                  [&](const Vec3u& t) { return t.maxCoeff() < mesh.positions.size(); }) &&
      std::all_of(mesh.texture_sets.begin(), mesh.texture_sets.end(),
                  [&](std::uint32_t set) { return set < model.texture_sets.size(); });
  return lengths && indices && std::all_of(mesh.positions.begin(), mesh.positions.end(), finite) &&
         std::all_of(mesh.uvs.begin(), mesh.uvs.end(), finite) &&
         std::all_of(mesh.normals.begin(), mesh.normals.end(), finite) &&
         std::all_of(mesh.tangents.begin(), mesh.tangents.end(), finite);
}

}  // namespace normalshop::test
