#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "verbs.h"

namespace {

constexpr int failed = 1;
constexpr int wrong_use = 2;

/// One line, whatever the message holds.
int complain(std::string what, int exit_code = failed) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  std::fprintf(stderr, "normalshop: %s\n", what.c_str());
  return exit_code;
}

int complain_about_flags(const CLI::App& app, const CLI::ParseError& error) {
  const auto verbs = app.get_subcommands();
  if (verbs.empty()) {
    const auto unknown = app.remaining();
    const std::string what = unknown.empty() ? "a verb is missing"
                                             : "there is no verb or flag '" + unknown.front() + "'";
    return complain(what + "; see normalshop --help", wrong_use);
  }
  const std::string verb = verbs.front()->get_name();
  return complain(verb + ": " + error.what() + "; see normalshop " + verb + " --help", wrong_use);
}

int run(int argc, char** argv) {
  CLI::App app{
      "Edits the normals of textured meshes: sketches, stamps and filters details in "
      "editing charts and writes them back to the atlas."};
  app.name("normalshop");
  app.set_version_flag("--version", NORMALSHOP_VERSION);
  app.require_subcommand(1);
  normalshop::cli::add_edit_verb(app);
  normalshop::cli::add_render_verb(app);
  normalshop::cli::add_compare_verb(app);
  normalshop::cli::add_info_verb(app);
  normalshop::cli::add_demo_verb(app);
  normalshop::cli::add_describe_verb(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return e.get_exit_code() == 0 ? app.exit(e) : complain_about_flags(app, e);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this job");
  } catch (const std::exception& e) {
    return complain(e.what());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (...) {
    return failed;  // not even the message could be put together
  }
}
