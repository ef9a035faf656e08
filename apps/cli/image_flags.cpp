#include "image_flags.h"

#include "normalshop/core/options.h"

namespace normalshop::cli {

std::optional<CodeType> code_type(const std::string& bits) {
  CodeType type{};
  return !bits.empty() && from_name(bits, type) ? std::optional(type) : std::nullopt;
}

std::optional<float> read_roughness(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::optional<double> value = read_number(text);
  if (value && *value >= 0.0 && *value <= 1.0) return static_cast<float>(*value);
  throw WrongUse("--roughness", "must be a number from 0 to 1, not \"" + text + "\"");
}

void ImageFlags::add(Verb& verb) {
  verb.takes("--mask", files.mask, "Grey picture: where edits arrive (everywhere unless given)");
  verb.takes("--edges", edges,
             "What lies beyond the picture: clamp (its border goes on, unless given), mirror, wrap "
             "(it is a tile)")
      .one_of({"clamp", "mirror", "wrap"});
}

void ImageFlags::add_green(Verb& verb) {
  verb.takes("--green", green, "up: OpenGL, down: DirectX (guessed from the curl unless given)")
      .one_of({"up", "down"});
}

void ImageFlags::add_bits(Verb& verb) {
  verb.takes("--bits", bits, "Bits a channel of the written normals (the input's unless given)")
      .one_of({"8", "16", "32"});
}

OpenImageOptions ImageFlags::open() const {
  OpenImageOptions out = files;
  if (!edges.empty()) from_name(edges, out.border);
  if (!green.empty()) out.green_down = green == "down";
  return out;
}

}  // namespace normalshop::cli
