#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "normalshop/document/store/database.h"

namespace normalshop {

/// Files inside a document, byte for byte, in packed parts. Equal ones are kept once.
class StoredFiles {
 public:
  explicit StoredFiles(const Database& database) : database_(database) {}

  /// Inside the caller's transaction; the file's id.
  std::int64_t add(std::string_view bytes) const;
  /// `name` stands for the file in messages.
  std::string read(std::int64_t file, const std::string& name) const;

 private:
  std::int64_t find(std::string_view bytes, std::int64_t digest) const;

  const Database& database_;
};

}  // namespace normalshop
