#pragma once

namespace normalshop::cli {

/// Does what the arguments of `normalshop` say and returns its exit code: 0, 1 for a job that
/// failed, 2 for wrong use. What went wrong is one line on the standard error; throws only where
/// there is no memory for that line.
int run_command(int argc, char** argv);

}  // namespace normalshop::cli
