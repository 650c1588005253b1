// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness-growth: the command growth, a program of its own (front.hpp).
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv, {{"growth", addGrowth}});
}
