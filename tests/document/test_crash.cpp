#include <algorithm>
#include <cstdlib>

#include "document/faulty_disk.h"
#include "document/stored_document.h"
#include "support/sanitized.h"

#include "normalshop/core/error.h"
#include "normalshop/document/store/database.h"

/// Documents on a disk that fails, fills up or loses its power at every point of a session.
namespace normalshop::test {
namespace {

namespace fs = std::filesystem;
using Fault = FaultyDisk::Fault;

/// How many of the points are tried; NORMALSHOP_CRASHES sets another number.
std::size_t wanted_points() {
  const char* wanted = std::getenv("NORMALSHOP_CRASHES");
  return wanted != nullptr ? static_cast<std::size_t>(std::atol(wanted)) : sanitized ? 8 : 25;
}

class CrashTest : public StoredSquare {
 protected:
  using Action = std::function<void(DocumentFile&)>;

  CrashTest() : stroke_(pen("[-0.4, 0.4], [0.3, 0.3]")) {
    Document document = imported();
    const MapsBefore before(document.storage(), true);
    document.apply(stroke_);
    changes_ = changed_tiles(before, document.storage(), first_layer);
  }

  /// All that a session writes.
  std::vector<Action> session() const {
    const auto stroke = [this](DocumentFile& file, std::int64_t layer, std::size_t from) {
      std::vector<TileChange> part(changes_.begin() + static_cast<std::ptrdiff_t>(from),
                                   changes_.end());
      for (TileChange& change : part) change.layer = layer;
      file.add({{StackStep::Edit, layer}, &stroke_, 100 + from}, part);
    };
    return {[=](DocumentFile& file) { stroke(file, first_layer, 0); },
            [=](DocumentFile& file) { stroke(file, first_layer, 1); },
            [](DocumentFile& file) { file.undo(); },
            [](DocumentFile& file) { file.add({{.step = StackStep::AddLayer}}, {}); },
            [=](DocumentFile& file) { stroke(file, 3, 2); },
            [](DocumentFile& file) {
              file.add({{.step = StackStep::SetLayer, .target = 3, .opacity = 0.5F}}, {});
            },
            [](DocumentFile& file) { file.jump(2); },
            [](DocumentFile& file) { file.undo(); },
            [](DocumentFile& file) { file.redo(); },
            [=](DocumentFile& file) { stroke(file, first_layer, 0); }};
  }

  /// All that a document is.
  static std::string state_of(const DocumentFile& file) {
    std::string state = to_json(layers_value(file.stack()));
    for (const HistoryEntry& entry : file.all_steps()) {
      state += std::to_string(entry.id) + (entry.undone ? "u " : " ");
    }
    for (const PackedTile& tile : file.tiles()) {
      if (tile.layer != imported_layer) state += std::to_string(tile.layer) + tile.bytes;
    }
    return state;
  }

  /// The states before the session and after each of its actions.
  std::vector<std::string> states() const {
    std::vector<std::string> states;
    DocumentFile file(path_);
    states.push_back(state_of(file));
    for (const Action& action : session()) {
      action(file);
      states.push_back(state_of(file));
    }
    return states;
  }

  /// How many actions are done when the disk fails; what a failing one left is checked if the disk
  /// works again.
  std::size_t run(const std::vector<std::string>& expected, bool works_again) const {
    std::size_t done = 0;
    try {
      DocumentFile file(path_);
      for (const Action& action : session()) {
        try {
          action(file);
          ++done;
        } catch (const DocumentError&) {
          if (works_again) {
            EXPECT_EQ(state_of(file), expected[done]) << "after action " << done;
          }
          throw;
        }
      }
    } catch (const DocumentError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.filename().string()), std::string::npos);
    }
    return done;
  }

  void expect_whole(const std::vector<std::string>& expected, std::size_t done) const {
    const DocumentFile file(path_);
    EXPECT_EQ(file.check(), std::vector<std::string>());
    const std::string state = state_of(file);
    // An action that failed may have got to the disk all the same, but not by halves.
    const bool next = done + 1 < expected.size() && state == expected[done + 1];
    EXPECT_TRUE(state == expected[done] || next) << "after " << done << " actions";
  }

  Edit stroke_;
  std::vector<TileChange> changes_;
};

TEST_F(CrashTest, NoFaultLosesOrHalvesAnything) {
  const std::string fresh = bytes_of(path_);
  const std::vector<std::string> expected = states();
  FaultyDisk disk;
  write_bytes(path_, fresh);
  disk.arm(Fault::None, 0);
  ASSERT_EQ(run(expected, false), expected.size() - 1);
  const std::size_t operations = disk.operations();
  ASSERT_GT(operations, 50U);
  const std::size_t stride = std::max<std::size_t>(1, operations / wanted_points());
  for (const Fault fault : {Fault::Error, Fault::Full, Fault::PowerCut}) {
    for (std::size_t point = 0; point < operations; point += stride) {
      SCOPED_TRACE(testing::Message() << "fault " << static_cast<int>(fault) << " at " << point);
      write_bytes(path_, fresh);
      fs::remove(log_of(path_));
      disk.arm(fault, point);
      const std::size_t done = run(expected, fault != Fault::PowerCut);
      if (fault == Fault::PowerCut) disk.lose_unsynced(static_cast<std::uint32_t>(point / stride));
      // The power goes once more while the document recovers.
      if (fault == Fault::PowerCut && point / stride % 2 == 1) {
        disk.arm(fault, point % 5);
        try {
          const DocumentFile file(path_);
        } catch (const DocumentError&) {
        }
        disk.lose_unsynced(static_cast<std::uint32_t>(point));
      }
      disk.arm(Fault::None, 0);
      expect_whole(expected, done);
      if (HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace normalshop::test
