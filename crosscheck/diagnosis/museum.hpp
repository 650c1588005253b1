// SPDX-License-Identifier: GPL-3.0-or-later
// Mistakes of real tools, planted again into a stranger's engine: does the check name each of them?
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/diagnosis/examine.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {

/// A mistake from the public record, and how it is planted (data/museum/museum.toml).
struct MuseumPiece {
  scene::SourceLocation where;
  std::string id, tool, kind, link, what;
  int year = 0;
  std::string plant;               ///< what stranger.py --mistake takes
  std::string scene;               ///< bundled, or a file beside the list
  std::string fidelity;            ///< "same": that mistake; "nearest": shows as it does
  std::vector<std::string> named;  ///< what the first finding has to be, one of these:
                                   ///< "rule", or "rule:link or joint"
};

struct Museum {
  std::filesystem::path folder;  ///< of the list, the engine and scenes of its own
  std::vector<MuseumPiece> pieces;
};

/// @throws scene::InputError  by file and line
Museum readMuseum(const std::string& text, const std::filesystem::path& file);
/// data/museum/museum.toml
Museum bundledMuseum();
/// The pieces of these names; of none: all. @throws scene::InputError with the name that is nearest
std::vector<MuseumPiece> selectPieces(const Museum& museum, const std::vector<std::string>& ids);

/// What the check said about one engine of the museum.
struct PieceFound {
  std::string scene, plant;  ///< plant: empty for the engine without a mistake
  bool caught = false;       ///< something is wrong
  int rank = 0;              ///< of the finding that names it; 0: none does
  int findings = 0;          ///< that explain all answers
  std::string named_as;      ///< "rule:link" of the first
  std::string sentence;      ///< of the first
  std::string failure;       ///< it could not be asked: why
  std::string text;          ///< of the whole check, for people
};

struct MuseumFound {
  std::vector<MuseumPiece> pieces;
  std::vector<PieceFound> found;  ///< by piece
  std::vector<PieceFound> right;  ///< the engine without a mistake, once a scene: nobody to blame

  bool isNamed(std::size_t i) const { return found[i].caught && found[i].rank == 1; }
  /// Every piece is named first, and a right engine blamed nowhere.
  bool holds() const;
};

/** Plants each piece and examines the engine as `check` does; and the engine without a mistake on
    each of the scenes, without which to be caught would mean nothing.

    @param prepare    a scene as `check` lets it in
    @param processes  at least 1 */
MuseumFound walkThrough(const Museum& museum, const std::vector<MuseumPiece>& pieces,
                        const std::function<scene::Scene(const std::string& scene)>& prepare,
                        int processes);

/// How a verdict's words ("named", "NOT CAUGHT") are put into a text, in colour; none: as they are.
using VerdictShown = std::function<std::string(const std::string& verdict)>;
/// The table: by kind, two lines a piece, and a line that sums up.
std::string museumTable(const MuseumFound& found, const VerdictShown& shown = {});
/// Each piece in full: the record, what was planted, what the check said.
std::string museumInFull(const MuseumFound& found, const VerdictShown& shown = {});
/// As museum.schema.json describes it.
std::string museumJson(const MuseumFound& found, const std::string& version);

}  // namespace dynwitness::crosscheck
