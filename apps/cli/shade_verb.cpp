#include <cstdio>

#include "image_flags.h"
#include "model_flags.h"
#include "verbs.h"

#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/project.h"
#include "normalshop/rgbn/shade.h"

namespace normalshop::cli {

namespace {

struct ShadeFlags {
  ImageFlags image;
  std::filesystem::path output;
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

void run_shade(const ShadeFlags& flags) {
  const ShadeOptions options = choose_light(flags);
  const OpenedImage opened = open_image(flags.image.open());
  const NormalMap& map = opened.document.normals();
  Image<Vec3f> normals(map.width(), map.height());
  for (int y = 0; y < map.height(); ++y) map.read_normals(y, normals.row(y));
  const SelfShade self =
      self_shade(opened.document, flags.shadows, options.lights.front().direction);
  ColorImage picture(map.width(), map.height(), Vec3f::Zero());
  shade(normals, opened.document.colors(), self.occlusion, self.shadow, picture, options);
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
