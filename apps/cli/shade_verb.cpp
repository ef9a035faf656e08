#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/core/error.h"
#include "normalshop/core/for_pixels.h"
#include "normalshop/document/option_values.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/discontinuity_shadow.h"
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
  float edge_shadows = 0.0F;
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

Vec2f towards(float azimuth) {
  constexpr float radian = 3.14159265F / 180.0F;
  return {std::cos(radian * azimuth), std::sin(radian * azimuth)};
}

/// 1 lit, less behind edges where something stands before what lies behind; `light` points towards
/// the light in the picture. Empty: 1 everywhere, as under a light that stands before the picture.
MaskImage edge_shadow(ImageView<Vec3f> normals, float length, const Vec2f& light) {
  if (length == 0.0F || light.norm() < 1e-6F) return {};
  DiscontinuityShadowOptions options;
  options.length = length;
  options.azimuth = std::atan2(light.y(), light.x()) * 180.0F / 3.14159265F;
  MaskImage lit(normals.width(), normals.height());
  discontinuity_shadow(normals, lit, lit.rect(), options);
  return lit;
}

MaskImage darker(MaskImage a, const MaskImage& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  for_pixels(a.rect(), [&](int x, int y) { a(x, y) = std::min(a(x, y), b(x, y)); });
  return a;
}

void darken(ColorSpan picture, const MaskImage& lit) {
  if (lit.empty()) return;
  for_pixels(picture.rect(), [&](int x, int y) { picture(x, y) *= lit(x, y); });
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

/// Where the light of a style stands in the picture: as --light says, else as the style's options
/// do, else the upper left.
template <class Options>
Vec2f style_light(const Options& style, const ShadeFlags& flags) {
  if (!flags.lights.empty()) return parse_vector(flags.lights.front(), "--light").head<2>();
  if constexpr (std::is_base_of_v<LightDirection, Options>) return towards(style.azimuth);
  return towards(LightDirection{}.azimuth);
}

/// Returns where the style's light stands in the picture.
Vec2f shade_in_style(ShadeStyle style, const ShadeFlags& flags, ImageView<Vec3f> normals,
                     ColorView colors, ColorSpan picture) {
  const Rect all = picture.rect();
  switch (style) {
    case ShadeStyle::Toon: {
      const auto options = read_style<ToonOptions>(flags);
      shade_toon(normals, colors, picture, all, options);
      return style_light(options, flags);
    }
    case ShadeStyle::Lines: {
      const auto options = read_style<LineOptions>(flags);
      shade_lines(normals, picture, all, options);
      return style_light(options, flags);
    }
    case ShadeStyle::Curvature: {
      const auto options = read_style<CurvatureShadeOptions>(flags);
      shade_curvature(normals, colors, picture, all, options);
      return style_light(options, flags);
    }
    default: {
      const auto options = read_style<ExaggeratedOptions>(flags);
      shade_exaggerated(normals, colors, picture, all, options);
      return style_light(options, flags);
    }
  }
}

/// Lit by a studio's lights; the edges' shadows are the first light's.
void shade_lit(const ShadeFlags& flags, const ShadeOptions& options, const ImageDocument& document,
               ImageView<Vec3f> normals, ColorSpan picture) {
  const Vec3f key = options.lights.front().direction;
  const SelfShade self = self_shade(document, flags.shadows, key);
  const MaskImage edges = edge_shadow(normals, flags.edge_shadows, key.head<2>());
  shade(normals, document.colors(), self.occlusion, darker(self.shadow, edges), picture, options);
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
    shade_lit(flags, options, opened.document, normals, picture);
  } else if (style == ShadeStyle::Matte) {
    shade_lambert(normals, colors, picture, picture.rect(), {options.lights, options.sky});
    const Vec2f light = options.lights.front().direction.head<2>();
    darken(picture, edge_shadow(normals, flags.edge_shadows, light));
  } else {
    const Vec2f light = shade_in_style(style, flags, normals, colors, picture);
    darken(picture, edge_shadow(normals, flags.edge_shadows, light));
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
             "NAME=VALUE of an option of toon, lines, curvature or exaggerated, which describe "
             "--styles lists; may be repeated");
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
  verb.takes("--edge-shadows", flags.edge_shadows,
             "Pixels that shadows reach behind edges in depth, in every style, away from the first "
             "--light; 0 none [0 to 1000]")
      .shows_default();
  flags.image.add_green(verb);
}

}  // namespace normalshop::cli
