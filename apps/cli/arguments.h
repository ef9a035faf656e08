#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line in the words that the verbs need. CLI11 stays inside arguments.cpp,
/// where it is compiled once.
namespace normalshop::cli {

/// The user has called the program wrongly. What the message says ends up on one line.
class WrongUse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  WrongUse(const std::string& flag, const std::string& what)
      : std::runtime_error(flag + ": " + what) {}
};

/// The whole text as a number; none when it is something else.
std::optional<double> read_number(std::string_view text);

/// What else is to be known about an argument just added.
class Argument {
 public:
  explicit Argument(CLI::Option& option) : option_(&option) {}
  Argument& required();
  /// From 1e-9 to 1e9.
  Argument& positive();
  Argument& between(int lowest, int highest);
  Argument& one_of(const std::vector<std::string>& names);
  /// The help shows the value that the variable has now.
  Argument& shows_default();

 private:
  CLI::Option* option_;
};

/// One verb of the program with its arguments.
class Verb {
 public:
  explicit Verb(CLI::App& app) : app_(&app) {}

  /// What the verb does, and the flags that it does it with: they live as long as the verb.
  template <class Flags>
  Flags& runs(void (*action)(const Flags&)) {
    const auto flags = std::make_shared<Flags>();
    when_chosen([flags, action] { action(*flags); });
    return *flags;
  }

  /// An argument that stands at its place ("model") or behind a flag ("-o,--output"). Value is a
  /// path, a string, an int, a float, a double, or a vector of strings: a flag that may be
  /// repeated.
  template <class Value>
  Argument takes(const std::string& names, Value& value, const std::string& help);
  /// A flag that stands for itself.
  void flag(const std::string& name, bool& value, const std::string& help);

 private:
  void when_chosen(std::function<void()> action);

  CLI::App* app_;
};

class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& summary, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Verb verb(const std::string& name, const std::string& summary);
  /// Runs the verb that the arguments name, or prints the help or the version that they ask for.
  /// Throws WrongUse, which says where the help is, and what the verb throws.
  void run(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace normalshop::cli
