#include "command.h"

int main(int argc, char** argv) {
  try {
    return normalshop::cli::run_command(argc, argv);
  } catch (...) {
    return 1;  // not even the message could be put together
  }
}
