// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/shown_sweep.hpp"

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::crosscheck {
namespace {

using recursive::Terms;

template <typename Motion>
Vector6d six(const Motion& x) {
  return x.vector();
}

Matrix6d matrixOf(const recursive::RigidInertia<double>& M) {
  return recursive::ArticulatedInertia<double>::fromRigid(M).matrix();
}

/// The sweeps of a model that keeps fixed joints, whose workspaces hold all that is shown.
class Shown {
 public:
  explicit Shown(const scene::Scene& scene)
      : scene_(scene),
        model_(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism),
                                     recursive::FixedJoints::kKept)),
        out_ws_(model_),
        free_ws_(model_),
        composite_ws_(model_) {}

  void sweep(ShownSweep& out) {
    const auto n = static_cast<std::size_t>(model_.dof());
    scene::State<double>& state = out.state;
    std::vector<double> tau(n, 0.0), passive(n, 0.0), qdd(n, 0.0);
    const std::vector<double> zeros(n, 0.0);
    // springs and friction alone: what they add to tau, whatever moves
    recursive::inverseDynamics(model_, state.x, state.qd, state.qdd, out_ws_, tau,
                               Terms{true, false, true, false});
    const std::vector<double> without = tau;
    recursive::inverseDynamics(model_, state.x, state.qd, state.qdd, out_ws_, tau);
    for (std::size_t k = 0; k < n; ++k) passive[k] = tau[k] - without[k];
    state.tau = tau;
    recursive::forwardDynamics(model_, state.x, state.qd, tau, free_ws_, qdd);
    recursive::MatrixX<double> M(model_.dof(), model_.dof());
    recursive::massMatrix(model_, state.x, composite_ws_, M);
    out.tau = Eigen::Map<const Eigen::VectorXd>(tau.data(), model_.dof());
    out.qdd = Eigen::Map<const Eigen::VectorXd>(qdd.data(), model_.dof());
    out.a_0.setZero();
    out.a_0.head<3>() = -model_.gravity;
    name();
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      out.links.push_back(link(i, state, passive));
  }

 private:
  /// The scene's links have one of the model each, and some joints more before it.
  void name() {
    names_.assign(model_.links.size(), "");
    joints_ = names_;
    const std::vector<scene::Link>& links = scene_.mechanism.links;
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (model_.places[i].link < 0) continue;
      names_[static_cast<std::size_t>(model_.places[i].link)] = links[i].name;
      joints_[static_cast<std::size_t>(model_.places[i].link)] = links[i].joint.name;
    }
    for (std::size_t i = model_.links.size(); i-- > 0;)
      if (names_[i].empty()) {
        names_[i] = "within " + joints_[i + 1];
        joints_[i] = joints_[i + 1];
      }
  }

  ShownLink link(std::size_t i, const scene::State<double>& state,
                 const std::vector<double>& passive) {
    const recursive::LinkModel<double>& link = model_.links[i];
    ShownLink out;
    out.name = names_[i];
    out.joint = joints_[i];
    out.kind = scene::name(link.kind);
    out.parent = link.parent;
    out.R = out_ws_.X_up[i].R;
    out.p = out_ws_.X_up[i].p;
    const int axes = link.dof < 0 ? 0 : recursive::axisCount(link.kind);
    const std::vector<std::string> rates = scene_.mechanism.rateLabels();
    out.Z = Eigen::MatrixXd(6, axes);
    out.first_rate = link.dof;
    out.Z_f = out.rotor = out.gyroscopic = out.passive = Eigen::VectorXd::Zero(axes);
    out.f = six(out_ws_.f[i]);
    for (int k = 0; k < axes; ++k) {
      const auto rate = static_cast<std::size_t>(link.dof + k);
      out.rates.push_back(rates[rate]);
      out.Z.col(k) = recursive::jointAxis(link, k);
      out.Z_f(k) = out.Z.col(k).dot(out.f);
      out.rotor(k) = link.rotor * state.qdd[rate];
      out.passive(k) = passive[rate];
    }
    out.d = link.rotor;
    out.M = matrixOf(link.M);
    out.M_C = matrixOf(composite_ws_.I_C[i]);
    out.v = six(out_ws_.v[i]);
    out.a = six(out_ws_.a[i]);
    // what it alone needs: what passes through its joint, without what its children's do
    out.own = out.f;
    for (std::size_t k = i + 1; k < model_.links.size(); ++k) {
      const recursive::LinkModel<double>& child = model_.links[k];
      if (child.parent != static_cast<int>(i)) continue;
      recursive::Force<double> f = out_ws_.f[k];
      if (recursive::spinsOnALink(model_, child)) {
        const auto rate = static_cast<std::size_t>(child.dof);
        f = f + recursive::spinForce(child, state.qd[rate], state.qdd[rate],
                                     out_ws_.X_up[k] * out_ws_.v[i]);
      }
      out.own -= six(out_ws_.X_up[k].inverseTimes(f));
    }
    if (axes > 0 && recursive::spinsOnALink(model_, link))
      out.gyroscopic(0) = dot(out_ws_.X_up[i] * out_ws_.a[static_cast<std::size_t>(link.parent)],
                              recursive::spinAxis(link));
    out.M_A = free_ws_.M_A[i].matrix();
    const Eigen::MatrixXd d = Eigen::MatrixXd::Identity(axes, axes) * link.rotor;
    out.D = d + out.Z.transpose() * out.M_A * out.Z;
    out.P.setIdentity();
    out.P_M = out.M_A;
    if (axes == 0) return out;
    const auto passed = recursive::sweptProjection(model_, state.x, free_ws_, static_cast<int>(i));
    out.P = passed.P;
    out.P_M = passed.P_M.matrix();
    // G of a gyroscopic rotor that a link carries: laws/projection_laws.hpp
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(6, axes);
    if (recursive::spinsOnALink(model_, link)) G.col(0) = six(recursive::spinAxis(link));
    const Eigen::MatrixXd inverse_D = out.D.inverse(), U_over_D = (out.M_A * out.Z + G) * inverse_D;
    const Matrix6d leak = U_over_D * (d - out.Z.transpose() * G) * inverse_D * out.Z.transpose();
    out.projector = (out.P * out.P - out.P + leak).cwiseAbs().maxCoeff();
    const Matrix6d P_M = out.P * out.M_A - U_over_D * G.transpose();
    out.asymmetry = (P_M - P_M.transpose()).cwiseAbs().maxCoeff();
    return out;
  }

  const scene::Scene& scene_;
  recursive::Model<double> model_;
  recursive::Workspace<double> out_ws_, free_ws_, composite_ws_;
  std::vector<std::string> names_, joints_;
};

}  // namespace

ShownSweep shownSweep(const scene::Scene& scene, const scene::State<double>& state) {
  requireTreated(scene, Command::kSweep);
  requireMotion(scene);
  ShownSweep out;
  out.state = state;
  out.rates = scene.mechanism.rateLabels();
  out.has_more = scene.mechanism.hasFriction() || !scene.mechanism.wrenches.empty();
  Shown(scene).sweep(out);

  const PreparedScene prepared(scene);
  MadeWitness made = lagrangeKind().make(prepared);
  if (made.isRefused()) throw scene::InputError({scene.file.string(), 0}, made.refusal());
  Witness& lagrange = **made;
  out.M = lagrange.value(Quantity::kM, out.state);
  out.c = lagrange.value(Quantity::kc, out.state);
  out.g = lagrange.value(Quantity::kg, out.state);
  out.lagrange = lagrange.value(Quantity::kTau, out.state);
  return out;
}

}  // namespace dynwitness::crosscheck
