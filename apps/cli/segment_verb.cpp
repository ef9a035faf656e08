#include <cstdio>

#include "image_flags.h"
#include "verbs.h"

#include "normalshop/io/image_segments.h"

namespace normalshop::cli {

namespace {

struct SegmentFlags {
  ImageFlags image;
  SegmentJobOptions job;
  bool json = false;
};

void run_segment(const SegmentFlags& flags) {
  const Value report = segment_image(flags.image.open(), flags.job);
  if (flags.json) {
    std::fputs(to_json(report).c_str(), stdout);
    return;
  }
  std::printf("%.0f segments\n", *report.find("segments")->number());
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
  verb.takes("--mask-output", flags.job.mask, "Grey PNG of the regions that --select names");
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
