#include "normalshop/io/atomic_file.h"

#include <cerrno>
#include <cstdint>
#include <random>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* what, int code) {
  throw IoError("cannot " + std::string(what) + " '" + path.string() +
                "': " + std::generic_category().message(code));
}

class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags, mode_t mode = 0)
      : fd_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  bool valid() const { return fd_ >= 0; }
  int get() const { return fd_; }

 private:
  int fd_;
};

std::string random_suffix() {
  static constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device device;
  std::string suffix;
  for (int i = 0; i < 6; ++i) suffix += letters[device() % letters.size()];
  return suffix;
}

void write_all(const fs::path& target, int fd, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(fd, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(target, "write", errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

}  // namespace

PendingFile::PendingFile(fs::path target) : target_(std::move(target)) {
  std::error_code ignored;
  if (target_.filename().empty() || fs::is_directory(target_, ignored)) {
    throw IoError("cannot write '" + target_.string() + "': it is a folder; give a file name");
  }
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw IoError("cannot write '" + target_.string() + "': there is no folder '" +
                  folder.string() + "'");
  }
  for (int attempt = 0; attempt < 100; ++attempt) {
    // A long name leaves no room for the suffix (255 bytes on most file systems).
    const std::string name = target_.filename().string().substr(0, 200);
    temporary_ = folder / ("." + name + ".tmp-" + random_suffix());
    const Descriptor file(temporary_, O_WRONLY | O_CREAT | O_EXCL, 0666);
    if (file.valid()) return;
    if (errno != EEXIST) fail(target_, "write", errno);
  }
  fail(target_, "write", EEXIST);
}

PendingFile::~PendingFile() {
  if (!committed_) ::unlink(temporary_.c_str());
}

void PendingFile::commit() {
  {
    const Descriptor file(temporary_, O_RDONLY);
    if (!file.valid() || ::fsync(file.get()) != 0) fail(target_, "write", errno);
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(target_, "write", errno);
  committed_ = true;
}

std::string read_file(const fs::path& path, std::size_t max_bytes) {
  // O_NONBLOCK: opening a pipe that nobody writes to must not hang.
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);
  if (!file.valid()) fail(path, "read", errno);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) fail(path, "read", errno);
  if (S_ISDIR(info.st_mode)) throw IoError("cannot read '" + path.string() + "': it is a folder");
  if (!S_ISREG(info.st_mode)) {
    throw IoError("cannot read '" + path.string() + "': it is not a regular file");
  }
  const auto size = static_cast<std::size_t>(info.st_size);
  if (size > max_bytes) {
    throw IoError("cannot read '" + path.string() + "': it has " + std::to_string(size) +
                  " bytes; at most " + std::to_string(max_bytes) + " are accepted");
  }
  std::string bytes(size, '\0');
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::read(file.get(), bytes.data() + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "read", errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

void write_file(const fs::path& path, std::string_view text) {
  PendingFile pending(path);
  {
    const Descriptor file(pending.path(), O_WRONLY);
    if (!file.valid()) fail(path, "write", errno);
    write_all(path, file.get(), text.data(), text.size());
  }
  pending.commit();
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  write_file(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace normalshop
