#include "normalshop/document/store/stored_files.h"

#include <algorithm>

#include "normalshop/core/error.h"
#include "normalshop/document/store/packing.h"

namespace normalshop {

namespace {

constexpr std::size_t part_bytes = std::size_t{4} << 20U;
constexpr std::int64_t largest_file = std::int64_t{1} << 34;
constexpr std::int64_t no_file = 0;

/// FNV-1a: finds equal files; whether they are equal is then looked at.
std::int64_t digest_of(std::string_view bytes) {
  std::uint64_t digest = 0xCBF29CE484222325U;
  for (const char c : bytes) digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  return static_cast<std::int64_t>(digest);
}

}  // namespace

std::int64_t StoredFiles::find(std::string_view bytes, std::int64_t digest) const {
  Statement same(database_, "SELECT id FROM files WHERE digest = ? AND size = ?");
  same.bind(1, digest).bind(2, static_cast<std::int64_t>(bytes.size()));
  while (same.step()) {
    if (read(same.integer(0), "a file") == bytes) return same.integer(0);
  }
  return no_file;
}

std::int64_t StoredFiles::add(std::string_view bytes) const {
  const std::int64_t digest = digest_of(bytes);
  const std::int64_t same = find(bytes, digest);
  if (same != no_file) return same;
  Statement(database_, "INSERT INTO files(size, digest) VALUES(?, ?)")
      .bind(1, static_cast<std::int64_t>(bytes.size()))
      .bind(2, digest)
      .run();
  const std::int64_t file = database_.last_id();
  Statement part(database_, "INSERT INTO file_parts(file, part, bytes) VALUES(?, ?, ?)");
  std::int64_t number = 0;
  for (std::size_t at = 0; at < bytes.size(); at += part_bytes) {
    const std::string packed = pack(bytes.substr(at, part_bytes));
    part.bind(1, file).bind(2, number++).bind_blob(3, packed).run();
  }
  return file;
}

std::string StoredFiles::read(std::int64_t file, const std::string& name) const {
  Statement head(database_, "SELECT size FROM files WHERE id = ?");
  head.bind(1, file);
  const bool known = head.step() && head.integer(0) >= 0 && head.integer(0) <= largest_file;
  if (!known) database_.fail("is damaged: it does not hold '" + name + "'");
  const auto size = static_cast<std::size_t>(head.integer(0));
  std::string bytes;
  Statement part(database_, "SELECT bytes FROM file_parts WHERE file = ? ORDER BY part");
  part.bind(1, file);
  while (part.step() && bytes.size() < size) {
    try {
      bytes += unpack(part.bytes(0), std::min(part_bytes, size - bytes.size()));
    } catch (const InvalidInput& error) {
      database_.fail("is damaged: its '" + name + "' " + error.what());
    }
  }
  if (bytes.size() != size) database_.fail("is damaged: a part of its '" + name + "' is missing");
  return bytes;
}

}  // namespace normalshop
