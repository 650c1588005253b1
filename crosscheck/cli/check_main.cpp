// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness-check: check, museum, golden and grade, in a program of their own (front.hpp).
#include "crosscheck/cli/front.hpp"

int main(int argc, char** argv) {
  using namespace dynwitness::cli;
  return front(
      argc, argv,
      {{"check", addCheck}, {"museum", addMuseum}, {"golden", addGolden}, {"grade", addGrade}});
}
