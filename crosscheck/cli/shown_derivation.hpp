// SPDX-License-Identifier: GPL-3.0-or-later
// A derivation to be read: which lines of it, in which letters, as a document, proven as printed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/scene.hpp"
#include "symbolic/derivation.hpp"

namespace dynwitness::cli {

struct ShownDerivation {
  std::string format = "text";                 ///< text, latex, html
  std::vector<std::string> quantities{"all"};  ///< one of M, c, g, all
  std::vector<std::string> only;               ///< names of lines; none: all
  std::vector<std::string> substitutions;      ///< "l=1"
  std::vector<std::string> names;              ///< "q1=theta"
  std::string beside;                          ///< newton_euler; empty: nothing
  bool linearized = false, proof = false, checks = true, shorthand = false;
};

struct DerivationText {
  std::string text;
  bool holds = true;
  std::string proof, problem;  ///< what was read back; what was found then
};

/// What stands around the steps of a derivation.
struct DocumentParts {
  /// HTML: what the page is.
  std::string summary = "The equations of motion, derived from kinetic and potential energy.";
  bool checks = true;     ///< what was checked
  bool mechanism = true;  ///< which joint each q is; LaTeX: and a drawing (a page has both anyway)
};
symbolic::Style styleOf(const std::string& format);  ///< text, latex, html
std::string derivationDocument(const scene::Scene& scene, const symbolic::Derivation& shown,
                               symbolic::Style style, const DocumentParts& parts);

/// @throws scene::InputError  a name that is none, with the nearest
DerivationText derivationText(const scene::Scene& scene, const ShownDerivation& asked);

}  // namespace dynwitness::cli
