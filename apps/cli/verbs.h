#pragma once

#include "arguments.h"

/// One function a verb (or, for the operators', all of them), each in its own file: adds its flags
/// and what to run.
namespace normalshop::cli {

void add_edit_verb(CommandLine& program);
/// new, apply, log, undo, redo, jump, verify and export.
void add_document_verbs(CommandLine& program);
/// layers, disable, enable and change.
void add_layer_verbs(CommandLine& program);
void add_replay_verb(CommandLine& program);
void add_render_verb(CommandLine& program);
void add_compare_verb(CommandLine& program);
void add_info_verb(CommandLine& program);
void add_demo_verb(CommandLine& program);
void add_check_verb(CommandLine& program);
void add_convert_verb(CommandLine& program);
void add_shade_verb(CommandLine& program);
void add_segment_verb(CommandLine& program);
void add_describe_verb(CommandLine& program);
void add_unwrap_verb(CommandLine& program);
void add_operator_verbs(CommandLine& program);

}  // namespace normalshop::cli
