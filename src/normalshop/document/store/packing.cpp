#include "normalshop/document/store/packing.h"

#include <memory>
#include <new>

#include <zstd.h>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

constexpr int level = 1;  // higher ones win 3 % on tiles of normals and take 3 times as long

[[noreturn]] void damaged(const std::string& why) { throw InvalidInput("is damaged: " + why); }

}  // namespace

std::string pack(std::string_view bytes) {
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(),
                                                                        ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the one way in which it can fail
  packed.resize(size);
  return packed;
}

std::string unpack(std::string_view packed, std::size_t largest) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) {
    damaged("it does not begin as it should");
  }
  if (size > largest) damaged("it states " + std::to_string(size) + " bytes");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  const std::size_t done =
      ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(done) != 0) damaged(ZSTD_getErrorName(done));
  if (done != bytes.size()) damaged("it ends too early");
  return bytes;
}

}  // namespace normalshop
