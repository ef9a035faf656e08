#include "image_flags.h"

#include "normalshop/core/options.h"

namespace normalshop::cli {

std::optional<CodeType> code_type(const std::string& bits) {
  CodeType type{};
  return !bits.empty() && from_name(bits, type) ? std::optional(type) : std::nullopt;
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
