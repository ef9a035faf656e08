#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Inside the io floor: URIs as glTF uses them.
namespace normalshop {

/// "%20" becomes " ". A "%" that no two hexadecimal digits follow stays.
std::string percent_decoded(std::string_view uri);
/// Everything but unreserved characters and "/" as "%XX".
std::string percent_encoded(std::string_view path);

struct DataUri {
  std::string mime;
  std::string bytes;
};
/// Content of "data:[mime][;base64],..."; nothing when it is not a data URI or its base64 is
/// damaged.
std::optional<DataUri> decode_data_uri(std::string_view uri);
inline bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }
/// "https://..." and the like, which are not files.
bool has_scheme(std::string_view uri);

std::string base64(std::string_view bytes);

}  // namespace normalshop
