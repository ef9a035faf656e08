#include "normalshop/io/staged_folder.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, const std::error_code& error) {
  throw IoError("cannot write into the folder '" + folder.string() + "': " + error.message());
}

void remove_empty(const std::vector<fs::path>& folders) {
  std::error_code ignored;
  for (const fs::path& folder : folders) fs::remove(folder, ignored);
}

}  // namespace

StagedFolder::StagedFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::path missing = folder_.has_filename() ? folder_ : folder_.parent_path();
  for (; !missing.empty() && !fs::exists(missing, error); missing = missing.parent_path()) {
    made_.push_back(missing);
  }
  fs::create_directories(folder_, error);
  if (!error && !fs::is_directory(folder_, error)) {
    error = std::make_error_code(std::errc::not_a_directory);
  }
  std::string name = (folder_ / ".normalshop-XXXXXX").string();
  if (!error && ::mkdtemp(name.data()) == nullptr) {
    error = std::error_code(errno, std::generic_category());
  }
  if (error) {
    remove_empty(made_);
    fail(folder_, error);
  }
  staging_ = name;
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  remove_empty(made_);
}

void StagedFolder::write(const std::function<void()>& job) const {
  try {
    job();
  } catch (const IoError& error) {
    std::string message = error.what();
    const std::string hidden = staging_.string();
    for (auto at = message.find(hidden); at != std::string::npos; at = message.find(hidden, at)) {
      message.replace(at, hidden.size(), folder_.string());
      at += folder_.string().size();
    }
    throw IoError(message);
  }
}

std::vector<fs::path> StagedFolder::commit(const std::vector<fs::path>& files) {
  std::vector<fs::path> placed;
  std::error_code error;
  for (const fs::path& file : files) {
    placed.push_back(folder_ / file.lexically_relative(staging_));
    fs::create_directories(placed.back().parent_path(), error);
    // What can fail is looked for before the first file takes its place.
    if (!error && fs::is_directory(placed.back())) {
      error = std::make_error_code(std::errc::is_a_directory);
    }
    if (error) {
      throw IoError("cannot write '" + placed.back().string() + "': " + error.message());
    }
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    fs::rename(files[i], placed[i], error);
    if (error) throw IoError("cannot write '" + placed[i].string() + "': " + error.message());
  }
  made_.clear();
  return placed;
}

}  // namespace normalshop
