// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that follow others: where they are when their leaders are somewhere.
//
// The one home of  q = multiplier q_leader + offset,  for every scalar. How rates and forces go
// through it is each witness's own business.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"

namespace dynwitness::scene {

/// A follower as it depends on the joint at the head of its chain, which follows nobody.
struct Follower {
  int link, leader;       ///< links, whose joints they are
  int slot, leader_slot;  ///< of their positions
  int rate;               ///< the leader's
  Rational multiplier;    ///< q = multiplier q_leader + offset, not 0
  Number offset;
};

/** All followers, in the order of the links; chains (c follows b, b follows a) as one step each.
    @throws InputError at the follower: no joint has the leader's name, either has not one position
      or is
            driven, the multiplier is 0, has pi or a parameter in it, or joints follow each other in
             a circle */
std::vector<Follower> followers(const Mechanism& mechanism);

/// By link: the index of its joint's first rate, which a follower shares with its leader; -1:
/// fixed.
std::vector<int> firstRates(const Mechanism& mechanism);

/// The slots that are given, those of followers left out, in their order.
std::vector<int> givenSlots(const Mechanism& mechanism);

/// The mechanism with all followers let go: joints with rates of their own.
Mechanism withoutMimics(Mechanism mechanism);

/// The mechanism without rotors geared to several rates.
Mechanism withoutGearedRotors(Mechanism mechanism);

/// For what is not modelled together with followers.
/// @throws InputError  "FILE: joint "b" follows "a" (mimic): <why>, allowed: joints that follow no
/// others"
void requireNoMimics(const SourceLocation& file, const Mechanism& mechanism,
                     const std::string& why);

/// Puts the followers' positions where their leaders' are.
void followLeaders(const std::vector<Follower>& followers, std::vector<Number>* q);
/// The same in a real scalar, from the leaders' q.
template <typename T, typename Numbers>
void followLeaders(const std::vector<Follower>& followers, const Numbers& number,
                   std::vector<T>* q) {
  for (const Follower& f : followers)
    (*q)[f.slot] = number(Number(f.multiplier)) * (*q)[f.leader_slot] + number(f.offset);
}

/// The same for positions of doubles with their cosines and sines.
void followLeaders(const Mechanism& mechanism, std::vector<JointPosition<double>>* x);

/** All positions of doubles, from those that are given or from all (then those of followers are
    replaced).
    @param q  as many as givenSlots() or as positions(); other counts are returned as they are */
std::vector<double> allPositions(const Mechanism& mechanism, const std::vector<double>& q);

}  // namespace dynwitness::scene
