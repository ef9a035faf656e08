#include "normalshop/surface/mesh.h"

namespace normalshop {

Bounds bounds(const Mesh& mesh) {
  Bounds b;
  for (std::size_t corner = 0; corner < mesh.corner_count(); ++corner) {
    b.low = b.low.cwiseMin(mesh.position(corner));
    b.high = b.high.cwiseMax(mesh.position(corner));
  }
  return b;
}

}  // namespace normalshop
