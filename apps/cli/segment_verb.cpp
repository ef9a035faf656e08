#include <cstdio>

#include "image_flags.h"
#include "verbs.h"

#include "normalshop/io/image_segments.h"

namespace normalshop::cli {

namespace {

struct SegmentFlags {
  ImageFlags image;
  SegmentJobOptions job;
  bool everywhere = false;
  bool json = false;
};

void run_segment(const SegmentFlags& flags) {
  SegmentJobOptions job = flags.job;
  job.wand.contiguous = !flags.everywhere;
  const Value report = segment_image(flags.image.open(), job);
  if (flags.json) {
    std::fputs(to_json(report).c_str(), stdout);
    return;
  }
  if (const Value* count = report.find("segments")) {
    std::printf("%.0f segments\n", *count->number());
  }
  if (const Value* count = report.find("selected_pixels")) {
    std::printf("%.0f pixels selected\n", *count->number());
  }
  for (const Value& file : *report.find("files")->array()) {
    std::printf("wrote %s\n", file.text()->c_str());
  }
}

}  // namespace

void add_segment_verb(CommandLine& program) {
  Verb verb = program.verb("segment", "Divides a picture into regions of like colour and normal");
  SegmentFlags& flags = verb.runs(run_segment);
  SegmentOptions& options = flags.job.segments;
  verb.takes("normals", flags.image.files.normals, "Normal map of the picture").required();
  verb.takes("--color", flags.image.files.color, "Its colours");
  verb.takes("-o,--output", flags.job.labels,
             "16-bit PNG of the regions: 0 belongs to none, then one number each");
  verb.takes("--picture", flags.job.picture, "PNG of the regions in different colours");
  verb.takes("--select", flags.job.selected,
             "x,y in pixels from the picture's middle, y up: the "
             "region there becomes the mask; may be repeated");
  verb.takes("--wand", flags.job.wands,
             "x,y likewise: what hangs together with the pixel there and is like it becomes the "
             "mask; may be repeated");
  verb.takes("--angle-tolerance", flags.job.wand.angle_tolerance,
             "Of the wand: largest angle between normals in degrees; 0 equal ones, 180 all")
      .shows_default();
  verb.takes("--color-tolerance", flags.job.wand.color_tolerance,
             "Of the wand: largest distance between linear colours; 0 equal ones, 1e6 all")
      .shows_default();
  verb.flag("--everywhere", flags.everywhere,
            "The wand takes all that is like the pixel, wherever it lies");
  verb.takes("--lasso", flags.job.lassos,
             "\"x,y x,y x,y ...\" likewise: what lies inside becomes the mask; may be repeated");
  verb.takes("--mask-output", flags.job.mask,
             "Grey PNG of all that --select, --wand and --lasso select");
  verb.takes("--feather", flags.job.feather, "Width of the mask's soft border in pixels");
  verb.takes("--coarseness", options.coarseness, "Larger: fewer, larger regions").shows_default();
  verb.takes("--min-size", options.min_size, "Smaller regions join a neighbour; in pixels")
      .shows_default();
  verb.takes("--color-weight", options.color_weight, "How much colours count").shows_default();
  verb.takes("--normal-weight", options.normal_weight, "How much normals count").shows_default();
  verb.takes("--sigma", options.sigma, "Smoothing before; in pixels").shows_default();
  flags.image.add(verb);
  flags.image.add_green(verb);
  verb.flag("--json", flags.json, "Print the result as JSON");
}

}  // namespace normalshop::cli
