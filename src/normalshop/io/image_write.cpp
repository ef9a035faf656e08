#include <algorithm>
#include <cctype>
#include <string>

#include <OpenImageIO/imageio.h>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/image_file.h"

namespace normalshop {

namespace {

struct Format {
  const char* library_name;
  const char* accepts;
  bool u8, u16, f32;
  int channels;  ///< bit c: c channels are accepted
};

constexpr int one_to_four = 0b11110;

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Format format_for(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".png") {
    return {"png", "PNG takes 8 and 16 bits", true, true, false, one_to_four};
  }
  if (extension == ".tif" || extension == ".tiff") {
    return {"tiff", "TIFF takes 8, 16 and 32 bits", true, true, true, one_to_four};
  }
  if (extension == ".exr") {
    return {"openexr", "OpenEXR takes floats", false, false, true, one_to_four};
  }
  if (extension == ".jpg" || extension == ".jpeg") {
    return {"jpeg", "JPEG takes 8 bits and 1 or 3 channels", true, false, false, 0b01010};
  }
  if (extension == ".tga") {
    return {"targa", "TGA takes 8 bits and 1, 3 or 4 channels", true, false, false, 0b11010};
  }
  throw InvalidInput("cannot write '" + path.string() +
                     "': the extension must be .png, .tif, .tiff, .exr, .jpg, .jpeg or .tga");
}

void check_fit(const std::filesystem::path& path, const Format& format, const RawImage& image) {
  const bool type_fits = image.type() == CodeType::U8    ? format.u8
                         : image.type() == CodeType::U16 ? format.u16
                                                         : format.f32;
  if (image.empty()) throw InvalidInput("cannot write '" + path.string() + "': no pixels");
  if (type_fits && (format.channels >> image.channels() & 1) != 0) return;
  throw InvalidInput("cannot write '" + path.string() + "': " + format.accepts +
                     ", the image has " + std::to_string(image.channels()) + " channels of " +
                     std::string(name_of(image.type())) + " bits");
}

OIIO::ImageSpec spec_of(const Format& format, const RawImage& image,
                        const ImageWriteOptions& options) {
  const OIIO::TypeDesc type = image.type() == CodeType::U8    ? OIIO::TypeDesc::UINT8
                              : image.type() == CodeType::U16 ? OIIO::TypeDesc::UINT16
                              : options.half_float            ? OIIO::TypeDesc::HALF
                                                              : OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(image.width(), image.height(), image.channels(), type);
  // Two channels are the x and y of a normal, not gray and alpha, where the format can say so.
  if (image.channels() == 2) spec.channelnames = {"R", "G"};
  if (image.channels() == 2) spec.alpha_channel = -1;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("png:compressionLevel", std::clamp(options.png_compression, 0, 9));
  spec.attribute("jpeg:subsampling", "4:4:4");
  const std::string_view name = format.library_name;
  if (name == "jpeg") {
    spec.attribute("compression",
                   "jpeg:" + std::to_string(std::clamp(options.jpeg_quality, 1, 100)));
  }
  if (name == "tiff" || name == "openexr") spec.attribute("compression", "zip");
  if (name == "targa") spec.attribute("compression", "rle");
  return spec;
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& error) {
  throw IoError("cannot write '" + path.string() + "': " + error.substr(0, error.find('\n')));
}

}  // namespace

void write_image(const std::filesystem::path& path, const RawImage& image,
                 const ImageWriteOptions& options) {
  const Format format = format_for(path);
  check_fit(path, format, image);
  PendingFile pending(path);
  const auto output = OIIO::ImageOutput::create(format.library_name);
  if (!output) fail(path, OIIO::geterror());
  const OIIO::ImageSpec spec = spec_of(format, image, options);
  const OIIO::TypeDesc stored = image.type() == CodeType::U8    ? OIIO::TypeDesc::UINT8
                                : image.type() == CodeType::U16 ? OIIO::TypeDesc::UINT16
                                                                : OIIO::TypeDesc::FLOAT;
  const bool written = output->open(pending.path().string(), spec) &&
                       output->write_image(stored, image.data()) && output->close();
  if (!written) fail(path, output->geterror());
  pending.commit();
}

}  // namespace normalshop
