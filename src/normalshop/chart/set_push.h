#pragma once

#include <mutex>
#include <vector>

#include "normalshop/chart/normal_editor.h"
#include "normalshop/chart/push_candidates.h"
#include "normalshop/chart/push_tally.h"
#include "normalshop/chart/shared_cursor.h"

/// How an edit of normals comes to the texels of one map, private to floor 4.
namespace normalshop {

/// The push into one texture set. Target: put(x, y, write) takes what a texel gets, with
/// write.facing as Target::facing says; different threads put into different tiles of
/// NormalMap::tile_size. It may store it in set.normals.
template <class Target>
class SetPush {
 public:
  SetPush(const Mesh& mesh, const EditSampler& sampler, const StorageSet& set, std::uint32_t index,
          Target& target)
      : editor_(mesh, sampler, set.texels, set.normals, Target::facing),
        target_(target),
        candidates_(mesh, sampler.reach(), index, set.normals.width(), set.normals.height()) {}
  PushTally run();

 private:
  PushTally edit_row(TexelLanes& row);
  PushTally put(const std::vector<TexelWrite>& writes);
  void put(const TexelWrite& write, PushTally& tally);

  NormalEditor editor_;
  Target& target_;
  PushCandidates candidates_;
  std::vector<TexelWrite> shared_;  // of texels that their owners leave to others
};

template <class Target>
PushTally SetPush<Target>::edit_row(TexelLanes& row) {
  PushTally tally;
  tally.visited = static_cast<std::size_t>(row.batch.count);
  if (!editor_.edit(row)) return tally;
  SharedCursor covered(editor_.texels().shared());
  for (int i = 0; i < row.batch.count; ++i) {
    const std::uint32_t index = row.texels[static_cast<std::size_t>(i)];
    if (!row.batch.acts(i) || holds_texel(shared_, index)) continue;
    const std::uint32_t owner = row.triangles[static_cast<std::size_t>(i)];
    put(editor_.write_of(row.batch, i, index, owner), tally);
    if (covered.holds(index)) ++tally.shared;
  }
  return tally;
}

template <class Target>
void SetPush<Target>::put(const TexelWrite& write, PushTally& tally) {
  const auto [x, y] = texel_place(write.texel, editor_.texels().width());
  target_.put(x, y, write);
  tally.largest = std::max(tally.largest, write.turn);
  ++tally.changed;
}

template <class Target>
PushTally SetPush<Target>::put(const std::vector<TexelWrite>& writes) {
  PushTally tally;
  for (const TexelWrite& w : writes) put(w, tally);
  return tally;
}

template <class Target>
PushTally SetPush<Target>::run() {
  // Before any texel changes: the gutter reads normals across its seams.
  const TexelMap& texels = editor_.texels();
  shared_ = editor_.shared_writes(texels.shared(), candidates_.wanted());
  const std::vector<TexelWrite> gutter =
      editor_.gutter_writes(texels.gutter(), candidates_.wanted());
  const std::vector<Rect> tiles = candidates_.tiles();
  PushTally tally;
  std::mutex mutex;
  parallel_for(tiles.size(), 1, [&](std::size_t begin, std::size_t end) {
    PushTally local;
    TexelRows rows(editor_.mesh(), editor_.sampler().grid(), texels, candidates_.wanted());
    for (std::size_t i = begin; i < end; ++i) {
      rows.visit(tiles[i], [&](TexelLanes& row) { local.add(edit_row(row)); });
    }
    const std::lock_guard lock(mutex);
    tally.add(local);
  });
  tally.add(put(shared_));
  tally.shared += shared_.size();
  tally.add(put(gutter));
  return tally;
}

}  // namespace normalshop
