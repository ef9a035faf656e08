#include "command.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "verbs.h"

namespace normalshop::cli {
namespace {

constexpr int failed = 1;
constexpr int wrong_use = 2;

/// One line, whatever the message holds.
int complain(std::string what, int exit_code = failed) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  std::fprintf(stderr, "normalshop: %s\n", what.c_str());
  return exit_code;
}

void run(int argc, char** argv) {
  CommandLine program("normalshop",
                      "Edits the normals of textured meshes: sketches, stamps and filters details "
                      "in editing charts and writes them back to the atlas.",
                      NORMALSHOP_VERSION);
  add_edit_verb(program);
  add_document_verbs(program);
  add_layer_verbs(program);
  add_replay_verb(program);
  add_render_verb(program);
  add_compare_verb(program);
  add_info_verb(program);
  add_unwrap_verb(program);
  add_demo_verb(program);
  add_describe_verb(program);
  add_operator_verbs(program);
  add_shade_verb(program);
  add_segment_verb(program);
  add_check_verb(program);
  add_convert_verb(program);
  program.run(argc, argv);
}

}  // namespace

int run_command(int argc, char** argv) {
  try {
    run(argc, argv);
  } catch (const WrongUse& e) {
    return complain(e.what(), wrong_use);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory for this job");
  } catch (const std::exception& e) {
    return complain(e.what());
  }
  if (std::fflush(stdout) != 0) return complain("cannot write to the standard output");
  return 0;
}

}  // namespace normalshop::cli
