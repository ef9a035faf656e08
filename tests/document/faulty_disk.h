#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace normalshop::test {

/// What SQLite writes passes through here while this lives: it counts what changes a file, and
/// makes one of these go wrong. One at a time in a program.
class FaultyDisk {
 public:
  enum class Fault {
    None,
    Error,    ///< that operation fails, and changes nothing
    Full,     ///< likewise, since the disk is full
    PowerCut  ///< from that operation on nothing reaches the disk
  };

  FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;
  ~FaultyDisk();

  /// The operation that goes wrong counts from 0, from now on.
  void arm(Fault fault, std::size_t operation);
  /// Since arm(): writes, truncations, syncs and deletions.
  std::size_t operations() const { return count_; }
  /// After a power cut, when all files are closed: of what was written since a file's last sync,
  /// some is on the disk and some is not, as `seed` has it.
  void lose_unsynced(std::uint32_t seed);

  // For the file system below.
  struct Change {
    std::size_t offset = 0;
    std::string bytes;
    bool truncates = false;  ///< to `offset`
  };
  struct File {
    std::string synced;
    std::vector<Change> since;
  };
  void opened(const std::string& path);
  void deleted(const std::string& path) { files_.erase(path); }
  void synced(const std::string& path);
  void changed(const std::string& path, Change change);
  /// The result code of the next operation: 0, or what goes wrong.
  int next(int error);

 private:
  struct Vfs;
  std::unique_ptr<Vfs> vfs_;
  Fault fault_ = Fault::None;
  std::size_t operation_ = 0;
  std::size_t count_ = 0;
  std::map<std::string, File> files_;
};

}  // namespace normalshop::test
