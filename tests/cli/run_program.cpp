#include "cli/run_program.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "command.h"
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace normalshop::test {
namespace {

struct Pipe {
  std::array<int, 2> ends{-1, -1};

  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    for (int i = 0; i < 2; ++i) close_end(static_cast<std::size_t>(i));
  }
  void close_end(std::size_t i) {
    if (ends[i] >= 0) ::close(ends[i]);
    ends[i] = -1;
  }
};

/// After fork() in a program of several threads: only calls that are safe in a signal handler.
[[noreturn]] void become_program(char* const* argv, const ProgramLimits& limits, int out, int err) {
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (limits.cpu) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(*limits.cpu), &set);
    if (::sched_setaffinity(0, sizeof(set), &set) != 0) ::_exit(126);
  }
  if (limits.file_bytes) {
    const struct rlimit limit { *limits.file_bytes, *limits.file_bytes };
    ::setrlimit(RLIMIT_FSIZE, &limit);
    ::signal(SIGXFSZ, SIG_IGN);
  }
  ::execv(argv[0], argv);
  ::_exit(127);
}

/// Reads both pipes until the program closes them. False when the time is over.
bool collect(Pipe& out, Pipe& err, ProgramRun& run, std::chrono::steady_clock::time_point end) {
  std::array<pollfd, 2> open{pollfd{out.ends[0], POLLIN, 0}, pollfd{err.ends[0], POLLIN, 0}};
  const std::array<std::string*, 2> texts{&run.out, &run.err};
  std::array<char, 4096> buffer{};
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    if (::poll(open.data(), open.size(), static_cast<int>(left.count())) < 0 && errno != EINTR) {
      return false;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (open[i].fd < 0 || open[i].revents == 0) continue;
      const ssize_t got = ::read(open[i].fd, buffer.data(), buffer.size());
      if (got > 0) texts[i]->append(buffer.data(), static_cast<std::size_t>(got));
      if (got == 0 || (got < 0 && errno != EINTR)) open[i].fd = -1;
    }
  }
  return true;
}

/// What is written to a standard stream while this lives.
class Captured {
 public:
  explicit Captured(FILE* stream)
      : stream_(stream), file_(std::tmpfile()), before_(::dup(::fileno(stream))) {
    if (file_ == nullptr || before_ < 0) throw std::runtime_error("cannot capture a stream");
    redirect(::fileno(file_));
  }
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  ~Captured() {
    redirect(before_);
    ::close(before_);
    std::fclose(file_);
  }
  std::string text() {
    std::fflush(stream_);
    std::string text(static_cast<std::size_t>(::lseek(::fileno(file_), 0, SEEK_END)), '\0');
    if (::pread(::fileno(file_), text.data(), text.size(), 0) < 0) text = "unreadable";
    return text;
  }

 private:
  void redirect(int to) {
    std::fflush(stream_);
    ::dup2(to, ::fileno(stream_));
  }

  FILE* stream_;
  FILE* file_;
  int before_;
};

/// Arguments as main() takes them.
class Words {
 public:
  explicit Words(const Arguments& arguments) : words_{NORMALSHOP_PROGRAM} {
    words_.insert(words_.end(), arguments.begin(), arguments.end());
    for (std::string& word : words_) argv_.push_back(word.data());
    argv_.push_back(nullptr);
  }
  int argc() const { return static_cast<int>(words_.size()); }
  char** argv() { return argv_.data(); }

 private:
  Arguments words_;
  std::vector<char*> argv_;
};

}  // namespace

ProgramRun call_program(const Arguments& arguments) {
  Words words(arguments);
  ProgramRun run;
  Captured out(stdout);
  Captured err(stderr);
  run.exit_code = cli::run_command(words.argc(), words.argv());
  run.out = out.text();
  run.err = err.text();
  return run;
}

ProgramRun run_program(const Arguments& arguments, const ProgramLimits& limits) {
  Words words(arguments);
  Pipe out;
  Pipe err;
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) become_program(words.argv(), limits, out.ends[1], err.ends[1]);
  out.close_end(1);
  err.close_end(1);
  ProgramRun run;
  if (!collect(out, err, run, std::chrono::steady_clock::now() + limits.time)) {
    run.timed_out = true;
    ::kill(child, SIGKILL);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return run;
}

std::vector<ProgramRun> run_all_of(const std::vector<Arguments>& runs,
                                   const std::optional<ProgramLimits>& limits) {
  std::vector<ProgramRun> results;
  for (const Arguments& arguments : runs) {
    results.push_back(limits ? run_program(arguments, *limits) : call_program(arguments));
  }
  return results;
}

std::string command_line(const Arguments& arguments) {
  std::string text = "normalshop";
  for (const std::string& argument : arguments) text += " " + argument;
  return text;
}

}  // namespace normalshop::test
