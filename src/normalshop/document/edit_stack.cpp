#include "normalshop/document/edit_stack.h"

#include <algorithm>
#include <charconv>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/document/field_reader.h"

namespace normalshop {

namespace {

constexpr int copy_bits = 32;

std::int64_t copied_edit(std::int64_t step, std::int64_t number) {
  return step << copy_bits | number;
}

std::string list_of(const std::vector<Layer>& layers) {
  std::string list;
  for (const Layer& layer : layers) {
    if (!list.empty()) list += ", ";
    list += std::to_string(layer.id) + " '" + layer.name + "'";
  }
  return list;
}

StackEdit& edit_in(std::vector<Layer>& layers, std::size_t layer, std::int64_t edit) {
  return *std::find_if(layers[layer].edits.begin(), layers[layer].edits.end(),
                       [&](const StackEdit& e) { return e.id == edit; });
}

std::vector<Layer>::iterator at(std::vector<Layer>& layers, std::size_t index) {
  return layers.begin() + static_cast<std::ptrdiff_t>(index);
}

void set(const StackChange& change, Layer& layer) {
  if (change.name) layer.name = *change.name;
  if (change.opacity) layer.opacity = *change.opacity;
  if (change.blend) layer.blend = *change.blend;
  if (change.hidden) layer.hidden = *change.hidden;
}

/// The topmost place unless another is given.
std::size_t place_of(const StackChange& change, std::size_t places) {
  if (!change.place) return places - 1;
  if (*change.place < 0 || static_cast<std::size_t>(*change.place) >= places) {
    throw InvalidInput("a layer's place must be from 0, the lowest, to " +
                       std::to_string(places - 1) + ", not " + std::to_string(*change.place));
  }
  return static_cast<std::size_t>(*change.place);
}

/// Files from elsewhere could double layers without end.
void check_room(const std::vector<Layer>& layers, const Layer& added) {
  constexpr std::size_t most_layers = 10'000;
  constexpr std::size_t most_edits = 1'000'000;
  std::size_t edits = added.edits.size();
  for (const Layer& layer : layers) edits += layer.edits.size();
  if (layers.size() >= most_layers || edits > most_edits) {
    throw InvalidInput("a document may have up to " + std::to_string(most_layers) + " layers and " +
                       std::to_string(most_edits) + " edits in them");
  }
}

void add_layer(const StackChange& change, std::int64_t id, std::vector<Layer>& layers) {
  Layer layer;
  layer.id = id;
  layer.name = "layer " + std::to_string(id);
  set(change, layer);
  check_room(layers, layer);
  layers.insert(at(layers, place_of(change, layers.size() + 1)), std::move(layer));
}

void move_layer(const StackChange& change, std::size_t index, std::vector<Layer>& layers) {
  const std::size_t place = place_of(change, layers.size());
  Layer layer = std::move(layers[index]);
  layers.erase(at(layers, index));
  layers.insert(at(layers, place), std::move(layer));
}

void duplicate(const StackChange& change, std::size_t index, std::int64_t id,
               std::vector<Layer>& layers) {
  Layer copy = layers[index];
  check_room(layers, copy);
  copy.id = id;
  copy.name += " copy";
  for (std::size_t i = 0; i < copy.edits.size(); ++i) {
    copy.edits[i].id = copied_edit(id, static_cast<std::int64_t>(i) + 1);
  }
  set(change, copy);
  layers.insert(at(layers, index + 1), std::move(copy));
}

void merge(std::size_t index, std::vector<Layer>& layers) {
  if (index == 0) {
    throw InvalidInput("layer '" + layers[0].name + "' is the lowest: there is none to merge into");
  }
  Layer& below = layers[index - 1];
  const Layer& above = layers[index];
  if (!above.plain() || !below.plain()) {
    throw InvalidInput("the layers '" + below.name + "' and '" + above.name +
                       "' must be shown at opacity 1 to be merged: their edits then come one after "
                       "the other");
  }
  below.edits.insert(below.edits.end(), above.edits.begin(), above.edits.end());
  layers.erase(at(layers, index));
}

void remove(std::size_t index, std::vector<Layer>& layers) {
  if (layers.size() == 1) {
    throw InvalidInput("layer '" + layers[0].name + "' is the only one: it can be hidden");
  }
  layers.erase(at(layers, index));
}

}  // namespace

std::string edit_text(std::int64_t edit) {
  const std::int64_t step = edit >> copy_bits;
  if (step == 0) return std::to_string(edit);
  return std::to_string(step) + "." + std::to_string(edit - (step << copy_bits));
}

std::optional<std::int64_t> edit_from_text(std::string_view text) {
  const auto number = [](std::string_view digits) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    return whole && value > 0 && value < std::int64_t{1} << 31 ? value : 0;
  };
  const std::size_t dot = text.find('.');
  const std::int64_t step = number(text.substr(0, dot));
  if (step == 0) return std::nullopt;
  if (dot == std::string_view::npos) return step;
  const std::int64_t copy = number(text.substr(dot + 1));
  if (copy == 0) return std::nullopt;
  return copied_edit(step, copy);
}

std::vector<std::int64_t> Layer::recipes() const {
  std::vector<std::int64_t> out;
  for (const StackEdit& edit : edits) {
    if (edit.enabled) out.push_back(edit.recipe);
  }
  return out;
}

EditStack::EditStack() {
  Layer first;
  first.id = first_layer;
  first.name = "first";
  layers.push_back(std::move(first));
}

std::size_t EditStack::find(std::int64_t layer) const {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (layers[i].id == layer) return i;
  }
  throw InvalidInput("there is no layer " + std::to_string(layer) + "; the layers are " +
                     list_of(layers));
}

std::size_t EditStack::layer_of(std::int64_t edit) const {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (const StackEdit& e : layers[i].edits) {
      if (e.id == edit) return i;
    }
  }
  throw InvalidInput("there is no edit " + edit_text(edit) + "; the log tells their numbers");
}

bool EditStack::on_top(std::size_t layer) const {
  if (!layers[layer].plain()) return false;
  return std::all_of(layers.begin() + static_cast<std::ptrdiff_t>(layer) + 1, layers.end(),
                     [](const Layer& above) { return above.recipes().empty(); });
}

std::int64_t EditStack::default_layer() const {
  for (std::size_t i = layers.size(); i-- > 0;) {
    if (!layers[i].hidden) return layers[i].id;
  }
  return layers.back().id;
}

void EditStack::take(const StackChange& change, std::int64_t id) {
  const std::int64_t target = change.target;
  switch (change.step) {
    case StackStep::Edit:
      layers[find(target)].edits.push_back({id, id, true});
      return;
    case StackStep::Change:
      edit_in(layers, layer_of(target), target).recipe = id;
      return;
    case StackStep::Enable:
    case StackStep::Disable:
      edit_in(layers, layer_of(target), target).enabled = change.step == StackStep::Enable;
      return;
    case StackStep::AddLayer:
      return add_layer(change, id, layers);
    case StackStep::SetLayer:
      return set(change, layers[find(target)]);
    case StackStep::MoveLayer:
      return move_layer(change, find(target), layers);
    case StackStep::Duplicate:
      return duplicate(change, find(target), id, layers);
    case StackStep::Merge:
      return merge(find(target), layers);
    case StackStep::Remove:
      return remove(find(target), layers);
  }
}

void EditStack::take_back_edit(const StackChange& change, std::int64_t id) {
  std::vector<StackEdit>& edits = layers[find(change.target)].edits;
  if (!edits.empty() && edits.back().id == id) edits.pop_back();
}

bool same_below(const EditStack& a, const EditStack& b, std::size_t layer) {
  const auto same = [](const Layer& p, const Layer& q) {
    return p.id == q.id && p.opacity == q.opacity && p.blend == q.blend && p.hidden == q.hidden &&
           p.recipes() == q.recipes();
  };
  const auto end = [&](const EditStack& s) {
    return s.layers.begin() + static_cast<std::ptrdiff_t>(std::min(layer, s.layers.size()));
  };
  return std::equal(a.layers.begin(), end(a), b.layers.begin(), end(b), same);
}

Value details_of(const StackChange& change) {
  Value::Object fields;
  if (change.name) fields.emplace_back("name", *change.name);
  if (change.opacity) fields.emplace_back("opacity", *change.opacity);
  if (change.blend) fields.emplace_back("blend", name_of(*change.blend));
  if (change.hidden) fields.emplace_back("hidden", *change.hidden);
  if (change.place) fields.emplace_back("place", *change.place);
  return fields;
}

void read_details(const Value& details, StackChange& change) {
  const FieldReader reader(details, "step");
  reader.only({"name", "opacity", "blend", "hidden", "place"});
  if (reader.has("name")) change.name = reader.required("name").text();
  if (reader.has("opacity")) {
    change.opacity = static_cast<float>(reader.required("opacity").number(0.0, 1.0));
  }
  if (reader.has("blend")) {
    constexpr auto names = names_of(LayerBlend{});
    const std::size_t index = reader.required("blend").one_of({names.begin(), names.end()});
    change.blend = static_cast<LayerBlend>(index);
  }
  if (reader.has("hidden")) change.hidden = reader.required("hidden").boolean();
  if (reader.has("place")) change.place = reader.required("place").whole_number(0, 1 << 20);
}

Value layers_value(const EditStack& stack) {
  Value::Array out;
  for (const Layer& layer : stack.layers) {
    out.push_back(Value::Object{{"id", static_cast<double>(layer.id)},
                                {"name", layer.name},
                                {"opacity", layer.opacity},
                                {"blend", name_of(layer.blend)},
                                {"hidden", layer.hidden},
                                {"edits", layer.edits.size()},
                                {"enabled edits", layer.recipes().size()}});
  }
  return out;
}

}  // namespace normalshop
