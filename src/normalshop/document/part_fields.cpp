#include "normalshop/document/part_fields.h"

#include "normalshop/core/error.h"
#include "normalshop/document/option_values.h"

namespace normalshop {

namespace {

AtlasMask read_atlas_mask(const FieldReader& reader, const std::string& set, Assets& assets) {
  AtlasMask mask{set, reader.text(), nullptr};
  try {
    mask.image = std::make_shared<const MaskImage>(assets.mask(mask.file));
  } catch (const Error& e) {
    throw InvalidInput(reader.path() + ": " + e.what());
  }
  return mask;
}

std::vector<AtlasMask> read_masks(const FieldReader& reader, Assets& assets) {
  if (reader.value().text() != nullptr) return {read_atlas_mask(reader, "", assets)};
  const Value::Object* sets = reader.value().object();
  if (sets == nullptr || sets->empty()) {
    reader.fail("the name of a file, or an object with one for each of some texture sets");
  }
  std::vector<AtlasMask> masks;
  for (const auto& [set, file] : *sets) {
    masks.push_back(read_atlas_mask(reader.required(set), set, assets));
  }
  return masks;
}

void read_feather(const FieldReader& reader, SurfacePart& part) {
  for (const std::string_view name : {"feather", "feather_texels"}) {
    if (!reader.has(name)) continue;
    const FieldReader width = reader.required(name);
    if (part.masks.empty()) width.fail("left out where there is no \"mask\"");
    const bool texels = name == "feather_texels";
    if (texels && reader.has("feather")) width.fail("left out beside \"feather\"");
    (texels ? part.feather_texels : part.feather) = static_cast<float>(width.number(0.0, 1e6));
  }
}

}  // namespace

SurfacePart read_part(const FieldReader& reader, bool surface, Assets& assets) {
  if (!surface) reader.fail("left out where the view is not \"surface\"");
  const bool object = reader.value().object() != nullptr;
  if (!object || !(reader.has("charts_at") || reader.has("mask"))) {
    reader.fail("an object with \"charts_at\" or \"mask\"");
  }
  reader.only({"charts_at", "mask", "feather", "feather_texels"});
  SurfacePart part;
  if (reader.has("charts_at")) {
    const FieldReader points = reader.required("charts_at");
    for (const FieldReader& point : points.items()) part.charts_at.push_back(point.vec3());
    if (part.charts_at.empty()) points.fail("a list of at least one point [x, y, z]");
  }
  if (reader.has("mask")) part.masks = read_masks(reader.required("mask"), assets);
  read_feather(reader, part);
  return part;
}

Value part_value(const SurfacePart& part) {
  Value::Object fields;
  Value::Array points;
  for (const Vec3f& point : part.charts_at) points.emplace_back(vec3_value(point));
  if (!points.empty()) fields.emplace_back("charts_at", points);
  Value::Object sets;
  for (const AtlasMask& mask : part.masks) sets.emplace_back(mask.set, mask.file);
  const bool one = sets.size() == 1 && sets.front().first.empty();
  if (one) fields.emplace_back("mask", sets.front().second);
  if (!one && !sets.empty()) fields.emplace_back("mask", sets);
  if (part.feather > 0.0F) fields.emplace_back("feather", part.feather);
  if (part.feather_texels > 0.0F) fields.emplace_back("feather_texels", part.feather_texels);
  return fields;
}

}  // namespace normalshop
