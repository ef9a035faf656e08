#include <cstddef>
#include <cstdint>
#include <span>

#include "normalshop/core/error.h"
#include "normalshop/io/conventions.h"
#include "normalshop/io/image_file.h"

/// Any bytes give an image or an Error; an image gives a guess of its convention.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace normalshop;
  try {
    const RawImage image = read_image(std::as_bytes(std::span(data, size)), "fuzz");
    if (image.channels() >= 2) guess_convention(image);
    looks_like_normal_map(image);
  } catch (const Error&) {
  }
  return 0;
}
