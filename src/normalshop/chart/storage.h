#pragma once

#include <vector>

#include "normalshop/core/color_map.h"
#include "normalshop/core/normal_map.h"
#include "normalshop/surface/texel_map.h"

namespace normalshop {

/// One texture set of the storage atlas. The maps may differ in size.
struct StorageSet {
  NormalMap normals;
  ColorMap albedo;
  TexelMap texels;  ///< of `normals`
  /// Of `albedo` where its size differs; empty until colours are pushed.
  TexelMap albedo_texels = {};
};

/// The storage atlas: one set per entry of Mesh::texture_set_names.
struct StorageAtlas {
  std::vector<StorageSet> sets;
};

}  // namespace normalshop
