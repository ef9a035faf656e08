#include <algorithm>
#include <set>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/document/document_file.h"
#include "normalshop/document/store/document_state.h"
#include "normalshop/document/store/packing.h"

/// The history in a document's file.
namespace normalshop {

namespace {

std::string percent(float share) { return to_line(Value(100.0F * share)) + " %"; }

std::string settings(const StackChange& change) {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (change.name) add("name '" + *change.name + "'");
  if (change.opacity) add("opacity " + percent(*change.opacity));
  if (change.blend) add("blend " + std::string(name_of(*change.blend)));
  if (change.hidden) add(*change.hidden ? "hidden" : "shown");
  if (change.place) add("place " + std::to_string(*change.place));
  return text;
}

HistoryEntry entry_of(StoredStep step, bool undone) {
  return {
      step.id, step.parent, std::move(step.change), std::move(step.operation), step.texels_changed,
      undone};
}

}  // namespace

std::string sentence(const HistoryEntry& entry) {
  const StackChange& change = entry.change;
  const std::string layer = " layer " + std::to_string(change.target);
  const std::string all = settings(change);
  switch (change.step) {
    case StackStep::Edit:
      return entry.operation + (change.target == first_layer ? "" : " in" + layer);
    case StackStep::Change:
      return entry.operation + ": changes edit " + edit_text(change.target);
    case StackStep::Enable:
      return "enables edit " + edit_text(change.target);
    case StackStep::Disable:
      return "disables edit " + edit_text(change.target);
    case StackStep::AddLayer:
      return "adds layer " + std::to_string(entry.id) + (all.empty() ? "" : ": " + all);
    case StackStep::SetLayer:
      return "sets" + layer + ": " + all;
    case StackStep::MoveLayer:
      return "moves" + layer + ": " + all;
    case StackStep::Duplicate:
      return "duplicates" + layer + " as layer " + std::to_string(entry.id);
    case StackStep::Merge:
      return "merges" + layer + " into the one below";
    case StackStep::Remove:
      return "removes" + layer;
  }
  return {};
}

std::vector<HistoryEntry> DocumentFile::history() const {
  const StoredHistory& history = state_->history;
  const StoredHistory::Step position = history.position();
  std::vector<HistoryEntry> entries;
  for (StoredStep& step : history.path_to(position)) {
    entries.push_back(entry_of(std::move(step), false));
  }
  for (auto step = history.next(position); step; step = history.next(step)) {
    entries.push_back(entry_of(history.step(*step), true));
  }
  return entries;
}

std::vector<HistoryEntry> DocumentFile::all_steps() const {
  const StoredHistory& history = state_->history;
  std::set<std::int64_t> present;
  for (const StoredStep& step : history.path_to(history.position())) present.insert(step.id);
  std::vector<HistoryEntry> entries;
  for (StoredStep& step : history.all()) {
    const bool undone = !present.contains(step.id);
    entries.push_back(entry_of(std::move(step), undone));
  }
  return entries;
}

EditStack DocumentFile::fold(const std::vector<StoredStep>& path) const {
  EditStack stack;
  for (const StoredStep& step : path) {
    try {
      stack.take(step.change, step.id);
    } catch (const InvalidInput& error) {
      state_->database.fail("is damaged: its step " + std::to_string(step.id) + ": " +
                            error.what());
    }
  }
  return stack;
}

EditStack DocumentFile::stack() const {
  return fold(state_->history.path_to(state_->history.position()));
}

std::int64_t DocumentFile::next_step() const { return state_->history.next_id(); }

Value DocumentFile::recipe(std::int64_t step) const {
  constexpr std::size_t largest_recipe = std::size_t{256} << 20U;
  Statement row(state_->database, "SELECT recipe FROM steps WHERE id = ?");
  const std::string name = "its step " + std::to_string(step);
  if (!row.bind(1, step).step()) state_->database.fail("is damaged: " + name + " is missing");
  try {
    return parse_json(unpack(row.bytes(0), largest_recipe), name);
  } catch (const InvalidInput& error) {
    state_->database.fail("is damaged: " + name + " " + error.what());
  }
}

Value DocumentFile::edit(std::int64_t step) const {
  const Value one = recipe(step);
  const Value* list = one.find("edits");
  if (list == nullptr || list->array() == nullptr || list->array()->size() != 1) {
    state_->database.fail("is damaged: its step " + std::to_string(step) + " is no edit");
  }
  return list->array()->front();
}

Value DocumentFile::recipe() const {
  Value::Array edits;
  for (const Layer& layer : stack().layers) {
    if (layer.hidden) continue;
    for (const std::int64_t step : layer.recipes()) edits.push_back(edit(step));
  }
  return Value::Object{{"version", 1}, {"edits", std::move(edits)}};
}

std::vector<NamedFile> DocumentFile::files_of(std::int64_t step) const {
  Statement row(state_->database, "SELECT name, file FROM step_files WHERE step = ?");
  row.bind(1, step);
  std::vector<NamedFile> files;
  while (row.step()) {
    std::string name(row.bytes(0));
    auto bytes = std::make_shared<const std::string>(state_->files.read(row.integer(1), name));
    files.push_back({std::move(name), std::move(bytes)});
  }
  return files;
}

std::vector<PackedTile> DocumentFile::tiles() const {
  std::vector<PackedTile> tiles;
  state_->history.visit_tiles([&](const TileVersion& version, const StoredHistory::Step&) {
    tiles.push_back(version.tile);
  });
  return tiles;
}

std::vector<PackedTile> DocumentFile::tiles_at(const TilePlace& place) const {
  return state_->history.tiles_at(place);
}

std::vector<PackedTile> DocumentFile::tiles_after(std::int64_t step, std::int64_t layer) const {
  return state_->history.tiles_after(step, layer);
}

std::vector<std::int64_t> DocumentFile::color_layers(std::uint32_t set) const {
  Statement row(
      state_->database,
      "SELECT DISTINCT t.layer FROM tiles t JOIN tile_versions v ON v.id = t.version WHERE "
      "t.texture_set = ? AND t.attribute = ? AND t.layer <> ? AND v.bytes IS NOT NULL");
  row.bind(1, std::int64_t{set}).bind(2, name_of(Attribute::Colors)).bind(3, imported_layer);
  std::vector<std::int64_t> layers;
  while (row.step()) layers.push_back(row.integer(0));
  return layers;
}

std::optional<DocumentFile::Snapshot> DocumentFile::find_snapshot(const EditStack& wanted,
                                                                  std::size_t layer,
                                                                  std::size_t least) const {
  const std::int64_t id = wanted.layers[layer].id;
  const std::vector<std::int64_t> recipes = wanted.layers[layer].recipes();
  std::optional<Snapshot> best;
  EditStack stack;
  for (const StoredStep& step : state_->history.path_to(state_->history.position())) {
    stack.take(step.change, step.id);
    if (layer >= stack.layers.size() || stack.layers[layer].id != id) continue;
    const std::vector<std::int64_t> held = stack.layers[layer].recipes();
    const std::size_t count = held.size();
    if (count < std::max(best ? best->recipes : 0, least + 1) || count > recipes.size()) continue;
    if (held.back() != recipes[count - 1] || !same_below(stack, wanted, layer)) continue;
    if (std::equal(held.begin(), held.end(), recipes.begin())) best = Snapshot{step.id, count};
  }
  return best;
}

std::int64_t DocumentFile::add(const NewStep& step, const std::vector<TileChange>& changes) {
  const Database& database = state_->database;
  if (read_only()) database.fail("is write-protected");
  const Edit* edit = step.edit;
  const std::string recipe = edit != nullptr ? pack(to_json(to_value(Recipe{{*edit}}))) : "";
  const std::string operation = edit != nullptr ? std::string(edit->operation->name()) : "";
  Transaction transaction(database);
  const std::int64_t id =
      state_->history.add(step.change, operation, step.texels_changed, recipe, changes);
  if (edit != nullptr) {
    Statement row(database, "INSERT OR REPLACE INTO step_files(step, name, file) VALUES(?, ?, ?)");
    for (const NamedFile& file : edit->files) {
      row.bind(1, id).bind(2, std::string_view(file.name));
      row.bind(3, state_->files.add(*file.bytes)).run();
    }
  }
  transaction.commit();
  return id;
}

void DocumentFile::fail_at(const TilePlace& place, const char* what) const {
  state_->database.fail("is damaged: " + name_of_tile(place) + " " + what);
}

void DocumentFile::check_revealed(const HistoryMove& move, const TileCheck& check) const {
  const auto check_all = [&](const std::vector<PackedTile>& tiles) {
    for (const PackedTile& tile : tiles) {
      try {
        check(tile);
      } catch (const InvalidInput& error) {
        fail_at(tile.place, error.what());
      }
    }
  };
  if (move.restacked) return check_all(tiles());
  for (const TilePlace& place : move.places) check_all(tiles_at(place));
}

std::optional<HistoryMove> DocumentFile::undo(const TileCheck& check) {
  const StoredHistory::Step position = state_->history.position();
  if (!position) return std::nullopt;
  return walk(state_->history.parent(*position), check);
}

std::optional<HistoryMove> DocumentFile::redo(const TileCheck& check) {
  const StoredHistory::Step next = state_->history.next(state_->history.position());
  if (!next) return std::nullopt;
  return walk(*next, check);
}

HistoryMove DocumentFile::jump(std::optional<std::int64_t> step, const TileCheck& check) {
  if (step) {
    Statement row(state_->database, "SELECT 1 FROM steps WHERE id = ?");
    if (!row.bind(1, *step).step()) {
      throw InvalidInput("'" + path().string() + "' has no step " + std::to_string(*step) +
                         "; \"normalshop log --all\" lists them");
    }
  }
  return walk(step, check);
}

/// Back to where the ways part, and on from there.
HistoryMove DocumentFile::walk(std::optional<std::int64_t> to, const TileCheck& check) {
  const StoredHistory& history = state_->history;
  if (read_only()) state_->database.fail("is write-protected");
  Transaction transaction(state_->database);
  HistoryMove move;
  std::vector<std::int64_t> ahead;
  const auto note = [&](std::int64_t id, bool undone, const std::vector<PackedTile>& tiles) {
    for (const PackedTile& tile : tiles) move.places.push_back(tile.place);
    HistoryEntry entry = entry_of(history.step(id), undone);
    move.restacked = move.restacked || entry.change.step != StackStep::Edit;
    (undone ? move.back : move.on).push_back(std::move(entry));
  };
  StoredHistory::Step at = history.position();
  // Steps are older than those made on them.
  for (StoredHistory::Step goal = to; at != goal;) {
    if (at && (!goal || *at > *goal)) {
      note(*at, true, history.step_back(*at));
      at = history.position();
    } else {
      ahead.push_back(*goal);
      goal = history.parent(*goal);
    }
  }
  for (; !ahead.empty(); ahead.pop_back()) {
    note(ahead.back(), false, history.step_on(ahead.back()));
  }
  std::sort(move.places.begin(), move.places.end());
  move.places.erase(std::unique(move.places.begin(), move.places.end()), move.places.end());
  if (!move.on.empty()) fold(history.path_to(to));  // throws for steps that cannot be
  check_revealed(move, check);
  transaction.commit();
  return move;
}

}  // namespace normalshop
