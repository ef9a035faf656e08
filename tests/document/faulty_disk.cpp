#include "document/faulty_disk.h"

#include <fstream>
#include <iterator>

#include <sqlite3.h>

#include "normalshop/core/random.h"

namespace normalshop::test {

namespace {

FaultyDisk* disk = nullptr;
sqlite3_vfs* below = nullptr;

/// In SQLite's memory, followed by the file that it stands for.
struct ShimFile {
  sqlite3_file base;
  std::string* path;
};

sqlite3_file* real(sqlite3_file* file) {
  return reinterpret_cast<sqlite3_file*>(reinterpret_cast<ShimFile*>(file) + 1);
}
const std::string& path_of(sqlite3_file* file) { return *reinterpret_cast<ShimFile*>(file)->path; }

int close_file(sqlite3_file* file) {
  delete reinterpret_cast<ShimFile*>(file)->path;
  return real(file)->pMethods->xClose(real(file));
}
int read_from(sqlite3_file* file, void* to, int count, sqlite3_int64 offset) {
  return real(file)->pMethods->xRead(real(file), to, count, offset);
}
int write_to(sqlite3_file* file, const void* from, int count, sqlite3_int64 offset) {
  if (const int code = disk->next(SQLITE_IOERR_WRITE)) return code;
  const int code = real(file)->pMethods->xWrite(real(file), from, count, offset);
  if (code != SQLITE_OK) return code;
  disk->changed(path_of(file),
                {static_cast<std::size_t>(offset),
                 std::string(static_cast<const char*>(from), static_cast<std::size_t>(count))});
  return code;
}
int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  if (const int code = disk->next(SQLITE_IOERR_TRUNCATE)) return code;
  const int code = real(file)->pMethods->xTruncate(real(file), size);
  if (code == SQLITE_OK) disk->changed(path_of(file), {static_cast<std::size_t>(size), {}, true});
  return code;
}
int sync_file(sqlite3_file* file, int flags) {
  if (const int code = disk->next(SQLITE_IOERR_FSYNC)) return code;
  const int code = real(file)->pMethods->xSync(real(file), flags);
  if (code == SQLITE_OK) disk->synced(path_of(file));
  return code;
}
int size_of(sqlite3_file* file, sqlite3_int64* size) {
  return real(file)->pMethods->xFileSize(real(file), size);
}
int lock_file(sqlite3_file* file, int level) {
  return real(file)->pMethods->xLock(real(file), level);
}
int unlock_file(sqlite3_file* file, int level) {
  return real(file)->pMethods->xUnlock(real(file), level);
}
int check_lock(sqlite3_file* file, int* out) {
  return real(file)->pMethods->xCheckReservedLock(real(file), out);
}
int control(sqlite3_file* file, int operation, void* argument) {
  return real(file)->pMethods->xFileControl(real(file), operation, argument);
}
int sector_size(sqlite3_file* file) { return real(file)->pMethods->xSectorSize(real(file)); }
int characteristics(sqlite3_file* file) {
  return real(file)->pMethods->xDeviceCharacteristics(real(file));
}

constexpr sqlite3_io_methods methods{
    1,         close_file,  read_from,  write_to, truncate_file, sync_file,       size_of,
    lock_file, unlock_file, check_lock, control,  sector_size,   characteristics, nullptr,
    nullptr,   nullptr,     nullptr,    nullptr,  nullptr};

int open_file(sqlite3_vfs* /*vfs*/, const char* name, sqlite3_file* file, int flags, int* out) {
  file->pMethods = nullptr;
  const int code = below->xOpen(below, name, real(file), flags, out);
  if (code != SQLITE_OK) return code;
  reinterpret_cast<ShimFile*>(file)->path = new std::string(name == nullptr ? "" : name);
  file->pMethods = &methods;
  disk->opened(path_of(file));
  return code;
}

int delete_file(sqlite3_vfs* /*vfs*/, const char* name, int sync) {
  if (const int code = disk->next(SQLITE_IOERR_DELETE)) return code;
  disk->deleted(name);
  return below->xDelete(below, name, sync);
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void apply(const FaultyDisk::Change& change, std::string& content) {
  if (change.truncates) {
    content.resize(change.offset);
    return;
  }
  const std::size_t end = change.offset + change.bytes.size();
  if (content.size() < end) content.resize(end);
  content.replace(change.offset, change.bytes.size(), change.bytes);
}

}  // namespace

struct FaultyDisk::Vfs {
  sqlite3_vfs shim;
};

FaultyDisk::FaultyDisk() : vfs_(std::make_unique<Vfs>()) {
  sqlite3_initialize();
  disk = this;
  below = sqlite3_vfs_find(nullptr);
  vfs_->shim = *below;
  vfs_->shim.zName = "faulty";
  vfs_->shim.szOsFile = static_cast<int>(sizeof(ShimFile)) + below->szOsFile;
  vfs_->shim.xOpen = open_file;
  vfs_->shim.xDelete = delete_file;
  sqlite3_vfs_register(&vfs_->shim, 1);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(&vfs_->shim);
  sqlite3_vfs_register(below, 1);
  disk = nullptr;
}

void FaultyDisk::arm(Fault fault, std::size_t operation) {
  fault_ = fault;
  operation_ = operation;
  count_ = 0;
  files_.clear();
}

int FaultyDisk::next(int error) {
  const std::size_t operation = count_++;
  const bool hit = fault_ == Fault::PowerCut ? operation >= operation_ : operation == operation_;
  if (fault_ == Fault::None || !hit) return 0;
  return fault_ == Fault::Full ? SQLITE_FULL : error;
}

void FaultyDisk::opened(const std::string& path) {
  if (!path.empty()) files_.try_emplace(path, File{content_of(path), {}});
}

void FaultyDisk::synced(const std::string& path) {
  if (!path.empty()) files_[path] = {content_of(path), {}};
}

void FaultyDisk::changed(const std::string& path, Change change) {
  if (!path.empty()) files_[path].since.push_back(std::move(change));
}

void FaultyDisk::lose_unsynced(std::uint32_t seed) {
  for (const auto& [path, file] : files_) {
    std::string content = file.synced;
    for (std::size_t i = 0; i < file.since.size(); ++i) {
      const bool kept = seed % 3 != 0 && hash(seed, static_cast<std::uint32_t>(i), 7) % 2 == 0;
      if (kept) apply(file.since[i], content);
    }
    std::ofstream(path, std::ios::binary | std::ios::trunc) << content;
  }
  files_.clear();
}

}  // namespace normalshop::test
