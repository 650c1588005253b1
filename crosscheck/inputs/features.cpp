// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/features.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

using Kind = Treatment::Kind;
using Features = std::vector<Feature>;

struct Words {
  Feature feature;
  const char* name;
};
constexpr Words kWords[] = {
    {Feature::kFixed, "fixed joint"},
    {Feature::kRevolute, "revolute joint"},
    {Feature::kPrismatic, "prismatic joint"},
    {Feature::kHelical, "helical joint"},
    {Feature::kCylindrical, "cylindrical joint"},
    {Feature::kUniversal, "universal joint"},
    {Feature::kPlanar, "planar joint"},
    {Feature::kSpherical, "spherical joint"},
    {Feature::kFloating, "floating joint"},
    {Feature::kGravity, "gravity"},
    {Feature::kRotor, "rotor"},
    {Feature::kGyroscopicRotor, "gyroscopic rotor"},
    {Feature::kGearedRotor, "rotor geared to several rates"},
    {Feature::kViscousFriction, "viscous friction"},
    {Feature::kCoulombFriction, "Coulomb friction"},
    {Feature::kJointSpring, "spring of a joint"},
    {Feature::kMimic, "joint that follows another"},
    {Feature::kLinkWrench, "wrench in link axes"},
    {Feature::kWorldWrench, "wrench in world axes"},
    {Feature::kDistanceClosure, "closure: distance"},
    {Feature::kPlaneClosure, "closure: plane"},
    {Feature::kPlanarPointClosure, "closure: planar_point"},
    {Feature::kPointClosure, "closure: point"},
    {Feature::kHingeClosure, "closure: hinge"},
    {Feature::kWeldClosure, "closure: weld"},
    {Feature::kSkateClosure, "closure: skate"},
    {Feature::kRollingClosure, "closure: rolling"},
    {Feature::kPointSpring, "spring between points"},
    {Feature::kPointDamper, "damper between points"},
    {Feature::kDrivenJoint, "driven joint"},
    {Feature::kAccelerationConstraint, "acceleration constraint"},
    {Feature::kStart, "start state"},
    {Feature::kNotModelled, "URDF's other words"},
};
static_assert(std::size(kWords) == std::size(kAllFeatures));

Features operator+(Features a, const Features& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// How a command treats some features.
struct Rule {
  Command command;
  Features features;
  Treatment treatment;
};

/// Everything that is not modelled. A feature that no rule of a command names is.
struct Rules {
  const Features closures = {Feature::kDistanceClosure,    Feature::kPlaneClosure,
                             Feature::kPlanarPointClosure, Feature::kPointClosure,
                             Feature::kHingeClosure,       Feature::kWeldClosure,
                             Feature::kSkateClosure,       Feature::kRollingClosure};
  const Features point_springs = {Feature::kPointSpring, Feature::kPointDamper};
  const Features wrenches = {Feature::kLinkWrench, Feature::kWorldWrench};
  const Features friction = {Feature::kViscousFriction, Feature::kCoulombFriction};
  const Features quaternions = {Feature::kSpherical, Feature::kFloating};
  const Features prescribed = {Feature::kDrivenJoint, Feature::kAccelerationConstraint};
  const Features spring_of_joint = {Feature::kJointSpring};
  const Treatment of_the_tree = {Kind::kTold,
                                 "the equations are those of the tree alone, all its joints free"};
  const Treatment random_states = {Kind::kNoPart, "random states are drawn, whatever the start"};
  const Treatment for_every_state = {Kind::kNoPart, "the equations are those of every state"};
  const Treatment finite_forces = {Kind::kNoPart, "finite forces do nothing while a blow lasts"};
  const Treatment no_forces = {Kind::kNoPart,
                               "M is the metric, and geodesics are motions without forces"};
  const Treatment no_inertia = {Kind::kNoPart, "no inertial parameter depends on it"};
  const Treatment own_springs = {Kind::kTold,
                                 "springs and dampers of the scene are not added to those of "
                                 "--stiffness and --damping"};
  const Treatment no_program = {Kind::kRefused, "programs are made for open trees alone"};
  const Treatment own_rates = {Kind::kRefused,
                               "what is computed here moves every position with a rate of its own"};
  const Treatment no_sign = {Kind::kRefused,
                             "programs compute with + - * / alone and have no sign for it"};
  const Treatment no_closed_forces = {Kind::kRefused,
                                      "tau of the closed mechanism is not that of its tree"};
  const Treatment held_by_forces = {Kind::kRefused, "tau depends on the forces nu that hold it"};
  const Features followers = {Feature::kMimic};
  const Treatment as_trees = {
      Kind::kTold, "programs are asked about the tree, every joint of it with a rate of its own"};

  std::vector<Rule> ofFollowers() const {
    return {
        {Command::kDeriveOperations,
         followers,
         {Kind::kRefused, "no kernel is made of joints that share a rate"}},
        {Command::kDeriveCode,
         followers,
         {Kind::kRefused, "no code is written for joints that share a rate"}},
        {Command::kEvaluateJoints,
         followers,
         {Kind::kRefused,
          "no articulated body is passed through a joint alone that shares its rate"}},
        {Command::kEvaluateTasks,
         followers,
         {Kind::kRefused, "the sweeps for tasks solve for each joint where they pass it"}},
        {Command::kChart,
         followers,
         {Kind::kRefused, "engines are timed on trees, where every joint has a rate of its own"}},
        {Command::kCheckFormulas, followers, own_rates},
        {Command::kAdvise,
         followers,
         {Kind::kRefused, "no code is written for joints that share a rate"}},
        {Command::kRotors, followers, own_rates},
        {Command::kGeometry, followers, own_rates},
        {Command::kAction, followers, own_rates},
        {Command::kImpedance, followers, own_rates},
        {Command::kSweep, followers, own_rates},
        {Command::kImpulse,
         followers,
         {Kind::kRefused, "impulses through joints that share a rate are not told apart"}},
    };
  }
  std::vector<Rule> ofGearedRotors() const {
    const Features geared = {Feature::kGearedRotor};
    const Treatment joint_by_joint = {
        Kind::kRefused,
        "it couples rates, and what is computed here passes each axis of a joint by itself"};
    const Treatment other_rotors = {Kind::kRefused,
                                    "rotors are told apart here by the one joint that turns them"};
    std::vector<Rule> out;
    for (const Command command :
         {Command::kDeriveOperations, Command::kDeriveCode, Command::kEvaluateJoints,
          Command::kEvaluateTasks, Command::kChart, Command::kImpulse, Command::kImpedance,
          Command::kSweep, Command::kEnvelope, Command::kReduce, Command::kAdvise,
          Command::kLinearize})
      out.push_back({command, geared, joint_by_joint});
    for (const Command command :
         {Command::kCheck, Command::kGrade, Command::kGolden, Command::kRotors})
      out.push_back({command, geared, other_rotors});
    for (const Command command : {Command::kGeometry, Command::kAction})
      out.push_back(
          {command,
           geared,
           {Kind::kRefused,
            "on a joint whose rates are no derivatives its motion is that of no metric and "
            "makes no action stationary, allowed: rotors of one rate"}});
    return out;
  }
  std::vector<Rule> ofComparisons() const {
    return {
        {Command::kCheck, closures + point_springs + prescribed, of_the_tree},
        {Command::kCheck, followers, as_trees},
        {Command::kCheck, {Feature::kStart}, random_states},
        {Command::kCheckFormulas, closures + point_springs + prescribed, of_the_tree},
        {Command::kCheckFormulas, {Feature::kStart}, for_every_state},
        {Command::kCheckFormulas,
         {Feature::kCoulombFriction},
         {Kind::kTold, "formulas have no sign of a rate, and are not asked about tau"}},
        {Command::kCheckFormulas,
         quaternions,
         {Kind::kRefused, "its rates are no derivatives of positions, which formulas are made of"}},
        {Command::kGrade, closures + point_springs + prescribed, of_the_tree},
        {Command::kGrade, followers, as_trees},
        {Command::kGrade, {Feature::kStart}, random_states},

        {Command::kGolden,
         closures + point_springs + prescribed,
         {Kind::kRefused,
          "the answers would be those of the tree alone, all its joints free, and taken for those of "
          "the mechanism"}},
        {Command::kGolden, followers, as_trees},
        {Command::kGolden, {Feature::kStart}, random_states},
    };
  }
  std::vector<Rule> ofEquations() const {
    return {
        {Command::kDerive, closures + point_springs + prescribed, of_the_tree},
        {Command::kDerive, {Feature::kStart}, for_every_state},
        {Command::kDerivePrograms,
         friction + wrenches,
         {Kind::kTold, "the programs compute M, c and g; friction and loads belong to tau"}},
        {Command::kDerivePrograms, closures + point_springs + prescribed, of_the_tree},
        {Command::kDerivePrograms, {Feature::kStart}, for_every_state},
        {Command::kDeriveOperations, closures + point_springs, no_program},
        {Command::kDeriveOperations, {Feature::kCoulombFriction}, no_sign},
        {Command::kDeriveOperations, prescribed, of_the_tree},
        {Command::kDeriveOperations, {Feature::kStart}, for_every_state},
        {Command::kDeriveCode, closures + point_springs, no_program},
        {Command::kDeriveCode, prescribed, of_the_tree},
        {Command::kDeriveCode, {Feature::kStart}, for_every_state},

        {Command::kEvaluateTree,
         friction + wrenches,
         {Kind::kNoPart,
          "friction and loads belong to tau and qdd, not to M, c, g, energies and momentum"}},
        {Command::kEvaluateTree,
         closures + point_springs + prescribed,
         {Kind::kTold,
          "M, c, g, kinetic, potential and momentum are those of the tree, all its joints free"}},
        {Command::kEvaluateJoints, closures + point_springs + prescribed, of_the_tree},
        {Command::kEvaluateJoints,
         {Feature::kGravity},
         {Kind::kNoPart,
          "gravity is the world's acceleration -g in the sweeps, no force on a link"}},
        {Command::kEvaluatePoints,
         Features{Feature::kGravity, Feature::kRotor, Feature::kGyroscopicRotor,
                  Feature::kGearedRotor} +
             friction + spring_of_joint + wrenches + closures + point_springs + prescribed,
         {Kind::kNoPart, "a point's motion is that of q, qd and qdd, whatever makes it"}},
        {Command::kEvaluateForces, closures + point_springs, no_closed_forces},
        {Command::kEvaluateForces, {Feature::kAccelerationConstraint}, held_by_forces},
        {Command::kEvaluateTasks,
         closures + point_springs + Features{Feature::kDrivenJoint},
         {Kind::kTold, "tasks are those of the tree alone, a motor at each of its joints"}},
        {Command::kEvaluateDerivatives,
         closures + point_springs + prescribed,
         {Kind::kRefused,
          "derivatives would be those of the tree alone, all its joints free; under closures and "
          "drives allowed: dynwitness linearize"}},
    };
  }
  std::vector<Rule> ofMotionAndParameters() const {
    return {
        {Command::kDrift,
         wrenches,
         {Kind::kRefused, "its energy is not constant, drift cannot be measured"}},
        {Command::kDrift,
         {Feature::kCoulombFriction},
         {Kind::kRefused,
          "it jumps where a joint turns back: no integrator has its order there, drift cannot be "
          "measured; allowed: viscous friction"}},
        {Command::kDrift,
         closures + point_springs,
         {Kind::kRefused,
          "the energy of the tree alone is not that of the mechanism; allowed: a tree of links"}},
        {Command::kDrift,
         {Feature::kDrivenJoint},
         {Kind::kRefused, "the drive does work, so that energy is not constant"}},
        {Command::kDrift,
         {Feature::kAccelerationConstraint},
         {Kind::kRefused, "the forces that hold it do work, so that energy is not constant"}},

        {Command::kChart, closures + point_springs + prescribed, of_the_tree},
        {Command::kChart, {Feature::kStart}, random_states},

        {Command::kRotors,
         {Feature::kGyroscopicRotor},
         {Kind::kNoPart, "both models of every rotor are compared, whichever the scene takes"}},
        {Command::kRotors, closures + point_springs + prescribed, of_the_tree},
        {Command::kRotors, {Feature::kStart}, random_states},

        {Command::kParameters, friction + spring_of_joint + wrenches, no_inertia},
        {Command::kParameters,
         closures + point_springs + prescribed,
         {Kind::kTold, "the parameters are those of the tree alone, all its joints free"}},
        {Command::kParameters, {Feature::kStart}, random_states},
    };
  }
  /// Bounds over ranges of q, qd and qdd, by polynomials in cosines and sines.
  std::vector<Rule> ofReduction() const {
    std::vector<Rule> out = {{Command::kReduce, {Feature::kCoulombFriction}, no_sign}};
    for (const Command command : {Command::kEnvelope, Command::kReduce}) {
      out.push_back(
          {command,
           {Feature::kHelical, Feature::kCylindrical, Feature::kUniversal, Feature::kPlanar,
            Feature::kSpherical, Feature::kFloating},
           {Kind::kRefused,
            "bounded are polynomials in the cosine and sine, or the position, of one rate a joint, "
            "allowed: revolute, prismatic and fixed joints"}});
      out.push_back({command, followers, own_rates});
      out.push_back({command, closures + point_springs, no_closed_forces});
      out.push_back(
          {command,
           {Feature::kDrivenJoint},
           {Kind::kRefused,
            "its motion is given, and not within ranges of its own, allowed: free joints"}});
      out.push_back({command, {Feature::kAccelerationConstraint}, held_by_forces});
      out.push_back({command,
                     {Feature::kStart},
                     {Kind::kNoPart, "bounds hold all over [envelope], whatever the start"}});
    }
    out.push_back({Command::kAdvise, closures + point_springs, no_program});
    out.push_back(
        {Command::kAdvise,
         {Feature::kCoulombFriction},
         {Kind::kRefused,
          "it jumps where a joint turns back: no integrator has its order there; allowed: viscous "
          "friction"}});
    out.push_back(
        {Command::kAdvise,
         prescribed,
         {Kind::kRefused, "the code that is advised is that of the tree, all its joints free"}});
    return out;
  }
  std::vector<Rule> ofStudies() const {
    return {
        {Command::kGeometry,
         Features{Feature::kGravity} + friction + spring_of_joint + wrenches + point_springs,
         no_forces},
        {Command::kGeometry,
         {Feature::kSkateClosure, Feature::kRollingClosure},
         {Kind::kRefused,
          "it leaves velocities that are those of no surface, allowed: closures of positions"}},
        {Command::kGeometry,
         prescribed,
         {Kind::kRefused, "what is left to move has a metric of its own, allowed: free joints"}},

        {Command::kAction,
         friction,
         {Kind::kRefused,
          "forces that depend on rates are given by --friction alone, the same for every joint"}},
        {Command::kAction,
         {Feature::kSkateClosure, Feature::kRollingClosure},
         {Kind::kRefused,
          "motion with it makes no action stationary, allowed: closures of positions"}},
        {Command::kAction,
         point_springs,
         {Kind::kRefused, "T - V here has springs of joints alone"}},
        {Command::kAction,
         prescribed,
         {Kind::kRefused, "varied paths would have to keep it, allowed: free joints"}},

        {Command::kImpulse,
         Features{Feature::kGravity} + friction + spring_of_joint + wrenches + point_springs,
         finite_forces},
        {Command::kImpulse,
         {Feature::kDrivenJoint},
         {Kind::kRefused,
          "its drive would have to hold the rate against the blow, allowed: free joints"}},
        {Command::kImpulse,
         {Feature::kAccelerationConstraint},
         {Kind::kRefused,
          "a constraint on accelerations says nothing of what velocities do in a blow"}},

        {Command::kImpedance,
         quaternions,
         {Kind::kTold,
          "its rates are no derivatives of coordinates, and a stretched spring adds no matrix "
          "(dJ'/dq) f there"}},
        {Command::kImpedance,
         Features{Feature::kGravity} + wrenches,
         {Kind::kNoPart, "stiffness, damping, compliance and inertia are asked about, no forces"}},
        {Command::kImpedance, friction + spring_of_joint + point_springs, own_springs},
        {Command::kImpedance,
         closures,
         {Kind::kRefused,
          "the point of a closed mechanism moves otherwise, allowed: a tree of links"}},
        {Command::kImpedance,
         prescribed,
         {Kind::kRefused, "the point does not move as its free joints say, allowed: free joints"}},

        {Command::kSweep, closures + point_springs + prescribed, of_the_tree},
        {Command::kLinearize,
         {Feature::kCoulombFriction},
         {Kind::kRefused,
          "dry friction has no derivative where a joint rests, allowed: viscous friction"}},
    };
  }
};

/// Made when first asked for: tests ask before this file's own constants would be there.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> all = [] {
    const Rules rules;
    std::vector<Rule> joined;
    for (const auto& part :
         {rules.ofFollowers(), rules.ofGearedRotors(), rules.ofComparisons(), rules.ofEquations(),
          rules.ofMotionAndParameters(), rules.ofReduction(), rules.ofStudies()})
      joined.insert(joined.end(), part.begin(), part.end());
    return joined;
  }();
  return all;
}

const scene::Link* firstLink(const scene::Mechanism& mechanism, bool (*has)(const scene::Joint&)) {
  for (const scene::Link& link : mechanism.links)
    if (link.parent >= 0 && has(link.joint)) return &link;
  return nullptr;
}

Feature closureFeature(scene::ClosureKind kind) {
  switch (kind) {
    case scene::ClosureKind::kDistance:
      return Feature::kDistanceClosure;
    case scene::ClosureKind::kPlane:
      return Feature::kPlaneClosure;
    case scene::ClosureKind::kPlanarPoint:
      return Feature::kPlanarPointClosure;
    case scene::ClosureKind::kPoint:
      return Feature::kPointClosure;
    case scene::ClosureKind::kHinge:
      return Feature::kHingeClosure;
    case scene::ClosureKind::kWeld:
      return Feature::kWeldClosure;
    case scene::ClosureKind::kSkate:
      return Feature::kSkateClosure;
    case scene::ClosureKind::kRolling:
      return Feature::kRollingClosure;
  }
  return Feature::kWeldClosure;
}

Feature jointFeature(scene::JointKind kind) {
  switch (kind) {
    case scene::JointKind::kFixed:
      return Feature::kFixed;
    case scene::JointKind::kRevolute:
      return Feature::kRevolute;
    case scene::JointKind::kPrismatic:
      return Feature::kPrismatic;
    case scene::JointKind::kHelical:
      return Feature::kHelical;
    case scene::JointKind::kCylindrical:
      return Feature::kCylindrical;
    case scene::JointKind::kUniversal:
      return Feature::kUniversal;
    case scene::JointKind::kPlanar:
      return Feature::kPlanar;
    case scene::JointKind::kSpherical:
      return Feature::kSpherical;
    case scene::JointKind::kFloating:
      return Feature::kFloating;
  }
  return Feature::kFloating;
}

bool startsElsewhere(const scene::Scene& scene) {
  const std::vector<scene::Number> rest = scene.mechanism.restPosition();
  const auto differs = [](const scene::Number& a, const scene::Number& b) {
    return a.text() != b.text();
  };
  for (std::size_t i = 0; i < scene.start_q.size(); ++i)
    if (differs(scene.start_q[i], rest[i])) return true;
  return std::any_of(scene.start_qd.begin(), scene.start_qd.end(),
                     [](const scene::Number& qd) { return !qd.isLiteralZero(); });
}

/// "a, b"
std::string list(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Sentences about the features that the command treats so, each reason once.
std::vector<std::string> sentences(const scene::Scene& scene, Command command, Kind kind) {
  std::vector<std::string> out;
  std::vector<std::string> reasons;
  for (const FoundFeature& found : featuresOf(scene)) {
    const Treatment t = treatment(command, found.feature);
    if (t.kind != kind || std::count(reasons.begin(), reasons.end(), t.reason) > 0) continue;
    reasons.emplace_back(t.reason);
    // "joint limits not modelled" says it itself
    const bool says_it = found.feature == Feature::kNotModelled;
    out.push_back(says_it ? found.what : found.what + ": " + t.reason);
  }
  return out;
}

std::string modelledBy(Feature feature) {
  std::vector<std::string> names;
  for (const Command command : kAllCommands)
    if (command != Command::kShow && treatment(command, feature).kind == Kind::kModelled)
      names.push_back(std::string("dynwitness ") + name(command));
  return names.empty() ? "" : "; modelled by " + list(names);
}

}  // namespace

const char* name(Command command) {
  switch (command) {
    case Command::kCrosscheck:
      return "crosscheck";
    case Command::kCheck:
      return "check";
    case Command::kCheckFormulas:
      return "check --answer (formulas)";
    case Command::kGolden:
      return "golden";
    case Command::kGrade:
      return "grade";
    case Command::kDerive:
      return "derive";
    case Command::kDerivePrograms:
      return "derive (c, python, sympy)";
    case Command::kDeriveOperations:
      return "derive --operations";
    case Command::kDeriveCode:
      return "derive --quantity tau,qdd,... (c, python, matlab, julia)";
    case Command::kEvaluateTree:
      return "evaluate (M, c, g, energies, momentum)";
    case Command::kEvaluateJoints:
      return "evaluate (X, M_A, P, F of joints)";
    case Command::kEvaluatePoints:
      return "evaluate (kinematics of points)";
    case Command::kEvaluateForces:
      return "evaluate (tau)";
    case Command::kEvaluateMotion:
      return "evaluate (qdd, lambda, nu, tau_drive, reactions)";
    case Command::kEvaluateTasks:
      return "evaluate (tasks)";
    case Command::kEvaluateDerivatives:
      return "evaluate (derivatives)";
    case Command::kDrift:
      return "drift";
    case Command::kChart:
      return "chart";
    case Command::kSimulate:
      return "simulate";
    case Command::kRotors:
      return "rotors";
    case Command::kParameters:
      return "parameters";
    case Command::kGeometry:
      return "geometry";
    case Command::kAction:
      return "action";
    case Command::kImpulse:
      return "impulse";
    case Command::kImpedance:
      return "impedance";
    case Command::kLinearize:
      return "linearize";
    case Command::kSweep:
      return "sweep";
    case Command::kEnvelope:
      return "envelope";
    case Command::kReduce:
      return "reduce";
    case Command::kNeed:
      return "need";
    case Command::kAdvise:
      return "advise";
    case Command::kShow:
      return "show";
  }
  return "";
}

const char* name(Feature feature) {
  for (const Words& words : kWords)
    if (words.feature == feature) return words.name;
  return "";
}

Treatment treatment(Command command, Feature feature) {
  if (feature == Feature::kNotModelled) return {Kind::kTold, "not modelled"};
  for (const Rule& rule : rules())
    if (rule.command == command &&
        std::find(rule.features.begin(), rule.features.end(), feature) != rule.features.end())
      return rule.treatment;
  return {};
}

std::vector<FoundFeature> featuresOf(const scene::Scene& scene) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const scene::SourceLocation file{scene.file.string(), 0};
  std::vector<FoundFeature> found;
  const auto add = [&](Feature feature, const std::string& what,
                       const scene::SourceLocation& where) {
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const FoundFeature& f) { return f.feature == feature; });
    if (!known) found.push_back({feature, what, where.file.empty() ? file : where});
  };
  for (const scene::Link& link : mechanism.links)
    if (link.parent >= 0)
      add(jointFeature(link.joint.kind),
          fmt::format("joint '{}' is {}", link.joint.name, scene::name(link.joint.kind)),
          link.where);
  if (mechanism.has_gravity) add(Feature::kGravity, "there is gravity", file);
  const auto addJoint = [&](Feature feature, bool (*has)(const scene::Joint&), const char* what) {
    if (const scene::Link* link = firstLink(mechanism, has))
      add(feature, fmt::format("joint '{}' {}", link->joint.name, what), link->where);
  };
  addJoint(
      Feature::kRotor, [](const scene::Joint& j) { return !j.rotor_inertia.isLiteralZero(); },
      "has a rotor");
  addJoint(
      Feature::kGyroscopicRotor,
      [](const scene::Joint& j) { return j.gyroscopic && !j.rotor_inertia.isLiteralZero(); },
      "has a gyroscopic rotor");
  addJoint(
      Feature::kGearedRotor, [](const scene::Joint& j) { return !j.rotors.empty(); },
      "has rotors geared to its rates");
  addJoint(
      Feature::kViscousFriction,
      [](const scene::Joint& j) { return !j.friction.viscous.isLiteralZero(); },
      "has viscous friction");
  addJoint(
      Feature::kCoulombFriction, [](const scene::Joint& j) { return j.friction.isCoulomb(); },
      "has Coulomb friction");
  addJoint(
      Feature::kJointSpring, [](const scene::Joint& j) { return !j.stiffness.isLiteralZero(); },
      "has a spring");
  addJoint(
      Feature::kMimic, [](const scene::Joint& j) { return j.mimic.has_value(); },
      "follows another");
  addJoint(
      Feature::kDrivenJoint, [](const scene::Joint& j) { return !j.motion.empty(); }, "is driven");
  for (const scene::Wrench& wrench : mechanism.wrenches) {
    const scene::Link& link = mechanism.links[static_cast<std::size_t>(wrench.link)];
    add(wrench.axes == scene::Wrench::Axes::kLink ? Feature::kLinkWrench : Feature::kWorldWrench,
        fmt::format("link '{}' has a wrench", link.name), file);
  }
  for (const scene::Closure& closure : mechanism.closures)
    add(closureFeature(closure.kind),
        closure.name.empty()
            ? fmt::format("there is a closure ({})", scene::name(closure.kind))
            : fmt::format("closure '{}' ({})", closure.name, scene::name(closure.kind)),
        closure.where);
  for (const scene::Spring& spring : mechanism.springs) {
    const std::string what =
        spring.name.empty() ? "between points" : fmt::format("'{}'", spring.name);
    if (!spring.stiffness.isLiteralZero())
      add(Feature::kPointSpring, "spring " + what, spring.where);
    if (!spring.damping.isLiteralZero()) add(Feature::kPointDamper, "damper " + what, spring.where);
  }
  for (const scene::AccelerationConstraint& constraint : mechanism.acceleration_constraints)
    add(Feature::kAccelerationConstraint,
        constraint.name.empty() ? "there is an acceleration_constraint"
                                : fmt::format("acceleration_constraint '{}'", constraint.name),
        constraint.where);
  if (startsElsewhere(scene)) add(Feature::kStart, "there is a start", file);
  if (!scene.not_modelled.empty()) add(Feature::kNotModelled, list(scene.not_modelled), file);
  std::sort(found.begin(), found.end(),
            [](const FoundFeature& a, const FoundFeature& b) { return a.feature < b.feature; });
  return found;
}

std::vector<std::string> refusals(const scene::Scene& scene, Command command) {
  return sentences(scene, command, Kind::kRefused);
}

void requireTreated(const scene::Scene& scene, Command command) {
  for (const FoundFeature& found : featuresOf(scene)) {
    const Treatment t = treatment(command, found.feature);
    if (t.kind == Kind::kRefused)
      throw scene::InputError(found.where,
                              found.what + ": " + t.reason + modelledBy(found.feature));
  }
}

void requireMotion(const scene::Scene& scene) {
  if (scene.mechanism.dof() == 0)
    throw scene::InputError({scene.file.string()},
                            "no joint moves, expected at least one that does");
}

std::vector<std::string> leftOut(const scene::Scene& scene, Command command) {
  return sentences(scene, command, Kind::kTold);
}

std::string featuresMarkdown() {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& text) {
    const auto at = std::find(notes.begin(), notes.end(), text);
    if (at != notes.end()) return at - notes.begin() + 1;
    notes.push_back(text);
    return static_cast<std::ptrdiff_t>(notes.size());
  };
  std::string text =
      "# What each command makes of each part of a scene\n\n"
      "`yes`: modelled, what the command says depends on it. `-`: it has no part in what the "
      "command says.\n"
      "`told`: left out, and said on standard error. `no`: the scene is refused, with exit status "
      "2. The numbers\n"
      "are reasons, below. This is the table that the commands obey (`crosscheck/inputs/features.cpp`), "
      "written by\n"
      "`dynwitness scenes --features`; a test goes through every pair.\n\n| |";
  std::string rule = "|---|";
  for (const Command command : kAllCommands) {
    text += fmt::format(" {} |", name(command));
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const Feature feature : kAllFeatures) {
    text += fmt::format("| {} |", name(feature));
    for (const Command command : kAllCommands) {
      const Treatment t = treatment(command, feature);
      switch (t.kind) {
        case Kind::kModelled:
          text += " yes |";
          break;
        case Kind::kNoPart:
          text += fmt::format(" - {} |", note(t.reason));
          break;
        case Kind::kTold:
          text += fmt::format(" told {} |", note(t.reason));
          break;
        case Kind::kRefused:
          text += fmt::format(" no {} |", note(t.reason));
          break;
      }
    }
    text += "\n";
  }
  text += "\n";
  for (std::size_t i = 0; i < notes.size(); ++i) text += fmt::format("{}. {}\n", i + 1, notes[i]);
  return text;
}

}  // namespace dynwitness::crosscheck
