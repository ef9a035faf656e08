#include <cstdio>
#include <filesystem>

#include "model_flags.h"
#include "progress_bar.h"
#include "verbs.h"

#include "normalshop/io/replay_document.h"

namespace normalshop::cli {

namespace {

namespace fs = std::filesystem;

struct ReplayFlags {
  fs::path document;
  fs::path output;
  ReplayOptions options;
};

void run_replay(const ReplayFlags& flags) {
  print_notes(replay_document(flags.document, flags.options, flags.output, progress_bar()));
  std::printf("made %s\n", flags.output.string().c_str());
}

}  // namespace

void add_replay_verb(CommandLine& program) {
  Verb verb = program.verb(
      "replay", "Makes the edits of a document again: at another size, on other maps or models");
  ReplayFlags& flags = verb.runs(run_replay);
  ReplayOptions& options = flags.options;
  verb.takes("document", flags.document, "Document (.nshop)").required();
  verb.takes("-o,--output", flags.output, "Document to be made").required();
  verb.takes("--size", options.size, "Larger side of the normal maps in texels").between(1, 16384);
  verb.takes("--model", options.model, "Another model, with the same UVs or of the same shape");
  verb.takes("--normal-map", options.normal_maps,
             "Another normal map: FILE or SET=FILE; may be repeated");
  verb.flag("--flip-v", options.flip_v, "The other model's texture coordinates have v up");
  verb.flag("--skip-failing", options.skip_failing, "Leave out edits that cannot be made there");
}

}  // namespace normalshop::cli
