// SPDX-License-Identifier: GPL-3.0-or-later
// What `dynwitness show` says of a scene, for people and for programs: which q is which joint, what
// the links weigh, and what is modelled.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/report/view.hpp"
#include "crosscheck/verdicts/ledger.hpp"
#include "scene/scene.hpp"
#include "scene/urdf.hpp"

namespace dynwitness::crosscheck {

struct Shown {
  scene::Scene scene;
  std::vector<scene::UrdfPart> parts = {};  ///< of a URDF, one a link: its limits; or none
  std::vector<std::string> warnings = {};   ///< why other commands refuse the scene
  std::vector<std::string> remarks = {};    ///< what is remarkable in the file (scene/remarks.hpp)
  bool has_no_inverse = false;              ///< only those that take the inverse of M refuse it
  std::optional<Ledger> ledger = {};        ///< of a scene that they do not refuse
};

/// Aligned tables: joints in the order of q, links, what else is modelled and what is not.
std::string showText(const Shown& shown);
/// Follows show.schema.json.
std::string showJson(const Shown& shown, const std::string& version);
/// The table of the joints alone, as HTML; empty: none moves.
std::string jointsHtml(const scene::Scene& scene);
/// The same as text, the columns that say what each q is; empty: none moves.
std::string jointsText(const scene::Scene& scene);
/// Some columns of that table, by their names there, for other notations: one row a joint.
std::vector<std::vector<std::string>> jointCells(const scene::Scene& scene,
                                                 const std::vector<std::string>& columns);
/// The picture with the same tables.
std::string showPage(const Shown& shown, const View& view, const std::string& version);

}  // namespace dynwitness::crosscheck
