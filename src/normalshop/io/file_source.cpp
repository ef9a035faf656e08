#include "normalshop/io/file_source.h"

#include <system_error>

#include "normalshop/io/atomic_file.h"

namespace normalshop {

namespace {

class DiskFiles : public FileSource {
 public:
  bool has(const std::filesystem::path& path) const override {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
  }
  std::string read(const std::filesystem::path& path) const override {
    return normalshop::read_file(path);
  }
};

}  // namespace

const std::shared_ptr<const FileSource>& disk_files() {
  static const std::shared_ptr<const FileSource> disk = std::make_shared<DiskFiles>();
  return disk;
}

}  // namespace normalshop
