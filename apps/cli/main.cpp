#include <cstdio>
#include <exception>
#include <new>

#include "verbs.h"

#include "normalshop/core/error.h"

namespace {

constexpr int failed = 1;
constexpr int wrong_use = 2;

int complain(const char* what) {
  std::fprintf(stderr, "normalshop: %s\n", what);
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
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
    return app.exit(e) == 0 ? 0 : wrong_use;
  } catch (const normalshop::Error& e) {
    return complain(e.what());
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this job");
  } catch (const std::exception& e) {
    return complain(e.what());
  }
  return 0;
}
