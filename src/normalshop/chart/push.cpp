#include "normalshop/chart/push.h"

#include "normalshop/chart/set_push.h"

namespace normalshop {

namespace {

/// Stores every texel at once.
struct DirectTarget {
  static constexpr auto facing = NormalEditor::Facing::Left;
  NormalMap& normals;
  void put(int x, int y, const TexelWrite& write) { normals.set_normal(x, y, write.value); }
};

}  // namespace

PushResult push(const Mesh& mesh, const EditingChart& chart, const ChartEdit& edit,
                StorageAtlas& storage) {
  const EditSampler sampler(chart, edit);
  PushTally tally;
  for (std::size_t i = 0; i < storage.sets.size(); ++i) {
    DirectTarget target{storage.sets[i].normals};
    SetPush set(mesh, sampler, storage.sets[i], static_cast<std::uint32_t>(i), target);
    tally.add(set.run());
  }
  return result_of(tally);
}

}  // namespace normalshop
