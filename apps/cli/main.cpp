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

int run(int argc, char** argv) {
  using namespace normalshop::cli;
  CommandLine program("normalshop",
                      "Edits the normals of textured meshes: sketches, stamps and filters details "
                      "in editing charts and writes them back to the atlas.",
                      NORMALSHOP_VERSION);
  add_edit_verb(program);
  add_render_verb(program);
  add_compare_verb(program);
  add_info_verb(program);
  add_demo_verb(program);
  add_describe_verb(program);
  add_operator_verbs(program);
  add_shade_verb(program);
  add_segment_verb(program);
  add_check_verb(program);
  add_convert_verb(program);
  try {
    program.run(argc, argv);
  } catch (const WrongUse& e) {
    return complain(e.what(), wrong_use);
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
