#include "normalshop/io/model_info.h"

#include <algorithm>

#include "normalshop/io/image_file.h"
#include "normalshop/io/open_document.h"
#include "normalshop/surface/seams.h"
#include "normalshop/surface/texel_density.h"

namespace normalshop {

namespace {

Value guess_value(const ConventionGuess& guess) {
  return Value::Object{{"sentence", guess.sentence},
                       {"space", name_of(guess.convention.space)},
                       {"space_confidence", guess.space_confidence},
                       {"green", guess.convention.green_down ? "down" : "up"},
                       {"green_confidence", guess.green_confidence},
                       {"two_channel", guess.convention.two_channel},
                       {"lengths", Value::Object{{"mean", guess.lengths.mean},
                                                 {"least", guess.lengths.min},
                                                 {"largest", guess.lengths.max}}}};
}

Value image_info(const std::filesystem::path& file) {
  const RawImage codes = read_image(file);
  Value::Object out{{"image", file.filename().string()},
                    {"size", Value::Array{codes.width(), codes.height()}},
                    {"channels", codes.channels()},
                    {"bits", name_of(codes.type())}};
  const bool normals = codes.channels() >= 3 && looks_like_normal_map(codes);
  out.emplace_back("normal map", normals);
  if (normals) out.emplace_back("guessed", guess_value(guess_convention(codes)));
  return out;
}

Value set_info(const OpenedDocument& opened, const Seams& seams, std::size_t i) {
  const Mesh& mesh = opened.document.mesh();
  const StorageSet& stored = opened.document.storage().sets[i];
  const OpenedSet& info = opened.sets[i];
  const auto index = static_cast<std::uint32_t>(i);
  std::vector<std::uint32_t> charts;
  std::size_t triangles = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.texture_sets[t] != index) continue;
    ++triangles;
    if (seams.chart[t] != no_chart) charts.push_back(seams.chart[t]);
  }
  std::sort(charts.begin(), charts.end());
  charts.erase(std::unique(charts.begin(), charts.end()), charts.end());
  const TexelUse use = texel_use(stored.texels);
  const TexelDensity density =
      texel_density(mesh, index, stored.normals.width(), stored.normals.height());
  Value::Object out{{"name", opened.model.texture_sets[i].name},
                    {"normal map", info.normal_map.empty() ? "none" : info.normal_map},
                    {"size", Value::Array{stored.normals.width(), stored.normals.height()}},
                    {"bits", name_of(info.type)},
                    {"triangles", triangles},
                    {"charts", charts.size()},
                    {"covered", use.coverage},
                    {"overlapping", use.overlap},
                    {"texel size", Value::Object{{"median", density.area_median},
                                                 {"smallest 5 %", density.p05},
                                                 {"largest 5 %", density.p95}}}};
  const int tile = opened.model.texture_sets[i].tile;
  if (tile != 0) out.emplace_back("tile", tile);
  if (info.guess) out.emplace_back("guessed", guess_value(*info.guess));
  return out;
}

Value model_info(const std::filesystem::path& file, const ModelReadOptions& reading) {
  OpenOptions options;
  options.model = file;
  options.flip_v = reading.flip_v;
  const OpenedDocument opened = open_document(options);
  const Mesh& mesh = opened.document.mesh();
  const Seams seams = find_seams(mesh);
  const Bounds box = bounds(mesh);
  Value::Array sets;
  for (std::size_t i = 0; i < opened.sets.size(); ++i) sets.push_back(set_info(opened, seams, i));
  Value::Array notes;
  for (const std::string& note : opened.notes) notes.emplace_back(note);
  return Value::Object{{"model", file.filename().string()},
                       {"vertices", mesh.positions.size()},
                       {"triangles", mesh.triangle_count()},
                       {"low", vec3_value(box.low)},
                       {"high", vec3_value(box.high)},
                       {"normals", opened.model.has_normals ? "from the file" : "computed"},
                       {"tangents", opened.model.has_tangents    ? "from the file"
                                    : opened.model.some_tangents ? "from the file and MikkTSpace"
                                                                 : "MikkTSpace"},
                       {"seam edges", seams.edges.size()},
                       {"open edges", seams.open_edges.size()},
                       {"irregular edges", seams.irregular_edges.size()},
                       {"texture set", sets},
                       {"notes", notes}};
}

}  // namespace

Value file_info(const std::filesystem::path& file, const ModelReadOptions& reading) {
  if (DocumentFile::is_one(file)) return DocumentFile(file).summary();
  return is_model_file(file) ? model_info(file, reading) : image_info(file);
}

}  // namespace normalshop
