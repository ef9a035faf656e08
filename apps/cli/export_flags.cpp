#include "export_flags.h"

#include <cstdio>

#include "image_flags.h"

#include "normalshop/core/options.h"

namespace normalshop::cli {

void ExportFlags::add(Verb& verb) {
  verb.takes("--preset", preset_, "Conventions of the written maps (the input's unless given)")
      .one_of({"gltf", "opengl", "directx", "object"});
  verb.takes("--bits", bits_, "Bits a channel of the written maps (the input's unless given)")
      .one_of({"8", "16", "32"});
  verb.flag("--mips", mips_,
            "Writes the mip levels of the maps too, free of what lies between charts");
  verb.takes("--roughness", roughness_,
             "The material's roughness, 0 to 1: writes it as a map too, with what the normals of "
             "a mip level lose added");
  verb.takes("--roughness-level", roughness_level_, "That mip level (1 unless given)")
      .between(1, 16);
}

ExportOptions ExportFlags::options() const {
  ExportOptions out;
  ExportPreset chosen{};
  if (!preset_.empty() && from_name(preset_, chosen)) out.preset = chosen;
  out.type = code_type(bits_);
  out.mip_levels = mips_;
  out.roughness = read_roughness(roughness_);
  out.roughness_level = roughness_level_;
  return out;
}

void print_edits(std::span<const Edit> edits, std::span<const EditReport> reports) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const EditReport& e = reports[i];
    std::printf("edit %zu (%s): %zu texels changed, largest change %.1f degrees, ", i,
                std::string(edits[i].operation->name()).c_str(), e.pushed.changed,
                static_cast<double>(e.pushed.largest_change));
    if (e.colors_changed > 0) std::printf("%zu colours, ", e.colors_changed);
    if (e.relief.largest >= 0.001F) {
      std::printf("height up to %.1f %% of the radius of curvature, ",
                  100.0 * static_cast<double>(e.relief.largest));
    }
    std::printf("chart %d x %d, ", e.chart_width, e.chart_height);
    if (e.tiles > 1) std::printf("%d tiles, ", e.tiles);
    std::printf("%.0f ms\n", 1e3 * (e.times.pull + e.times.operate + e.times.push));
  }
}

void print_files(std::span<const std::filesystem::path> files) {
  for (const auto& file : files) std::printf("wrote %s\n", file.string().c_str());
}

}  // namespace normalshop::cli
