#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "normalshop/document/value.h"

namespace normalshop {

/// What a layer does to the normals below it, where its opacity lets some of them through.
enum class LayerBlend {
  Linear,   ///< slopes are mixed
  Rotation  ///< normals turn, by a share of the angle
};
constexpr auto names_of(LayerBlend) {
  return std::array<std::string_view, 2>{"linear", "rotation"};
}

/// An edit in a layer.
struct StackEdit {
  std::int64_t id = 0;      ///< the step that made it; of copies see edit_text()
  std::int64_t recipe = 0;  ///< the step that holds its recipe: its own until it is changed
  bool enabled = true;
  bool operator==(const StackEdit&) const = default;
};

/// Edits, each made on what the one before left, and what of them is seen.
struct Layer {
  std::int64_t id = 0;  ///< the step that made it; first_layer is there from the beginning
  std::string name;
  float opacity = 1.0F;
  LayerBlend blend = LayerBlend::Linear;
  bool hidden = false;
  std::vector<StackEdit> edits;
  bool operator==(const Layer&) const = default;

  bool seen() const { return !hidden && opacity > 0.0F; }
  /// Does it show as its edits left it?
  bool plain() const { return !hidden && opacity == 1.0F; }
  /// That are enabled, by the steps that hold their recipes.
  std::vector<std::int64_t> recipes() const;
};

/// How people name an edit: "12", or "20.3" for the third that step 20, which duplicates a layer,
/// made.
std::string edit_text(std::int64_t edit);
std::optional<std::int64_t> edit_from_text(std::string_view text);

inline constexpr std::int64_t imported_layer = -1;  ///< what lies under all of them
inline constexpr std::int64_t first_layer = 0;

enum class StackStep {
  Edit,       ///< puts an edit on top of a layer
  Change,     ///< gives an edit another recipe
  Enable,     ///< lets an edit count again
  Disable,    ///< leaves an edit out
  AddLayer,   ///< an empty one
  SetLayer,   ///< name, opacity, blend, hidden
  MoveLayer,  ///< to another place
  Duplicate,  ///< a layer, into one of its own above it
  Merge,      ///< a layer into the one below it; both must be plain
  Remove      ///< a layer with its edits
};
constexpr auto names_of(StackStep) {
  return std::array<std::string_view, 10>{
      "edit",      "change",     "enable",          "disable",     "add layer",
      "set layer", "move layer", "duplicate layer", "merge layer", "remove layer"};
}

/// One step of a document's history, as a value.
struct StackChange {
  StackStep step = StackStep::Edit;
  std::int64_t target = first_layer;  ///< the layer, or of Change, Enable and Disable the edit
  std::optional<std::string> name = {};
  std::optional<float> opacity = {};
  std::optional<LayerBlend> blend = {};
  std::optional<bool> hidden = {};
  std::optional<int> place = {};  ///< among the layers from the bottom, of AddLayer and MoveLayer
};
/// What StackChange holds beside step and target.
Value details_of(const StackChange& change);
/// Throws InvalidInput naming the field.
void read_details(const Value& details, StackChange& change);

/// A document's layers from the bottom up: what its history comes to.
struct EditStack {
  EditStack();
  std::vector<Layer> layers;
  bool operator==(const EditStack&) const = default;

  /// Takes a step, which gets this id. Throws InvalidInput where it names what is not there, or
  /// what cannot be; the stack is unchanged then.
  void take(const StackChange& change, std::int64_t id);

  /// Takes the last StackStep::Edit back.
  void take_back_edit(const StackChange& change, std::int64_t id);

  /// Index of a layer. Throws InvalidInput, naming those that there are.
  std::size_t find(std::int64_t layer) const;
  /// The layer of an edit. Throws InvalidInput.
  std::size_t layer_of(std::int64_t edit) const;
  /// Is a layer seen as its edits leave it, with nothing above it?
  bool on_top(std::size_t layer) const;
  /// The topmost layer that is not hidden; the topmost of all where all are.
  std::int64_t default_layer() const;
};

/// The layers from the lowest on, for people and programs.
Value layers_value(const EditStack& stack);
/// Is what lies below a layer's place the same in both?
bool same_below(const EditStack& a, const EditStack& b, std::size_t layer);

}  // namespace normalshop
