// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo as a witness. It reads the mechanism from URDF: the scene's own file, or one written for
// it; from MJCF where a joint is of a kind that a URDF cannot say (mjcf.hpp). What neither says is
// set in MuJoCo's model: gravity, rotors (armature), springs.
//
// MuJoCo keeps a link's inertia as principal moments and axes. Its compiler finds the axes by
// Jacobi turns and stops when the cosine of the next turn is above 1 - 1e-12 (mju_eig3, eigEPS;
// unchanged in MuJoCo's sources of 2026), so up to 1.4e-6 rad are never turned and the products of
// inertia that are left there are dropped. On the Panda that moves the inertia of link_1 by 6e-7 of
// itself and leaves 7 or 8 digits of M. There are therefore two witnesses:
//   mujoco            reads the inertias as they are written. Its bound contains what the dropped
//                     products do to the answer, found by our sweeps;
//   mujoco_principal  gets them with the axes turned before, which is the remedy: its compiler then
//                     has nothing to turn.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/joint_friction.hpp"
#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "crosscheck/witnesses/mjcf.hpp"
#include "crosscheck/witnesses/mujoco_closures.hpp"
#include "crosscheck/witnesses/mujoco_model.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "crosscheck/witnesses/own_file.hpp"
#include "crosscheck/witnesses/own_steps.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

namespace dynwitness::crosscheck {
namespace {

enum class Inertias { kAsWritten, kPrincipal };

const EngineWords& wordsOf(Inertias inertias) {
  return inertias == Inertias::kAsWritten ? kMujoco : kMujocoPrincipal;
}

using Eigen::Matrix3d;
using Eigen::Vector3d;
using scene::RealNumbers;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// ------------------------------------------------------------------------------ inertias

Vector3d vector(const scene::Vector& v, const RealNumbers<double>& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

/// I = R diag(moments) R', in link axes, about the centre of mass.
struct Body {
  double mass;
  Vector3d com, moments;
  Matrix3d I, R;
};

Body bodyOf(const scene::MassProperties& m, const ToldNumbers& number) {
  const ToldNumbers::Inertia given = number.inertia(m);
  Body body;
  body.mass = static_cast<double>(given.mass);
  body.com = given.com.cast<double>();
  body.I = given.I.cast<double>();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(body.I);
  body.moments = solver.eigenvalues().cwiseMax(0.0);  // a rod's zero may come out as -1e-19
  body.R = solver.eigenvectors();
  if (body.R.determinant() < 0) body.R.col(0) *= -1;
  return body;
}

/// What MuJoCo's compiler may refuse in a link: no mass, no extent (a point, a rod), or moments of
/// a plane body that its turns leave short of the triangle inequality. Each of the three moments is
/// then off by no more than what is left off the diagonal (Weyl).
bool isRefused(const Body& body) {
  const Vector3d& I = body.moments;  // rising
  return body.mass < mjMINVAL || I[0] < mjMINVAL ||
         I[0] + I[1] < I[2] * (1 + 3 * std::sqrt(2 * kMujocoTurnStop));
}

scene::Number exactly(double x) {
  return scene::Number(scene::Rational(x));
}

/// About the centre of mass, in axes of the given turn from link axes.
scene::MassProperties inertiaAs(const scene::MassProperties& original, const Matrix3d& I,
                                const Vector3d& yaw_pitch_roll) {
  scene::MassProperties m = original;
  m.about = scene::MassProperties::About::kCenterOfMass;
  for (int k = 0; k < 3; ++k) m.rpy[k] = exactly(yaw_pitch_roll[2 - k]);
  m.xx = exactly(I(0, 0));
  m.yy = exactly(I(1, 1));
  m.zz = exactly(I(2, 2));
  m.xy = exactly(I(0, 1));
  m.xz = exactly(I(0, 2));
  m.yz = exactly(I(1, 2));
  return m;
}

/// A body that the compiler takes, in place of one that it refuses.
scene::MassProperties placeholder() {
  scene::MassProperties m;
  m.mass = m.xx = m.yy = m.zz = scene::Number(1);
  return m;
}

/// The same for MJCF: in link axes, or in the principal ones.
std::string inertial(const Body& body, Inertias inertias) {
  const std::string begin = fmt::format("<inertial mass=\"{:.17g}\" pos=\"{}\"", body.mass,
                                        mjcfNumbers({body.com[0], body.com[1], body.com[2]}));
  const Matrix3d& I = body.I;
  if (inertias == Inertias::kAsWritten)
    return fmt::format("{} fullinertia=\"{}\"/>", begin,
                       mjcfNumbers({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}));
  const Eigen::Quaterniond q = Eigen::Quaterniond(body.R).normalized();
  return fmt::format("{} diaginertia=\"{}\" quat=\"{}\"/>", begin,
                     mjcfNumbers({body.moments[0], body.moments[1], body.moments[2]}),
                     mjcfNumbers({q.w(), q.x(), q.y(), q.z()}));
}

std::vector<std::string> inertialsTold(const std::vector<Body>& bodies, Inertias inertias,
                                       bool with_placeholders) {
  std::vector<std::string> out;
  for (const Body& body : bodies) {
    if (with_placeholders && isRefused(body))
      out.emplace_back(R"(<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>)");
    else  // what rests may have no mass; what moves without is refused
      out.push_back(body.mass == 0 && body.moments.isZero(0) ? "" : inertial(body, inertias));
  }
  return out;
}

/// The scene that MuJoCo is told.
scene::Scene told(scene::Scene scene, const std::vector<Body>& bodies, Inertias inertias,
                  bool with_placeholders) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    scene::MassProperties& m = scene.mechanism.links[i].inertia;
    if (with_placeholders && isRefused(bodies[i]))
      m = placeholder();
    else if (inertias == Inertias::kPrincipal)
      m = inertiaAs(m, bodies[i].moments.asDiagonal(), bodies[i].R.eulerAngles(2, 1, 0));
  }
  return scene;
}

// -------------------------------------------------------------------------------- loading

/// @param text  URDF or MJCF
/// @param more  elements of MuJoCo's own besides
/// @param rows  most rows of constraints
MujocoOwned<mjModel> loaded(std::string text, const std::string& more, int rows) {
  // nothing may be fused, bounded, balanced or inferred: the model is to be what the file says
  const std::string settings =
      "<compiler fusestatic=\"false\" inertiafromgeom=\"false\" "
      "balanceinertia=\"false\" boundmass=\"0\" boundinertia=\"0\"/>" +
      // no limits and no contacts: MuJoCo clears the room for them at every state
      fmt::format("<size njmax=\"{}\" nconmax=\"1\"/>", rows) + more;
  const std::size_t end_of_robot = text.rfind("</robot>");
  const bool is_urdf = end_of_robot != std::string::npos;
  if (is_urdf)
    text.insert(end_of_robot, "<mujoco>" + settings + "</mujoco>");
  else
    text.insert(text.rfind("</mujoco>"), settings);
  const char* kFile = is_urdf ? "scene.urdf" : "scene.xml";
  std::string error;
  MujocoOwned<mjModel> model = mujocoModelOf(text, kFile, &error);
  if (!model) throw std::runtime_error("MuJoCo does not read the file: " + error);
  return model;
}

int idOf(const mjModel* model, mjtObj kind, const std::string& name) {
  const int id = mj_name2id(model, kind, name.c_str());
  if (id < 0) throw std::runtime_error("MuJoCo did not make '" + name + "' of the file");
  return id;
}

// -------------------------------------------------------------------------------- witness

class MujocoWitness : public Witness, public FileReader, public OwnSteps, public OutsideClaims {
 public:
  MujocoWitness(const PreparedScene& prepared, Inertias inertias)
      : MujocoWitness(prepared, inertias, std::nullopt) {}
  /// @param closures  what equations() is asked about, of a mechanism with this tree
  MujocoWitness(const PreparedScene& prepared, Inertias inertias,
                std::optional<MujocoClosures> closures)
      : closures_(std::move(closures)),
        name_(wordsOf(inertias).name),
        friction_(prepared.mechanism()),
        bound_(prepared, kQuaternion),
        solve_bound_(prepared, SolvedBy::kMassMatrix, kEngineTurns, kQuaternion),
        sweep_(prepared.model<double>()) {
    const scene::Scene& scene = prepared.scene();
    const scene::Mechanism& mechanism = scene.mechanism;
    requirePlainRotors(mechanism);
    installMujocoHandlers();
    const RealNumbers<double> number(mechanism);
    const ToldNumbers told_number(mechanism);
    std::vector<Body> bodies;
    for (const scene::Link& link : mechanism.links)
      bodies.push_back(bodyOf(link.inertia, told_number));
    std::vector<bool> was_read(bodies.size(), true);
    const bool by_urdf =
        !closures_ && std::all_of(mechanism.links.begin(), mechanism.links.end(),
                                  [](const scene::Link& link) { return isPlain(link.joint.kind); });
    const auto file = [&](bool with_placeholders) {
      if (by_urdf) return scene::urdfForEngines(told(scene, bodies, inertias, with_placeholders));
      std::vector<std::string> inertials = inertialsTold(bodies, inertias, with_placeholders);
      for (std::size_t i = 0; closures_ && i < inertials.size(); ++i)
        inertials[i] += closures_->sites(i);
      return mjcf(mechanism, inertials);
    };
    const auto read = [&](const std::string& text) {
      return closures_ ? loaded(text, closures_->elements(), closures_->mostRows())
                       : loaded(text, "", 1);
    };
    const std::string first = file(false);  // what cannot be written is refused here
    own_file_ = by_urdf && isOwnFile(first, told(scene, bodies, inertias, false));
    try {
      model_ = read(first);
    } catch (const std::runtime_error&) {
      own_file_ = false;
      model_ = read(file(true));
      for (std::size_t i = 0; i < bodies.size(); ++i) was_read[i] = !isRefused(bodies[i]);
    }
    for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
      const scene::Link& link = mechanism.links[i];
      if (by_urdf)
        findLink(link, link.name, link.joint.name, number);
      else
        findLink(link, mjcfLink(static_cast<int>(i)), mjcfJoint(static_cast<int>(i)), number);
      if (link.joint.kind == scene::JointKind::kFloating)
        findFrame(mjcfJointFrame(static_cast<int>(i)));
    }
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (!was_read[i] && links_[i] != 0) setBody(links_[i], bodies[i]);
    if (inertias == Inertias::kAsWritten) prepareLoss(scene, bodies, was_read);
    if (closures_) closures_->find(model_.get(), links_);
    setPhysics(mechanism, number);
    data_.reset(mj_makeData(model_.get()));
    mj_setConst(model_.get(), data_.get());  // derived numbers, after the changes
    mj_kinematics(model_.get(), data_.get());
    for (Floating& joint : floating_) placeFrame(joint);
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity != Quantity::kReactions; }
  bool readsOwnFile() const override { return own_file_; }

  bool knowsJacobian() const override { return true; }
  /// By mj_jac.
  std::vector<SaidJacobian> jacobians(const FramePoint& point,
                                      const std::vector<scene::State<double>>& states) override {
    const int body = links_[static_cast<std::size_t>(point.link)];
    using Jacobian = Eigen::Matrix<mjtNum, 3, Eigen::Dynamic, Eigen::RowMajor>;
    Jacobian linear(3, model_->nv), angular(3, model_->nv);
    std::vector<SaidJacobian> out;
    for (const scene::State<double>& state : states) {
      setMotion(state, false);
      mj_fwdPosition(model_.get(), data_.get());
      const RowMajor3 R = Eigen::Map<const RowMajor3>(data_->xmat + 9 * body);
      const Vector3d at = Eigen::Map<const Vector3d>(data_->xpos + 3 * body) + R * point.at;
      mj_jac(model_.get(), data_.get(), linear.data(), angular.data(), at.data(), body);
      Eigen::MatrixXd J(6, dofs_.size());
      for (std::size_t i = 0; i < dofs_.size(); ++i)
        J.col(static_cast<Eigen::Index>(i)) << linear.col(dofs_[i]), angular.col(dofs_[i]);
      for (const Floating& joint : floating_)
        J.middleCols<3>(joint.dof) = (J.middleCols<3>(joint.dof) * joint.R).eval();
      out.push_back({J, {}});
    }
    return out;
  }

  /// By mj_step with MuJoCo's default integrator: semi-implicit Euler.
  OwnMotion ownMotion(const scene::State<double>& start, double step, long steps,
                      long every) override {
    if (!floating_.empty() || !quaternions_.empty())
      throw std::runtime_error("joints with quaternions are not moved by its own steps here");
    mjModel* m = model_.get();
    mjData* d = data_.get();
    const auto before = std::make_pair(m->opt.timestep, m->opt.disableflags);
    m->opt.timestep = step;
    m->opt.disableflags |= mjDSBL_CONSTRAINT;
    setMotion(start, true);
    setGravity(true);
    OwnMotion out;
    out.by = fmt::format("{}, Euler, steps of {} s", name_, step);
    for (long k = 0;; ++k) {
      if (k % every == 0) {
        mj_forward(m, d);
        OwnMotion::Moment moment{static_cast<double>(k) * step, {}, {}, {}};
        for (const int at : positions_) moment.q.push_back(d->qpos[at]);
        for (const int at : dofs_) {
          moment.qd.push_back(d->qvel[at]);
          moment.qdd.push_back(d->qacc[at]);
        }
        out.moments.push_back(std::move(moment));
      }
      if (k == steps) break;
      mj_step(m, d);
    }
    std::tie(m->opt.timestep, m->opt.disableflags) = before;
    return out;
  }

  /** Equations of a whole mechanism, in the rates of its tree: M and bias as for the tree (springs
      between points are tendons there), J and b by MujocoClosures.
      @param followers  gets one row a follower */
  DenseEquations<double> equations(const scene::State<double>& state,
                                   const scene::Mechanism& mechanism, Eigen::MatrixXd* followers) {
    mjModel* m = model_.get();
    mjData* d = data_.get();
    DenseEquations<double> out;
    scene::State<double> at_rest = state;
    at_rest.qdd = sweep_.zeros();
    out.bias = value(Quantity::kTau, at_rest);
    out.M = value(Quantity::kM, at_rest);
    m->opt.disableflags &= ~mjDSBL_CONSTRAINT;
    setMotion(at_rest, true);
    setGravity(false);
    mj_kinematics(m, d);
    closures_->place(m, d);
    mj_fwdPosition(m, d);
    mj_fwdVelocity(m, d);
    setAccelerations(at_rest.qdd);
    mj_rnePostConstraint(m, d);
    m->opt.disableflags |= mjDSBL_CONSTRAINT;
    const MujocoClosures::Equations said = closures_->equations(m, d);
    const auto& held = mechanism.acceleration_constraints;
    const auto rows = said.J.rows(), k = static_cast<Eigen::Index>(held.size());
    out.J.resize(rows + k, out.M.cols());
    out.b.resize(rows + k);
    out.C = Eigen::VectorXd::Zero(rows + k);
    for (Eigen::Index i = 0; i < rows; ++i)
      out.J.row(i) = inOrderOfScene(said.J.row(i).data()).transpose();
    out.b.head(rows) = -said.gamma;
    followers->resize(said.J_followers.rows(), out.M.cols());
    for (Eigen::Index i = 0; i < followers->rows(); ++i)
      followers->row(i) = inOrderOfScene(said.J_followers.row(i).data()).transpose();
    const RealNumbers<double> number(mechanism);
    for (Eigen::Index i = 0; i < k; ++i)
      addConstraint(held[static_cast<std::size_t>(i)], number, rows + i, &out);
    return out;
  }

  /// What forceAxisError() says of M qdd and of the bias, of the largest of their entries.
  double forceError(const scene::State<double>& state, const Eigen::VectorXd& qdd) {
    return (forceAxisError(state, state.qd, sweep_.zeros(), Terms::all()) +
            massAxisError(state) * qdd.cwiseAbs())
        .maxCoeff();
  }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out{value(quantity, state), bound_(quantity, state)};
    out.bound += axisError(quantity, state);
    if (quantity == Quantity::kQdd) {
      const scene::State<double> answered = moving(state, out.value);
      solve_bound_.judge(state, bound_(Quantity::kTau, answered), out);
      out.residual_bound +=
          axisError(Quantity::kTau, answered) + massAxisError(state) * out.value.cwiseAbs();
      if (compiled_) {
        out.residual_loss = loss(Quantity::kTau, answered);
        out.residual_bound += out.residual_loss;
      }
    }
    if (compiled_) {
      out.known_loss = loss(quantity, state);
      out.bound += out.known_loss;
    }
    return out;
  }

 private:
  std::optional<MujocoClosures> closures_;

  struct AppliedWrench {
    int body;
    bool world_axes;
    Vector3d force, moment, at;
  };

  /** A floating joint: MuJoCo's free one, or three slides and a ball. Its linear speeds are in the
      axes of the world, of the joint frame, which R turns the scene's into,

          v' = R v    dv'/dt = R (dv/dt + w x v)

      while the angular ones are in the axes of the body, like the scene's. A free joint's position
      is the body's in the world, which p, q of the joint frame lead to. */
  struct Floating {
    int slot, dof;
    int frame;  ///< MuJoCo's body in the place of the joint frame; -1: slides and a ball
    Vector3d p = Vector3d::Zero();
    RowMajor3 R_frame = RowMajor3::Identity();
    mjtNum q[4] = {1, 0, 0, 0};
    RowMajor3 R = RowMajor3::Identity();  ///< at the state that was set
  };

  void findLink(const scene::Link& link, const std::string& name, const std::string& joint_name,
                const RealNumbers<double>& number) {
    // of a root called "world", MuJoCo makes its own world, without mass
    const bool is_world = link.parent < 0 && name == "world";
    if (is_world && number(link.inertia.mass) != 0)
      throw std::runtime_error("MuJoCo drops the mass of a root link called 'world'");
    links_.push_back(is_world ? 0 : idOf(model_.get(), mjOBJ_BODY, name));
    if (link.joint.kind == scene::JointKind::kFixed) return;
    const int joint = idOf(model_.get(), mjOBJ_JOINT, joint_name);
    const int dof = model_->jnt_dofadr[joint], position = model_->jnt_qposadr[joint];
    if (link.joint.kind == scene::JointKind::kFloating)
      floating_.push_back(
          {static_cast<int>(positions_.size()), static_cast<int>(dofs_.size()), -1});
    if (!scene::ratesArePositionDerivatives(link.joint.kind))
      quaternions_.push_back(position + scene::degreesOfFreedom(link.joint.kind) - 3);
    // the joints of a body stand in the order of the scene's rates
    const int slots = static_cast<int>(scene::positionSlots(link.joint.kind).size());
    for (int k = 0; k < slots; ++k) positions_.push_back(position + k);
    for (int k = 0; k < scene::degreesOfFreedom(link.joint.kind); ++k) {
      dofs_.push_back(dof + k);
      model_->dof_damping[dof + k] = model_->dof_frictionloss[dof + k] = 0;  // URDF may have them
    }
    if (scene::degreesOfFreedom(link.joint.kind) > 1) return;  // no rotor, no spring
    const double gear = number(link.joint.gear_ratio);
    model_->dof_armature[dof] = gear * gear * number(link.joint.rotor_inertia);
    model_->jnt_stiffness[joint] = number(link.joint.stiffness);
    model_->qpos_spring[positions_.back()] = number(link.joint.rest);
  }

  void findFrame(const std::string& name) {
    floating_.back().frame = mj_name2id(model_.get(), mjOBJ_BODY, name.c_str());
  }

  /// Of a free joint: where its frame is in the world, by MuJoCo.
  void placeFrame(Floating& joint) const {
    if (joint.frame < 0) return;
    joint.p = Eigen::Map<const Vector3d>(data_->xpos + 3 * joint.frame);
    joint.R_frame = Eigen::Map<const RowMajor3>(data_->xmat + 9 * joint.frame);
    std::copy_n(data_->xquat + 4 * joint.frame, 4, joint.q);
  }

  void setBody(int id, const Body& body) {
    const RowMajor3 R = body.R;
    model_->body_mass[id] = body.mass;
    std::copy_n(body.com.data(), 3, model_->body_ipos + 3 * id);
    std::copy_n(body.moments.data(), 3, model_->body_inertia + 3 * id);
    mju_mat2Quat(model_->body_iquat + 4 * id, R.data());
    // the compiler's shortcuts for the body that it saw
    model_->body_sameframe[id] = 0;
    std::fill_n(model_->body_simple, model_->nbody, 0);
    std::fill_n(model_->dof_simplenum, model_->nv, 0);
  }

  void setPhysics(const scene::Mechanism& mechanism, const RealNumbers<double>& number) {
    mjOption& option = model_->opt;
    // no joint limits, no contacts; equality constraints where equations() asks for them
    option.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS;
    option.jacobian = mjJAC_DENSE;
    option.enableflags |= mjENBL_ENERGY;
    option.density = option.viscosity = 0;
    if (mechanism.has_gravity) gravity_ = vector(mechanism.gravity, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({links_[w.link], w.axes == scene::Wrench::Axes::kWorld,
                           vector(w.force, number), vector(w.moment, number),
                           vector(w.at, number)});
  }

  // What MuJoCo's algorithm rounds beyond the sweeps that EngineBound runs.
  //
  // It keeps orientations as unit quaternions: a product of two leaves 4 u in a component where
  // turning by a matrix leaves 3 u in an entry; the matrix made of it doubles that, and making it
  // adds 2 u.
  static constexpr double kQuaternion = 10.0 / 3;

  /** It gathers forces in world axes, about the tree's centre of mass, and only there projects them
     on the axes of joints. Each component of a joint's force therefore counts in full, with the
     error of an orientation: three turns a joint, 10 u each. Our sweeps project in the joint's own
     axes, where most components drop out exactly.
      Not joint by joint: a body balanced on its own axis, far from the tree's centre of mass, has
      moments about that centre which its joint does not feel (random_plain_1_181).
      @return 30 u (|m| + r |f|) of the largest force through any joint, r its distance from the
     centre of mass; |qd|' times that of M times |qd| / 2 for T, |M^-1| times those of what qdd
     solves for qdd */
  Eigen::MatrixXd axisError(Quantity quantity, const scene::State<double>& state) {
    const std::vector<double> zeros = sweep_.zeros();
    switch (quantity) {
      case Quantity::kM:
        return massAxisError(state);
      case Quantity::kc:
        return forceAxisError(state, state.qd, zeros, Terms::none());
      case Quantity::kg:
        return forceAxisError(state, zeros, zeros, Terms::potential());
      case Quantity::kTau:
        return forceAxisError(state, state.qd, state.qdd, Terms::all());
      case Quantity::kKinetic: {
        const Eigen::VectorXd qd = column(state.qd).cwiseAbs();
        return scalar(double(qd.dot(massAxisError(state) * qd) / 2));
      }
      case Quantity::kQdd: {
        const Eigen::MatrixXd M = CompositeBody::answer(sweep_, Quantity::kM, state);
        const Eigen::VectorXd qdd = CompositeBody::answer(sweep_, Quantity::kQdd, state);
        return M.inverse().cwiseAbs() * (forceAxisError(state, state.qd, zeros, Terms::all()) +
                                         massAxisError(state) * qdd.cwiseAbs());
      }
      case Quantity::kPotential:
        return scalar(0.0);
      case Quantity::kMomentum:
        return Eigen::MatrixXd::Zero(6, 1);
      case Quantity::kReactions:
        break;
    }
    throw std::logic_error("mujoco: unknown quantity");
  }

  Eigen::MatrixXd massAxisError(const scene::State<double>& state) {
    const auto n = static_cast<Eigen::Index>(dofs_.size());
    Eigen::MatrixXd errors(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      std::vector<double> unit = sweep_.zeros();
      unit[static_cast<std::size_t>(j)] = 1;
      errors.col(j) = forceAxisError(state, sweep_.zeros(), unit, Terms::none());
    }
    return Eigen::MatrixXd::Constant(n, n, errors.maxCoeff());
  }

  Eigen::VectorXd forceAxisError(const scene::State<double>& state, const std::vector<double>& qd,
                                 const std::vector<double>& qdd, Terms terms) {
    sweep_.inverse(state, qd, qdd, terms);
    const auto& links = sweep_.model.links;
    const auto n = static_cast<Eigen::Index>(links.size());
    Eigen::VectorXd moment(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const recursive::LinkModel<double>& link = links[static_cast<std::size_t>(k)];
      const recursive::Force<double>& f = sweep_.ws.f[static_cast<std::size_t>(k)];
      const int joint = model_->dof_jntid[dofs_[static_cast<std::size_t>(link.dof)]];
      const int root = model_->body_rootid[model_->jnt_bodyid[joint]];
      const double r = (Eigen::Map<const Vector3d>(data_->subtree_com + 3 * root) -
                        Eigen::Map<const Vector3d>(data_->xanchor + 3 * joint))
                           .norm();
      moment(k) = f.moment.norm() + r * f.force.norm();
    }
    return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(dofs_.size()),
                                     30 * RunningError::kUnitRoundoff * moment.maxCoeff());
  }

  /** The mechanism with the inertias that MuJoCo's compiler made of the written ones. A difference
      that its stopping rule explains is accepted; one that it does not is left to be found. */
  void prepareLoss(const scene::Scene& scene, const std::vector<Body>& bodies,
                   const std::vector<bool>& was_read) {
    const scene::Mechanism& mechanism = scene.mechanism;
    scene::Mechanism compiled = mechanism;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const int id = links_[i];
      if (id == 0 || !was_read[i]) continue;
      RowMajor3 R;
      mju_quat2Mat(R.data(), model_->body_iquat + 4 * id);
      const Eigen::Map<const Vector3d> moments(model_->body_inertia + 3 * id);
      const Matrix3d D = R.transpose() * bodies[i].I * R;
      const double dropped = std::max({std::abs(D(0, 1)), std::abs(D(0, 2)), std::abs(D(1, 2))});
      // What is left to turn moves a difference of moments off the diagonal; an entry below
      // kMujocoTurnStop is not turned at all. D itself is rounded: entries of R made of a
      // quaternion by 10 u, so R by 3 * 10 u (Frobenius) on each side, and two products by 9 u
      // each.
      const double left =
          std::sqrt(2 * kMujocoTurnStop) * (moments.maxCoeff() - moments.minCoeff());
      const double rounded = (2 * 30 + 2 * 9) * RunningError::kUnitRoundoff * moments.maxCoeff();
      if (dropped > std::max(kMujocoTurnStop, left) + rounded) continue;
      const Matrix3d I = R * moments.asDiagonal() * R.transpose();
      compiled.links[i].inertia = inertiaAs(mechanism.links[i].inertia, I, Vector3d::Zero());
    }
    const auto sweeps = [&scene](const scene::Mechanism& m) {
      scene::Scene with = scene;
      with.mechanism = m;
      return Sweeps{newtonEulerKind().make(with).value(), articulatedBodyKind().make(with).value()};
    };
    written_ = sweeps(mechanism);
    compiled_ = sweeps(compiled);
  }

  /// How far the compiled inertias move the answer, with the error of finding out.
  Eigen::MatrixXd loss(Quantity quantity, const scene::State<double>& state) {
    const auto by = [&](Sweeps& sweeps) {
      Witness& sweep = quantity == Quantity::kQdd ? *sweeps.forward : *sweeps.inverse;
      return sweep.answer(quantity, state);
    };
    const Answer compiled = by(*compiled_), written = by(*written_);
    return (compiled.value - written.value).cwiseAbs() + compiled.bound + written.bound;
  }

  void setMotion(const scene::State<double>& state, bool moving) {
    mj_resetData(model_.get(), data_.get());
    mjtNum* qpos = data_->qpos;
    for (std::size_t i = 0; i < positions_.size(); ++i) qpos[positions_[i]] = state.x[i].q;
    for (const int at : quaternions_) {
      Eigen::Map<Eigen::Vector4d> q(qpos + at);
      q.stableNormalize();  // of any length in a scene
    }
    for (Floating& joint : floating_) {
      mjtNum* p = qpos + positions_[static_cast<std::size_t>(joint.slot)];
      if (joint.frame >= 0) {
        Eigen::Map<Vector3d> at(p);
        at = (joint.p + joint.R_frame * at).eval();
        mju_mulQuat(p + 3, joint.q, Eigen::Vector4d(Eigen::Map<Eigen::Vector4d>(p + 3)).data());
      }
      mju_quat2Mat(joint.R.data(), p + 3);
    }
    if (moving) expand(state.qd, data_->qvel);
    velocity_ = moving ? state.qd : sweep_.zeros();
  }

  /// From the scene's rates (or forces) to MuJoCo's.
  void expand(const std::vector<double>& rates, mjtNum* out) const {
    for (std::size_t i = 0; i < dofs_.size(); ++i) out[dofs_[i]] = rates[i];
    for (const Floating& joint : floating_) {
      Eigen::Map<Vector3d> v(out + dofs_[static_cast<std::size_t>(joint.dof)]);
      v = (joint.R * v).eval();
    }
  }
  /// What accelerations have besides: R (w x v), at the state that was set.
  std::vector<mjtNum> accelerationBias() const {
    std::vector<mjtNum> bias(static_cast<std::size_t>(model_->nv), 0.0);
    for (const Floating& joint : floating_) {
      const double* rates = velocity_.data() + joint.dof;
      const Vector3d v = Eigen::Map<const Vector3d>(rates),
                     w = Eigen::Map<const Vector3d>(rates + 3);
      Eigen::Map<Vector3d>(bias.data() + dofs_[static_cast<std::size_t>(joint.dof)]) =
          joint.R * w.cross(v);
    }
    return bias;
  }

  void setGravity(bool on) {
    const Vector3d gravity = on ? gravity_ : Vector3d::Zero();
    std::copy_n(gravity.data(), 3, model_->opt.gravity);
  }

  /// Forces of the loads on the joints (MuJoCo's J' F); positions must be up to date.
  std::vector<double> loads() {
    std::vector<double> Q(model_->nv, 0.0);
    for (const AppliedWrench& w : wrenches_) {
      const RowMajor3 R = Eigen::Map<const RowMajor3>(data_->xmat + 9 * w.body);
      const Vector3d force = w.world_axes ? w.force : Vector3d(R * w.force);
      const Vector3d moment = w.world_axes ? w.moment : Vector3d(R * w.moment);
      const Vector3d point = Eigen::Map<const Vector3d>(data_->xpos + 3 * w.body) + R * w.at;
      mj_applyFT(model_.get(), data_.get(), force.data(), moment.data(), point.data(), w.body,
                 Q.data());
    }
    return Q;
  }

  /// From MuJoCo's forces (or rates) to the scene's: expand() is its own inverse's transpose.
  Eigen::MatrixXd inOrderOfScene(const mjtNum* forces) const {
    Eigen::MatrixXd out(dofs_.size(), 1);
    for (std::size_t i = 0; i < dofs_.size(); ++i) out(i, 0) = forces[dofs_[i]];
    for (const Floating& joint : floating_)
      out.middleRows<3>(joint.dof) = (joint.R.transpose() * out.middleRows<3>(joint.dof)).eval();
    return out;
  }

  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) {
    return friction_.around(quantity, state, [&](const scene::State<double>& without) {
      return frictionless(quantity, without);
    });
  }
  Eigen::MatrixXd frictionless(Quantity quantity, const scene::State<double>& state) {
    mjModel* m = model_.get();
    mjData* d = data_.get();
    setMotion(state, quantity != Quantity::kg);
    setGravity(quantity != Quantity::kc);
    mj_fwdPosition(m, d);
    mj_fwdVelocity(m, d);  // qfrc_bias: c + gravity; qfrc_passive: springs, minus their part of g
    switch (quantity) {
      case Quantity::kM:
        return massMatrix();
      case Quantity::kc:
        return velocityForces();
      case Quantity::kg:
        return inOrderOfScene(d->qfrc_bias) - inOrderOfScene(d->qfrc_passive);
      case Quantity::kTau:
        setAccelerations(state.qdd);
        mj_inverse(m, d);
        return inOrderOfScene(d->qfrc_inverse) - inOrderOfScene(loads().data());
      case Quantity::kQdd:
        return accelerations(state);
      case Quantity::kKinetic:
        mj_energyVel(m, d);
        return scalar(double(d->energy[1]));
      case Quantity::kPotential:
        mj_energyPos(m, d);
        return scalar(double(d->energy[0]));
      case Quantity::kMomentum:
        return momentum();
      case Quantity::kReactions:
        break;
    }
    throw std::logic_error("mujoco: unknown quantity");
  }

  void setAccelerations(const std::vector<double>& qdd) {
    expand(qdd, data_->qacc);
    if (!floating_.empty()) mju_addTo(data_->qacc, accelerationBias().data(), model_->nv);
  }

  /// c: inverse dynamics without gravity, at the accelerations that the scene's qdd = 0 are.
  Eigen::MatrixXd velocityForces() {
    if (floating_.empty()) return inOrderOfScene(data_->qfrc_bias);
    setAccelerations(sweep_.zeros());
    std::vector<mjtNum> forces(static_cast<std::size_t>(model_->nv));
    mj_rne(model_.get(), data_.get(), 1, forces.data());
    return inOrderOfScene(forces.data());
  }

  Eigen::MatrixXd massMatrix() {
    Eigen::MatrixXd full(model_->nv, model_->nv), M(dofs_.size(), dofs_.size());
    mj_fullM(model_.get(), full.data(), data_->qM);
    for (std::size_t j = 0; j < dofs_.size(); ++j)
      for (std::size_t i = 0; i < dofs_.size(); ++i) M(i, j) = full(dofs_[i], dofs_[j]);
    for (const Floating& joint : floating_) {
      M.middleRows<3>(joint.dof) = (joint.R.transpose() * M.middleRows<3>(joint.dof)).eval();
      M.middleCols<3>(joint.dof) = (M.middleCols<3>(joint.dof) * joint.R).eval();
    }
    return M;
  }

  /// Of a link's acceleration: J by mj_jac, what there is without qdd by mj_objectAcceleration.
  void addConstraint(const scene::AccelerationConstraint& held, const RealNumbers<double>& number,
                     Eigen::Index row, DenseEquations<double>* out) const {
    const int body = links_[static_cast<std::size_t>(held.link)];
    const MujocoClosures::Moving link(model_.get(), data_.get(), body);
    const Vector3d at = link.p + link.R * vector(held.at, number);
    Vector3d u = vector(held.direction, number), turn = vector(held.rotation, number);
    if (held.axes == scene::AccelerationConstraint::Axes::kLink) {
      u = (link.R * u).eval();
      turn = (link.R * turn).eval();
    }
    using Jacobian = Eigen::Matrix<mjtNum, 3, Eigen::Dynamic, Eigen::RowMajor>;
    Jacobian linear(3, model_->nv), angular(3, model_->nv);
    mj_jac(model_.get(), data_.get(), linear.data(), angular.data(), at.data(), body);
    const Eigen::RowVectorXd seen = u.transpose() * linear + turn.transpose() * angular;
    out->J.row(row) = inOrderOfScene(seen.data()).transpose();
    out->b(row) = number(held.value) - u.dot(link.acceleration(at)) - turn.dot(link.w_rate);
    out->C(row) = number(held.compliance);
  }

  Eigen::MatrixXd accelerations(const scene::State<double>& state) {
    const std::vector<double> Q = loads();
    expand(state.tau, data_->qfrc_applied);
    mju_addTo(data_->qfrc_applied, Q.data(), model_->nv);
    mj_forward(model_.get(), data_.get());
    if (data_->warning[mjWARN_INERTIA].number > 0)
      throw std::runtime_error(
          fmt::format("M is singular for MuJoCo: a pivot below {:g} is replaced by it", mjMINVAL));
    std::vector<mjtNum> qacc(data_->qacc, data_->qacc + model_->nv);
    if (!floating_.empty()) mju_subFrom(qacc.data(), accelerationBias().data(), model_->nv);
    return inOrderOfScene(qacc.data());
  }

  /// MuJoCo has the angular momentum about the centre of mass.
  Eigen::MatrixXd momentum() {
    mj_subtreeVel(model_.get(), data_.get());
    const Vector3d p =
        model_->body_subtreemass[0] * Eigen::Map<const Vector3d>(data_->subtree_linvel);
    const Vector3d com = Eigen::Map<const Vector3d>(data_->subtree_com);
    Eigen::MatrixXd out(6, 1);
    out << p, Eigen::Map<const Vector3d>(data_->subtree_angmom) + com.cross(p);
    return out;
  }

  std::string name_;
  JointFriction friction_;
  EngineBound bound_;
  SolveBound solve_bound_;
  Setup<double> sweep_;  ///< for axisError()
  struct Sweeps {
    std::unique_ptr<Witness> inverse, forward;
  };
  bool own_file_ = false;
  std::optional<Sweeps> written_, compiled_;  ///< of `mujoco` only
  MujocoOwned<mjModel> model_;
  MujocoOwned<mjData> data_;
  Vector3d gravity_ = Vector3d::Zero();
  std::vector<int> links_;             ///< MuJoCo's body, one a scene link
  std::vector<int> dofs_, positions_;  ///< places in qvel and qpos, one a rate and a slot
  std::vector<int> quaternions_;       ///< places in qpos of those that are not normalised
  std::vector<Floating> floating_;
  std::vector<double> velocity_;  ///< qd of the state that was set
  std::vector<AppliedWrench> wrenches_;
};

/// The convention card.
std::string conventions(Inertias inertias) {
  std::string card =
      "reads: URDF, parsed by MuJoCo: the user's own file, without geometry, where the scene is one and "
      "MuJoCo takes it, otherwise one written from the scene; fixed joints kept "
      "(fusestatic=false), nothing bounded, balanced or inferred; MJCF where a joint is "
      "cylindrical, universal, planar, spherical or floating, inertias then in link axes or in "
      "the principal ones\n"
      "joints: hinge, slide, ball and free, several in one body where the scene's joint has "
      "several rates (cylindrical: slide, hinge; universal: two hinges; planar: two slides, hinge); "
      "a floating joint is free where its parent rests in the world, otherwise three slides and a "
      "ball; there is no helical one\n"
      "speeds: angular ones of ball and free are the body's own in its axes, as in the scene; "
      "linear ones are turned from the body's axes, and their accelerations have w x v besides\n"
      "does not read: links without mass or extent, and moments that break the triangle inequality "
      "by a rounding, are refused; they pass the compiler as placeholders and get their mass, "
      "centre of mass, moments and axes in mjModel\n"
      "spatial vectors: angular part first, world axes, about the centre of mass of the tree\n"
      "orientations: unit quaternions (w, x, y, z)\n"
      "inertia: principal moments, and the quaternion of their axes, about the centre of mass\n"
      "bias: qfrc_bias = c + gravity; c is asked with gravity switched off\n"
      "springs: qfrc_passive = -stiffness (q - rest), with the sign of a force; not in qfrc_bias\n"
      "gravity: mjOption.gravity is the acceleration of a falling body, as in the scene\n"
      "friction: its own is off; viscous and Coulomb friction are added here\n"
      "rotors: dof_armature = gear_ratio^2 rotor_inertia, on the diagonal of M\n"
      "loads: mj_applyFT at the point, world axes; inverse dynamics leaves them out, they are "
      "subtracted here\n"
      "momentum: mj_subtreeVel, angular part about the centre of mass, moved to the origin here\n"
      "switched off: joint limits, contacts, damping, friction\n";
  if (inertias == Inertias::kAsWritten)
    card +=
        "known loss: products of inertia. The compiler turns each inertia into its principal axes "
        "by Jacobi turns (mju_eig3) and stops when the cosine of the next turn exceeds 1 - 1e-12, "
        "that is with up to 1.4e-6 rad still to turn; what is left off the diagonal is dropped. "
        "The "
        "inertia is wrong by up to 1.4e-6 (largest - smallest moment)\n"
        "limit: the rounding of the algorithm, plus what the inertias in mjModel, where that rule "
        "explains them, do to the answer\n"
        "remedy: write each inertia in its principal axes (URDF: <inertial><origin rpy>; MJCF: "
        "diaginertia and quat instead of fullinertia), as the witness mujoco_principal does; or "
        "set "
        "body_inertia and body_iquat after loading";
  else
    card +=
        "known loss: none; this is mujoco with the remedy for its known loss: every inertia is "
        "written in its principal axes, found here in double";
  return card;
}

WitnessKind kind(Inertias inertias) {
  WitnessInfo info;
  info.name = wordsOf(inertias).name;
  info.version = mj_versionString();
  info.method = wordsOf(inertias).method;
  info.conventions = conventions(inertias);
  return overTree(engineKind<MujocoWitness>(info, inertias));
}

/** Followers are eliminated by MuJoCo's rows of them, each of which has its own rate and that of
    the joint at the head of its chain:  qd_tree = G qd. */
class MechanismOfMujoco {
 public:
  explicit MechanismOfMujoco(const PreparedScene& scene)
      : mechanism_(scene.mechanism()),
        coupling_(mechanism_, RealNumbers<double>(mechanism_)),
        witness_(scene.tree(), Inertias::kPrincipal, MujocoClosures(mechanism_)) {
    const std::vector<int> first = scene::firstRates(scene.tree().mechanism());
    for (const scene::Follower& f : scene::followers(mechanism_))
      followers_.push_back({first[static_cast<std::size_t>(f.link)], f.rate});
    rate_of_tree_.assign(static_cast<std::size_t>(mechanism_.dof()), -1);
    const std::vector<int> shared = scene::firstRates(mechanism_);
    for (std::size_t i = 0; i < mechanism_.links.size(); ++i)
      for (int k = 0; k < mechanism_.links[i].joint.ownRates(); ++k)
        rate_of_tree_[static_cast<std::size_t>(shared[i] + k)] = first[i] + k;
  }

  MujocoEquations operator()(const scene::State<double>& state) {
    const scene::State<double> on_tree = coupling_.onTree(state);
    Eigen::MatrixXd follow;
    MujocoEquations out;
    out.equations =
        std::make_shared<DenseEquations<double>>(witness_.equations(on_tree, mechanism_, &follow));
    DenseEquations<double>& e = *out.equations;
    Eigen::MatrixXd G =
        Eigen::MatrixXd::Zero(e.M.rows(), static_cast<Eigen::Index>(rate_of_tree_.size()));
    for (std::size_t i = 0; i < rate_of_tree_.size(); ++i)
      G(rate_of_tree_[i], static_cast<Eigen::Index>(i)) = 1;
    for (std::size_t i = 0; i < followers_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Follower& f = followers_[i];
      const int leader = rate_of_tree_[static_cast<std::size_t>(f.leader)];
      G(f.rate, f.leader) = -follow(row, leader) / follow(row, f.rate);
    }
    if (!followers_.empty()) {
      e.M = (G.transpose() * e.M * G).eval();
      e.bias = (G.transpose() * e.bias).eval();
      e.J = (e.J * G).eval();
    }
    out.force_error = [this, on_tree, G](const Eigen::VectorXd& qdd) {
      return G.cwiseAbs().colwise().sum().maxCoeff() * witness_.forceError(on_tree, G * qdd);
    };
    return out;
  }

 private:
  struct Follower {
    int rate, leader;  ///< in the tree; the leader's in the mechanism
  };
  scene::Mechanism mechanism_;
  Coupling<double> coupling_;
  MujocoWitness witness_;
  std::vector<Follower> followers_;
  std::vector<int> rate_of_tree_;  ///< by rate of the mechanism
};

MujocoMechanism mechanismOf(const PreparedScene& scene) {
  const auto mechanism = std::make_shared<MechanismOfMujoco>(scene);
  return [mechanism](const scene::State<double>& state) { return (*mechanism)(state); };
}

std::vector<WitnessKind> kinds() {
  return {kind(Inertias::kAsWritten), kind(Inertias::kPrincipal)};
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::EngineModule dynwitness_engine = {
    DYNWITNESS_VERSION, dynwitness::crosscheck::kinds, nullptr, nullptr,
    dynwitness::crosscheck::mechanismOf};
