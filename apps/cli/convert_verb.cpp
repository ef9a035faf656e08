#include <cstdio>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/io/image_convert.h"

namespace normalshop::cli {

namespace {

struct ConvertFlags {
  ImageFlags image;
  ImageExport output;
  std::string to_green;
  bool normalize = false;
  int level = 0;
  std::string roughness;
  bool json = false;
};

void run_convert(const ConvertFlags& flags) {
  if (!flags.roughness.empty() && flags.level == 0) {
    throw WrongUse("--roughness", "needs the mip level that it is of: --level");
  }
  if (flags.level > 0 && (flags.normalize || flags.json)) {
    throw WrongUse("--level", "writes a mip level alone, without --normalize and --json");
  }
  const OpenImageOptions files = flags.image.open();
  const OpenedImage opened = open_image(files);
  ImageExport output = flags.output;
  output.type = code_type(flags.image.bits);
  if (!flags.to_green.empty()) output.green_down = flags.to_green == "down";
  if (flags.level > 0) {
    convert_level(files, opened, output, flags.level, read_roughness(flags.roughness));
    print_notes(opened.notes);
    std::printf("wrote %s\n", output.normals.string().c_str());
    return;
  }
  const ConvertReport report = convert_image(files, opened, output, flags.normalize);
  print_notes(opened.notes);
  if (flags.json) {
    const Value::Object value{{"pixels", report.pixels},
                              {"not_unit", report.not_unit},
                              {"without_direction", report.without_direction},
                              {"file", output.normals.string()}};
    std::fputs(to_json(value).c_str(), stdout);
    return;
  }
  std::printf("%zu pixels, %zu normals of another length than 1%s, %zu without direction\n",
              report.pixels, report.not_unit, flags.normalize ? " (now 1)" : "",
              report.without_direction);
  std::printf("wrote %s\n", output.normals.string().c_str());
}

}  // namespace

void add_convert_verb(CommandLine& program) {
  Verb verb = program.verb("convert",
                           "Writes a picture's normals with another direction of green, number of "
                           "bits or file format, or with length 1");
  ConvertFlags& flags = verb.runs(run_convert);
  verb.takes("normals", flags.image.files.normals, "Normal map").required();
  verb.takes("-o,--output", flags.output.normals, "File for the converted normals").required();
  flags.image.add_green(verb);
  verb.takes("--to-green", flags.to_green,
             "Direction of green in the written file (the input's unless given): up: OpenGL, down: "
             "DirectX")
      .one_of({"up", "down"});
  verb.flag("--normalize", flags.normalize, "Gives every normal length 1");
  verb.takes("--level", flags.level, "Writes this mip level of the normals instead, from 1 on")
      .between(1, 16);
  verb.takes("--roughness", flags.roughness,
             "The material's roughness, 0 to 1: writes it as a picture instead, with what the "
             "normals of --level lose added");
  flags.image.add_bits(verb);
  verb.flag("--json", flags.json, "Print the result as JSON");
}

}  // namespace normalshop::cli
