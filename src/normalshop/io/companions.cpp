#include <system_error>

#include "normalshop/core/error.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/detail/model_source.h"
#include "normalshop/io/udim.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

bool leads_out(const fs::path& reference) {
  return reference.is_absolute() || reference.empty() || *reference.begin() == "..";
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

Companions::Companions(const ModelSource& source, const fs::path& model_path,
                       const std::map<std::size_t, MapReferences>& maps)
    : source_folder_(source.folder), files_(source.files), folder_(folder_of(model_path)) {
  for (const auto& [set, reference] : maps) {
    for (const std::string& file : {reference.normal, reference.color}) {
      if (!file.empty()) reserved_.push_back((folder_ / file).lexically_normal());
    }
  }
  reserved_.push_back(model_path.lexically_normal());
}

std::string Companions::place(const std::string& reference) const {
  const fs::path normal = fs::path(reference).lexically_normal();
  return leads_out(normal) ? normal.filename().string() : normal.generic_string();
}

/// Files of one name from different folders that lie outside the model's become name_2 and so on.
std::string Companions::unused(const std::string& wanted) const {
  const fs::path path(wanted);
  std::string name = wanted;
  for (int i = 2; taken_.contains(name); ++i) {
    const std::string numbered = path.stem().string() + "_" + std::to_string(i);
    name = (path.parent_path() / (numbered + path.extension().string())).generic_string();
  }
  return name;
}

bool Companions::reserved(const fs::path& target) const {
  for (const fs::path& other : reserved_) {
    if (other == target.lexically_normal()) return true;
  }
  return false;
}

void Companions::put(const std::string& name, std::string_view bytes) {
  const fs::path target = folder_ / name;
  std::error_code error;
  fs::create_directories(folder_of(target), error);
  write_file(target, bytes);
  result.files.push_back(target);
}

std::string Companions::write(const std::string& reference, std::string_view bytes) {
  std::string name = unused(place(reference));
  taken_.insert(name);
  put(name, bytes);
  return name;
}

/// Every tile's file, as far as they exist.
std::string Companions::copy_tiles(const std::string& reference) {
  std::string pattern = place(reference);
  if (reserved(folder_ / pattern)) return pattern;
  for (int tile = first_tile_number; tile <= last_tile_number; ++tile) {
    const std::string name = tile_path(reference, tile).generic_string();
    if (files_->has(source_folder_ / name)) copy(name);
  }
  return pattern;
}

std::string Companions::copy(const std::string& reference) {
  if (names_tiles(reference)) return copy_tiles(reference);
  const fs::path from = source_folder_ / reference;
  const std::string key = from.lexically_normal().string();
  const auto known = done_.find(key);
  if (known != done_.end()) return known->second;
  std::string name = unused(place(reference));
  taken_.insert(name);
  done_[key] = name;
  const fs::path target = folder_ / name;
  std::error_code error;
  if (name.empty() || reserved(target) || fs::equivalent(from, target, error)) return name;
  if (!files_->has(from)) {
    result.notes.push_back("'" + from.string() +
                           "' is missing, so it is not copied beside the model");
    return name;
  }
  put(name, files_->read(from));
  return name;
}

}  // namespace normalshop
