#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/document/map_tiles.h"
#include "normalshop/document/store/database.h"

namespace normalshop {

/// A tile as an edit left it.
struct TileVersion {
  std::int64_t id = 0;
  PackedTile tile;
};

/// An edit as it is kept.
struct StoredEdit {
  std::int64_t id = 0;
  std::string operation;
  std::size_t texels_changed = 0;
};

/// The edits of a document with the tiles that they made, and where in them it is. Each edit knows
/// the one that it was made on, each version of a tile the one before: undo and redo cost what the
/// edit touched, whatever the length of the history.
///
/// What changes something belongs into a transaction of the caller.
class StoredHistory {
 public:
  using Edit = std::optional<std::int64_t>;  ///< none: the imported maps

  explicit StoredHistory(const Database& database) : database_(database) {}

  Edit position() const;
  Edit parent(std::int64_t edit) const;
  /// The youngest edit that was made on this one.
  Edit next(Edit edit) const;
  StoredEdit edit(std::int64_t id) const;

  /// Makes an edit at the position, and it the position. Returns its id.
  std::int64_t add(std::string_view operation, std::size_t texels, std::string_view packed_recipe,
                   const std::vector<TileChange>& changes) const;
  /// From the position to its parent, or to next(): the tiles that change, as they become.
  std::vector<PackedTile> step_back(std::int64_t from) const;
  std::vector<PackedTile> step_on(std::int64_t to) const;

  /// Each tile of the present state, or each version of each tile, with the edit that made it.
  using Visit = std::function<void(const TileVersion&, const Edit& edit)>;
  void visit_tiles(const Visit& visit) const;
  void visit_versions(const Visit& visit) const;

 private:
  void set_position(Edit edit) const;
  Edit present_version(const TilePlace& place) const;
  std::int64_t add_version(Edit edit, const TilePlace& place, Edit previous,
                           std::string_view bytes) const;
  void set_present(const TilePlace& place, Edit version) const;
  TilePlace place(const Statement& row, int column) const;
  std::string bytes_of(std::int64_t version) const;

  const Database& database_;
};

}  // namespace normalshop
