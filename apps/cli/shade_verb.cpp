#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/error.h"
#include "normalshop/document/option_values.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/project.h"
#include "normalshop/rgbn/shade.h"
#include "normalshop/rgbn/shade_curvature.h"
#include "normalshop/rgbn/shade_exaggerated.h"
#include "normalshop/rgbn/shade_lambert.h"
#include "normalshop/rgbn/shade_lines.h"
#include "normalshop/rgbn/shade_toon.h"

namespace normalshop::cli {

namespace {

enum class ShadeStyle { Lit, Matte, Toon, Lines, Curvature, Exaggerated };
constexpr auto names_of(ShadeStyle) {
  return std::array<std::string_view, 6>{"lit",   "matte",     "toon",
                                         "lines", "curvature", "exaggerated"};
}

struct ShadeFlags {
  ImageFlags image;
  std::filesystem::path output;
  std::string style = "lit";
  std::vector<std::string> options;
  std::vector<std::string> lights;
  Material material;
  float exposure = 1.0F;
  float shadows = 0.0F;
};

/// One light: the key of the studio. Several: these alone, sharing the light of one.
ShadeOptions choose_light(const ShadeFlags& flags) {
  ShadeOptions options;
  std::vector<Vec3f> directions;
  for (const std::string& light : flags.lights) {
    directions.push_back(parse_vector(light, "--light"));
    if (directions.back().isZero()) throw WrongUse("--light", "must not be 0,0,0");
  }
  if (directions.size() == 1) options.lights = ShadeOptions::studio_lights(directions.front());
  if (directions.size() > 1) {
    options.lights.clear();
    const float share = 3.0F / static_cast<float>(directions.size());
    for (const Vec3f& d : directions) options.lights.push_back({d, Vec3f::Constant(share)});
  }
  options.material = flags.material;
  options.exposure = flags.exposure;
  return options;
}

/// What shades itself: from the height whose slopes come nearest.
struct SelfShade {
  MaskImage occlusion;
  MaskImage shadow;
};

SelfShade self_shade(const ImageDocument& document, float reach, const Vec3f& key) {
  SelfShade out;
  if (!(reach > 0.0F)) return out;
  const PictureSlopes picture = slopes_of(document);
  const Rect all = picture.slopes.rect();
  MaskImage height(all.width(), all.height());
  integrate_height(picture.slopes, picture.validity, height, all);
  out.occlusion.resize(all.width(), all.height());
  out.shadow.resize(all.width(), all.height());
  ambient_occlusion(height, reach, out.occlusion);
  cast_shadow(height, key, reach, out.shadow);
  return out;
}

/// The defaults, and what "bands=4" says instead.
Value style_options(const Value& defaults, const std::vector<std::string>& settings) {
  Value::Object fields = *defaults.object();
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw WrongUse("--set", "must be NAME=VALUE, not \"" + setting + "\"");
    }
    const std::string text = setting.substr(equals + 1);
    const auto number = read_number(text);
    const std::string name = setting.substr(0, equals);
    std::erase_if(fields, [&](const auto& field) { return field.first == name; });
    fields.emplace_back(name, number ? Value(*number) : Value(text));
  }
  return fields;
}

/// The style's options; its light from --light, where that is given.
template <class Options>
Options read_style(const ShadeFlags& flags) {
  const Value settings = style_options(options_value(Options{}), flags.options);
  Options options;
  try {
    options = read_options<Options>(FieldReader(settings, "--set"));
  } catch (const InvalidInput& error) {
    throw WrongUse(error.what());
  }
  if constexpr (std::is_base_of_v<LightDirection, Options>) {
    if (!flags.lights.empty()) {
      const Vec3f light = parse_vector(flags.lights.front(), "--light").normalized();
      constexpr float degrees = 57.2957795F;
      options.azimuth = degrees * std::atan2(light.y(), light.x());
      options.elevation = degrees * std::asin(std::clamp(light.z(), 0.0F, 1.0F));
    }
  }
  return options;
}

void shade_in_style(ShadeStyle style, const ShadeFlags& flags, ImageView<Vec3f> normals,
                    ColorView colors, ColorSpan picture) {
  const Rect all = picture.rect();
  switch (style) {
    case ShadeStyle::Toon:
      shade_toon(normals, colors, picture, all, read_style<ToonOptions>(flags));
      break;
    case ShadeStyle::Lines:
      shade_lines(normals, picture, all, read_style<LineOptions>(flags));
      break;
    case ShadeStyle::Curvature:
      shade_curvature(normals, colors, picture, all, read_style<CurvatureShadeOptions>(flags));
      break;
    case ShadeStyle::Exaggerated:
      shade_exaggerated(normals, colors, picture, all, read_style<ExaggeratedOptions>(flags));
      break;
    default:
      break;
  }
}

void run_shade(const ShadeFlags& flags) {
  const ShadeOptions options = choose_light(flags);
  const OpenedImage opened = open_image(flags.image.open());
  const NormalMap& map = opened.document.normals();
  Image<Vec3f> normals(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) map.read_normals(y, normals.row(y));
  const ColorImage& colors = opened.document.colors();
  ColorImage picture(map.width(), map.height(), Vec3f::Zero());
  ShadeStyle style{};
  from_name(flags.style, style);
  if (style == ShadeStyle::Lit) {
    const SelfShade self =
        self_shade(opened.document, flags.shadows, options.lights.front().direction);
    shade(normals, colors, self.occlusion, self.shadow, picture, options);
  } else if (style == ShadeStyle::Matte) {
    shade_lambert(normals, colors, picture, picture.rect(), {options.lights, options.sky});
  } else {
    shade_in_style(style, flags, normals, colors, picture);
  }
  write_png_srgb(flags.output, picture);
  print_notes(opened.notes);
  std::printf("wrote %s\n", flags.output.string().c_str());
}

}  // namespace

void add_shade_verb(CommandLine& program) {
  Verb verb = program.verb("shade", "Lights a picture with normals");
  ShadeFlags& flags = verb.runs(run_shade);
  verb.takes("normals", flags.image.files.normals, "Normal map of the picture").required();
  verb.takes("--color", flags.image.files.color, "Its colours (neutral grey unless given)");
  verb.takes("-o,--output", flags.output, "PNG file").required();
  verb.takes("--style", flags.style, "How")
      .one_of({"lit", "matte", "toon", "lines", "curvature", "exaggerated"})
      .shows_default();
  verb.takes("--set", flags.options,
             "NAME=VALUE of an option of toon, lines, curvature or exaggerated; may be repeated");
  verb.takes("--light", flags.lights,
             "Direction x,y,z towards the light: x right, y up, z towards the viewer; may be "
             "repeated, then these lights alone shine");
  verb.takes("--roughness", flags.material.roughness, "0 a mirror, 1 chalk").shows_default();
  verb.takes("--specular", flags.material.specular, "Reflectance straight on, 0 to 1")
      .shows_default();
  verb.takes("--exposure", flags.exposure, "Multiplies the light").shows_default();
  verb.takes("--shadows", flags.shadows,
             "Pixels that shadows and occlusion reach, from the height that fits best; 0 none")
      .shows_default();
  flags.image.add_green(verb);
}

}  // namespace normalshop::cli
