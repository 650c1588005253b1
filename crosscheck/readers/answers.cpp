// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/answers.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <Eigen/QR>

namespace dynwitness::crosscheck {
namespace {

using Eigen::Vector3d;

/// A robot that may be what was read.
struct Guess {
  Misreading finding;
  Robot robot;
};

class Search {
 public:
  Search(const FileParts& file, const std::vector<std::vector<double>>& positions,
         const std::vector<MassAndGravity>& said, std::string reader, int states,
         std::uint64_t seed)
      : file_(file),
        ours_(file.robot()),
        q_(positions),
        said_(said),
        reader_(std::move(reader)),
        states_(states),
        seed_(seed) {}

  std::vector<Misreading> findings() {
    if (fits(ours_)) return {};
    if (tryGravity(true) || tryEverywhere() || tryOne() || tryArmature() || tryGravity(false))
      return out_;
    inward();
    return out_;
  }

 private:
  static bool near(double a, double b, double bound) { return std::abs(a - b) <= bound; }

  /// Row i of M up to the diagonal, and g_i, at one state.
  static bool rowFits(const MassAndGravity& a, const MassAndGravity& b, Eigen::Index i) {
    if (!near(a.g[i], b.g[i], a.g_bound[i])) return false;
    for (Eigen::Index j = 0; j <= i; ++j)
      if (!near(a.M(i, j), b.M(i, j), a.M_bound(i, j)) ||
          !near(a.M(i, j), b.M(j, i), a.M_bound(i, j)))
        return false;
    return true;
  }
  bool fits(const Robot& robot) const {
    for (std::size_t k = 0; k < q_.size(); ++k) {
      const MassAndGravity a = massAndGravity(robot, q_[k]);
      for (Eigen::Index i = a.g.size() - 1; i >= 0; --i)
        if (!rowFits(a, said_[k], i)) return false;
    }
    return true;
  }
  bool fitsRow(const Robot& robot, std::size_t row) const {
    for (std::size_t k = 0; k < q_.size(); ++k)
      if (!rowFits(massAndGravity(robot, q_[k]), said_[k], static_cast<Eigen::Index>(row)))
        return false;
    return true;
  }

  bool keep(const Guess& guess) {
    out_.push_back(guess.finding);
    Misreading& finding = out_.back();
    finding.has_effect = true;
    finding.effect = effectOf(ours_, guess.robot, states_, seed_);
    return true;
  }
  bool tryWhole(const Guess& guess) { return fits(guess.robot) && keep(guess); }

  Guess guessOf(std::size_t b, const MassReading& reading, const Robot& from) const {
    Guess guess{{ours_.bodies[b].link, "inertia", reading.words, shown(ours_.bodies[b].moments),
                 shown(reading.moments), file_.where(b)},
                from};
    guess.robot.bodies[b].moments = reading.moments;
    guess.finding.read = reading.moments;
    const std::string record = publicRecord(reader_, reading.mistake);
    if (!record.empty()) guess.finding.records.push_back(record);
    return guess;
  }
  Guess guessOf(std::size_t b, const JointReading& reading, const Robot& from) const {
    const ReadBody &a = ours_.bodies[b], &c = reading.body;
    const std::string quantity = reading.quantity;
    Guess guess{{a.link, quantity, reading.words,
                 quantity == "origin" ? shown(a.placement)
                 : quantity == "axis" ? shown(a.axis)
                                      : scene::name(a.kind),
                 quantity == "origin" ? shown(c.placement)
                 : quantity == "axis" ? shown(c.axis)
                                      : scene::name(c.kind),
                 file_.where(b)},
                from};
    ReadBody& changed = guess.robot.bodies[b];
    changed.placement = c.placement;
    changed.axis = c.axis;
    changed.kind = c.kind;
    return guess;
  }
  /// A diagonal entry of M is larger by the same number at all positions.
  Guess armatureOf(std::size_t b, const Robot& from) const {
    const auto i = static_cast<Eigen::Index>(b);
    const double armature = said_[0].M(i, i) - massAndGravity(from, q_[0]).M(i, i);
    const double before = ours_.bodies[b].armature;
    Guess guess{
        {ours_.bodies[b].link, "armature",
         before == 0 ? fmt::format("a default of the reader's, {:.6g}", armature) : "",
         fmt::format("{:.6g}", before), fmt::format("{:.6g}", before + armature), file_.where(b)},
        from};
    guess.robot.bodies[b].armature += armature;
    return guess;
  }

  /// g is linear in gravity, and M does not know it.
  bool tryGravity(bool plainly) {
    Robot along = ours_;
    const Eigen::Index n = said_[0].g.size(), m = static_cast<Eigen::Index>(q_.size());
    Eigen::MatrixXd G(n * m, 3);
    Eigen::VectorXd g(n * m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const auto at = static_cast<std::size_t>(k);
      g.segment(k * n, n) = said_[at].g;
      for (int axis = 0; axis < 3; ++axis) {
        along.gravity = Vector3d::Unit(axis);
        G.block(k * n, axis, n, 1) = massAndGravity(along, q_[at]).g;
      }
    }
    Guess guess{{"", "gravity", "", shown(ours_.gravity), "", {}}, ours_};
    guess.robot.gravity = G.colPivHouseholderQr().solve(g);
    // none, or the other sign: those need no digits of the least squares
    for (const double size : {0.0, -1.0}) {
      if (!plainly) break;
      Guess plain = guess;
      plain.robot.gravity = size * ours_.gravity;
      plain.finding.rule = gravityMistake(ours_.gravity, plain.robot.gravity);
      plain.finding.theirs = shown(plain.robot.gravity);
      if (tryWhole(plain)) return true;
    }
    guess.finding.rule = gravityMistake(ours_.gravity, guess.robot.gravity);
    guess.finding.theirs = shown(guess.robot.gravity);
    return !plainly && tryWhole(guess);
  }

  /// The same mistake at every link, or every joint.
  bool tryEverywhere() {
    std::vector<std::vector<MassReading>> masses;
    std::vector<std::vector<JointReading>> joints;
    std::set<Mistake> mistakes;
    std::vector<std::string> rules;
    for (std::size_t b = 0; b < ours_.bodies.size(); ++b) {
      masses.push_back(misreadings(file_, b));
      joints.push_back(jointMisreadings(file_, b));
      for (const MassReading& one : masses.back()) mistakes.insert(one.mistake);
      for (const JointReading& one : joints.back())
        if (std::find(rules.begin(), rules.end(), one.words) == rules.end())
          rules.push_back(one.words);
    }
    const auto tryAll = [&](const std::function<const Guess*(std::size_t)>& at) {
      Robot all = ours_;
      std::vector<Guess> guesses;
      for (std::size_t b = 0; b < ours_.bodies.size(); ++b)
        if (const Guess* one = at(b)) {
          all.bodies[b] = one->robot.bodies[b];
          guesses.push_back(*one);
        }
      if (guesses.size() < 2 || !fits(all)) return false;
      for (const Guess& one : guesses) keep(one);
      return true;
    };
    Guess held;
    for (const Mistake mistake : mistakes)
      if (tryAll([&](std::size_t b) -> const Guess* {
            for (const MassReading& one : masses[b])
              if (one.mistake == mistake) {
                held = guessOf(b, one, ours_);
                return &held;
              }
            return nullptr;
          }))
        return true;
    for (const std::string& rule : rules)
      if (tryAll([&](std::size_t b) -> const Guess* {
            for (const JointReading& one : joints[b])
              if (one.words == rule) {
                held = guessOf(b, one, ours_);
                return &held;
              }
            return nullptr;
          }))
        return true;
    return false;
  }

  /// One mistake, at one link or joint.
  bool tryOne() {
    for (std::size_t b = 0; b < ours_.bodies.size(); ++b) {
      for (const MassReading& one : misreadings(file_, b))
        if (tryWhole(guessOf(b, one, ours_))) return true;
      for (const JointReading& one : jointMisreadings(file_, b))
        if (tryWhole(guessOf(b, one, ours_))) return true;
    }
    return false;
  }
  bool tryArmature() {
    for (std::size_t b = 0; b < ours_.bodies.size(); ++b) {
      const Guess guess = armatureOf(b, ours_);
      if (guess.robot.bodies[b].armature >= 0 && tryWhole(guess)) return true;
    }
    return false;
  }

  /// From the tips inward, each row with what is known outward of it.
  void inward() {
    Robot known = ours_;
    std::vector<bool> hidden(ours_.bodies.size(), false);
    for (std::size_t b = ours_.bodies.size(); b-- > 0;) {
      if (hidden[b]) {
        hide(b, &hidden);
        continue;
      }
      if (fitsRow(known, b) || explainRow(b, &known)) continue;
      leastChange(b, known);
      hide(b, &hidden);
    }
  }
  void hide(std::size_t b, std::vector<bool>* hidden) const {
    const int parent = ours_.bodies[b].parent;
    if (parent >= 0) (*hidden)[static_cast<std::size_t>(parent)] = true;
  }
  bool explainRow(std::size_t b, Robot* known) {
    const auto take = [&](const Guess& guess) {
      if (!fitsRow(guess.robot, b)) return false;
      *known = guess.robot;
      Guess alone = guess;
      alone.robot = ours_;
      alone.robot.bodies[b] = guess.robot.bodies[b];
      return keep(alone);
    };
    for (const MassReading& one : misreadings(file_, b))
      if (take(guessOf(b, one, *known))) return true;
    for (const JointReading& one : jointMisreadings(file_, b))
      if (take(guessOf(b, one, *known))) return true;
    for (const MassReading& one : pairsOfMisreadings(file_, b))
      if (take(guessOf(b, one, *known))) return true;
    const Guess guess = armatureOf(b, *known);
    return guess.robot.bodies[b].armature >= 0 && take(guess);
  }

  /// The least change of the ten numbers of a link that gives its row.
  void leastChange(std::size_t b, const Robot& known) {
    const auto row = static_cast<Eigen::Index>(b);
    const Eigen::Index per_state = row + 2, m = static_cast<Eigen::Index>(q_.size());
    const auto rowOf = [&](const MassAndGravity& x) {
      Eigen::VectorXd out(per_state);
      out << x.M.row(row).head(row + 1).transpose(), x.g[row];
      return out;
    };
    const auto numbersOf = [&](const Robot& robot) {
      Eigen::VectorXd out(per_state * m);
      for (Eigen::Index k = 0; k < m; ++k)
        out.segment(k * per_state, per_state) =
            rowOf(massAndGravity(robot, q_[static_cast<std::size_t>(k)]));
      return out;
    };
    Eigen::VectorXd said(per_state * m);
    for (Eigen::Index k = 0; k < m; ++k)
      said.segment(k * per_state, per_state) = rowOf(said_[static_cast<std::size_t>(k)]);
    const Eigen::VectorXd before = numbersOf(known);
    constexpr int kNumbers = 10;
    static constexpr int kRow[] = {0, 1, 2, 0, 0, 1}, kColumn[] = {0, 1, 2, 1, 2, 2};
    Eigen::MatrixXd Y(per_state * m, kNumbers);
    const auto changed = [&](const Eigen::VectorXd& by) {
      Robot robot = known;
      MassMoments& moments = robot.bodies[b].moments;
      moments.mass += by[0];
      moments.first += by.segment<3>(1);
      for (int k = 0; k < 6; ++k) {
        moments.second(kRow[k], kColumn[k]) += by[4 + k];
        if (kRow[k] != kColumn[k]) moments.second(kColumn[k], kRow[k]) += by[4 + k];
      }
      return robot;
    };
    // a mass alone of zero has no centre: another kilogram with each
    Eigen::VectorXd kilogram = Eigen::VectorXd::Unit(kNumbers, 0);
    const Eigen::VectorXd with_mass = numbersOf(changed(kilogram));
    Y.col(0) = with_mass - before;
    for (int k = 1; k < kNumbers; ++k)
      Y.col(k) = numbersOf(changed(kilogram + Eigen::VectorXd::Unit(kNumbers, k))) - with_mass;
    const Eigen::VectorXd by = Y.completeOrthogonalDecomposition().solve(said - before);
    const double left = (Y * by - (said - before)).norm() / (said - before).norm();
    static constexpr const char* kNames[] = {"m",   "m cx", "m cy", "m cz", "Ixx",
                                             "Iyy", "Izz",  "Ixy",  "Ixz",  "Iyz"};
    std::string change;
    for (int k = 0; k < kNumbers; ++k)
      if (std::abs(by[k]) > roundingOf(1) * by.norm())
        change += fmt::format("{}{} {:+.6g}", change.empty() ? "" : ", ", kNames[k], by[k]);
    Misreading finding{
        ours_.bodies[b].link,
        "inertia",
        "",
        shown(ours_.bodies[b].moments),
        fmt::format("the least change about the link's joint that gives its row of M "
                    "and g: {} (explains all but {:.2g} of it)",
                    change, left),
        file_.where(b)};
    out_.push_back(finding);
  }

  const FileParts& file_;
  const Robot& ours_;
  const std::vector<std::vector<double>>& q_;
  const std::vector<MassAndGravity>& said_;
  std::string reader_;
  int states_;
  std::uint64_t seed_;
  std::vector<Misreading> out_;
};

}  // namespace

std::vector<Misreading> explainAnswers(const FileParts& file,
                                       const std::vector<std::vector<double>>& positions,
                                       const std::vector<MassAndGravity>& said,
                                       const std::string& reader, int states, std::uint64_t seed) {
  return Search(file, positions, said, reader, states, seed).findings();
}

}  // namespace dynwitness::crosscheck
