#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/extension.h"
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

/// `image` may be the first rows of `height`.
OIIO::ImageSpec spec_of(const Format& format, const RawImage& image, int height,
                        const ImageWriteOptions& options) {
  const OIIO::TypeDesc type = image.type() == CodeType::U8    ? OIIO::TypeDesc::UINT8
                              : image.type() == CodeType::U16 ? OIIO::TypeDesc::UINT16
                              : options.half_float            ? OIIO::TypeDesc::HALF
                                                              : OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(image.width(), height, image.channels(), type);
  // Two channels are the x and y of a normal, not gray and alpha, where the format can say so.
  if (image.channels() == 2) spec.channelnames = {"R", "G"};
  if (image.channels() == 2) spec.alpha_channel = -1;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("png:compressionLevel", 3);  // fast, and within a few percent of 6
  spec.attribute("jpeg:subsampling", "4:4:4");
  const std::string_view name = format.library_name;
  if (name == "jpeg") spec.attribute("compression", "jpeg:95");
  if (name == "tiff" || name == "openexr") spec.attribute("compression", "zip");
  if (name == "targa") spec.attribute("compression", "rle");
  return spec;
}

/// The file that the library writes to. Some of its formats don't look whether the disk took their
/// bytes (a full one does not), so the first failure is kept here.
class CheckedFile : public OIIO::Filesystem::IOProxy {
 public:
  explicit CheckedFile(const std::filesystem::path& path)
      : IOProxy(path.string(), Write), file_(std::fopen(path.c_str(), "w+b")) {
    check(file_ != nullptr);
  }
  CheckedFile(const CheckedFile&) = delete;
  CheckedFile& operator=(const CheckedFile&) = delete;
  ~CheckedFile() override { close(); }

  const char* proxytype() const override { return "file"; }
  void close() override {
    if (file_ != nullptr) check(std::fclose(file_) == 0);
    file_ = nullptr;
    m_mode = Closed;
  }
  std::int64_t tell() override { return file_ != nullptr ? std::ftell(file_) : 0; }
  bool seek(std::int64_t offset) override {
    return file_ != nullptr && check(std::fseek(file_, offset, SEEK_SET) == 0);
  }
  std::size_t read(void* bytes, std::size_t size) override {
    return file_ != nullptr ? std::fread(bytes, 1, size, file_) : 0;
  }
  std::size_t write(const void* bytes, std::size_t size) override {
    const std::size_t written = file_ != nullptr ? std::fwrite(bytes, 1, size, file_) : 0;
    check(written == size);
    return written;
  }
  std::size_t size() const override {
    if (file_ == nullptr) return 0;
    const long here = std::ftell(file_);
    std::fseek(file_, 0, SEEK_END);
    const long end = std::ftell(file_);
    std::fseek(file_, here, SEEK_SET);
    return static_cast<std::size_t>(end);
  }
  void flush() const override {
    if (file_ != nullptr) std::fflush(file_);
  }
  /// Of the first call that failed; 0: none.
  int error_code() const { return error_code_; }

 private:
  bool check(bool done) {
    if (!done && error_code_ == 0) error_code_ = errno != 0 ? errno : EIO;
    return done;
  }

  std::FILE* file_;
  int error_code_ = 0;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& error) {
  throw IoError("cannot write '" + path.string() + "': " + error.substr(0, error.find('\n')));
}

/// Whole chunks of rows of every format that packs several at once.
constexpr int band_height = 256;

/// A file of `height` rows like those of `first`, which write(output, type) writes.
template <class Write>
void write_file_of(const std::filesystem::path& path, const RawImage& first, int height,
                   const ImageWriteOptions& options, const Write& write) {
  const Format format = format_for(path);
  check_fit(path, format, first);
  PendingFile pending(path);
  const auto output = OIIO::ImageOutput::create(format.library_name);
  if (!output) fail(path, OIIO::geterror());
  const OIIO::ImageSpec spec = spec_of(format, first, height, options);
  const OIIO::TypeDesc stored = first.type() == CodeType::U8    ? OIIO::TypeDesc::UINT8
                                : first.type() == CodeType::U16 ? OIIO::TypeDesc::UINT16
                                                                : OIIO::TypeDesc::FLOAT;
  CheckedFile file(pending.path());
  const bool written = file.error_code() == 0 && output->set_ioproxy(&file) &&
                       output->open(pending.path().string(), spec) && write(*output, stored) &&
                       output->close();
  const std::string error = output->geterror();
  file.close();
  if (file.error_code() != 0) fail(path, std::generic_category().message(file.error_code()));
  if (!written) fail(path, error);
  pending.commit();
}

}  // namespace

void write_image(const std::filesystem::path& path, const RawImage& image,
                 const ImageWriteOptions& options) {
  write_file_of(path, image, image.height(), options,
                [&](OIIO::ImageOutput& output, const OIIO::TypeDesc& stored) {
                  return output.write_image(stored, image.data());
                });
}

void write_image(const std::filesystem::path& path, int height,
                 const std::function<RawImage(int y, int count)>& rows,
                 const ImageWriteOptions& options) {
  RawImage band = rows(0, std::min(height, band_height));
  write_file_of(path, band, height, options,
                [&](OIIO::ImageOutput& output, const OIIO::TypeDesc& stored) {
                  for (int y = 0; y < height; y += band_height) {
                    const int end = std::min(height, y + band_height);
                    if (y > 0) band = rows(y, end - y);
                    if (!output.write_scanlines(y, end, 0, stored, band.data())) return false;
                  }
                  return true;
                });
}

}  // namespace normalshop
