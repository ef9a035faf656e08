#include "model_flags.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>

namespace normalshop::cli {

Argument ModelFlags::add(Verb& verb, const std::string& help) {
  const Argument model = verb.takes("model", options_.model, help);
  verb.takes("--normal-map", options_.normal_maps,
             "Normal map instead of the model's own: FILE, or SET=FILE with several sets");
  verb.takes("--albedo", options_.albedos, "Colour map, likewise");
  verb.takes("--space", space_, "Space of the normals (guessed unless given)")
      .one_of({"tangent", "object", "world"});
  verb.takes("--green", green_, "up: OpenGL, down: DirectX (guessed from the curl unless given)")
      .one_of({"up", "down"});
  verb.flag("--flip-v", options_.flip_v, "The model's V runs the other way than its format says");
  verb.takes("--size", options_.size, "Larger side of the normal map in texels").between(1, 16384);
  return model;
}

OpenOptions ModelFlags::options() const {
  OpenOptions out = options_;
  NormalSpace space{};
  if (!space_.empty() && from_name(space_, space)) out.space = space;
  if (!green_.empty()) out.green_down = green_ == "down";
  return out;
}

namespace {

std::optional<Vec3f> read_vector(const std::string& text) {
  Vec3f v;
  const char* at = text.data();
  const char* end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    const auto [next, error] = std::from_chars(at, end, v[i]);
    if (error != std::errc() || !(std::abs(v[i]) <= 1e9F)) return std::nullopt;
    if (i < 2 && (next == end || *next != ',')) return std::nullopt;
    if (i == 2 && next != end) return std::nullopt;
    at = next + 1;
  }
  return v;
}

}  // namespace

Vec3f parse_vector(const std::string& text, const std::string& flag) {
  if (const auto v = read_vector(text)) return *v;
  throw WrongUse(flag, "must be three numbers x,y,z up to 1e9, not \"" + text + "\"");
}

ViewSpec parse_view(const std::string& text) {
  NamedView name{};
  if (from_name(text, name)) return name;
  const auto direction = read_vector(text);
  if (direction && !direction->isZero()) {
    FreeView view;
    view.direction = *direction;
    return view;
  }
  throw WrongUse("--view",
                 "must be front, back, left, right, top, bottom or a direction "
                 "x,y,z towards the viewer, not \"" +
                     text + "\"");
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
}

}  // namespace normalshop::cli
