#include <cstdio>

#include "image_flags.h"
#include "verbs.h"

#include "normalshop/io/image_check.h"

namespace normalshop::cli {

namespace {

struct CheckFlags {
  ImageFlags image;
  std::filesystem::path picture;
  float largest = 0.0F;
  bool json = false;
};

void print_check(const Value& report) {
  const auto number = [&](const char* name) { return *report.find(name)->number(); };
  const Value& lengths = *report.find("lengths");
  std::printf("conventions: %s\n", report.find("conventions")->text()->c_str());
  std::printf("lengths: mean %.4f, from %.4f to %.4f\n", *lengths.find("mean")->number(),
              *lengths.find("least")->number(), *lengths.find("largest")->number());
  std::printf("pixels: %.0f, of which %.0f have no direction and %.0f are on the horizon\n",
              number("pixels"), number("without_direction"), number("on_the_horizon"));
  std::printf(
      "curl: %.3g of the slopes' energy is that of no surface (%.3g of their derivatives')\n",
      number("curl_share"), number("curl_share_of_derivatives"));
}

void run_check(const CheckFlags& flags) {
  const OpenImageOptions files = flags.image.open();
  const OpenedImage opened = open_image(files);
  const Value report = check_image(opened, files.border);
  if (flags.json) {
    std::fputs(to_json(report).c_str(), stdout);
  } else {
    print_check(report);
  }
  if (flags.picture.empty()) return;
  const float largest = write_curl_picture(opened, files.border, flags.largest, flags.picture);
  std::fprintf(flags.json ? stderr : stdout, "wrote %s (dark: 0, pale: a curl of %.3g)\n",
               flags.picture.string().c_str(), static_cast<double>(largest));
}

}  // namespace

void add_check_verb(CommandLine& program) {
  Verb verb = program.verb("check",
                           "Says what is wrong with a picture's normals: lengths, "
                           "directions, conventions, curl");
  CheckFlags& flags = verb.runs(run_check);
  verb.takes("normals", flags.image.files.normals, "Normal map").required();
  flags.image.add(verb);
  flags.image.add_green(verb);
  verb.takes("-o,--output", flags.picture, "PNG picture of the curl in false colours");
  verb.takes("--max", flags.largest,
             "Curl of the brightest colour (the 99th percentile unless given)")
      .positive();
  verb.flag("--json", flags.json, "Print the result as JSON");
}

}  // namespace normalshop::cli
