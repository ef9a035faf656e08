#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "model_flags.h"
#include "verbs.h"

#include "normalshop/chart/render.h"
#include "normalshop/core/options.h"
#include "normalshop/document/value.h"
#include "normalshop/io/image_file.h"

namespace normalshop::cli {

namespace {

struct RenderFlags {
  ModelFlags model;
  std::filesystem::path output;
  std::string view = "front";
  std::string light;
  std::string center;
  std::string facing;
  float width = 0.0F;
  std::string style = "lit";
  std::string angles;
  std::string resolution = "1200x1200";
  bool json = false;
};

void parse_resolution(const std::string& text, RenderOptions& options) {
  int read = 0;
  const int fields = std::sscanf(text.c_str(), "%dx%d%n", &options.width, &options.height, &read);
  const auto fits = [](int side) { return side >= 1 && side <= 16384; };
  if (fields == 2 && static_cast<std::size_t>(read) == text.size() && fits(options.width) &&
      fits(options.height)) {
    return;
  }
  throw WrongUse("--resolution", "must be WxH with sides from 1 to 16384, not \"" + text + "\"");
}

void parse_angles(const std::string& text, RenderOptions& options) {
  int read = 0;
  const int fields =
      std::sscanf(text.c_str(), "%f,%f%n", &options.full_angle, &options.zero_angle, &read);
  if (fields == 2 && static_cast<std::size_t>(read) == text.size() && options.full_angle >= 0.0F &&
      options.full_angle < options.zero_angle && options.zero_angle <= 90.0F) {
    return;
  }
  throw WrongUse("--effective",
                 "must be two angles FULL,ZERO with 0 <= FULL < ZERO <= 90, not \"" + text + "\"");
}

ViewSpec choose_view(const RenderFlags& flags) {
  if (!flags.facing.empty()) {
    if (!(flags.width > 0.0F)) throw WrongUse("--facing", "needs --width");
    return FacingView{parse_vector(flags.facing, "--facing"), flags.width, flags.width};
  }
  return parse_view(flags.view);
}

void run_render(const RenderFlags& flags) {
  RenderOptions options;
  parse_resolution(flags.resolution, options);
  from_name(flags.style, options.style);
  if (!flags.angles.empty()) parse_angles(flags.angles, options);
  if (!flags.light.empty()) options.light = parse_vector(flags.light, "--light");
  if (options.light.isZero()) throw WrongUse("--light", "must not be 0,0,0");
  const ViewSpec spec = choose_view(flags);
  const auto center = flags.center.empty()
                          ? std::nullopt
                          : std::optional<Vec3f>(parse_vector(flags.center, "--center"));
  const OpenedDocument opened = open_document(flags.model.options());
  View view = resolve(spec, opened.document.mesh());
  if (center) view.center = *center;
  if (flags.width > 0.0F) view.width = view.height = flags.width;
  write_png_srgb(flags.output,
                 render(opened.document.mesh(), opened.document.storage(), view, options));
  print_notes(opened.notes);
  if (flags.json) {
    const Value report = Value::Object{
        {"picture", flags.output.string()}, {"width", options.width}, {"height", options.height}};
    std::fputs(to_json(report).c_str(), stdout);
  } else {
    std::printf("wrote %s\n", flags.output.string().c_str());
  }
}

}  // namespace

void add_render_verb(CommandLine& program) {
  Verb verb = program.verb("render", "Draws a model with its normal maps");
  RenderFlags& flags = verb.runs(run_render);
  flags.model.add(verb).required();
  verb.takes("-o,--output", flags.output, "PNG file").required();
  verb.takes("--view", flags.view,
             "front, back, left, right, top, bottom or a direction x,y,z towards the viewer")
      .shows_default();
  verb.takes("--center", flags.center, "Object-space point x,y,z in the picture's middle");
  verb.takes("--facing", flags.facing, "Look straight at the surface point nearest to x,y,z");
  verb.takes("--width", flags.width, "Width of the view in object units (the model's unless given)")
      .positive();
  verb.takes("--light", flags.light,
             "Direction x,y,z towards the light: x right, y up, z towards the viewer");
  verb.takes("--style", flags.style, "What to show")
      .one_of({"lit", "normals", "albedo", "weight", "effective", "charts"})
      .shows_default();
  verb.takes("--effective", flags.angles,
             "Angles FULL,ZERO of an edit's \"effective\", for the styles weight and effective "
             "(60,75 unless given)");
  verb.takes("--resolution", flags.resolution, "WxH in pixels").shows_default();
  verb.flag("--json", flags.json, "Print what was written as JSON");
}

}  // namespace normalshop::cli
