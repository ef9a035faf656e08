#pragma once

#include "normalshop/rgbn/domain_transform.h"

/// The distances of the domain transform, private to this floor.
namespace normalshop {

/// Shapes a plane of numbers. Its rows are a multiple of domain_lanes long, and a bit further
/// apart: in a plane whose rows are a power of two apart the pixels of a column would share few
/// lines of the cache. What is beyond `width` is set to 0.
void shape_plane(Image<float>& plane, int width, int height);

/// How much of a pixel's left (across) and upper (down) neighbour goes on in it.
struct DomainWeights {
  Image<float> across;
  Image<float> down;
};

/// Fills `weights` with those of the first of `iterations`, from the guide's normals and colours;
/// nothing passes from or to a pixel whose validity is 0.
void set_weights(const RgbnView& guide, MaskView validity, const DomainTransformOptions& options,
                 int iterations, DomainWeights& weights);

}  // namespace normalshop
