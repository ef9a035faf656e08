#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "normalshop/io/file_source.h"

/// Inside the io floor: a glTF file's JSON and buffers, with every field checked before it is used.
///
/// The JSON is read here and not by tinygltf, because the writer edits the same JSON: it must keep
/// its order and everything that it does not know.
namespace normalshop::gltf {

using Json = nlohmann::ordered_json;

struct File {
  std::string name;  ///< for messages
  std::filesystem::path folder;
  bool binary = false;
  Json json;
  std::string text;                  ///< the JSON as it was
  std::vector<std::string> buffers;  ///< contents
};

/// Parses .gltf text or .glb and loads all buffers. Throws InvalidInput or IoError.
File parse(std::span<const std::byte> bytes, const std::filesystem::path& path,
           const FileSource& files);
/// The JSON alone, already known to be good.
Json parse_json(const std::string& text, const std::string& name);

/// `json[key]` as a whole number >= 0; `fallback` when absent. Throws InvalidInput naming `where`.
std::int64_t index_at(const File& file, const Json& json, const char* key, const std::string& where,
                      std::int64_t fallback);
/// The same, required, and below `size`.
std::size_t reference_at(const File& file, const Json& json, const char* key,
                         const std::string& where, std::size_t size);
float number_at(const File& file, const Json& json, const char* key, const std::string& where,
                float fallback);
/// `count` finite numbers, or the fallback when absent.
std::vector<double> numbers_at(const File& file, const Json& json, const char* key,
                               const std::string& where, std::vector<double> fallback);
std::string string_at(const Json& json, const char* key);
/// Array `key`, or an empty one. Throws when it is something else.
const Json& array_at(const File& file, const Json& json, const char* key);
/// Object `key`, or an empty one.
const Json& object_at(const File& file, const Json& json, const char* key);

[[noreturn]] void fail(const File& file, const std::string& what);

/// Bytes of bufferViews[index].
std::span<const std::byte> buffer_view(const File& file, std::size_t index);

/// How an accessor's elements lie in a buffer.
struct Layout {
  std::size_t buffer = 0;
  std::size_t offset = 0;
  std::size_t stride = 0;
};

struct Accessor {
  std::size_t count = 0;
  int components = 0;      ///< 1 to 4
  int component_type = 0;  ///< 5120 .. 5126
  bool normalized = false;
  bool has_data = false;  ///< else all zero before the sparse values
  Layout data;
  std::size_t sparse_count = 0;
  int sparse_index_type = 0;
  Layout sparse_indices;
  Layout sparse_values;
};

std::size_t component_size(int component_type);

/// accessors[index], all its elements known to lie inside their buffers. At most `max_count`.
Accessor accessor(const File& file, std::size_t index, std::size_t max_count);
/// Elements as floats, `accessor.components` a piece, all finite.
std::vector<float> read_floats(const File& file, std::size_t index, std::size_t max_count,
                               int components);
/// Unsigned whole numbers of a SCALAR accessor.
std::vector<std::uint32_t> read_indices(const File& file, std::size_t index, std::size_t max_count);

}  // namespace normalshop::gltf
