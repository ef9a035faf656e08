#include "normalshop/io/detail/gltf_file.h"

#include <cmath>
#include <cstring>

#include "normalshop/core/error.h"
#include "normalshop/io/detail/uri.h"

namespace normalshop::gltf {

namespace {

const Json empty_array = Json::array();
const Json empty_object = Json::object();

std::uint32_t word(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  }
  return value;
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Splits a .glb into its JSON and its binary chunk.
void split_chunks(File& file, std::span<const std::byte> bytes, std::string& binary) {
  if (bytes.size() < 20) fail(file, "is truncated: a .glb has at least 20 bytes");
  if (word(bytes, 4) != 2)
    fail(file, "has glTF version " + std::to_string(word(bytes, 4)) + "; accepted is 2");
  const std::size_t length = word(bytes, 8);
  if (length > bytes.size())
    fail(file, "is truncated: it states " + std::to_string(length) + " bytes and has " +
                   std::to_string(bytes.size()));
  std::size_t at = 12;
  for (int chunk = 0; at + 8 <= length; ++chunk) {
    const std::size_t size = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    if (size > length - at - 8) fail(file, "is damaged: a chunk is longer than the file");
    if (chunk == 0 && type != 0x4E4F534AU) fail(file, "is damaged: its first chunk is no JSON");
    if (chunk == 0) file.text = text_of(bytes.subspan(at + 8, size));
    if (chunk == 1 && type == 0x004E4942U) binary = text_of(bytes.subspan(at + 8, size));
    at += 8 + size;
  }
}

std::string load_buffer(const File& file, const Json& buffer, const std::string& where,
                        std::string& binary, const FileSource& files) {
  const std::string uri = string_at(buffer, "uri");
  if (uri.empty()) {
    if (file.binary && where == "buffers[0]") return std::move(binary);
    return {};
  }
  if (is_data_uri(uri)) {
    auto data = decode_data_uri(uri);
    if (!data) fail(file, where + ".uri is a damaged data URI");
    return std::move(data->bytes);
  }
  if (has_scheme(uri)) fail(file, where + ".uri is '" + uri + "'; accepted are files beside it");
  return files.read(file.folder / percent_decoded(uri));
}

void load_buffers(File& file, std::string& binary, const FileSource& files) {
  const Json& buffers = array_at(file, file.json, "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = "buffers[" + std::to_string(i) + "]";
    const std::int64_t length = index_at(file, buffers[i], "byteLength", where, 0);
    file.buffers.push_back(load_buffer(file, buffers[i], where, binary, files));
    if (file.buffers.back().size() < static_cast<std::size_t>(length)) {
      fail(file, where + " should have " + std::to_string(length) + " bytes and has " +
                     std::to_string(file.buffers.back().size()));
    }
  }
}

/// Writing JSON recurses, so nesting is limited before anything is built.
bool is_too_deep(const std::string& text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > 256) return true;
  }
  return false;
}

}  // namespace

void fail(const File& file, const std::string& what) {
  throw InvalidInput("'" + file.name + "': " + what);
}

Json parse_json(const std::string& text, const std::string& name) {
  if (is_too_deep(text)) {
    throw InvalidInput("'" + name + "' nests its JSON deeper than 256 levels");
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    throw InvalidInput("'" + name + "' is no glTF file: it does not hold a JSON object");
  }
  return json;
}

File parse(std::span<const std::byte> bytes, const std::filesystem::path& path,
           const FileSource& files) {
  File file;
  file.name = path.string();
  file.folder = path.parent_path();
  std::string binary;
  file.binary = bytes.size() >= 4 && word(bytes, 0) == 0x46546C67U;
  if (file.binary) {
    split_chunks(file, bytes, binary);
  } else {
    file.text = text_of(bytes);
  }
  file.json = parse_json(file.text, file.name);
  const std::string version = string_at(object_at(file, file.json, "asset"), "version");
  if (!version.starts_with("2.")) {
    fail(file, "asset.version is '" + version.substr(0, 20) + "'; accepted is glTF 2.x");
  }
  load_buffers(file, binary, files);
  return file;
}

std::int64_t index_at(const File& file, const Json& json, const char* key, const std::string& where,
                      std::int64_t fallback) {
  const auto found = json.find(key);
  if (found == json.end()) return fallback;
  constexpr double limit = 9007199254740992.0;  // 2^53
  if (found->is_number()) {
    const double value = found->get<double>();
    if (value >= 0.0 && value < limit && value == std::floor(value)) {
      return static_cast<std::int64_t>(value);
    }
  }
  fail(file, where + "." + key + " must be a whole number of at least 0");
}

std::size_t reference_at(const File& file, const Json& json, const char* key,
                         const std::string& where, std::size_t size) {
  const std::int64_t value = index_at(file, json, key, where, -1);
  if (value < 0) fail(file, where + "." + key + " is missing");
  if (static_cast<std::uint64_t>(value) >= size) {
    fail(file, where + "." + key + " is " + std::to_string(value) + ", but there are only " +
                   std::to_string(size));
  }
  return static_cast<std::size_t>(value);
}

float number_at(const File& file, const Json& json, const char* key, const std::string& where,
                float fallback) {
  const auto found = json.find(key);
  if (found == json.end()) return fallback;
  const double value = found->is_number() ? found->get<double>() : std::nan("");
  if (!(std::abs(value) <= 1e30)) fail(file, where + "." + key + " must be a number");
  return static_cast<float>(value);
}

std::vector<double> numbers_at(const File& file, const Json& json, const char* key,
                               const std::string& where, std::vector<double> fallback) {
  const auto found = json.find(key);
  if (found == json.end()) return fallback;
  const std::string message =
      where + "." + key + " must be " + std::to_string(fallback.size()) + " numbers";
  if (!found->is_array() || found->size() != fallback.size()) fail(file, message);
  for (std::size_t i = 0; i < fallback.size(); ++i) {
    const Json& value = (*found)[i];
    fallback[i] = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(fallback[i]) <= 1e30)) fail(file, message);
  }
  return fallback;
}

std::string string_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

const Json& array_at(const File& file, const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return empty_array;
  if (!found->is_array()) fail(file, std::string(key) + " must be a list");
  return *found;
}

const Json& object_at(const File& file, const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end()) return empty_object;
  if (!found->is_object()) fail(file, std::string(key) + " must be an object");
  return *found;
}

}  // namespace normalshop::gltf
