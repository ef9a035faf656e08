#include "arguments.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>

namespace normalshop::cli {

namespace {

/// The whole sentence for the user: whose fault, what, and where the help is.
WrongUse wrong_use(const CLI::App& app, const std::string& what) {
  const auto verbs = app.get_subcommands();
  if (!verbs.empty()) {
    const std::string verb = verbs.front()->get_name();
    const auto extra = verbs.front()->remaining();
    // A flag written wrongly is also a missing one: CLI11 names only what is missing.
    const auto flag = std::find_if(extra.begin(), extra.end(),
                                   [](const std::string& text) { return text.starts_with("-"); });
    const std::string fault = flag != extra.end() ? "there is no flag '" + *flag + "'" : what;
    return WrongUse(verb, fault + "; see normalshop " + verb + " --help");
  }
  const auto unknown = app.remaining();
  const std::string missing =
      unknown.empty() ? "a verb is missing" : "there is no verb or flag '" + unknown.front() + "'";
  return WrongUse(missing + "; see normalshop --help");
}

/// Last one first, as CLI11 wants them. It takes "-.5" for a flag, but not "-0.5".
std::vector<std::string> arguments(int argc, char** argv) {
  std::vector<std::string> all;
  for (int i = argc - 1; i > 0; --i) {
    std::string text = argv[i];
    const bool number =
        text.size() > 2 && text.starts_with("-.") && text[2] >= '0' && text[2] <= '9';
    if (number) text.insert(1, "0");
    all.push_back(std::move(text));
  }
  return all;
}

}  // namespace

std::optional<double> read_number(std::string_view text) {
  double number = 0.0;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number);
  return error == std::errc() && end == last ? std::optional(number) : std::nullopt;
}

Argument& Argument::required() {
  option_->required();
  return *this;
}

Argument& Argument::positive() {
  // CLI11's own checks compare, so they let "nan" through.
  option_->check([](const std::string& text) {
    double value = 0.0;
    const bool fits = CLI::detail::lexical_cast(text, value) && value >= 1e-9 && value <= 1e9;
    return fits ? std::string() : "must be a number from 1e-9 to 1e9, not " + text;
  });
  return *this;
}

Argument& Argument::between(int lowest, int highest) {
  option_->check(CLI::Range(lowest, highest));
  return *this;
}

Argument& Argument::one_of(const std::vector<std::string>& names) {
  option_->check(CLI::IsMember(names));
  return *this;
}

Argument& Argument::shows_default() {
  option_->capture_default_str();
  return *this;
}

template <class Value>
Argument Verb::takes(const std::string& names, Value& value, const std::string& help) {
  return Argument(*app_->add_option(names, value, help));
}

template <>
Argument Verb::takes(const std::string& names, std::vector<std::string>& value,
                     const std::string& help) {
  // One value a flag, or a flag before the model's name would take that too.
  return Argument(*app_->add_option(names, value, help)->allow_extra_args(false));
}

template Argument Verb::takes(const std::string&, std::filesystem::path&, const std::string&);
template Argument Verb::takes(const std::string&, std::string&, const std::string&);
template Argument Verb::takes(const std::string&, int&, const std::string&);
template Argument Verb::takes(const std::string&, float&, const std::string&);
template Argument Verb::takes(const std::string&, double&, const std::string&);

void Verb::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Verb::when_chosen(std::function<void()> action) { app_->callback(std::move(action)); }

CommandLine::CommandLine(const std::string& program, const std::string& summary,
                         const std::string& version)
    : app_(std::make_unique<CLI::App>(summary)) {
  app_->name(program);
  app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Verb CommandLine::verb(const std::string& name, const std::string& summary) {
  return Verb(*app_->add_subcommand(name, summary));
}

void CommandLine::run(int argc, char** argv) {
  try {
    app_->parse(arguments(argc, argv));
  } catch (const CLI::Success& asked) {  // for help or the version
    app_->exit(asked);
  } catch (const CLI::ParseError& error) {
    throw wrong_use(*app_, error.what());
  } catch (const WrongUse& error) {
    throw wrong_use(*app_, error.what());
  }
}

}  // namespace normalshop::cli
