#include <algorithm>
#include <cmath>
#include <cstring>

#include "normalshop/io/detail/gltf_file.h"

namespace normalshop::gltf {

namespace {

/// A few bytes of JSON must not ask for gigabytes of zeros.
constexpr std::size_t largest_without_data = std::size_t{1} << 20;

const std::byte* at(const File& file, const Layout& layout, std::size_t element) {
  return reinterpret_cast<const std::byte*>(file.buffers[layout.buffer].data()) + layout.offset +
         element * layout.stride;
}

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

float component(const std::byte* from, int type, bool normalized) {
  float top = 1.0F;
  float value = 0.0F;
  switch (type) {
    case 5120:
      value = load<std::int8_t>(from), top = 127.0F;
      break;
    case 5121:
      value = load<std::uint8_t>(from), top = 255.0F;
      break;
    case 5122:
      value = load<std::int16_t>(from), top = 32767.0F;
      break;
    case 5123:
      value = load<std::uint16_t>(from), top = 65535.0F;
      break;
    case 5125:
      value = static_cast<float>(load<std::uint32_t>(from)), top = 4294967295.0F;
      break;
    default:
      return load<float>(from);
  }
  return normalized ? std::max(value / top, -1.0F) : value;
}

std::uint32_t whole(const std::byte* from, int type) {
  if (type == 5121) return load<std::uint8_t>(from);
  if (type == 5123) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

int components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return 0;
}

struct View {
  std::size_t buffer;
  std::size_t offset;
  std::size_t length;
  std::size_t stride;  ///< 0: tightly packed
};

View view_at(const File& file, std::size_t index) {
  const Json& views = array_at(file, file.json, "bufferViews");
  const std::string where = "bufferViews[" + std::to_string(index) + "]";
  const Json& view = views.at(index);
  View v{};
  v.buffer = reference_at(file, view, "buffer", where, file.buffers.size());
  v.offset = static_cast<std::size_t>(index_at(file, view, "byteOffset", where, 0));
  v.length = static_cast<std::size_t>(index_at(file, view, "byteLength", where, 0));
  v.stride = static_cast<std::size_t>(index_at(file, view, "byteStride", where, 0));
  const std::size_t size = file.buffers[v.buffer].size();
  if (v.offset > size || v.length > size - v.offset) {
    fail(file, where + " reaches beyond the end of buffers[" + std::to_string(v.buffer) + "]");
  }
  return v;
}

/// Where `count` elements lie that a bufferView holds from `json.byteOffset` on.
Layout layout_at(const File& file, const Json& json, const std::string& where, std::size_t count,
                 std::size_t element_size, bool may_stride) {
  const std::size_t views = array_at(file, file.json, "bufferViews").size();
  const std::size_t index = reference_at(file, json, "bufferView", where, views);
  const View view = view_at(file, index);
  const auto offset = static_cast<std::size_t>(index_at(file, json, "byteOffset", where, 0));
  Layout layout{view.buffer, view.offset + offset, element_size};
  if (may_stride && view.stride != 0) layout.stride = view.stride;
  if (layout.stride < element_size || layout.stride > 65536) {
    fail(file, "bufferViews[" + std::to_string(index) + "].byteStride is " +
                   std::to_string(layout.stride) + "; at least " + std::to_string(element_size) +
                   " is needed");
  }
  // All numbers are below 2^53, and count is limited: no product overflows.
  const std::size_t needed = count == 0 ? 0 : (count - 1) * layout.stride + element_size;
  if (offset > view.length || needed > view.length - offset) {
    fail(file, where + " reaches beyond the end of bufferViews[" + std::to_string(index) + "]");
  }
  return layout;
}

void read_sparse(const File& file, const Json& json, const std::string& where, Accessor& a) {
  const Json& sparse = object_at(file, json, "sparse");
  if (sparse.empty()) return;
  a.sparse_count = static_cast<std::size_t>(index_at(file, sparse, "count", where + ".sparse", 0));
  if (a.sparse_count > a.count) fail(file, where + ".sparse.count is larger than its count");
  const Json& indices = object_at(file, sparse, "indices");
  const Json& values = object_at(file, sparse, "values");
  const auto type = index_at(file, indices, "componentType", where + ".sparse.indices", 0);
  if (type != 5121 && type != 5123 && type != 5125) {
    fail(file, where + ".sparse.indices.componentType must be 5121, 5123 or 5125");
  }
  a.sparse_index_type = static_cast<int>(type);
  a.sparse_indices = layout_at(file, indices, where + ".sparse.indices", a.sparse_count,
                               component_size(a.sparse_index_type), false);
  a.sparse_values =
      layout_at(file, values, where + ".sparse.values", a.sparse_count,
                component_size(a.component_type) * static_cast<std::size_t>(a.components), false);
}

}  // namespace

std::size_t component_size(int component_type) {
  if (component_type == 5120 || component_type == 5121) return 1;
  if (component_type == 5122 || component_type == 5123) return 2;
  return 4;
}

std::span<const std::byte> buffer_view(const File& file, std::size_t index) {
  const View view = view_at(file, index);
  const std::string& buffer = file.buffers[view.buffer];
  return std::as_bytes(std::span(buffer)).subspan(view.offset, view.length);
}

Accessor accessor(const File& file, std::size_t index, std::size_t max_count) {
  const std::string where = "accessors[" + std::to_string(index) + "]";
  const Json& json = array_at(file, file.json, "accessors").at(index);
  Accessor a;
  a.count = static_cast<std::size_t>(index_at(file, json, "count", where, 0));
  if (a.count > max_count) {
    fail(file, where + ".count is " + std::to_string(a.count) + "; accepted are at most " +
                   std::to_string(max_count));
  }
  a.components = components_of(string_at(json, "type"));
  if (a.components == 0) fail(file, where + ".type must be SCALAR, VEC2, VEC3 or VEC4");
  const auto type = index_at(file, json, "componentType", where, 0);
  if (type < 5120 || type > 5126 || type == 5124) {
    fail(file, where + ".componentType must be 5120 to 5123, 5125 or 5126");
  }
  a.component_type = static_cast<int>(type);
  const auto normalized = json.find("normalized");
  a.normalized = normalized != json.end() && normalized->is_boolean() && normalized->get<bool>();
  a.has_data = json.contains("bufferView");
  if (a.has_data) {
    a.data =
        layout_at(file, json, where, a.count,
                  component_size(a.component_type) * static_cast<std::size_t>(a.components), true);
  }
  if (!a.has_data && a.count > largest_without_data) {
    fail(file, where + ".count is " + std::to_string(a.count) + ", but it has no bufferView; " +
                   "accepted are then at most " + std::to_string(largest_without_data));
  }
  read_sparse(file, json, where, a);
  return a;
}

std::vector<float> read_floats(const File& file, std::size_t index, std::size_t max_count,
                               int components) {
  const std::string where = "accessors[" + std::to_string(index) + "]";
  const Accessor a = accessor(file, index, max_count);
  if (a.components != components) {
    fail(file, where + ".type must have " + std::to_string(components) + " components here");
  }
  const auto n = static_cast<std::size_t>(components);
  const std::size_t size = component_size(a.component_type);
  std::vector<float> values(a.count * n, 0.0F);
  const auto read_element = [&](const std::byte* from, float* to) {
    for (std::size_t c = 0; c < n; ++c) {
      to[c] = component(from + c * size, a.component_type, a.normalized);
    }
  };
  for (std::size_t i = 0; a.has_data && i < a.count; ++i) {
    read_element(at(file, a.data, i), &values[i * n]);
  }
  for (std::size_t i = 0; i < a.sparse_count; ++i) {
    const std::size_t target = whole(at(file, a.sparse_indices, i), a.sparse_index_type);
    if (target >= a.count) fail(file, where + ".sparse has an index beyond its count");
    read_element(at(file, a.sparse_values, i), &values[target * n]);
  }
  for (const float value : values) {
    if (!std::isfinite(value)) fail(file, where + " holds a number that is not finite");
  }
  return values;
}

std::vector<std::uint32_t> read_indices(const File& file, std::size_t index,
                                        std::size_t max_count) {
  const std::string where = "accessors[" + std::to_string(index) + "]";
  const Accessor a = accessor(file, index, max_count);
  const bool type_fits =
      a.component_type == 5121 || a.component_type == 5123 || a.component_type == 5125;
  if (!type_fits || a.components != 1) {
    fail(file, where + " holds indices: it must be SCALAR with componentType 5121, 5123 or 5125");
  }
  std::vector<std::uint32_t> values(a.count, 0);
  for (std::size_t i = 0; a.has_data && i < a.count; ++i) {
    values[i] = whole(at(file, a.data, i), a.component_type);
  }
  for (std::size_t i = 0; i < a.sparse_count; ++i) {
    const std::size_t target = whole(at(file, a.sparse_indices, i), a.sparse_index_type);
    if (target >= a.count) fail(file, where + ".sparse has an index beyond its count");
    values[target] = whole(at(file, a.sparse_values, i), a.component_type);
  }
  return values;
}

}  // namespace normalshop::gltf
