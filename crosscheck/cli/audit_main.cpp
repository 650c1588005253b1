// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness-audit: the command audit, a program of its own (front.hpp).
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(argc, argv, {{"audit", addAudit}});
}
