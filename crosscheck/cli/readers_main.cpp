// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness-readers: readers and same, in a program of their own (front.hpp).
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv, {{"readers", addReaders}, {"same", addSame}});
}
