#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace normalshop::test {

/// How a run of `normalshop` ended.
struct ProgramRun {
  int exit_code = -1;  ///< 128 + the signal when one ended it
  bool timed_out = false;
  std::string out;
  std::string err;
};

struct ProgramLimits {
  std::chrono::seconds time{60};
  std::optional<int> cpu = {};                 ///< runs on this processor alone
  std::optional<std::size_t> file_bytes = {};  ///< writing a longer file fails, as on a full disk
};

using Arguments = std::vector<std::string>;

/// Starts the built `normalshop` with these arguments and waits for its end.
ProgramRun run_program(const Arguments& arguments, const ProgramLimits& limits = {});
/// Does the same in this process: no half second for loading the program's libraries.
ProgramRun call_program(const Arguments& arguments);
/// Each run after the other: called, or with limits, started.
std::vector<ProgramRun> run_all_of(const std::vector<Arguments>& runs,
                                   const std::optional<ProgramLimits>& limits = {});
/// For messages of tests.
std::string command_line(const Arguments& arguments);

}  // namespace normalshop::test
