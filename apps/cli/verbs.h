#pragma once

#include <CLI/CLI.hpp>

/// One function a verb, each in its own file: adds its flags and what to run.
namespace normalshop::cli {

void add_edit_verb(CLI::App& app);
void add_render_verb(CLI::App& app);
void add_compare_verb(CLI::App& app);
void add_info_verb(CLI::App& app);
void add_demo_verb(CLI::App& app);
void add_describe_verb(CLI::App& app);

}  // namespace normalshop::cli
