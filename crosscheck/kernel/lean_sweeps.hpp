// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps with as few operations as we know, for programs that are written once a scene.
//
// The sweeps of recursive/ are made to be read, and to run on any mechanism. These are made to be
// traced: they may decide by the numbers of the scene, they carry what the fewest operations need,
// and they are no second opinion. That they are the same functions is shown over a prime field.
#pragma once

#include <vector>

#include "crosscheck/scalars/traced.hpp"
#include "recursive/model.hpp"
#include "symbolic/graph.hpp"

namespace dynwitness::crosscheck::kernel {

using Vector3 = recursive::Vector3<Traced>;
using Matrix3 = recursive::Matrix3<Traced>;
using Symmetric3 = recursive::Symmetric3<Traced>;

/** A link and its mass distribution by moments: mass, first moment h = integral of r dm [kg m],
    second moment S = integral of r r' dm [kg m^2], about the origin of its frame. S says the same
    as the rotational inertia, I = trace(S) 1 - S, but a rod along z enters one entry of it. */
struct LeanLink {
  int parent = -1, dof = -1, slot = -1;  ///< as in LinkModel
  bool turns = true;                     ///< about z; else it slides along z
  bool stays = false;  ///< of a link that turns: its axes stay those of the unturned joint, in
                       ///< which its figures turn; what passes through it need not
  Matrix3 R;           ///< parent axes to the axes of the unmoved joint
  Vector3 p;           ///< origin of the unmoved joint in the parent [m]
  Traced mass;
  Vector3 h;
  Symmetric3 S;
  Traced rotor, stiffness, rest;
  Vector3 force, moment;  ///< constant wrench in link axes about the origin
};

struct LeanModel {
  std::vector<LeanLink> links;
  Vector3 gravity;
};

/// Whether the lean sweeps know everything that the model has: joints that turn or slide, and loads
/// in link axes.
bool isLean(const recursive::Model<Traced>& model);
LeanModel leanModel(const recursive::Model<Traced>& model);

/** Base parameters: moves to the parent what a joint's motion cannot tell apart. A rod along the
    axis of a turning joint (mass, h_z and S_zz in any proportions) does not notice whether it turns
    with the joint; a slider's S moves as if it were fixed to the parent. M, c and g are the same
    functions of the state afterwards, with mass, h_z and S_zz of every turning link zero.
    @see W. Khalil and E. Dombre, Modeling, Identification and Control of Robots (2002),
          section 9.4 */
void regroup(LeanModel& model);

/// Mass on a link's joint axis: mass [kg], h_z [kg m] and S_zz [kg m^2], in any proportions.
struct Rod {
  Traced mass, h, S;
};

/** Gives a turning link a rod along its axis and takes it off the parent, of which it is a part
    too. It undoes a part of regroup(), where that pays: a point mass at the origin can take the
    first moment of the parent off it that lies along the way to the link; h_z and S_zz, those along
    the axis. */
void takeRod(LeanModel& model, int link, const Rod& rod);

/// Moves the origin of a link by t along its own z axis, along which any point would have done.
void slide(LeanModel& model, int link, Traced t);

/** Measures lengths in the unit of this many metres and masses so that kg m^2 remain: every product
    with that length falls away. Only where nothing slides.  @return false: nothing was changed */
bool scaleLengths(LeanModel& model, Traced unit);

struct LeanTerms {
  bool accelerations = true, velocities = true, gravity = true, springs = true, loads = true;
};

/// How a vector goes from the parent's axes to the link's: by the fixed turn and then the joint's,
/// or by one matrix that is the product of both.
enum class Turning { kInSteps, kByMatrix };

/** tau = M qdd + c + g - loads by Newton-Euler sweeps that carry the acceleration a of the body's
    point at the origin and the matrix U = [w']x + [w]x [w]x, so that r has the acceleration a + U
    r:
        (1)  w_i = R w_p + z qd,  w'_i = R w'_p + w_i x z qd + z qdd,  a_i = R (a_p + U_p p)
        (2)  F = m a + U h,       N = h x a + integral of r x U r dm
        (3)  f_p += R' f,         n_p += R' n + p x R' f,   tau_i = n_z + d qdd + k (q - rest)
    Points on a turning joint's axis z move with both links, so that U_i z = R U_p z. Where z is an
    axis of the parent's, that column is there, and brings most of w' and U with it:
        (4)  U_xz, U_yz, U_zz = R U_p z,  w'_y = U_xz - w_x w_z = w_x w_z - U_zx,  w'_x likewise
    Of N_z only w_x w_y and w'_z are needed, if nothing else asks for both U_xy and U_yx:
        (5)  S_xx U_yx - S_yy U_xy = (S_xx - S_yy) w_x w_y + (S_xx + S_yy) w'_z */
std::vector<Traced> inverseDynamics(const LeanModel& model, const scene::State<Traced>& state,
                                    LeanTerms terms = {}, Turning turning = Turning::kInSteps);

/// M by composite bodies, in moments: n x n, row by row.
std::vector<Traced> massMatrix(const LeanModel& model, const scene::State<Traced>& state,
                               Turning turning = Turning::kInSteps);

/// g = dV/dq, springs included, from the composite bodies' first moments.
std::vector<Traced> gravity(const LeanModel& model, const scene::State<Traced>& state,
                            Turning turning = Turning::kInSteps);

/// x of M x = b, by M = L' D L from the tips inward, which fills no zero of a branching M.
/// @param parent_dof  the next joint inboard, -1: none
std::vector<Traced> solve(std::vector<Traced> M, std::vector<Traced> b,
                          const std::vector<int>& parent_dof);

}  // namespace dynwitness::crosscheck::kernel
