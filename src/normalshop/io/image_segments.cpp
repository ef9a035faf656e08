#include "normalshop/io/image_segments.h"

#include <charconv>
#include <cmath>
#include <set>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/mask.h"
#include "normalshop/rgbn/selection.h"

namespace normalshop {

namespace {

constexpr std::uint32_t most_labels = 65535;

Segments divide(const OpenedImage& opened, const SegmentOptions& options) {
  const PictureSlopes picture = slopes_of(opened.document);
  return segment({picture.slopes, opened.document.colors(), picture.validity}, options);
}

RawImage label_codes(const Segments& segments) {
  if (segments.count > most_labels) {
    throw InvalidInput("there are " + std::to_string(segments.count) +
                       " segments, more than the 65535 that 16 bits can count; a larger coarseness "
                       "or smallest size gives fewer");
  }
  const auto& labels = segments.labels;
  RawImage codes(labels.width(), labels.height(), 1, CodeType::U16);
  for (int y = 0; y < labels.height(); ++y) {
    auto* row = codes.row<std::uint16_t>(y);
    for (int x = 0; x < labels.width(); ++x) {
      const std::uint32_t label = labels(x, y);
      row[x] = static_cast<std::uint16_t>(label == no_label ? 0 : label + 1);
    }
  }
  return codes;
}

/// Colours of middling lightness; black where there is no segment.
ColorImage label_colors(const Segments& segments) {
  const auto& labels = segments.labels;
  ColorImage colors(labels.width(), labels.height());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const std::uint32_t label = labels(x, y);
      const std::uint32_t bits = hash(label, 17, 4);
      const auto channel = [&](unsigned shift) {
        return 0.25F + 0.7F * static_cast<float>((bits >> shift) & 255U) / 255.0F;
      };
      colors(x, y) =
          label == no_label ? Vec3f(0.0F, 0.0F, 0.0F) : Vec3f(channel(0), channel(8), channel(16));
    }
  }
  return colors;
}

Vec2i parse_place(const std::string& text, int width, int height) {
  const char* end = text.data() + text.size();
  float x = 0.0F;
  float y = 0.0F;
  const auto first = std::from_chars(text.data(), end, x);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == ',') {
    const auto second = std::from_chars(first.ptr + 1, end, y);
    const float column = std::floor(x + 0.5F * static_cast<float>(width));
    const float row = std::floor(0.5F * static_cast<float>(height) - y);
    const bool inside = column >= 0.0F && row >= 0.0F && column < static_cast<float>(width) &&
                        row < static_cast<float>(height);
    if (second.ec == std::errc() && second.ptr == end && inside) {
      return {static_cast<int>(column), static_cast<int>(row)};
    }
  }
  throw InvalidInput("the place \"" + text +
                     "\" must be x,y in pixels from the picture's middle, y up: x from " +
                     std::to_string(-width / 2) + " to " + std::to_string(width / 2) + ", y from " +
                     std::to_string(-height / 2) + " to " + std::to_string(height / 2));
}

MaskImage selected_mask(const Segments& segments, const SegmentJobOptions& options) {
  const auto& labels = segments.labels;
  std::set<std::uint32_t> chosen;
  for (const std::string& place : options.selected) {
    const Vec2i pixel = parse_place(place, labels.width(), labels.height());
    chosen.insert(labels(pixel.x(), pixel.y()));
  }
  chosen.erase(no_label);
  const std::vector<std::uint32_t> list(chosen.begin(), chosen.end());
  MaskImage mask(labels.width(), labels.height());
  select_labels(labels, list, mask, mask.rect());
  if (!(options.feather > 0.0F)) return mask;
  MaskImage soft(labels.width(), labels.height());
  feather_mask(mask, soft, soft.rect(), {options.feather});
  return soft;
}

RawImage mask_codes(MaskView mask) {
  RawImage codes(mask.width(), mask.height(), 1, CodeType::U8);
  for (int y = 0; y < mask.height(); ++y) {
    auto* row = codes.row<std::uint8_t>(y);
    for (int x = 0; x < mask.width(); ++x) {
      row[x] = static_cast<std::uint8_t>(255.0F * mask(x, y) + 0.5F);
    }
  }
  return codes;
}

void check_options(const SegmentJobOptions& options) {
  if (options.labels.empty() && options.picture.empty() && options.mask.empty()) {
    throw InvalidInput(
        "nothing would be written: name a file for labels, for a picture or for a mask");
  }
  if (options.mask.empty() != options.selected.empty()) {
    throw InvalidInput("a mask needs places that it selects, and places need a file for the mask");
  }
}

}  // namespace

Value segment_image(const OpenImageOptions& open, const SegmentJobOptions& options) {
  check_options(options);
  const OpenedImage opened = open_image(open);
  const Segments segments = divide(opened, options.segments);
  Value::Array files;
  const auto note = [&](const std::filesystem::path& file) { files.emplace_back(file.string()); };
  if (!options.labels.empty()) {
    write_image(options.labels, label_codes(segments));
    note(options.labels);
  }
  if (!options.picture.empty()) {
    write_png_codes(options.picture, label_colors(segments));
    note(options.picture);
  }
  if (!options.mask.empty()) {
    write_image(options.mask, mask_codes(selected_mask(segments, options)));
    note(options.mask);
  }
  return Value::Object{{"segments", std::size_t{segments.count}}, {"files", files}};
}

}  // namespace normalshop
