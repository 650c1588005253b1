// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/hypotheses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace dynwitness::crosscheck {
namespace {

using Edit = std::function<void(TextbookLink&)>;
using Applies = std::function<bool(const TextbookLink&)>;
constexpr double kDegree = M_PI / 180;
/// Entries of an inertia, as its six numbers are listed.
constexpr std::array<std::array<int, 2>, 6> kEntries = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

Matrix3d pointMass(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}
/// What the theorem of parallel axes adds from the centre of mass to the link's origin.
Matrix3d toOrigin(const TextbookLink& link) {
  return pointMass(link.mass, link.com);
}
/// The same to the moved joint's origin, in link axes.
Matrix3d toJoint(const TextbookLink& link) {
  return pointMass(link.mass, link.com + link.after.R.transpose() * link.after.p);
}
/// The link's frame in its parent's at q = 0.
Frame atRest(const TextbookLink& link) {
  return link.before * link.after;
}
bool isTrivial(const Frame& frame) {
  return frame.R == Matrix3d::Identity() && frame.p == Vector3d::Zero();
}
bool hasOneRate(const TextbookLink& link) {
  return link.parent >= 0 && scene::degreesOfFreedom(link.kind) == 1;
}
bool hasAxisOfOne(const TextbookLink& link) {
  return hasOneRate(link) && scene::hasAxis(link.kind);
}
bool moves(const TextbookLink& link) {
  return link.parent >= 0 && link.kind != scene::JointKind::kFixed;
}
bool hasParent(const TextbookLink& link) {
  return link.parent >= 0;
}
Matrix3d withProducts(Matrix3d I, double factor) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) I(i, j) *= factor;
  return I;
}
/// The inertia about the centre of mass, from numbers as they were written.
Matrix3d fromWritten(const TextbookLink& link, const Matrix3d& written, const Matrix3d& axes) {
  Matrix3d I = axes * written * axes.transpose();
  if (link.about_origin) I -= toOrigin(link);
  return I;
}

/// Collects hypotheses.
class List {
 public:
  explicit List(const TextbookModel& model) : model_(model) {}

  void add(const std::string& rule, const std::string& sentence,
           std::function<void(Belief&)> apply) {
    out_.push_back({rule, -1, false, sentence, std::move(apply)});
  }
  /// @param sentence  {} stands for "link 'arm'" or "joint 'elbow'"
  void at(const std::string& rule, std::size_t i, bool at_joint, const std::string& sentence,
          std::function<void(Belief&)> apply) {
    const TextbookLink& link = model_.links[i];
    const std::string where =
        at_joint ? fmt::format("joint '{}'", link.joint) : fmt::format("link '{}'", link.name);
    out_.push_back(
        {rule, static_cast<int>(i), at_joint, fmt::format(sentence, where), std::move(apply)});
  }
  /// One a link to which it applies, and all of them together.
  void each(
      const std::string& rule, bool at_joint, const Applies& applies, const std::string& sentence,
      const Edit& edit, const std::function<void(Formulas&)>& formula = [](Formulas&) {}) {
    int count = 0;
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      if (!applies(model_.links[i])) continue;
      ++count;
      at(rule, i, at_joint, sentence, [edit, formula, i](Belief& b) {
        edit(b.model.links[i]);
        formula(b.formulas);
      });
    }
    if (count < 2) return;
    add(rule, fmt::format(sentence, at_joint ? "every joint" : "every link"),
        [edit, formula, applies](Belief& b) {
          for (TextbookLink& link : b.model.links)
            if (applies(link)) edit(link);
          formula(b.formulas);
        });
  }
  void formula(const std::string& rule, const std::string& sentence,
               const std::function<void(Formulas&)>& edit) {
    add(rule, sentence, [edit](Belief& b) { edit(b.formulas); });
  }
  const TextbookModel& model() const { return model_; }
  std::vector<Hypothesis> take() { return std::move(out_); }

 private:
  const TextbookModel& model_;
  std::vector<Hypothesis> out_;
};

void addGravity(List& list) {
  list.add("gravity_sign", "gravity with the opposite sign",
           [](Belief& b) { b.model.gravity = -b.model.gravity; });
  list.add("gravity_missing", "gravity left out",
           [](Belief& b) { b.model.gravity = Vector3d::Zero(); });
  list.add("gravity_twice", "gravity counted twice", [](Belief& b) { b.model.gravity *= 2; });
  const double size = list.model().gravity.norm();
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {-1, 1}) {
      const Vector3d other = sign * size * Vector3d::Unit(axis);
      if (size == 0 || other == list.model().gravity || other == -list.model().gravity) continue;
      list.add("gravity_frame",
               fmt::format("gravity along {}{} of the world", sign < 0 ? "-" : "+", "xyz"[axis]),
               [other](Belief& b) { b.model.gravity = other; });
    }
  std::array<int, 3> order = {0, 1, 2};
  while (std::next_permutation(order.begin(), order.end())) {
    const Vector3d& g = list.model().gravity;
    const Vector3d other(g(order[0]), g(order[1]), g(order[2]));
    list.add("gravity_frame",
             fmt::format("coordinates of gravity in the order {}{}{}", "xyz"[order[0]],
                         "xyz"[order[1]], "xyz"[order[2]]),
             [other](Belief& b) { b.model.gravity = other; });
  }
  list.formula("gravity_frame", "gravity in the world's axes taken as if in the axes of each link",
               [](Formulas& f) { f.gravity_not_turned = true; });
  for (std::size_t i = 0; i < list.model().links.size(); ++i)
    if (list.model().links[i].kind == scene::JointKind::kFloating)
      list.formula("gravity_frame",
                   fmt::format("gravity in the world's axes taken as if in those of link '{}'",
                               list.model().links[i].name),
                   [i](Formulas& f) { f.gravity_turns_with = static_cast<int>(i); });
  for (const bool twice : {true, false})
    list.formula("gravity_in_c",
                 twice ? "gravity included in c (and once more in tau)" : "gravity included in c",
                 [twice](Formulas& f) {
                   f.gravity_in_c = true;
                   f.g_twice_in_tau = twice;
                 });
}

void addFormulas(List& list) {
  for (const bool in_tau : {true, false}) {
    const std::string where = in_tau ? "" : ", not in tau";
    const auto factor = [&](const std::string& rule, const std::string& what, double of_M,
                            double of_c) {
      list.formula(rule, what + where, [=](Formulas& f) {
        f.factor_M = of_M;
        f.factor_c = of_c;
        f.factor_in_tau = in_tau;
      });
    };
    factor("c_twice", "c counted twice", 1, 2);
    factor("c_half", "half of c", 1, 0.5);
    factor("qd_ignored", "c left out", 1, 0);
    factor("half_inertia", "half of M", 0.5, 1);
    factor("double_inertia", "M twice as large", 2, 1);
    factor("half_inertia", "half of M and of c", 0.5, 0.5);
    factor("double_inertia", "M and c twice as large", 2, 2);
    list.formula("c_times_qd", "c multiplied by the rates, entry by entry" + where,
                 [in_tau](Formulas& f) {
                   f.c_times_qd = true;
                   f.factor_in_tau = in_tau;
                 });
  }
  list.formula("double_inertia", "kinetic energy twice as large",
               [](Formulas& f) { f.factor_kinetic = 2; });
  list.formula("half_inertia", "half of the kinetic energy",
               [](Formulas& f) { f.factor_kinetic = 0.5; });
  list.formula("qdd_ignored", "accelerations of the joints ignored in tau",
               [](Formulas& f) { f.qdd_ignored = true; });
  for (const bool in_tau : {false, true}) {
    list.formula("triangle_only", "only the upper triangle of M filled", [in_tau](Formulas& f) {
      f.triangle = Formulas::Triangle::kUpper;
      f.triangle_in_tau = in_tau;
    });
    list.formula("triangle_only", "only the lower triangle of M filled", [in_tau](Formulas& f) {
      f.triangle = Formulas::Triangle::kLower;
      f.triangle_in_tau = in_tau;
    });
  }
  list.formula("gyroscopic_missing", "w x I w left out of the links' moments",
               [](Formulas& f) { f.gyroscopic = false; });
  list.formula("bias_missing",
               "accelerations that come of velocities alone (dJ/dt qd) left out of c",
               [](Formulas& f) { f.point_bias = f.turn_bias = false; });
  list.formula("bias_missing",
               "accelerations of points that come of velocities (dJv/dt qd) left out of c",
               [](Formulas& f) { f.point_bias = false; });
  list.formula("bias_missing",
               "angular accelerations that come of velocities (dJw/dt qd) left out of c",
               [](Formulas& f) { f.turn_bias = false; });
  const std::vector<TextbookLink>& links = list.model().links;
  for (const Formulas::Bias bias : {Formulas::Bias::kMoved, Formulas::Bias::kSpatial}) {
    const std::string what = bias == Formulas::Bias::kMoved
                                 ? "accelerations that a moved axis makes (w x z qd) left out at {}"
                                 : "v x Z qd left out of the spatial acceleration at {}";
    for (std::size_t i = 0; i < links.size(); ++i)
      if (moves(links[i]))
        list.at("bias_missing", i, true, what, [i, bias](Belief& b) {
          b.formulas.joint_bias = bias;
          b.formulas.biased_joint = static_cast<int>(i);
        });
    list.formula("bias_missing", fmt::format(what, "every joint"),
                 [bias](Formulas& f) { f.joint_bias = bias; });
  }
  for (std::size_t i = 0; i < links.size(); ++i)
    if (hasParent(links[i]))
      list.at("gyroscopic_missing", i, false, "w x I w left out of the moment of {}",
              [i](Belief& b) { b.formulas.not_gyroscopic = static_cast<int>(i); });
  list.formula("centrifugal_missing", "c without the squares of rates (Coriolis terms alone)",
               [](Formulas& f) { f.products = Formulas::Products::kMixed; });
  list.formula("centrifugal_missing", "w x (w x r) left out of the accelerations of points",
               [](Formulas& f) { f.centripetal = false; });
  list.formula("coriolis_missing", "2 w x v of slides left out",
               [](Formulas& f) { f.slide_coriolis = false; });
  list.formula("coriolis_missing",
               "c without products of different rates (centrifugal terms alone)",
               [](Formulas& f) { f.products = Formulas::Products::kSquares; });
}

/// The link and what fixed joints carry on it, made one body without the theorem of parallel axes.
void lumpWithoutParallelAxes(TextbookModel& model, std::size_t first) {
  std::vector<Frame> frames(model.links.size());
  std::vector<std::size_t> body = {first};
  for (std::size_t i = first + 1; i < model.links.size(); ++i) {
    const TextbookLink& link = model.links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    if (link.kind != scene::JointKind::kFixed || std::count(body.begin(), body.end(), parent) == 0)
      continue;
    frames[i] = frames[parent] * link.before * link.after;
    body.push_back(i);
  }
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
  for (const std::size_t i : body) {
    TextbookLink& link = model.links[i];
    mass += link.mass;
    moment += link.mass * (frames[i].p + frames[i].R * link.com);
    inertia += frames[i].R * link.inertia * frames[i].R.transpose();
    link.mass = 0;
    link.com = Vector3d::Zero();
    link.inertia = Matrix3d::Zero();
  }
  TextbookLink& whole = model.links[first];
  whole.mass = mass;
  if (mass != 0) whole.com = moment / mass;
  whole.inertia = inertia;
}

void addLumped(List& list) {
  const TextbookModel& model = list.model();
  std::vector<std::size_t> carriers;  // moving links with something on a fixed joint
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (moves(model.links[i]) &&
        std::any_of(model.links.begin(), model.links.end(), [&](const TextbookLink& link) {
          return link.kind == scene::JointKind::kFixed && link.parent == static_cast<int>(i);
        }))
      carriers.push_back(i);
  const std::string what =
      "parallel axis terms missing where {} and what it carries on fixed joints are made one body";
  for (const std::size_t i : carriers)
    list.at("parallel_axis_missing", i, false, what,
            [i](Belief& b) { lumpWithoutParallelAxes(b.model, i); });
  if (carriers.size() > 1)
    list.add("parallel_axis_missing", fmt::format(what, "every link"), [carriers](Belief& b) {
      for (const std::size_t i : carriers) lumpWithoutParallelAxes(b.model, i);
    });
}

void addInertias(List& list) {
  const Applies any = [](const TextbookLink& link) { return hasParent(link); };
  const Applies off_origin = [](const TextbookLink& link) {
    return hasParent(link) && link.after.p != Vector3d::Zero();
  };
  const auto both = [&](const std::string& rule, const std::string& sentence, double factor) {
    list.each(rule, false, any, sentence,
              [factor](TextbookLink& link) { link.inertia += factor * toOrigin(link); });
    list.each(rule, false, off_origin, sentence + ", as far as the joint's axis",
              [factor](TextbookLink& link) { link.inertia += factor * toJoint(link); });
  };
  both("inertia_about_joint",
       "inertia of {} taken about the joint instead of the centre of mass (parallel axis twice)",
       1);
  both("parallel_axis_missing", "parallel axis term of {} missing", -1);
  both("parallel_axis_sign", "parallel axis term of {} with the opposite sign", -2);
  list.each("parallel_axis_sign", false, any,
            "parallel axis term of {} with the opposite sign, from the joint to the centre of mass",
            [](TextbookLink& link) { link.inertia += 2 * toOrigin(link); });
  for (const double factor : {-1.0, 0.0}) {
    const std::string rule = factor < 0 ? "product_sign" : "products_dropped";
    const std::string what = factor < 0 ? "products of inertia of {} with the opposite sign"
                                        : "products of inertia of {} dropped";
    list.each(rule, false, any, what,
              [factor](TextbookLink& link) { link.inertia = withProducts(link.inertia, factor); });
    list.each(rule, false, any, what + ", in the axes in which they are given",
              [factor](TextbookLink& link) {
                link.inertia = fromWritten(link, withProducts(link.written, factor), link.axes);
              });
    list.each(rule, false, any, what + ", about the link's origin", [factor](TextbookLink& link) {
      link.inertia = withProducts(Matrix3d(link.inertia + toOrigin(link)), factor) - toOrigin(link);
    });
  }
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} taken in link axes although it is given in axes of its own",
            [](TextbookLink& link) {
              link.inertia = fromWritten(link, link.written, Matrix3d::Identity());
            });
  list.each("rotation_transposed", false, any,
            "inertia of {} turned the wrong way from axes of its own", [](TextbookLink& link) {
              link.inertia = fromWritten(link, link.written, link.axes.transpose());
            });
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} taken in link axes as it is in those of its parent at rest",
            [](TextbookLink& link) {
              const Matrix3d R = atRest(link).R;
              link.inertia = (R.transpose() * link.inertia * R).eval();
            });
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} turned by its placement once more", [](TextbookLink& link) {
              const Matrix3d R = atRest(link).R;
              link.inertia = (R * link.inertia * R.transpose()).eval();
            });
  const Applies has_axes = [](const TextbookLink& link) {
    return hasParent(link) && link.axes != Matrix3d::Identity();
  };
  for (const Formulas::Triangle kept :
       {Formulas::Triangle::kBoth, Formulas::Triangle::kUpper, Formulas::Triangle::kLower})
    for (const bool left : {true, false})
      list.each(
          "principal_axes_not_rotated", false, has_axes,
          fmt::format("inertia of {{}} turned from axes of its own on the {} alone ({}){}",
                      left ? "left" : "right", left ? "R I" : "I R'",
                      kept == Formulas::Triangle::kBoth    ? ""
                      : kept == Formulas::Triangle::kUpper ? ", M from its upper triangle"
                                                           : ", M from its lower triangle"),
          [left](TextbookLink& link) {
            Matrix3d I = left ? Matrix3d(link.axes * link.written)
                              : Matrix3d(link.written * link.axes.transpose());
            if (link.about_origin) I -= toOrigin(link);
            link.inertia = I;
          },
          [kept](Formulas& f) { f.mirrored = kept; });
  list.each("inertia_dropped", false, any, "inertia of {} about its centre of mass left out",
            [](TextbookLink& link) { link.inertia = Matrix3d::Zero(); });
  addLumped(list);
  std::array<int, 3> order = {0, 1, 2};
  do
    list.each("principal_axes_not_rotated", false, any,
              "principal moments of {} taken as moments about the link's axes",
              [order](TextbookLink& link) {
                const Eigen::SelfAdjointEigenSolver<Matrix3d> solved(link.inertia);
                for (int k = 0; k < 3; ++k)
                  link.inertia.row(k) = Vector3d::Unit(k).transpose() *
                                        solved.eigenvalues()(order[static_cast<std::size_t>(k)]);
              });
  while (std::next_permutation(order.begin(), order.end()));
  list.each("half_inertia", false, any, "half of the inertia of {}",
            [](TextbookLink& link) { link.inertia *= 0.5; });
  list.each("double_inertia", false, any, "inertia of {} twice as large",
            [](TextbookLink& link) { link.inertia *= 2; });
  list.each("com_dropped", false, any, "centre of mass of {} taken at the link's origin",
            [](TextbookLink& link) { link.com = Vector3d::Zero(); });
  list.each("com_dropped", false, off_origin, "centre of mass of {} taken at the joint",
            [](TextbookLink& link) { link.com = -link.after.R.transpose() * link.after.p; });
}

void addCentresOfMass(List& list) {
  const std::string rule = "com_wrong_frame";
  for (std::size_t i = 1; i < list.model().links.size(); ++i) {
    for (const Formulas::Com com : {Formulas::Com::kParentFrame, Formulas::Com::kParentAxes})
      list.at(rule, i, false,
              com == Formulas::Com::kParentFrame
                  ? "centre of mass of {} taken in the frame of its parent"
                  : "centre of mass of {} taken in the axes of its parent",
              [i, com](Belief& b) {
                b.formulas.com_elsewhere = static_cast<int>(i);
                b.formulas.com = com;
              });
  }
  const Applies any = [](const TextbookLink& link) { return hasParent(link); };
  list.each(rule, false, any, "centre of mass of {} taken in the moved joint frame",
            [](TextbookLink& link) {
              link.com = (link.after.R.transpose() * (link.com - link.after.p)).eval();
            });
  list.each(rule, false, any, "centre of mass of {} taken in the axes of the moved joint frame",
            [](TextbookLink& link) { link.com = (link.after.R.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} turned with its inertia's axes",
            [](TextbookLink& link) { link.com = (link.axes * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {}, in link axes, taken in its inertia's axes",
            [](TextbookLink& link) { link.com = (link.axes.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} turned by its placement once more",
            [](TextbookLink& link) { link.com = (atRest(link).R * link.com).eval(); });
  list.each(rule, false, any,
            "centre of mass of {} in the axes of its parent at rest taken as if in its own",
            [](TextbookLink& link) { link.com = (atRest(link).R.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} moved by its placement once more",
            [](TextbookLink& link) {
              const Frame rest = atRest(link);
              link.com = rest.R * link.com + rest.p;
            });
  list.each(rule, false, any,
            "centre of mass of {} taken in the frame of its parent, as it is at rest",
            [](TextbookLink& link) {
              const Frame rest = atRest(link);
              link.com = (rest.R.transpose() * (link.com - rest.p)).eval();
            });
}

void addJointForces(List& list) {
  const Applies has_rotor = [](const TextbookLink& link) { return link.added != 0; };
  list.each("rotor_missing", true, has_rotor, "rotor of {} missing",
            [](TextbookLink& link) { link.added = link.rotor = link.spin = 0; });
  list.each("rotor_doubled", true, has_rotor, "rotor of {} counted twice", [](TextbookLink& link) {
    link.added *= 2;
    link.spin *= 2;
  });
  list.each("rotor_ratio_not_squared", true, has_rotor, "gear ratio of {} not squared",
            [](TextbookLink& link) { link.added = link.gear * link.rotor; });
  list.each("rotor_ratio_not_squared", true, has_rotor, "gear ratio of {} left out",
            [](TextbookLink& link) { link.added = link.rotor; });
  list.each("rotor_sign", true, has_rotor, "rotor of {} with the opposite sign",
            [](TextbookLink& link) { link.added = -link.added; });
  const Applies spins = [](const TextbookLink& link) { return link.spin != 0; };
  list.each("rotor_sign", true, spins, "gyroscopic rotor of {} spins the other way",
            [](TextbookLink& link) { link.spin = -link.spin; });
  list.each("gyroscopic_missing", true, spins,
            "rotor of {} without what its spin does to its parent",
            [](TextbookLink& link) { link.spin = 0; });
  const Applies damped = [](const TextbookLink& link) { return link.viscous != 0; };
  const Applies rubs = [](const TextbookLink& link) {
    return link.viscous != 0 || link.coulomb[0] != 0 || link.coulomb[1] != 0;
  };
  const Applies coulomb = [](const TextbookLink& link) {
    return link.coulomb[0] != 0 || link.coulomb[1] != 0;
  };
  list.each("damping_sign", true, damped, "damping of {} with the opposite sign",
            [](TextbookLink& link) { link.viscous = -link.viscous; });
  list.each("damping_sign", true, rubs, "friction of {} with the opposite sign",
            [](TextbookLink& link) {
              link.viscous = -link.viscous;
              for (double& x : link.coulomb) x = -x;
            });
  list.each("damping_missing", true, damped, "damping of {} left out",
            [](TextbookLink& link) { link.viscous = 0; });
  list.each("friction_missing", true, rubs, "friction of {} left out",
            [](TextbookLink& link) { link.viscous = link.coulomb[0] = link.coulomb[1] = 0; });
  list.each("friction_missing", true, coulomb, "Coulomb friction of {} left out",
            [](TextbookLink& link) { link.coulomb[0] = link.coulomb[1] = 0; });
  list.each(
      "spring_missing", true, [](const TextbookLink& link) { return link.stiffness != 0; },
      "spring of {} left out", [](TextbookLink& link) { link.stiffness = 0; });
  list.each(
      "spring_sign", true, [](const TextbookLink& link) { return link.stiffness != 0; },
      "spring of {} with the opposite sign",
      [](TextbookLink& link) { link.stiffness = -link.stiffness; });
}

void addWrenches(List& list) {
  if (list.model().wrenches.empty()) return;
  list.add("wrench_missing", "wrenches left out", [](Belief& b) { b.model.wrenches.clear(); });
  const auto each = [&](const std::string& rule, const std::string& sentence,
                        const std::function<void(TextbookWrench&)>& edit) {
    list.add(rule, sentence, [edit](Belief& b) {
      for (TextbookWrench& wrench : b.model.wrenches) edit(wrench);
    });
  };
  each("wrench_sign", "wrenches with the opposite sign", [](TextbookWrench& w) {
    w.force = -w.force;
    w.moment = -w.moment;
  });
  each("wrench_frame", "wrenches in link axes taken in world axes",
       [](TextbookWrench& w) { w.in_world = true; });
  each("wrench_frame", "wrenches in world axes taken in link axes",
       [](TextbookWrench& w) { w.in_world = false; });
  each("wrench_point", "forces of wrenches taken at the link's origin",
       [](TextbookWrench& w) { w.at = Vector3d::Zero(); });
}

void addPlacementTurns(List& list) {
  const TextbookModel& model = list.model();
  list.each("rotation_transposed", false, hasParent, "rotation of {} (its placement) transposed",
            [](TextbookLink& link) { link.before.R.transposeInPlace(); });
  list.each("rotation_transposed", false, hasParent, "rotation of {} beyond its joint transposed",
            [](TextbookLink& link) { link.after.R.transposeInPlace(); });
  for (std::size_t i = 1; i < model.links.size(); ++i)
    list.at("rotation_transposed", i, false,
            "rotation of {} in its parent, with its joint's, transposed",
            [i](Belief& b) { b.formulas.turned_back = static_cast<int>(i); });
  for (std::size_t i = 1; i < model.links.size(); ++i)
    if (hasOneRate(model.links[i]) && model.links[i].kind != scene::JointKind::kPrismatic)
      list.at("rotation_transposed", i, false, "turn of the joint of {} transposed",
              [i, &model](Belief& b) {
                std::vector<double>& sign = b.passing.position_sign;
                if (sign.empty()) sign.assign(static_cast<std::size_t>(model.positions), 1.0);
                sign[static_cast<std::size_t>(model.links[i].q)] *= -1;
              });
  list.each("rotation_transposed", false, hasParent, "placement of {} inverted",
            [](TextbookLink& link) {
              link.before.R.transposeInPlace();
              link.before.p = (-link.before.R * link.before.p).eval();
            });
  list.each("rpy_order", false, hasParent, "turns of the placement of {} in the opposite order",
            [](TextbookLink& link) {
              Matrix3d R = Matrix3d::Identity();
              for (const PlacementStep& step : link.before_steps)
                if (step.axis >= 0) R = composed({step}).R * R;
              link.before.R = R;
            });
}

void addFixedChildren(List& list) {
  const Applies fixed = [](const TextbookLink& link) {
    return link.parent >= 0 && link.kind == scene::JointKind::kFixed;
  };
  const Edit weightless = [](TextbookLink& link) {
    link.mass = 0;
    link.inertia = Matrix3d::Zero();
  };
  list.each("fixed_child_skipped", false, fixed, "{}, on a fixed joint, skipped: its mass",
            weightless);
  list.each("fixed_child_skipped", false, fixed, "{}, on a fixed joint, skipped: its placement",
            [](TextbookLink& link) { link.before = link.after = Frame(); });
  list.each("fixed_child_skipped", false, fixed,
            "{}, on a fixed joint, skipped: its mass and its placement",
            [weightless](TextbookLink& link) {
              weightless(link);
              link.before = link.after = Frame();
            });
}

/// A row of Denavit and Hartenberg, read by the other convention.
void readAsModified(TextbookLink& link) {
  std::vector<PlacementStep> turn_z, shift, turn_x;
  for (const PlacementStep& step : link.after_steps)
    (step.axis < 0 ? shift : step.axis == 2 ? turn_z : turn_x).push_back(step);
  const Vector3d p = composed(shift).p;
  Frame a, d;
  a.p = {p(0), 0, 0};
  d.p = {0, 0, p(2)};
  link.before = composed(turn_x) * a * composed(turn_z) * d;
  link.after = Frame();
}
void readAsStandard(TextbookLink& link) {
  std::vector<PlacementStep> turn_z, turn_x;
  Vector3d p = Vector3d::Zero();
  for (const PlacementStep& step : link.before_steps) {
    if (step.axis < 0) p += step.shift;
    if (step.axis == 2) turn_z.push_back(step);
    if (step.axis == 0) turn_x.push_back(step);
  }
  Frame shift;
  shift.p = p;
  link.before = Frame();
  link.after = composed(turn_z) * shift * composed(turn_x);
}

void addDenavitHartenberg(List& list) {
  const TextbookModel& model = list.model();
  // all at once is the likely way
  const bool has_dh = std::any_of(model.links.begin(), model.links.end(),
                                  [](const TextbookLink& link) { return link.is_dh; });
  const bool has_mdh = std::any_of(model.links.begin(), model.links.end(),
                                   [](const TextbookLink& link) { return link.is_mdh; });
  if (has_dh)
    list.each(
        "dh_as_modified", false, [](const TextbookLink& link) { return link.is_dh; },
        "Denavit-Hartenberg row of {} read as a modified one", readAsModified);
  if (has_mdh)
    list.each(
        "dh_as_modified", false, [](const TextbookLink& link) { return link.is_mdh; },
        "modified Denavit-Hartenberg row of {} read as a standard one", readAsStandard);
  list.each(
      "dh_as_modified", false,
      [](const TextbookLink& link) { return hasParent(link) && !isTrivial(link.after); },
      "placement of {} beyond its joint taken before the joint",
      [](TextbookLink& link) {
        link.before = link.before * link.after;
        link.after = Frame();
      });
}

void addDegrees(List& list) {
  for (const double unit : {kDegree, 1 / kDegree}) {
    const std::string how =
        unit < 1 ? "in radians taken for degrees" : "in degrees taken for radians";
    const auto scaled = [unit](TextbookLink& link, int axis) {
      for (auto* steps : {&link.before_steps, &link.after_steps})
        for (PlacementStep& step : *steps)
          if (step.axis >= 0 && (axis < 0 || step.axis == axis)) step.angle *= unit;
      link.before = composed(link.before_steps);
      link.after = composed(link.after_steps);
    };
    const Applies turned = [](const TextbookLink& link) {
      return hasParent(link) &&
             (link.before.R != Matrix3d::Identity() || link.after.R != Matrix3d::Identity());
    };
    const auto turns_about = [](const TextbookLink& link, int axis) {
      for (const auto* steps : {&link.before_steps, &link.after_steps})
        for (const PlacementStep& step : *steps)
          if (step.axis == axis && step.angle != 0) return true;
      return false;
    };
    for (int axis = 0; axis < 3; ++axis)
      list.each(
          "angle_in_degrees", false,
          [=](const TextbookLink& link) { return hasParent(link) && turns_about(link, axis); },
          fmt::format("angle about {} of the placement of {{}} {}", "xyz"[axis], how),
          [=](TextbookLink& link) { scaled(link, axis); });
    list.each("angle_in_degrees", false, turned, "angles of the placement of {} " + how,
              [scaled](TextbookLink& link) { scaled(link, -1); });
    const auto rotation = [unit](Matrix3d& R) {
      const Eigen::AngleAxisd turn(R);
      R = Eigen::AngleAxisd(turn.angle() * unit, turn.axis()).toRotationMatrix();
    };
    list.each("angle_in_degrees", false, turned, "angle of the placement of {} " + how,
              [rotation](TextbookLink& link) { rotation(link.before.R); });
    list.each("angle_in_degrees", false, turned, "angle of the placement of {} " + how,
              [rotation](TextbookLink& link) { rotation(link.after.R); });
    list.add("angle_in_degrees", "angles of joints " + how,
             [unit](Belief& b) { b.passing.angle_unit = unit; });
  }
}

/// Links whose joints have one position.
std::vector<std::size_t> singleJoints(const TextbookModel& model) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (hasOneRate(model.links[i])) out.push_back(i);
  return out;
}

void addJointOrders(List& list) {
  const TextbookModel& model = list.model();
  const std::vector<std::size_t> single = singleJoints(model);
  const std::size_t n = single.size();
  const auto order = [&](const std::string& sentence, const std::vector<std::size_t>& taken) {
    std::vector<int> rates(static_cast<std::size_t>(model.dof)),
        positions(static_cast<std::size_t>(model.positions));
    std::iota(rates.begin(), rates.end(), 0);
    std::iota(positions.begin(), positions.end(), 0);
    for (std::size_t k = 0; k < n; ++k) {
      const TextbookLink &here = model.links[single[k]], &there = model.links[single[taken[k]]];
      rates[static_cast<std::size_t>(here.qd)] = there.qd;
      positions[static_cast<std::size_t>(here.q)] = there.q;
    }
    list.add("joint_order", sentence, [=](Belief& b) {
      b.passing.order = rates;
      b.passing.position_order = positions;
    });
  };
  std::vector<std::size_t> same(n);
  std::iota(same.begin(), same.end(), std::size_t{0});
  if (n > 1) {
    std::vector<std::size_t> backward(same.rbegin(), same.rend()), on = same;
    if (n > 2) order("joints in the opposite order", backward);
    if (n > 2) {
      std::rotate(on.begin(), on.begin() + 1, on.end());
      order("joints counted from the second on", on);
      std::rotate(on.begin(), on.begin() + static_cast<std::ptrdiff_t>(n) - 2, on.end());
      order("joints counted from the last on", on);
    }
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = a + 1; b < n; ++b) {
        std::vector<std::size_t> swapped = same;
        std::swap(swapped[a], swapped[b]);
        order(fmt::format("joints '{}' and '{}' taken for each other", model.links[single[a]].joint,
                          model.links[single[b]].joint),
              swapped);
      }
  }
}

void addJointSigns(List& list) {
  const TextbookModel& model = list.model();
  const std::vector<std::size_t> single = singleJoints(model);
  const auto flip = [&model](Belief& b, std::size_t i) {
    Passing& by = b.passing;
    if (by.sign.empty()) by.sign.assign(static_cast<std::size_t>(model.dof), 1.0);
    if (by.position_sign.empty())
      by.position_sign.assign(static_cast<std::size_t>(model.positions), 1.0);
    by.sign[static_cast<std::size_t>(model.links[i].qd)] *= -1;
    by.position_sign[static_cast<std::size_t>(model.links[i].q)] *= -1;
  };
  for (const std::size_t i : single)
    list.at("joint_sign", i, true, "{} moves in the opposite direction",
            [flip, i](Belief& b) { flip(b, i); });
  if (single.size() > 1)
    list.add("joint_sign", "all joints move in the opposite direction", [flip, single](Belief& b) {
      for (const std::size_t i : single) flip(b, i);
    });
  list.each("joint_sign", true, hasAxisOfOne, "axis of {} points in the opposite direction",
            [](TextbookLink& link) { link.axis = -link.axis; });
}

void addJointAxes(List& list) {
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {1, -1})
      list.each(
          "axis_wrong", true,
          [axis](const TextbookLink& link) {
            return hasAxisOfOne(link) && std::abs(link.axis(axis)) != 1;
          },
          fmt::format("{{}} moves about {}{} of its frame", sign < 0 ? "-" : "", "xyz"[axis]),
          [axis, sign](TextbookLink& link) { link.axis = sign * Vector3d::Unit(axis); });
  list.each("axis_wrong", true, hasAxisOfOne, "axis of {} taken in the parent's axes",
            [](TextbookLink& link) { link.axis = (link.before.R.transpose() * link.axis).eval(); });
  list.each("axis_wrong", true, hasAxisOfOne, "axis of {} turned by its placement once more",
            [](TextbookLink& link) { link.axis = (link.before.R * link.axis).eval(); });
  list.each(
      "prismatic_as_revolute", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kPrismatic; },
      "{}, prismatic, taken as revolute",
      [](TextbookLink& link) { link.kind = scene::JointKind::kRevolute; });
  list.each(
      "revolute_as_prismatic", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kRevolute; },
      "{}, revolute, taken as prismatic",
      [](TextbookLink& link) { link.kind = scene::JointKind::kPrismatic; });
  list.each(
      "pitch_ignored", true,
      [](const TextbookLink& link) { return link.kind == scene::JointKind::kHelical; },
      "{}, helical, taken as revolute", [](TextbookLink& link) { link.pitch = 0; });
}

/// Of spherical and floating joints.
void addFreeTurns(List& list) {
  const TextbookModel& model = list.model();
  const bool turns = std::any_of(model.links.begin(), model.links.end(), [](const TextbookLink& l) {
    return l.parent >= 0 &&
           (l.kind == scene::JointKind::kSpherical || l.kind == scene::JointKind::kFloating);
  });
  if (!turns) return;
  list.add("quaternion_order", "quaternions taken as (x, y, z, w)",
           [](Belief& b) { b.passing.xyzw = true; });
  struct InWorldAxes {
    const char* what;
    bool turns, slides;
  };
  for (const InWorldAxes& which :
       {InWorldAxes{"rates", true, true}, InWorldAxes{"angular velocities", true, false},
        InWorldAxes{"velocities", false, true}})
    for (const bool forces : {true, false})
      list.add("base_twist_world",
               fmt::format("{} of spherical and floating joints taken in world axes{}", which.what,
                           forces ? ", and forces given there" : ""),
               [which, forces](Belief& b) {
                 b.passing.world_turns = which.turns;
                 b.passing.world_slides = which.slides;
                 b.passing.world_forces = forces;
               });
}

void addSeries(List& list) {
  constexpr int kMostTerms = 14;
  for (const bool reduced : {false, true})
    for (int terms = 1; terms <= kMostTerms; ++terms)
      for (const bool in_world : {false, true}) {
        const auto add = [&](const std::string& what, int sine, int cosine) {
          list.formula("sine_series",
                       fmt::format("{} by {} terms of the series{}{}", what, terms,
                                   reduced ? " (angles brought to [-pi, pi])" : "",
                                   in_world ? ", all in world axes" : ""),
                       [=](Formulas& f) {
                         f.sine_terms = sine;
                         f.cosine_terms = cosine;
                         f.reduced = reduced;
                         f.in_world = in_world;
                       });
        };
        add("sine and cosine", terms, terms);
        add("sine", terms, 0);
        add("sine and cosine (one term more)", terms, terms + 1);
        add("cosine", 0, terms);
      }
}

/// The state that was asked before, in part.
void addStale(List& list) {
  const auto add = [&](const std::string& what, const Stale& stale) {
    list.add("stale_state", what + " of the question before used again",
             [stale](Belief& b) { b.stale = stale; });
  };
  add("positions", {true, false, false});
  add("positions and rates", {true, true, false});
  add("the state", {true, true, true});
  add("rates", {false, true, false});
  add("accelerations", {false, false, true});
}

/// How reactions are told.
void addReactions(List& list) {
  list.formula("reaction_sign", "reactions that the link exerts on its parent",
               [](Formulas& f) { f.reaction_on_parent = true; });
  list.formula("reaction_order", "reactions with the moment first",
               [](Formulas& f) { f.moment_first = true; });
  struct About {
    const char* words;
    Formulas::About point;
  };
  struct In {
    const char* words;
    Formulas::Axes axes;
  };
  for (const About& about : {About{"", Formulas::About::kJoint},
                             About{" about the link's origin", Formulas::About::kLink},
                             About{" about the link's centre of mass", Formulas::About::kCom}})
    for (const In& in : {In{"", Formulas::Axes::kJoint}, In{" in link axes", Formulas::Axes::kLink},
                         In{" in world axes", Formulas::Axes::kWorld}}) {
      if (*about.words == '\0' && *in.words == '\0') continue;
      list.formula("reaction_frame", fmt::format("reactions{}{}", about.words, in.words),
                   [point = about.point, axes = in.axes](Formulas& f) {
                     f.reaction_about = point;
                     f.reaction_axes = axes;
                   });
    }
}

}  // namespace

std::vector<Hypothesis> hypotheses(const TextbookModel& model) {
  List list(model);
  addGravity(list);
  addFormulas(list);
  addJointForces(list);
  addInertias(list);
  addWrenches(list);
  addPlacementTurns(list);
  addFixedChildren(list);
  addDenavitHartenberg(list);
  addDegrees(list);
  addCentresOfMass(list);
  addJointOrders(list);
  addJointSigns(list);
  addJointAxes(list);
  addFreeTurns(list);
  addSeries(list);
  addStale(list);
  addReactions(list);
  // the other reading of these words: numbers about the centre of mass taken as if about the joint
  list.each("inertia_about_joint", false, hasParent,
            "inertia of {}, given about the centre of mass, taken as if about the joint",
            [](TextbookLink& link) { link.inertia -= toOrigin(link); });
  return list.take();
}

namespace {

using Values = Eigen::VectorXd;

double sizeOr1(double x) {
  return x == 0 ? 1.0 : std::abs(x);
}

/// Collects suspects of one link, or of the joint that carries it.
class Numbers {
 public:
  Numbers(const TextbookModel& model, std::size_t i, std::vector<Suspect>& out)
      : link_(model.links[i]), i_(i), out_(out) {}

  /// One that is added to.
  /// @param edit  what an addition does to the link
  void add(const std::string& rule, const std::string& what, const std::string& unit,
           const std::string& name, double value, double scale,
           const std::function<void(TextbookLink&, double)>& edit, bool at_joint = false) {
    const std::string of = at_joint ? fmt::format(" of joint '{}'", link_.joint)
                                    : fmt::format(" of link '{}'", link_.name);
    out_.push_back({rule,
                    static_cast<int>(i_),
                    at_joint,
                    what + of,
                    unit,
                    {name},
                    {value},
                    {scale},
                    [edit, i = i_](Belief& b, const Values& s) { edit(b.model.links[i], s(0)); }});
  }
  const TextbookLink& link() const { return link_; }
  double reach() const {
    return sizeOr1(std::max({link_.before.p.norm(), link_.after.p.norm(), link_.com.norm()}));
  }

 private:
  const TextbookLink& link_;
  std::size_t i_;
  std::vector<Suspect>& out_;
};

void suspectMass(Numbers& of) {
  const double mass = of.link().mass;
  of.add("mass_wrong", "mass", "kg", "mass", mass, sizeOr1(mass),
         [](TextbookLink& l, double s) { l.mass += s; });
  if (mass != 0)
    of.add("mass_wrong", "density (mass, and inertia with it)", "kg", "mass", mass, mass,
           [](TextbookLink& l, double s) {
             const double factor = 1 + s / l.mass;
             l.mass *= factor;
             l.inertia *= factor;
           });
}

void suspectLengths(Numbers& of) {
  const TextbookLink& link = of.link();
  for (const bool after : {false, true}) {
    const Vector3d p = after ? link.after.p : link.before.p;
    const auto move = [&](const std::string& name, const Vector3d& direction, double value) {
      of.add("length_wrong", "length", "m", name, value, of.reach(),
             [after, direction](TextbookLink& l, double s) {
               (after ? l.after : l.before).p += s * direction;
             });
    };
    int along = 0;
    for (int k = 0; k < 3; ++k) along += p(k) != 0;
    if (along > 1) move("|p|", p.normalized(), p.norm());
    for (int k = 0; k < 3; ++k)
      if (p(k) != 0) move(fmt::format("p{}", "xyz"[k]), Vector3d::Unit(k), p(k));
    for (int k = 0; k < 3; ++k)
      if (p(k) == 0 && (!after || !isTrivial(link.after)))
        move(fmt::format("p{}", "xyz"[k]), Vector3d::Unit(k), 0);
  }
}

void suspectInertia(Numbers& of) {
  const TextbookLink& link = of.link();
  if (link.inertia != Matrix3d::Zero())
    of.add("inertia_wrong", "inertia, by one factor,", "", "factor", 1, 1,
           [](TextbookLink& l, double s) { l.inertia *= 1 + s; });
  for (const auto& [a, b] : kEntries)
    of.add("inertia_wrong", "inertia", "kg m^2", fmt::format("I{}{}", "xyz"[a], "xyz"[b]),
           link.inertia(a, b), sizeOr1(link.inertia.trace()),
           [a = a, b = b](TextbookLink& l, double s) {
             l.inertia(a, b) += s;
             if (a != b) l.inertia(b, a) += s;
           });
}

void suspectCentreOfMass(Numbers& of) {
  for (int k = 0; k < 3; ++k)
    of.add("com_wrong", "centre of mass", "m", fmt::format("c{}", "xyz"[k]), of.link().com(k),
           of.reach(), [k](TextbookLink& l, double s) { l.com(k) += s; });
}

void suspectJoint(Numbers& of) {
  if (!hasOneRate(of.link())) return;
  const auto number = [&](const std::string& rule, const std::string& what, const std::string& unit,
                          double TextbookLink::*member) {
    const double value = of.link().*member;
    if (value == 0) return;
    of.add(
        rule, what, unit, what, value, std::abs(value),
        [member](TextbookLink& l, double s) { l.*member += s; }, true);
  };
  number("rotor_wrong", "inertia of the rotor at the joint", "kg m^2", &TextbookLink::added);
  number("damping_wrong", "damping", "N m s/rad", &TextbookLink::viscous);
  number("spring_wrong", "stiffness", "N m/rad", &TextbookLink::stiffness);
}

/// All six of an inertia.
Suspect wholeInertia(const TextbookModel& model, std::size_t i) {
  const TextbookLink& link = model.links[i];
  const Matrix3d& I = link.inertia;
  const double size = sizeOr1(I.trace());
  return {"inertia_wrong",
          static_cast<int>(i),
          false,
          fmt::format("inertia of link '{}'", link.name),
          "kg m^2",
          {"Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"},
          {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)},
          {size, size, size, size, size, size},
          [i](Belief& b, const Values& s) {
            Matrix3d d;
            d << s(0), s(3), s(4), s(3), s(1), s(5), s(4), s(5), s(2);
            b.model.links[i].inertia += d;
          }};
}

}  // namespace

std::vector<Suspect> suspects(const TextbookModel& model) {
  std::vector<Suspect> out;
  if (model.gravity != Vector3d::Zero()) {
    const double g = model.gravity.norm();
    out.push_back({"gravity_wrong",
                   -1,
                   false,
                   "gravity",
                   "m/s^2",
                   {"g"},
                   {g},
                   {g},
                   [g](Belief& b, const Values& s) { b.model.gravity *= 1 + s(0) / g; }});
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    Numbers of(model, i, out);
    suspectMass(of);
    suspectLengths(of);
    suspectInertia(of);
    suspectCentreOfMass(of);
    suspectJoint(of);
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) out.push_back(wholeInertia(model, i));
  return out;
}

}  // namespace dynwitness::crosscheck
