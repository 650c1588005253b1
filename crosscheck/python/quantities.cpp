// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/python/quantities.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/scalars/many_states.hpp"
#include "recursive/build_model.hpp"
#include "recursive/derivatives.hpp"
#include "recursive/energy.hpp"
#include "recursive/fast/dynamics.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/point_motion.hpp"
#include "recursive/reactions.hpp"
#include "recursive/regressor.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::python {

namespace kernel = crosscheck::kernel;
using recursive::Model;
using recursive::Terms;
using Positions = std::vector<scene::JointPosition<double>>;

struct Quantities::Parts {
  explicit Parts(const scene::Mechanism& mechanism)
      : number(mechanism),
        model(recursive::buildModel(mechanism, number)),
        with_fixed_joints(recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept)),
        inertial(scene::inertialParameters(mechanism)) {}

  scene::RealNumbers<double> number;
  Model<double> model, with_fixed_joints;
  std::vector<scene::InertialParameter> inertial;
  bool kernel_was_tried = false;
  std::optional<kernel::Kernel> kernel;
};

struct Quantities::Room::Parts {
  explicit Parts(const Quantities::Parts& of)
      : fast(of.model),
        ws(of.model),
        ws_with_fixed_joints(of.with_fixed_joints),
        derivatives(of.model),
        of_tau(of.model),
        of_qdd(of.model),
        qd(static_cast<std::size_t>(of.model.dof())),
        qdd(qd),
        tau(qd),
        zeros(qd) {}

  const Positions& at(const double* q, int count) {
    x.resize(static_cast<std::size_t>(count));
    std::transform(q, q + count, x.begin(), [](double q_k) { return scene::jointPosition(q_k); });
    return x;
  }
  static const std::vector<double>& copied(const double* from, std::vector<double>& to) {
    std::copy(from, from + to.size(), to.begin());
    return to;
  }

  recursive::fast::Dynamics fast;
  recursive::Workspace<double> ws, ws_with_fixed_joints;
  recursive::DerivativesWorkspace<double> derivatives;
  recursive::InverseDynamicsDerivatives<double> of_tau;
  recursive::ForwardDynamicsDerivatives<double> of_qdd;
  Positions x;
  std::vector<double> qd, qdd, tau;
  const std::vector<double> zeros;
};

Quantities::Quantities(scene::Scene scene)
    : scene_(std::move(scene)), parts_(std::make_unique<Parts>(scene_.mechanism)) {}
Quantities::~Quantities() = default;
Quantities::Room::Room(const Quantities& quantities)
    : parts_(std::make_unique<Parts>(*quantities.parts_)) {}
Quantities::Room::~Room() = default;

int Quantities::dof() const {
  return scene_.mechanism.dof();
}
int Quantities::positions() const {
  return parts_->model.positions;
}
int Quantities::parameters() const {
  return static_cast<int>(parts_->inertial.size());
}
std::vector<std::string> Quantities::parameterNames() const {
  std::vector<std::string> names;
  for (const scene::InertialParameter& p : parts_->inertial)
    names.push_back(fmt::format("{}.{} [{}]",
                                scene_.mechanism.links[static_cast<std::size_t>(p.link)].name,
                                scene::name(p.kind), scene::unit(p, scene_.mechanism)));
  return names;
}

std::size_t Quantities::link(const std::string& name) const {
  std::vector<std::string> names;
  for (const scene::Link& link : scene_.mechanism.links) names.push_back(link.name);
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end())
    throw std::invalid_argument(fmt::format("link: no link '{}'{}, allowed: {}", name,
                                            scene::didYouMean(name, names),
                                            fmt::join(names, ", ")));
  return static_cast<std::size_t>(it - names.begin());
}

std::string Quantities::notOfTheTree() const {
  const scene::Mechanism& mechanism = scene_.mechanism;
  const char* what = !mechanism.closures.empty()                   ? "closures"
                     : !mechanism.springs.empty()                  ? "springs between points"
                     : mechanism.isDriven()                        ? "driven joints"
                     : !mechanism.acceleration_constraints.empty() ? "acceleration constraints"
                                                                   : nullptr;
  if (what == nullptr) return "";
  return fmt::format(
      "{}: tau and qdd of a scene with {} are not those of its tree, allowed: M, c, g, energies and "
      "kinematics, which are the tree's; or evaluate(), which runs the program",
      scene_.name, what);
}

// ---- state by state -----------------------------------------------------------------------------

void Quantities::massMatrix(const double* q, double* M, Room& room) const {
  room.parts_->fast.massMatrix(q, M);
}

void Quantities::coriolis(const double* q, const double* qd, double* c, Room& room) const {
  Room::Parts& r = *room.parts_;
  recursive::inverseDynamics(parts_->model, r.at(q, positions()), r.copied(qd, r.qd), r.zeros, r.ws,
                             r.tau, Terms::none());
  std::copy(r.tau.begin(), r.tau.end(), c);
}

void Quantities::gravity(const double* q, double* g, Room& room) const {
  Room::Parts& r = *room.parts_;
  recursive::inverseDynamics(parts_->model, r.at(q, positions()), r.zeros, r.zeros, r.ws, r.tau,
                             Terms::potential());
  std::copy(r.tau.begin(), r.tau.end(), g);
}

void Quantities::inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau,
                                 Room& room) const {
  room.parts_->fast.inverseDynamics(q, qd, qdd, tau);
}

void Quantities::forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd,
                                 Room& room) const {
  room.parts_->fast.forwardDynamics(q, qd, tau, qdd);
}

double Quantities::kinetic(const double* q, const double* qd, Room& room) const {
  Room::Parts& r = *room.parts_;
  return recursive::kineticEnergy(parts_->model, r.at(q, positions()), r.copied(qd, r.qd), r.ws);
}

double Quantities::potential(const double* q, Room& room) const {
  Room::Parts& r = *room.parts_;
  return recursive::potentialEnergy(parts_->model, r.at(q, positions()), r.ws);
}

void Quantities::momentum(const double* q, const double* qd, double* p, Room& room) const {
  Room::Parts& r = *room.parts_;
  const auto total =
      recursive::momentum(parts_->model, r.at(q, positions()), r.copied(qd, r.qd), r.ws);
  for (int k = 0; k < 3; ++k) {
    p[k] = total.force(k);
    p[3 + k] = total.moment(k);
  }
}

void Quantities::reactions(const double* q, const double* qd, const double* qdd, double* wrenches,
                           Room& room) const {
  Room::Parts& r = *room.parts_;
  recursive::inverseDynamics(parts_->with_fixed_joints, r.at(q, positions()), r.copied(qd, r.qd),
                             r.copied(qdd, r.qdd), r.ws_with_fixed_joints, r.tau);
  std::vector<double> out(6 * (parts_->with_fixed_joints.joints.size() - 1));
  recursive::jointReactions(parts_->with_fixed_joints, r.ws_with_fixed_joints, out);
  std::copy(out.begin(), out.end(), wrenches);
}

namespace {
using RowMajor = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
}  // namespace

void Quantities::regressor(const double* q, const double* qd, const double* qdd, double* Y,
                           Room& room) const {
  Room::Parts& r = *room.parts_;
  recursive::MatrixX<double> columns(dof(), parameters());
  recursive::regressor(parts_->model, parts_->inertial, r.at(q, positions()), r.copied(qd, r.qd),
                       r.copied(qdd, r.qdd), r.ws, columns);
  RowMajor(Y, dof(), parameters()) = columns;
}

void Quantities::inverseDerivatives(const double* q, const double* qd, const double* qdd,
                                    double* by_q, double* by_qd, Room& room) const {
  Room::Parts& r = *room.parts_;
  recursive::inverseDynamicsDerivatives(parts_->model, r.at(q, positions()), r.copied(qd, r.qd),
                                        r.copied(qdd, r.qdd), r.derivatives, r.of_tau);
  RowMajor(by_q, dof(), dof()) = r.of_tau.dtau_dq;
  RowMajor(by_qd, dof(), dof()) = r.of_tau.dtau_dqd;
}

void Quantities::forwardDerivatives(const double* q, const double* qd, const double* tau,
                                    double* by_q, double* by_qd, double* by_tau, Room& room) const {
  Room::Parts& r = *room.parts_;
  r.fast.forwardDynamics(q, qd, tau, r.qdd.data());
  recursive::forwardDynamicsDerivatives(parts_->model, r.at(q, positions()), r.copied(qd, r.qd),
                                        r.qdd, r.derivatives, r.of_tau, r.of_qdd);
  RowMajor(by_q, dof(), dof()) = r.of_qdd.dqdd_dq;
  RowMajor(by_qd, dof(), dof()) = r.of_qdd.dqdd_dqd;
  RowMajor(by_tau, dof(), dof()) = r.of_qdd.dqdd_dtau;
}

void Quantities::point(std::size_t link, const std::array<double, 3>& at, const double* q,
                       const double* qd, const OfPoint& out, Room& room) const {
  Room::Parts& r = *room.parts_;
  const recursive::PointMotion<double> motion =
      recursive::pointMotion(parts_->model, r.at(q, positions()), r.copied(qd, r.qd), r.zeros, link,
                             recursive::Vector3<double>(at[0], at[1], at[2]), r.ws);
  RowMajor(out.position, 1, 3) = motion.position.transpose();
  RowMajor(out.rotation, 3, 3) = motion.R;
  RowMajor(out.jacobian, 6, dof()) = motion.J;
  RowMajor(out.jacobian_rate, 6, dof()) = motion.J_rate;
}

// ---- many states --------------------------------------------------------------------------------

namespace {
recursive::fast::Strided<const double> strided(const Quantities::Rows& rows) {
  return {rows.from, rows.apart};
}
}  // namespace

void Quantities::massMatrices(Rows q, double* M, long count) const {
  recursive::fast::ManyStates many(parts_->model);
  many.massMatrix(static_cast<std::size_t>(count), strided(q), {M, dof() * dof()});
}

void Quantities::inverseDynamicsOfMany(Rows q, Rows qd, Rows qdd, double* tau, long count) const {
  recursive::fast::ManyStates many(parts_->model);
  many.inverseDynamics(static_cast<std::size_t>(count), strided(q), strided(qd), strided(qdd),
                       {tau, dof()});
}

void Quantities::forwardDynamicsOfMany(Rows q, Rows qd, Rows tau, double* qdd, long count) const {
  recursive::fast::ManyStates many(parts_->model);
  many.forwardDynamics(static_cast<std::size_t>(count), strided(q), strided(qd), strided(tau),
                       {qdd, dof()});
}

// ---- in the kernel's lanes ----------------------------------------------------------------------

bool Quantities::hasKernel(bool forward) const {
  Parts& p = *parts_;
  if (!p.kernel_was_tried) {
    p.kernel_was_tried = true;
    try {
      p.kernel.emplace(kernel::SmallestRoads(scene_.mechanism));
    } catch (const std::exception&) {  // no compiler, no straight line, M singular: sweeps then
    }
  }
  return p.kernel && p.kernel->has(forward ? kernel::Formula::kForwardDynamics
                                           : kernel::Formula::kInverseDynamics);
}

namespace {

/// States that are turned at a time: three blocks of a 7-joint arm are 43 kB, which a second-level
/// cache holds.
constexpr long kBlock = 256;

/// The kernel wants component i of state k at [i count + k], Python has it at [k n + i].
template <typename Call>
void inBlocks(const std::array<const double*, 3>& in, const std::array<int, 3>& widths, double* out,
              int width, long count, const Call& call) {
  std::array<std::vector<double>, 3> turned;
  for (std::size_t a = 0; a < in.size(); ++a)
    turned[a].resize(static_cast<std::size_t>(widths[a]) * kBlock);
  std::vector<double> result(static_cast<std::size_t>(width) * kBlock);
  for (long first = 0; first < count; first += kBlock) {
    const long block = std::min(kBlock, count - first);
    for (std::size_t a = 0; a < in.size(); ++a) {
      const double* from = in[a] + first * widths[a];
      for (long k = 0; k < block; ++k)
        for (int i = 0; i < widths[a]; ++i)
          turned[a][static_cast<std::size_t>(i * block + k)] = from[k * widths[a] + i];
    }
    call(turned[0].data(), turned[1].data(), turned[2].data(), result.data(), block);
    double* to = out + first * width;
    for (long k = 0; k < block; ++k)
      for (int i = 0; i < width; ++i)
        to[k * width + i] = result[static_cast<std::size_t>(i * block + k)];
  }
}

}  // namespace

void Quantities::inverseDynamicsInLanes(const double* q, const double* qd, const double* qdd,
                                        double* tau, long count) const {
  const kernel::Kernel& code = *parts_->kernel;
  inBlocks({q, qd, qdd}, {positions(), dof(), dof()}, tau, dof(), count,
           [&code](const double* a, const double* b, const double* c, double* out, long block) {
             code.inverseDynamics(a, b, c, out, block);
           });
}

void Quantities::forwardDynamicsInLanes(const double* q, const double* qd, const double* tau,
                                        double* qdd, long count) const {
  const kernel::Kernel& code = *parts_->kernel;
  inBlocks({q, qd, tau}, {positions(), dof(), dof()}, qdd, dof(), count,
           [&code](const double* a, const double* b, const double* c, double* out, long block) {
             code.forwardDynamics(a, b, c, out, block);
           });
}

}  // namespace dynwitness::python
