#include <algorithm>
#include <cstring>
#include <string>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <zlib.h>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

namespace normalshop {

namespace {

using Bytes = std::span<const std::byte>;

std::uint8_t byte_at(Bytes bytes, std::size_t i) {
  return i < bytes.size() ? std::to_integer<std::uint8_t>(bytes[i]) : std::uint8_t{0};
}

bool starts_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// TGA has no magic number: every field of its header must make sense.
bool looks_like_tga(Bytes bytes) {
  if (bytes.size() < 18) return false;
  const int map_type = byte_at(bytes, 1);
  const int image_type = byte_at(bytes, 2);
  const int bits = byte_at(bytes, 16);
  const bool mapped = image_type == 1 || image_type == 9;
  const bool known =
      mapped || image_type == 2 || image_type == 3 || image_type == 10 || image_type == 11;
  const bool bits_known = bits == 8 || bits == 15 || bits == 16 || bits == 24 || bits == 32;
  return known && bits_known && map_type <= 1 && (!mapped || map_type == 1);
}

/// OpenImageIO's name of the format, or nullptr.
const char* format_of(Bytes bytes) {
  using namespace std::string_view_literals;
  if (starts_with(bytes, "\x89PNG\r\n\x1a\n"sv)) return "png";
  if (starts_with(bytes, "\xff\xd8\xff"sv)) return "jpeg";
  if (starts_with(bytes, "II*\0"sv) || starts_with(bytes, "MM\0*"sv)) return "tiff";
  if (starts_with(bytes, "II+\0"sv) || starts_with(bytes, "MM\0+"sv)) return "tiff";
  if (starts_with(bytes, "\x76\x2f\x31\x01"sv)) return "openexr";
  if (looks_like_tga(bytes)) return "targa";
  return nullptr;
}

std::string quoted(std::string_view name) { return "'" + std::string(name) + "'"; }

/// The library's own words, as the end of a sentence.
std::string reason(const std::string& error) {
  const std::string line = error.substr(0, error.find('\n'));
  return line.empty() ? std::string() : " (" + line + ")";
}

CodeType code_type_of(const OIIO::TypeDesc& type, std::string_view name) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return CodeType::U8;
    case OIIO::TypeDesc::UINT16:
      return CodeType::U16;
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
    case OIIO::TypeDesc::DOUBLE:
      return CodeType::F32;
    default:
      break;
  }
  throw InvalidInput("the image " + quoted(name) + " holds codes of type " + type.c_str() +
                     "; accepted are 8 and 16 bits without sign, and floats");
}

OIIO::TypeDesc library_type(CodeType type) {
  return type == CodeType::U8    ? OIIO::TypeDesc::UINT8
         : type == CodeType::U16 ? OIIO::TypeDesc::UINT16
                                 : OIIO::TypeDesc::FLOAT;
}

void check_size(std::int64_t width, std::int64_t height, std::string_view name) {
  const bool sides =
      width >= 1 && height >= 1 && width <= max_image_side && height <= max_image_side;
  if (sides && static_cast<std::size_t>(width * height) <= max_image_pixels) return;
  throw InvalidInput("the image " + quoted(name) + " says it has " + std::to_string(width) + " x " +
                     std::to_string(height) + " pixels; accepted are 1 to " +
                     std::to_string(max_image_side) + " a side and " +
                     std::to_string(max_image_pixels) + " in all");
}

/// Size in a PNG's or TGA's header, which can be told before the library allocates anything.
void check_header(Bytes bytes, std::string_view format, std::string_view name) {
  const auto big_endian = [&](std::size_t at) {
    std::int64_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value * 256 + byte_at(bytes, at + i);
    return value;
  };
  if (format == "png" && bytes.size() >= 24) check_size(big_endian(16), big_endian(20), name);
  if (format == "targa") {
    check_size(byte_at(bytes, 12) + 256 * byte_at(bytes, 13),
               byte_at(bytes, 14) + 256 * byte_at(bytes, 15), name);
  }
}

/// How many bytes of a picture one byte of its file can hold at most (fewer than 8 bits a channel
/// become 8, half floats 32); 0: not known.
std::size_t largest_packing(std::string_view format, std::string_view compression) {
  if (format != "tiff" && format != "openexr") return 2100;
  if (compression.empty() || compression == "none") return 16;
  if (compression == "zip" || compression == "zips") return 2100;
  if (compression == "lzw") return 6000;
  if (compression == "packbits" || compression == "rle") return 512;
  return 0;
}

/// A small file that promises a huge picture is damaged, and its memory is not asked for.
void check_promise(Bytes bytes, std::size_t packing, std::size_t pixel_bytes,
                   std::string_view name) {
  if (packing == 0 || pixel_bytes / packing <= bytes.size() + 4096) return;
  throw IoError("the image " + quoted(name) + " is damaged or truncated: it is far too short for " +
                "the size that it states");
}

/// libjpeg fills what is missing with gray and goes on, so the end marker is looked for here.
void check_jpeg_end(Bytes bytes, std::string_view name) {
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && byte_at(bytes, at) == 0xFF) {
    const int marker = byte_at(bytes, at + 1);
    if (marker == 0xDA) break;
    const bool alone = marker == 0xFF || marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8);
    const std::size_t length =
        static_cast<std::size_t>(byte_at(bytes, at + 2)) * 256 + byte_at(bytes, at + 3);
    at += marker == 0xFF ? 1 : alone ? 2 : 2 + length;
  }
  for (std::size_t i = bytes.size(); i >= at + 2; --i) {
    if (byte_at(bytes, i - 2) == 0xFF && byte_at(bytes, i - 1) == 0xD9) return;
  }
  throw IoError("the image " + quoted(name) + " is truncated: its end marker is missing");
}

/// libpng writes its complaints to the terminal: a file that is cut off or damaged is told without
/// it, by the chunks' lengths and checksums.
void check_png_chunks(Bytes bytes, std::string_view name) {
  const auto big_endian = [&](std::size_t at) {
    std::size_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value * 256 + byte_at(bytes, at + i);
    return value;
  };
  std::size_t at = 8;
  while (at + 12 <= bytes.size()) {
    const std::size_t length = big_endian(at);
    if (length > bytes.size() - at - 12) break;
    const Bytes checked = bytes.subspan(at + 4, length + 4);  // type and content
    const auto sum = crc32_z(0, reinterpret_cast<const Bytef*>(checked.data()), checked.size());
    if (sum != big_endian(at + 8 + length)) {
      throw IoError("the image " + quoted(name) + " is damaged: a checksum in it is wrong");
    }
    if (starts_with(checked, "IEND")) return;
    at += 12 + length;
  }
  throw IoError("the image " + quoted(name) + " is truncated: its last chunk is missing");
}

/// OpenEXR's data window may be smaller or larger than the picture.
void copy_window(const RawImage& from, int offset_x, int offset_y, RawImage& to) {
  std::memset(to.data(), 0, to.size_bytes());
  const auto pixel = static_cast<std::size_t>(to.channels() * RawImage::code_size(to.type()));
  const int x0 = std::max(0, offset_x);
  const int x1 = std::min(to.width(), offset_x + from.width());
  if (x1 <= x0) return;
  for (int y = 0; y < from.height(); ++y) {
    const int target = y + offset_y;
    if (target < 0 || target >= to.height()) continue;
    const std::uint8_t* source = from.data() + static_cast<std::size_t>(y) * from.row_bytes() +
                                 static_cast<std::size_t>(x0 - offset_x) * pixel;
    std::memcpy(to.data() + static_cast<std::size_t>(target) * to.row_bytes() +
                    static_cast<std::size_t>(x0) * pixel,
                source, static_cast<std::size_t>(x1 - x0) * pixel);
  }
}

RawImage read_pixels(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, std::string_view format,
                     Bytes bytes, std::string_view name) {
  const CodeType type = code_type_of(spec.format, name);
  int channels = std::min(spec.nchannels, 4);
  if (spec.nchannels > 4 && spec.alpha_channel != 3) channels = 3;
  if (channels < 1) throw InvalidInput("the image " + quoted(name) + " has no channels");
  const auto pixel_bytes = static_cast<std::size_t>(spec.width) *
                           static_cast<std::size_t>(spec.height) *
                           static_cast<std::size_t>(channels * RawImage::code_size(type));
  const std::string compression = spec.get_string_attribute("compression");
  check_promise(bytes, largest_packing(format, compression), pixel_bytes, name);
  RawImage image(spec.width, spec.height, channels, type);
  const bool done = input.read_image(0, 0, 0, channels, library_type(type), image.data());
  if (!done || input.has_error()) {
    throw IoError("the image " + quoted(name) + " is damaged or truncated" +
                  reason(input.geterror()));
  }
  if (spec.full_width < 1 || spec.full_height < 1) return image;
  if (spec.x == spec.full_x && spec.y == spec.full_y && spec.width == spec.full_width &&
      spec.height == spec.full_height) {
    return image;
  }
  check_size(spec.full_width, spec.full_height, name);
  RawImage whole(spec.full_width, spec.full_height, channels, type);
  copy_window(image, spec.x - spec.full_x, spec.y - spec.full_y, whole);
  return whole;
}

RawImage decode(Bytes bytes, std::string_view name, ImageTraits* traits) {
  const char* format = format_of(bytes);
  if (bytes.empty()) throw IoError("the image " + quoted(name) + " is empty");
  if (format == nullptr) {
    throw InvalidInput(quoted(name) +
                       " is not an image of a known format; accepted are PNG, JPEG, " +
                       "TIFF, OpenEXR and TGA");
  }
  check_header(bytes, format, name);
  if (std::string_view(format) == "jpeg") check_jpeg_end(bytes, name);
  if (std::string_view(format) == "png") check_png_chunks(bytes, name);
  OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
  const auto input = OIIO::ImageInput::create(format);
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  OIIO::ImageSpec spec;
  if (!input || !input->set_ioproxy(&memory) || !input->open(std::string(name), spec, config)) {
    const std::string error = input ? input->geterror() : OIIO::geterror();
    throw IoError("the image " + quoted(name) + " is damaged or truncated" + reason(error));
  }
  check_size(spec.width, spec.height, name);
  if (spec.depth > 1 || spec.deep) {
    throw InvalidInput("the image " + quoted(name) +
                       " is a volume or deep; accepted are flat ones");
  }
  if (traits != nullptr) {
    *traits = {std::string_view(format) == "tiff", spec.format == OIIO::TypeDesc::HALF};
  }
  return read_pixels(*input, spec, format, bytes, name);
}

}  // namespace

RawImage read_image(std::span<const std::byte> bytes, std::string_view name, ImageTraits* traits) {
  try {
    return decode(bytes, name, traits);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw IoError("the image " + quoted(name) + " cannot be decoded" + reason(error.what()));
  }
}

RawImage read_image(const std::filesystem::path& path, ImageTraits* traits) {
  const std::string bytes = read_file(path);
  return read_image(std::as_bytes(std::span(bytes)), path.string(), traits);
}

}  // namespace normalshop
