#include "normalshop/io/image_segments.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "normalshop/core/error.h"
#include "normalshop/core/random.h"
#include "normalshop/io/image_file.h"
#include "normalshop/rgbn/mask.h"
#include "normalshop/rgbn/selection.h"

namespace normalshop {

namespace {

constexpr std::uint32_t most_labels = 65535;

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

/// "x,y"; none when it is something else.
std::optional<Vec2f> parse_point(std::string_view text) {
  constexpr float farthest = 1e6F;
  const char* end = text.data() + text.size();
  Vec2f point;
  const auto first = std::from_chars(text.data(), end, point.x());
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ',') return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, point.y());
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  if (!(point.cwiseAbs().maxCoeff() <= farthest)) return std::nullopt;
  return point;
}

/// The pixel at a point.
Vec2i parse_place(const std::string& text, const Rect& picture) {
  const int width = picture.width();
  const int height = picture.height();
  if (const auto point = parse_point(text)) {
    const float column = std::floor(point->x() + 0.5F * static_cast<float>(width));
    const float row = std::floor(0.5F * static_cast<float>(height) - point->y());
    const bool inside = column >= 0.0F && row >= 0.0F && column < static_cast<float>(width) &&
                        row < static_cast<float>(height);
    if (inside) return {static_cast<int>(column), static_cast<int>(row)};
  }
  throw InvalidInput("the place \"" + text +
                     "\" must be x,y in pixels from the picture's middle, y up: x from " +
                     std::to_string(-width / 2) + " to " + std::to_string(width / 2) + ", y from " +
                     std::to_string(-height / 2) + " to " + std::to_string(height / 2));
}

/// In pixels, the middle of the first at 0.
std::vector<Vec2f> parse_lasso(const std::string& text, const Rect& picture) {
  const Vec2f middle(0.5F * static_cast<float>(picture.width()) - 0.5F,
                     0.5F * static_cast<float>(picture.height()) - 0.5F);
  std::vector<Vec2f> polygon;
  std::string_view rest = text;
  bool good = true;
  while (good) {
    const std::size_t begin = rest.find_first_not_of(' ');
    if (begin == std::string_view::npos) break;
    rest.remove_prefix(begin);
    const std::string_view word = rest.substr(0, rest.find(' '));
    const auto point = parse_point(word);
    good = point.has_value();
    if (good) polygon.emplace_back(middle.x() + point->x(), middle.y() - point->y());
    rest.remove_prefix(word.size());
  }
  if (good && polygon.size() >= 3) return polygon;
  throw InvalidInput("the lasso \"" + text +
                     "\" must be at least 3 points x,y with spaces between them, in pixels from "
                     "the picture's middle, y up");
}

void add(MaskView other, MaskImage& mask) {
  combine_masks(mask, other, mask, mask.rect(), MaskOperation::Add);
}

void add_segments(const Segments& segments, const SegmentJobOptions& options, MaskImage& mask) {
  std::set<std::uint32_t> chosen;
  for (const std::string& place : options.selected) {
    const Vec2i pixel = parse_place(place, mask.rect());
    chosen.insert(segments.labels(pixel.x(), pixel.y()));
  }
  chosen.erase(no_label);
  if (chosen.empty()) return;
  const std::vector<std::uint32_t> list(chosen.begin(), chosen.end());
  MaskImage selected(mask.width(), mask.height());
  select_labels(segments.labels, list, selected, selected.rect());
  add(selected, mask);
}

MaskImage selected_mask(const RgbnView& image, const Segments& segments,
                        const SegmentJobOptions& options, Border border) {
  MaskImage mask(image.slopes.width(), image.slopes.height(), 0.0F);
  MaskImage selected(mask.width(), mask.height());
  add_segments(segments, options, mask);
  for (const std::string& place : options.wands) {
    select_alike(image, parse_place(place, mask.rect()), selected, options.wand, border);
    add(selected, mask);
  }
  for (const std::string& lasso : options.lassos) {
    select_polygon(parse_lasso(lasso, mask.rect()), selected, selected.rect());
    add(selected, mask);
  }
  if (!(options.feather > 0.0F)) return mask;
  feather_mask(mask, selected, selected.rect(), {options.feather}, border);
  return selected;
}

std::size_t selected_pixels(MaskView mask) {
  std::size_t count = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) count += mask(x, y) >= 0.5F ? 1 : 0;
  }
  return count;
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
  const bool selects =
      !options.selected.empty() || !options.wands.empty() || !options.lassos.empty();
  if (options.mask.empty() == selects) {
    throw InvalidInput(
        "a mask needs places, wands or lassos that select it, and these need a file for the mask");
  }
}

}  // namespace

Value segment_image(const OpenImageOptions& open, const SegmentJobOptions& options) {
  check_options(options);
  const OpenedImage opened = open_image(open);
  const PictureSlopes picture = slopes_of(opened.document);
  const RgbnView image{picture.slopes, opened.document.colors(), picture.validity};
  const Border border = opened.document.border();
  Value::Object report;
  Segments segments;
  if (!options.labels.empty() || !options.picture.empty() || !options.selected.empty()) {
    segments = segment(image, options.segments, border);
    report.emplace_back("segments", std::size_t{segments.count});
  }
  MaskImage mask;
  if (!options.mask.empty()) {
    mask = selected_mask(image, segments, options, border);
    report.emplace_back("selected_pixels", selected_pixels(mask));
  }
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
    write_image(options.mask, mask_codes(mask));
    note(options.mask);
  }
  report.emplace_back("files", files);
  return report;
}

}  // namespace normalshop
