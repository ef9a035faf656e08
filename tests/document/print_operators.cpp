#include <cstdio>

#include "normalshop/document/edit_operator.h"

int main() {
  std::fputs(normalshop::to_json(normalshop::describe_operators()).c_str(), stdout);
  return 0;
}
