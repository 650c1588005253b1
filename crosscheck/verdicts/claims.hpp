// SPDX-License-Identifier: GPL-3.0-or-later
// What a program says besides quantities of a state, judged: the links that it believes in, and how
// a point of one of them moves.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "scene/mechanism.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// A number of a link that a program has otherwise than the scene.
struct ModelDifference {
  std::string link, parameter, unit;  ///< "link_3", "Ixx", "kg m^2"; or "link", "": it is missing
  double said = 0, scene = 0;
  double limit = 0;  ///< how far apart they may be
};
/// "link 'link_3': Ixx is 0.2 kg m^2 in its model and 0.1 kg m^2 in the scene"
std::string sentenceOf(const ModelDifference& difference);

struct ModelFound {
  std::vector<ModelDifference> differences;
  std::vector<std::string> merged;     ///< sentences: links that it keeps as one body
  Eigen::VectorXd said, scene, limit;  ///< of all numbers that were compared
};

/** Its links against the scene's. What rests in the world has no part in the motion and is not
    compared. Links that fixed joints hold together are one body, and how an engine shares that body
    among its links is a convention: a link that it does not tell belongs to the one inboard that it
    does; and where all that it tells of a body comes to the scene's body, there is no difference.

    Limits are for numbers that were kept in other axes or about another point than the scene's: of
    parts i with masses m_i, levers l_i (of the centre of mass from the origins of link and joint,
    and of the part from the link), inertias I_i of norm |I_i|, seen through s_i turns, a turn
    losing 14 u of a vector (engine_bound.hpp: an orientation from two 9 u, a quarter turn 5 u):

        mass      (k + 1) u sum m_i             k roundings to sum k parts, one when it is told
        com       (10 + 14 s + k) u sum m_i l_i / sum m_i      one R r (6 u), products and quotient
        inertia   sum (78 + 28 s_i + k) u |I_i| + (32 + 28 s_i + 3 k) u m_i l_i^2
                                                in axes of its own (54 u), turned (12 u), parallel
                                                axes (12 u) of levers that are off as com is

    @param factor  of what double loses: 2^29 for single precision */
ModelFound compareModel(const scene::Mechanism& mechanism, const std::vector<BelievedLink>& links,
                        double factor);

/// Both claims of a program as checks of a crosscheck: "model" and "jacobian", where it makes them.
/// @throws std::runtime_error  it has failed
std::vector<CheckResult> judgeClaims(OutsideClaims& claims, const std::string& witness,
                                     const PreparedScene& scene,
                                     const std::vector<scene::State<double>>& states);

}  // namespace dynwitness::crosscheck
