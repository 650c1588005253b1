// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/hamilton.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <boost/math/constants/constants.hpp>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/flow.hpp"
#include "crosscheck/scalars/lifted_closures.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/squares.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {

/// Beside those of flow.hpp.
static scene::JointPosition<RunningError> slotPosition(const RunningError& q) {
  return runningErrorPosition(q);
}

namespace {

using recursive::Terms;
using D = Dual<double>;
using DD = Dual<D>;
using Values = std::vector<double>;

constexpr double kPi = boost::math::constants::pi<double>();
constexpr int kFirstSteps = 64, kMostSteps = 8192;
constexpr int kOrder = 4;            // of the steps and of Simpson's sums
constexpr int kSines = 3;            // a joint, in a varied path
constexpr int kHalfWaves = 8;        // of a path that raises the action, a quarter of them
constexpr int kMostDof = 10;         // whose second variation is formed
constexpr double kAmplitude = 0.01;  // of varied paths [rad, m]
constexpr double kSharp =
    1000;  // steps are halved until conjugate times are known to duration / this
/// A step adds to the state four times, each sum rounded by half an eps of it at most.
constexpr double kRoundedByStep = 2 * std::numeric_limits<double>::epsilon();

/// The motion at one instant.
struct Node {
  double time, weight;  ///< Simpson's [s]
  Values slots, slot_rates, qd, Q;
};

/// What stays the same over all step sizes.
struct Problem {
  recursive::Model<double> model;
  Terms terms;
  double damping, duration;
  bool coordinates;  ///< all rates are independent, and the derivatives of q
  bool conservative;
  PhasePoint<double> start;
  recursive::Constraints<double> closures;
  Surface surface;  ///< where the start is

  int n() const { return static_cast<int>(surface.rates.size()); }  ///< freedoms
  int dof() const { return model.dof(); }
  bool isClosed() const { return !surface.rows.empty(); }
  template <typename T>
  Flow<T> flow() const {
    if constexpr (std::is_same_v<T, double>)
      return {model, terms, damping, closures, surface.rows};
    else
      return {lifted<T>(model), terms, damping, lifted<T>(closures, dof()), surface.rows};
  }
};

double magnitude(double x) {
  return std::abs(x);
}
double magnitude(const RunningError& x) {
  return std::abs(x.value());
}
template <typename T>
double magnitude(const Dual<T>& x) {
  return std::max(magnitude(x.value), magnitude(x.derivative));
}

bool isFinite(const Values& slots, const Values& qd) {
  const auto holds = [](double x) { return std::isfinite(x); };
  return std::all_of(slots.begin(), slots.end(), holds) && std::all_of(qd.begin(), qd.end(), holds);
}

/// The same number as if it were exact.
template <typename T>
T withoutBound(const T& x) {
  return x;
}
RunningError withoutBound(const RunningError& x) {
  return x.value();
}
template <typename T>
Dual<T> withoutBound(const Dual<T>& x) {
  return {withoutBound(x.value), withoutBound(x.derivative)};
}

/// How the rates of a closed mechanism follow from the independent ones at a position.
struct Dependence {
  Dependence(const Problem& problem, const Values& slots) : dof(problem.dof()) {
    const Surface& surface = problem.surface;
    recursive::Constraints<double> closures = problem.closures;
    recursive::Workspace<double> ws(problem.model);
    recursive::constraintEquations(problem.model, slotPositions(slots), Values(dof, 0.0), ws,
                                   closures);
    const Eigen::MatrixXd J = closures.J(surface.rows, Eigen::all);
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(J(Eigen::all, surface.dependent));
    const double size = Eigen::BDCSVD<Eigen::MatrixXd>(J).singularValues()(0);
    regularity = (lu.matrixLU().diagonal().cwiseAbs() / size).minCoeff();
    if (lu.determinant() < 0) regularity = -regularity;
    inverse = lu.inverse();
    along = Eigen::MatrixXd::Zero(dof, problem.n());
    for (int a = 0; a < problem.n(); ++a) along(surface.rates[static_cast<std::size_t>(a)], a) = 1;
    along(surface.dependent, Eigen::all) = -inverse * J(Eigen::all, surface.rates);
  }
  int dof;
  double regularity;               ///< smallest pivot over the largest singular value, det's sign
  Eigen::MatrixXd inverse, along;  ///< of J of the dependent rates; all rates, dof x n
};

// ---- T - V and Q near the motion ----------------------------------------------------------------

/** Energies and forces at q + B(q) zeta, B taking rates to rates of slots: what a variation zeta
   with rates zeta' makes of the motion, in any scalar. Of closed mechanisms zeta is of the
   independent rates; the others go with them so that phi stays 0. */
template <typename S>
class Near {
 public:
  explicit Near(const Problem& problem)
      : problem_(problem),
        model_(lifted<S>(problem.model)),
        ws_(model_),
        moving_(lifted<Dual<S>>(problem.model)),
        ws_moving_(moving_),
        closures_(lifted<Dual<S>>(problem.closures, problem.dof())) {}

  /// Positions and rates of the varied path.
  void at(const Node& node, const std::vector<S>& zeta, const std::vector<S>& zeta_rate) {
    const int positions = model_.positions;
    if (problem_.coordinates) {
      std::vector<S> slots;
      qd_.clear();
      for (int i = 0; i < positions; ++i) {
        slots.push_back(S(node.slots[i]) + zeta[i]);
        qd_.push_back(S(node.qd[i]) + zeta_rate[i]);
      }
      x_ = slotPositions(slots);
      return;
    }
    using T = Dual<S>;  // along time
    std::vector<T> slots, zeta_moving(problem_.dof(), T(S(0)));
    for (int i = 0; i < positions; ++i) slots.push_back(T(S(node.slots[i]), S(node.slot_rates[i])));
    for (int a = 0; a < problem_.n(); ++a)
      zeta_moving[problem_.surface.rates[a]] = T(zeta[a], zeta_rate[a]);
    if (problem_.isClosed()) follow(node, slots, &zeta_moving);
    const std::vector<T> varied = displaced(slots, zeta_moving);
    std::vector<S> now, rates;
    for (const T& slot : varied) {
      now.push_back(slot.value);
      rates.push_back(slot.derivative);
    }
    x_ = slotPositions(now);
    qd_ = ratesOfSlots(model_, x_, rates);
  }
  S lagrangian() {
    S L = recursive::kineticEnergy(model_, x_, qd_, ws_);
    if (problem_.terms.gravity) L -= recursive::potentialEnergy(model_, x_, ws_);
    return L;
  }
  /// Q' qd of loads and dampers.
  S power() {
    S sum = S(0);
    const std::vector<S> Q = forces();
    for (int i = 0; i < problem_.dof(); ++i) sum += Q[i] * qd_[i];
    return sum;
  }
  /// Forces that have no potential here: loads and dampers.
  std::vector<S> forces() {
    const std::vector<S> rest(problem_.dof(), S(0));
    std::vector<S> Q(problem_.dof(), S(0));
    recursive::inverseDynamics(model_, x_, rest, rest, ws_, Q,
                               {false, false, problem_.terms.loads});
    for (int i = 0; i < problem_.dof(); ++i) Q[i] = -Q[i] - S(problem_.damping) * qd_[i];
    return Q;
  }

 private:
  using Moving = std::vector<Dual<S>>;
  Moving displaced(const Moving& slots, const Moving& zeta) {
    Moving change(slots.size(), Dual<S>(S(0)));
    recursive::positionRates(moving_, slotPositions(slots), zeta, change);
    for (std::size_t i = 0; i < slots.size(); ++i) change[i] += slots[i];
    return change;
  }
  /// Newton's steps in the dependent part of zeta until phi and phi' are 0, all with the node's own
  /// Jacobian: on duals each makes one more derivative right. Wherever they come from, the last one
  /// says where phi is 0, and how surely.
  void follow(const Node& node, const Moving& slots, Moving* zeta) {
    constexpr int kMost = 40;
    const Dependence here(problem_, node.slots);
    const Moving rest(problem_.dof(), Dual<S>(S(0)));
    const Surface& surface = problem_.surface;
    const auto m = static_cast<Eigen::Index>(surface.rows.size());
    double before = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMost; ++step) {
      recursive::constraintEquations(moving_, slotPositions(displaced(slots, *zeta)), rest,
                                     ws_moving_, closures_);
      double largest = 0;
      Moving moved;
      for (Eigen::Index i = 0; i < m; ++i) {
        Dual<S> correction(S(0));
        for (Eigen::Index k = 0; k < m; ++k)
          correction += closures_.phi(surface.rows[k]) * Dual<S>(S(here.inverse(i, k)));
        moved.push_back((*zeta)[surface.dependent[i]] - correction);
        largest = std::max(largest, magnitude(correction));
      }
      // below this a step that does not halve the last one is rounding
      const bool is_last =
          step + 1 == kMost || largest == 0 || (largest < 1e-9 && !(largest < before / 2));
      for (Eigen::Index i = 0; i < m; ++i)
        (*zeta)[surface.dependent[i]] = is_last ? moved[i] : withoutBound(moved[i]);
      if (is_last) return;
      before = largest;
    }
  }

  const Problem& problem_;
  recursive::Model<S> model_;
  recursive::Workspace<S> ws_;
  recursive::Model<Dual<S>> moving_;
  recursive::Workspace<Dual<S>> ws_moving_;
  recursive::Constraints<Dual<S>> closures_;
  std::vector<scene::JointPosition<S>> x_;
  std::vector<S> qd_;
};

// ---- the motion ---------------------------------------------------------------------------------

/// The independent rates have to tell the others all along.
void requireDependence(const Problem& problem, const Node& node, double at_start) {
  constexpr double kLeast = 1e-6;
  if (!isFinite(node.slots, node.qd)) return;
  const double regularity = Dependence(problem, node.slots).regularity;
  if (!(regularity * at_start > 0 && std::abs(regularity) > kLeast))
    throw scene::InputError(
        {}, fmt::format("up to t = {:.6g} s the mechanism passes a place where the rates that are "
                        "independent at the start do not tell the others; allowed: a shorter "
                        "duration",
                        node.time));
}

std::vector<Node> motionOf(const Problem& problem, int steps) {
  Flow<double> flow = problem.flow<double>();
  Near<double> near(problem);
  const double h = problem.duration / steps;
  const Values none(problem.n(), 0.0);
  std::vector<Node> nodes;
  PhasePoint<double> y = problem.start;
  const double at_start = problem.isClosed() ? Dependence(problem, y.slots).regularity : 0;
  for (int k = 0; k <= steps; ++k) {
    if (k > 0) y = flow.step(y, h);
    const double share = k == 0 || k == steps ? 1 : k % 2 == 1 ? 4 : 2;
    Node node = {h * k, share * h / 3, y.slots, flow.slotRates(y), y.qd, {}};
    near.at(node, none, none);
    node.Q = near.forces();
    nodes.push_back(node);
    if (problem.isClosed()) requireDependence(problem, node, at_start);
  }
  return nodes;
}

/// zeta_i(t) = sum of a_im sin(m pi t / duration), m = 1, 2, ...
struct Sines {
  std::vector<Values> a;  ///< by joint
  double value(int i, double phase) const {
    double sum = 0;
    for (std::size_t m = 0; m < a[i].size(); ++m) sum += a[i][m] * std::sin((m + 1) * phase);
    return sum;
  }
  double rate(int i, double phase, double duration) const {
    double sum = 0;
    for (std::size_t m = 0; m < a[i].size(); ++m)
      sum += a[i][m] * (m + 1) * kPi / duration * std::cos((m + 1) * phase);
    return sum;
  }
};

/// sin(k pi) is exactly 0 at the last node: the ends are kept.
double phaseOf(const Problem& problem, const Node& node, const std::vector<Node>& nodes) {
  return &node == &nodes.back() ? 0 : kPi * node.time / problem.duration;
}

struct FirstVariation {
  double action = 0;       ///< dS
  double with_forces = 0;  ///< dS + integral of Q' zeta
  double with_work = 0;    ///< d(S + integral of W)
  double size = 0;         ///< sum of the magnitudes that it was summed from
};

FirstVariation firstVariation(const Problem& problem, const std::vector<Node>& nodes,
                              const Sines& zeta) {
  Near<D> near(problem);
  FirstVariation out;
  const int n = problem.n();
  for (const Node& node : nodes) {
    const double phase = phaseOf(problem, node, nodes);
    std::vector<D> z, z_rate;
    double forces = 0;
    for (int i = 0; i < n; ++i) {
      const double value = zeta.value(i, phase);
      const double rate = zeta.rate(i, kPi * node.time / problem.duration, problem.duration);
      z.push_back(D(0.0, value));
      z_rate.push_back(D(0.0, rate));
      forces += node.Q[i] * value;
    }
    near.at(node, z, z_rate);
    const double dL = near.lagrangian().derivative;
    out.action += node.weight * dL;
    out.with_forces += node.weight * (dL + forces);
    // W at all later times, integrated over them
    out.with_work += node.weight * (dL + (problem.duration - node.time) * near.power().derivative);
    out.size += node.weight * (std::abs(dL) + std::abs(forces));
  }
  return out;
}

/// S of the path q + amplitude zeta, by the nodes and by every second of them.
struct PathAction {
  RunningError by_all = 0, by_half = 0;
};

PathAction actionOf(const Problem& problem, const std::vector<Node>& nodes, const Sines* zeta,
                    double amplitude) {
  using Error = RunningError;
  Near<Error> near(problem);
  const int n = problem.n();
  PathAction S;
  std::vector<Error> z(n, Error(0)), z_rate(n, Error(0));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Node& node = nodes[k];
    if (zeta != nullptr)
      for (int i = 0; i < n; ++i) {
        z[i] = amplitude * zeta->value(i, phaseOf(problem, node, nodes));
        z_rate[i] = amplitude * zeta->rate(i, kPi * node.time / problem.duration, problem.duration);
      }
    near.at(node, z, z_rate);
    const Error L = near.lagrangian();
    S.by_all += Error(node.weight) * L;
    // Simpson's weights of steps twice as long: 2 (1, 4, 2, 4, ..., 1)
    const bool is_end = k == 0 || k + 1 == nodes.size();
    if (k % 2 == 0) S.by_half += Error(node.weight * (is_end ? 2 : k % 4 == 2 ? 4 : 2)) * L;
  }
  return S;
}

/** S(q + eta) - S(q), and what of it is not the second variation's:
      roundings             running error bounds, of q + eta too
      the steps             the integral by every second node differs by more than by all
      dS                    which would vanish if the steps followed the motion
      higher variations     those of even eta^4 and odd eta^3 leave 3/4 and 1/2 of themselves in
                            change(eta) - 4 change(eta / 2), hence twice that */
using Change = Action::Path::Change;

Change changeOf(const Problem& problem, const std::vector<Node>& nodes, const PathAction& own,
                const Sines& zeta, double first, double amplitude) {
  const PathAction there = actionOf(problem, nodes, &zeta, amplitude),
                   half = actionOf(problem, nodes, &zeta, amplitude / 2);
  const RunningError change = there.by_all - own.by_all;
  const double longer = (there.by_half - own.by_half).value(),
               higher = change.value() - 4 * (half.by_all - own.by_all).value();
  return {change.value(), change.bound() + std::abs(change.value() - longer) +
                              amplitude * std::abs(first) + 2 * std::abs(higher)};
}

/** By how much rounding the state after each step moves dS(eta), at most: between two steps it is
    [p' eta], and eta, nowhere above 1 (of dependent rates above what they then are), feels each
    jump of p = M qd. */
double movedByRounding(const Problem& problem, const std::vector<Node>& nodes) {
  const int n = problem.dof();
  const recursive::Model<D> model = lifted<D>(problem.model);
  recursive::Workspace<D> ws(model);
  recursive::MatrixX<D> M(n, n);
  double sum = 0;
  for (const Node& node : nodes) {
    Eigen::VectorXd most = Eigen::VectorXd::Ones(n);
    if (problem.isClosed()) most = Dependence(problem, node.slots).along.cwiseAbs().rowwise().sum();
    for (std::size_t k = 0; k < node.slots.size(); ++k) {
      std::vector<D> slots(node.slots.begin(), node.slots.end());
      slots[k].derivative = node.slots[k];
      recursive::massMatrix(model, slotPositions(slots), ws, M);
      for (int i = 0; i < n; ++i) {
        double jump = 0;
        for (int j = 0; j < n; ++j) {
          jump += M(i, j).derivative * node.qd[j];
          if (k == 0) sum += most(i) * std::abs(M(i, j).value * node.qd[j]);
        }
        sum += most(i) * std::abs(jump);
      }
    }
  }
  return kRoundedByStep * sum;
}

// ---- second variation ---------------------------------------------------------------------------

/// Second derivatives of L by (zeta, zeta') at each node, 2 n x 2 n.
std::vector<Eigen::MatrixXd> hessians(const Problem& problem, const std::vector<Node>& nodes) {
  const int n = problem.n();
  Near<DD> near(problem);
  std::vector<Eigen::MatrixXd> out;
  for (const Node& node : nodes) {
    Eigen::MatrixXd H(2 * n, 2 * n);
    for (int a = 0; a < 2 * n; ++a)
      for (int b = 0; b <= a; ++b) {
        std::vector<DD> z[2] = {std::vector<DD>(n, DD(D(0.0))), std::vector<DD>(n, DD(D(0.0)))};
        z[a / n][a % n] += DD(D(0.0, 1.0));
        z[b / n][b % n] += DD(D(0.0), D(1.0));
        near.at(node, z[0], z[1]);
        H(a, b) = H(b, a) = near.lagrangian().derivative.derivative;
      }
    out.push_back(H);
  }
  return out;
}

/// The second variation less `least` of its kinetic part, between two nodes that straight lines
/// join: a block each for the ends, and one between them.
struct Element {
  Eigen::MatrixXd left, right, across;
};
/// Of every `2 stride` steps one: Simpson's three nodes.
std::vector<Element> elements(const Problem& problem, const std::vector<Eigen::MatrixXd>& H,
                              int stride, double least) {
  const int n = problem.n(), last = static_cast<int>(H.size()) - 1;
  const double width = 2 * stride * problem.duration / last;
  std::vector<Element> out;
  for (int k = 0; k < last; k += 2 * stride) {
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(n, n), right = left, across = left;
    for (int point = 0; point < 3; ++point) {
      const Eigen::MatrixXd& h = H[k + point * stride];
      const Eigen::MatrixXd qq = h.topLeftCorner(n, n), qv = h.topRightCorner(n, n),
                            vv = (1 - least) * h.bottomRightCorner(n, n);
      const double weight = (point == 1 ? 4 : 1) * width / 6, up = point / 2.0, down = 1 - up,
                   slope = 1 / width;
      left +=
          weight * (down * down * qq - down * slope * (qv + qv.transpose()) + slope * slope * vv);
      right += weight * (up * up * qq + up * slope * (qv + qv.transpose()) + slope * slope * vv);
      across += weight * (down * up * qq + down * slope * qv - up * slope * qv.transpose() -
                          slope * slope * vv);
    }
    out.push_back({left, right, across});
  }
  return out;
}

/** Negative directions of the second variation on all variations that are straight between every
    `2 stride`-th node and 0 at both ends. Block by block, M = L D L' of a block-tridiagonal matrix:
   as many as the blocks of D have negative eigenvalues (Sylvester). A subspace can miss a direction
   of the true second variation, never add one; the finer it is, the fewer it misses.
    @param least  counts eigenvalues over the kinetic part below this one, which is below 1 */
int negativeDirections(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int stride,
                       double least = 0) {
  int negative = 0;
  Eigen::MatrixXd carried;  // of the elements to the left
  for (const Element& element : elements(problem, H, stride, least)) {
    Eigen::MatrixXd right = element.right;
    if (carried.size() > 0) {  // the node between this element and the last is free
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> D(carried + element.left);
      negative += static_cast<int>((D.eigenvalues().array() < 0).count());
      right -= element.across.transpose() * D.eigenvectors() *
               D.eigenvalues().cwiseInverse().asDiagonal() * D.eigenvectors().transpose() *
               element.across;
    }
    carried = right;
  }
  return negative;
}

/// The `number`-th lowest eigenvalue of the second variation over its kinetic part, at most 1.
double eigenvalue(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int number) {
  const auto isBelow = [&](double value) {
    return negativeDirections(problem, H, 1, value) >= number;
  };
  double low = -1, high = 1;
  while (isBelow(low) && std::isfinite(low)) low *= 2;
  for (double middle = 0; middle > low && middle < high; middle = low + (high - low) / 2)
    (isBelow(middle) ? high : low) = middle;
  return high;
}

/// A variation that is straight from node to node, 0 at both ends, nowhere above 1.
struct Lines {
  std::vector<Eigen::VectorXd> at;  ///< at the ends of equal parts of the duration
  int parts() const { return static_cast<int>(at.size()) - 1; }
};

/** The direction of the second variation's lowest eigenvalue, by inverse iteration just below it,
    where the second variation less that much of its kinetic part is positive definite: L L' block
    by block.
    @param lowest  of eigenvalue() */
Lines lowestDirection(const Problem& problem, const std::vector<Eigen::MatrixXd>& H,
                      double lowest) {
  constexpr int kIterations = 8;
  constexpr double kBelow = 1e-6;  // each iteration leaves so much of the others, or less
  const int n = problem.n();
  const double least = lowest - kBelow * std::max(1.0, std::abs(lowest));
  const std::vector<Element> shifted = elements(problem, H, 1, least);
  const std::size_t inner = shifted.size() - 1;  // nodes that are free
  std::vector<Eigen::LLT<Eigen::MatrixXd>> D;
  for (std::size_t k = 0; k < inner; ++k) {
    Eigen::MatrixXd block = shifted[k].right + shifted[k + 1].left;
    if (k > 0) block -= shifted[k].across.transpose() * D.back().solve(shifted[k].across);
    D.emplace_back(block);
  }
  std::vector<Eigen::VectorXd> x(inner + 2, Eigen::VectorXd::Zero(n));
  for (std::size_t k = 0; k < inner; ++k)  // any that is no eigenvector of something simple
    for (int i = 0; i < n; ++i)
      x[k + 1](i) = std::sin(kPi * static_cast<double>(k + 1) / static_cast<double>(inner + 1)) *
                    (1 + 0.1 * i + 0.3 * static_cast<double>(k) / static_cast<double>(inner));
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // the kinetic part of x, but for a factor
    std::vector<Eigen::VectorXd> b(inner + 2, Eigen::VectorXd::Zero(n));
    for (std::size_t k = 0; k <= inner; ++k) {
      const double width = 1 / static_cast<double>(inner + 1);
      Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
      for (int point = 0; point < 3; ++point)
        mass += (point == 1 ? 4 : 1) *
                H[2 * k + static_cast<std::size_t>(point)].bottomRightCorner(n, n);
      const Eigen::VectorXd stretch = mass * (x[k + 1] - x[k]) / width;
      b[k] -= stretch;
      b[k + 1] += stretch;
    }
    for (std::size_t k = 1; k < inner; ++k)
      b[k + 1] -= shifted[k].across.transpose() * D[k - 1].solve(b[k]);
    for (std::size_t k = inner; k-- > 0;) {
      Eigen::VectorXd right = b[k + 1];
      if (k + 1 < inner) right -= shifted[k + 1].across * x[k + 2];
      x[k + 1] = D[k].solve(right);
    }
    double largest = 0;
    for (const Eigen::VectorXd& v : x) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (Eigen::VectorXd& v : x) v /= largest;
  }
  return {x};
}

/// S of the path q + amplitude eta by Simpson's sums, whose panels end where eta is bent.
template <typename S>
S actionAlong(const Problem& problem, const std::vector<Node>& nodes, const Lines& eta,
              const S& amplitude) {
  const int n = problem.n(), last = static_cast<int>(nodes.size()) - 1, part = last / eta.parts();
  const double h = problem.duration / last;
  Near<S> near(problem);
  S sum = S(0);
  std::vector<S> z(n, S(0)), z_rate(n, S(0));
  for (int panel = 0; panel < last; panel += 2) {
    const std::size_t k = static_cast<std::size_t>(panel / part);
    const Eigen::VectorXd slope = (eta.at[k + 1] - eta.at[k]) / (h * part);
    for (int point = 0; point < 3; ++point) {
      const double from = static_cast<double>(panel + point) / part - static_cast<double>(k);
      for (int i = 0; i < n; ++i) {
        z[i] = amplitude * S((1 - from) * eta.at[k](i) + from * eta.at[k + 1](i));
        z_rate[i] = amplitude * S(slope(i));
      }
      near.at(nodes[static_cast<std::size_t>(panel + point)], z, z_rate);
      sum += S((point == 1 ? 4 : 1) * h / 3) * near.lagrangian();
    }
  }
  return sum;
}

/** S(q + eta) - S(q) as changeOf() has it; what steps leave of it is by how much half as many
    change it. */
Change changeAlong(const Problem& problem, const std::vector<Node>& nodes,
                   const std::vector<Node>& coarse, const Lines& eta, double amplitude,
                   double* first) {
  const auto change = [&](const std::vector<Node>& by, double size) {
    return actionAlong<RunningError>(problem, by, eta, size) -
           actionAlong<RunningError>(problem, by, eta, 0.0);
  };
  *first = actionAlong<D>(problem, nodes, eta, D(0.0, 1.0)).derivative;
  const RunningError fine = change(nodes, amplitude), half = change(nodes, amplitude / 2);
  return {fine.value(), fine.bound() + std::abs(fine.value() - change(coarse, amplitude).value()) +
                            amplitude * std::abs(*first) +
                            2 * std::abs(fine.value() - 4 * half.value())};
}

// ---- neighbouring motions -----------------------------------------------------------------------

/// Motions that start at the same place with another velocity, and the same motion a little later.
struct Neighbours {
  explicit Neighbours(const Problem& problem) : problem(problem), flow(problem.flow<D>()) {
    Flow<double> plain = problem.flow<double>();
    const Values slot_rates = plain.slotRates(problem.start),
                 qdd = plain.accelerations(problem.start);
    const Eigen::MatrixXd along = problem.isClosed()
                                      ? Dependence(problem, problem.start.slots).along
                                      : Eigen::MatrixXd::Identity(problem.n(), problem.n());
    for (int k = 0; k <= problem.n(); ++k) {
      PhasePoint<D> y;
      const bool later = k == problem.n();
      for (std::size_t i = 0; i < problem.start.slots.size(); ++i)
        y.slots.push_back(D(problem.start.slots[i], later ? slot_rates[i] : 0.0));
      for (int i = 0; i < problem.dof(); ++i)
        y.qd.push_back(D(problem.start.qd[i], later ? qdd[i] : along(i, k)));
      now.push_back(y);
    }
  }
  void step(double h) {
    for (PhasePoint<D>& y : now) y = flow.step(y, h);
  }
  /// A(t), column k: where the k-th neighbour is, seen from the motion, n x n.
  Eigen::MatrixXd places() const {
    Eigen::MatrixXd A(problem.n(), problem.n());
    for (int k = 0; k < problem.n(); ++k) {
      const PhasePoint<D>& y = now[k];
      Values slots, aside;
      for (const D& q : y.slots) {
        slots.push_back(q.value);
        aside.push_back(q.derivative);
      }
      const Values change = ratesOfSlots(problem.model, slotPositions(slots), aside);
      for (int i = 0; i < problem.n(); ++i) A(i, k) = change[problem.surface.rates[i]];
    }
    return A;
  }
  /// dp, p = M qd, in coordinates; column k of the k-th neighbour.
  Eigen::MatrixXd momenta() {
    const recursive::Model<D>& model = flow.model();
    recursive::Workspace<D> ws(model);
    recursive::MatrixX<D> M(problem.n(), problem.n());
    Eigen::MatrixXd P(problem.n(), problem.n());
    for (int k = 0; k < problem.n(); ++k) {
      recursive::massMatrix(model, slotPositions(now[k].slots), ws, M);
      for (int i = 0; i < problem.n(); ++i) {
        D p(0.0);
        for (int j = 0; j < problem.n(); ++j) p += M(i, j) * now[k].qd[j];
        P(i, k) = p.derivative;
      }
    }
    return P;
  }

  const Problem& problem;
  Flow<D> flow;
  std::vector<PhasePoint<D>> now;  ///< n neighbours by velocity, then the motion a little later
};

/** By how much rounding the state moves A'P - P'A, at most: P refers to the motion's own place and
    rates, and moves with them.
    @param now  neighbours, in coordinates */
double movedByRounding(const Problem& problem, const std::vector<PhasePoint<D>>& now) {
  const int n = problem.n();
  const recursive::Model<DD> model = lifted<DD>(problem.model);
  recursive::Workspace<DD> ws(model);
  recursive::MatrixX<DD> M(n, n);
  Eigen::MatrixXd A(n, n), moved = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i) A(i, k) = now[k].slots[i].derivative;
  for (int which = 0; which < 2 * n; ++which) {
    Eigen::MatrixXd P(n, n);
    for (int k = 0; k < n; ++k) {
      std::vector<DD> slots, qd;
      for (int i = 0; i < n; ++i) {
        const D &q = now[k].slots[i], &v = now[k].qd[i];
        slots.push_back(DD(D(q.value, which == i ? q.value : 0.0), D(q.derivative)));
        qd.push_back(DD(D(v.value, which == n + i ? v.value : 0.0), D(v.derivative)));
      }
      recursive::massMatrix(model, slotPositions(slots), ws, M);
      for (int i = 0; i < n; ++i) {
        DD p(D(0.0));
        for (int j = 0; j < n; ++j) p += M(i, j) * qd[j];
        P(i, k) = p.derivative.derivative;
      }
    }
    const Eigen::MatrixXd product = A.transpose() * P;
    moved += (product - product.transpose()).cwiseAbs();
  }
  return kRoundedByStep * moved.maxCoeff();
}

struct JacobiFields {
  std::vector<Action::Conjugate> conjugates;
  StepResidual unsymmetric, late;  ///< A'P - P'A, J - (q', qd') of the later motion
  double size_late = 0;
  double size_state = 0, growth = 1;  ///< largest |q|, |qd|; largest entry of a neighbour
  std::vector<std::vector<PhasePoint<D>>> shared;  ///< neighbours where every size of steps is
};

/** How many singular values of A vanish together within two steps after `from`. Each passes 0 as |t
   - t*|; the least of the smallest is sought by golden sections, and one that would reach 0 within
   duration / kSharp of there counts. */
Action::Conjugate manyMeet(Neighbours* neighbours, const std::vector<PhasePoint<D>>& from,
                           double start, double h) {
  const auto values = [&](double later) {
    neighbours->now = from;
    neighbours->step(later);
    return Eigen::VectorXd(
        Eigen::JacobiSVD<Eigen::MatrixXd>(neighbours->places()).singularValues().reverse());
  };
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 2 * h;
  while (high - low > h / kSharp) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (values(a)(0) < values(b)(0) ? high : low) = values(a)(0) < values(b)(0) ? b : a;
  }
  const double at = (low + high) / 2;
  const Eigen::VectorXd least = values(at), before = values(0), after = values(2 * h);
  Action::Conjugate out = {start + at, 0, 0};
  for (Eigen::Index i = 0; i < least.size(); ++i) {
    const double slope =
        std::max((before(i) - least(i)) / at, (after(i) - least(i)) / (2 * h - at));
    if (slope > 0 && least(i) / slope < neighbours->problem.duration / kSharp) ++out.multiplicity;
  }
  return out;
}

/// @param work  of all numbers of steps up to this one: 1, 2, 4, ... times the first
JacobiFields jacobiFields(const Problem& problem, int steps, scene::Work& work) {
  JacobiFields out;
  Neighbours neighbours(problem);
  Flow<double> plain = problem.flow<double>();
  const double h = problem.duration / steps;
  const auto determinant = [](const Eigen::MatrixXd& A, double t) {
    return (A / t).eval().determinant();
  };
  double before = 0, earlier = 0;           // determinants at the last two nodes
  std::vector<PhasePoint<D>> last_but_one;  // neighbours at the node before the last
  for (int k = 1; k <= steps; ++k) {
    const std::vector<PhasePoint<D>> from = neighbours.now;
    neighbours.step(h);
    work.doneTo((steps - kFirstSteps + k) / (2.0 * std::max(steps, 2 * kFirstSteps) - kFirstSteps));
    const std::vector<PhasePoint<D>> to = neighbours.now;
    const double time = h * k, det = determinant(neighbours.places(), time);
    if (k > 1 && before * det < 0) {  // between: halve the step until nothing is left of it
      double low = 0, high = h;
      for (double middle = h / 2; middle > low && middle < high; middle = low + (high - low) / 2) {
        neighbours.now = from;
        neighbours.step(middle);
        const double at = determinant(neighbours.places(), time - h + middle);
        (before * at > 0 ? low : high) = middle;
      }
      out.conjugates.push_back({time - h + low, 0, 1});
    } else if (k > 2 && std::abs(before) < std::min(std::abs(earlier), std::abs(det)) &&
               earlier * before > 0) {
      // it came near 0 and turned back: several neighbours may meet at once, which changes no sign
      const Action::Conjugate meeting = manyMeet(&neighbours, last_but_one, time - 2 * h, h);
      if (meeting.multiplicity >= 2) out.conjugates.push_back(meeting);
    }
    neighbours.now = to;
    last_but_one = from;
    earlier = before;
    before = det;
    const Eigen::MatrixXd A = neighbours.places();
    const bool is_shared = k % (steps / kFirstSteps) == 0;  // every size of steps comes here

    // neighbours stay Lagrangian: A'P = P'A
    if (problem.coordinates) {
      const Eigen::MatrixXd P = neighbours.momenta(), product = A.transpose() * P;
      for (int i = 0; i < problem.n(); ++i)
        for (int j = 0; j < i; ++j) out.unsymmetric.add(product(i, j) - product(j, i), is_shared);
      out.unsymmetric.terms = std::max(out.unsymmetric.terms, product.cwiseAbs().maxCoeff());
      if (is_shared) out.shared.push_back(neighbours.now);
    }
    // the motion a little later is a neighbour: its place is ahead by qd
    const PhasePoint<D>& later = neighbours.now.back();
    PhasePoint<double> y;
    for (const D& q : later.slots) y.slots.push_back(q.value);
    for (const D& qd : later.qd) y.qd.push_back(qd.value);
    for (const Values* values : {&y.slots, &y.qd})
      for (const double value : *values) out.size_state = std::max(out.size_state, std::abs(value));
    for (int k = 0; k < problem.n(); ++k)
      for (const auto* values : {&neighbours.now[k].slots, &neighbours.now[k].qd})
        for (const D& value : *values)
          out.growth = std::max(out.growth, std::abs(value.derivative));
    const Values slot_rates = plain.slotRates(y), qdd = plain.accelerations(y);
    const auto compare = [&](const D& found, double expected) {
      const double difference = found.derivative - expected;
      out.late.add(difference, is_shared);
      out.size_late = std::max(out.size_late, std::abs(expected));
    };
    for (std::size_t i = 0; i < y.slots.size(); ++i) compare(later.slots[i], slot_rates[i]);
    for (int i = 0; i < problem.dof(); ++i) compare(later.qd[i], qdd[i]);
  }
  // each step rounds the state, and neighbours say how far that carries
  out.late.terms = out.size_late + out.size_state * out.growth;
  return out;
}

// ---- verdicts -----------------------------------------------------------------------------------

CheckResult describe(const char* name, const char* statement, const char* quantity,
                     const char* left) {
  CheckResult check;
  check.law = name;
  check.statement = statement;
  check.quantity = quantity;
  check.left = left;
  check.states = 1;
  return check;
}

void leaveOpen(CheckResult* check, const std::string& reason) {
  check->verdict = Verdict::kNotAnswerable;
  check->ratio = 0;
  check->reason = reason;
}

double largestDifference(const Values& a, const Values& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

void require(bool holds, const std::string& message) {
  if (!holds) throw scene::InputError({}, message);
}

Problem problemOf(const scene::Scene& scene, const ActionOptions& options) {
  requireTreated(scene, options.potential ? Command::kAction : Command::kGeometry);
  requireMotion(scene);
  const scene::RealNumbers<double> number(scene.mechanism);
  Problem problem = {recursive::buildModel(scene.mechanism, number),
                     options.potential ? Terms::all() : Terms::none(),
                     options.damping,
                     options.duration,
                     true,
                     true,
                     {},
                     recursive::Constraints<double>(),
                     {}};
  problem.closures = recursive::buildConstraints(scene.mechanism, number, problem.model);
  require(options.duration > 0 && std::isfinite(options.duration),
          fmt::format("duration is {} s, allowed: positive", options.duration));
  require(options.damping >= 0 && std::isfinite(options.damping),
          fmt::format("damping is {}, allowed: zero or more", options.damping));
  require(options.paths >= 1, fmt::format("{} paths, allowed: one or more", options.paths));
  problem.start.slots = givenOr("start q", options.q, inDouble(scene, scene.start_q));
  problem.start.qd = givenOr("start qd", options.qd, inDouble(scene, scene.start_qd));
  problem.surface = surfaceNear(scene, problem.start.slots, problem.start.qd);
  problem.start = {problem.surface.q, problem.surface.qd};
  requireSquares("velocity", problem.start.qd, weightsAt(problem.model, problem.start.slots));
  for (const auto& link : problem.model.links)
    if (recursive::axisCount(link.kind) > 1) problem.coordinates = false;
  problem.conservative =
      options.damping == 0 && (!options.potential || scene.mechanism.wrenches.empty());
  if (scene.mechanism.closures.empty()) return problem;
  problem.coordinates = false;
  require(problem.conservative,
          "friction or wrenches on a closed mechanism, allowed: a tree, or neither");
  require(problem.n() > 0, "closures leave nothing free to move");
  return problem;
}

Sines variation(const scene::Scene& scene, int n, std::uint64_t seed, int index) {
  RandomStream random(scene.name + " variation", seed, index);
  Sines zeta;
  for (int i = 0; i < n; ++i) {
    zeta.a.emplace_back();
    for (int m = 0; m < kSines; ++m) zeta.a[i].push_back(random.uniform(-1, 1) / kSines);
  }
  return zeta;
}

/// When equal steps over `duration` leave the numbers [s]; never: infinity.
double leavesNumbers(const Problem& problem, double duration, int steps) {
  Flow<double> flow = problem.flow<double>();
  PhasePoint<double> y = problem.start;
  const double h = duration / steps;
  for (int k = 1; k <= steps; ++k) {
    y = flow.step(y, h);
    if (!isFinite(y.slots, y.qd)) return h * k;
  }
  return std::numeric_limits<double>::infinity();
}

void requireMotionAtStart(const Problem& problem) {
  Flow<double> flow = problem.flow<double>();
  require(isFinite(flow.slotRates(problem.start), flow.accelerations(problem.start)),
          "qdd is not finite at the start: M is singular there, or the numbers are too large; "
          "allowed: a start from which it moves");
}

/// The two finest sizes of steps are needed, and one of them left the numbers.
[[noreturn]] void refuseUnresolved(const Problem& problem) {
  const double duration = problem.duration;
  double left = std::numeric_limits<double>::infinity();
  int steps = kMostSteps / 2;
  for (; steps <= kMostSteps; steps *= 2) {
    left = leavesNumbers(problem, duration, steps);
    if (std::isfinite(left)) break;
  }
  double passed = duration / 2;
  while (std::isfinite(leavesNumbers(problem, passed, kMostSteps / 2))) passed /= 2;
  throw scene::InputError(
      {}, fmt::format("duration is {} s: {} steps of {:.3g} s leave the numbers at t = {:.6g} s, "
                      "these steps do not resolve the motion; allowed: a shorter duration; of its "
                      "halves, {:.6g} s is the first that {} steps end",
                      duration, steps, duration / steps, left, passed, kMostSteps / 2));
}

/** The second variation: how many directions lower the action. Where that and conjugate times
    differ, one eigenvalue has the wrong sign. It is wrong only if it is farther from 0 than steps
    of twice the length move it.
    @param sharp  conjugate times are the same at two sizes of steps */
void countDirections(const Problem& problem, const std::vector<Node>& nodes, bool sharp,
                     Action* out, Lines* slowest) {
  CheckResult check =
      describe("directions that lower the action",
               "negative eigenvalues of the second variation = conjugate times", "S", "T - V");
  check.right = "articulated_body";
  check.unit = Unit::kDirections;
  if (problem.n() > kMostDof) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = fmt::format("{} freedoms; the second variation is formed for at most {}",
                               problem.n(), kMostDof);
    out->checks.push_back(check);
    return;
  }
  std::vector<Eigen::MatrixXd> H = hessians(problem, nodes);
  int expected = 0;
  for (const Action::Conjugate& conjugate : out->conjugates) expected += conjugate.multiplicity;
  // lines from node to node can miss a direction, never add one: finer ones until none is missed
  int coarse = negativeDirections(problem, H, 2);
  out->negative = negativeDirections(problem, H, 1);
  int steps = out->steps;
  while (out->negative < expected && 2 * steps <= kMostSteps) {
    steps *= 2;
    coarse = out->negative;
    H = hessians(problem, motionOf(problem, steps));
    out->negative = negativeDirections(problem, H, 1);
  }
  out->lowest = eigenvalue(problem, H, 1);
  if (out->negative > 0) *slowest = lowestDirection(problem, H, out->lowest);
  check.worst = std::abs(out->negative - expected);
  check.limit = 0;
  const std::string counts =
      fmt::format("{} negative eigenvalues, {} conjugate times", out->negative, expected);
  if (out->negative != expected && (!sharp || out->negative != coarse)) {
    leaveOpen(&check, fmt::format("{}; steps of twice the length count others: {} steps do not "
                                  "decide",
                                  counts, steps));
  } else if (out->negative != expected) {
    const int number = std::min(out->negative, expected) + 1;
    const double fine = eigenvalue(problem, H, number),
                 moved = std::abs(
                     eigenvalue(problem, hessians(problem, motionOf(problem, steps / 2)), number) -
                     fine);
    if (std::abs(fine) <= moved) {
      leaveOpen(&check, fmt::format("{}; eigenvalue {} is {:.3g}, and {} steps for {} move it by "
                                    "{:.3g}: they do not decide",
                                    counts, number, fine, steps / 2, steps, moved));
    } else {
      check.verdict = Verdict::kDisagree;
      check.ratio = std::numeric_limits<double>::infinity();
      check.reason = counts;
    }
  }
  out->checks.push_back(check);
}

/// Whether S of the paths near by is larger or smaller, as far as it is sure.
void judgePaths(const std::vector<Action::Path>& paths, int negative, CheckResult* nearby) {
  nearby->states = 0;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const Action::Path& path = paths[k];
    const bool is_slow = path.kind == Action::Path::Kind::kSlowest, is_lower = path.change < 0;
    if (negative > 0 && !is_slow && path.kind != Action::Path::Kind::kFast)
      continue;  // may be either
    ++nearby->states;
    if (!(std::abs(path.change) > path.unsure)) {
      nearby->addVoided(static_cast<int>(k),
                        fmt::format("{}: S changes by {:.3g} J s, sure to within {:.3g}", path.name,
                                    path.change, path.unsure),
                        false);
    } else if (is_lower != is_slow) {
      nearby->worst += 1;
      nearby->verdict = Verdict::kDisagree;
      nearby->ratio = std::numeric_limits<double>::infinity();
      nearby->reason += fmt::format("{}: S changes by {:.3g} J s; ", path.name, path.change);
    }
  }
  if (nearby->verdict == Verdict::kDisagree) return;
  // one path that is higher shows a minimum as far as paths can; a saddle takes both
  if (nearby->judged() < (negative > 0 ? 2 : 1)) leaveOpen(nearby, nearby->voided_reason);
}

/** Nothing is said where the steps round the place by as much as varied paths are away from it: at
    1e16 rad a pendulum moves by 2 rad or not at all. */
void judgePlaces(const std::vector<Node>& nodes, Action* out) {
  double farthest = 0;
  for (const Node& node : nodes)
    for (const double q : node.slots) farthest = std::max(farthest, std::abs(q));
  const double rounded = kRoundedByStep * farthest * out->steps;
  if (rounded < kAmplitude) return;
  for (CheckResult& check : out->checks)
    leaveOpen(&check, fmt::format("at a place of {:.3g}, {} steps round it by up to {:.3g}; varied "
                                  "paths are {} away",
                                  farthest, out->steps, rounded, kAmplitude));
}

}  // namespace

void judgeOrder(CheckResult* check, const std::vector<StepResidual>& seen, double size,
                const std::function<double()>& moved, int steps) {
  const StepResidual &fine = seen.back(), &coarse = seen[seen.size() - 2];
  const double rounding = std::numeric_limits<double>::epsilon() * fine.terms * steps;
  const double order = std::log2(coarse.worst / fine.worst);
  check->limit = kOrder - 1;
  check->unit = Unit::kObservedOrder;
  check->worst = order;
  if (!std::isfinite(fine.worst) || !std::isfinite(rounding)) {
    leaveOpen(check, fmt::format("it leaves the numbers in {} steps", steps));
    return;
  }
  if (fine.worst > rounding && std::isfinite(coarse.worst) && order > check->limit) {
    check->ratio = check->limit / order;
    return;
  }
  const double floor = fine.worst <= rounding ? rounding : rounding + moved();
  if (!std::isfinite(floor) || (floor >= size && size > 0)) {
    leaveOpen(check, fmt::format("not by {} steps: they round {:.3g} to within {:.3g}", steps, size,
                                 floor));
    return;
  }
  if (fine.worst <= floor) {
    check->unit = Unit::kRoundingOfSteps;
    check->worst = floor > 0 ? fine.worst / floor : 0;
    check->limit = 1;
    check->ratio = check->worst;
    return;
  }
  const std::string course =
      fmt::format("falls with order {:.2f} to {:.3g} at {} steps", order, fine.worst, steps);
  if (seen.size() > 2) {
    double largest = 0;
    for (const double x : fine.at) largest = std::max(largest, std::abs(x));
    const double last = largestDifference(fine.at, coarse.at),
                 before = largestDifference(coarse.at, seen[seen.size() - 3].at);
    const bool is_settled = last <= floor || std::log2(before / last) > kOrder - 1;
    if (is_settled && largest > floor + last) {
      check->ratio = std::numeric_limits<double>::infinity();
      check->verdict = Verdict::kDisagree;
      check->reason = fmt::format("{}, where it stays; {} is expected", course, kOrder);
      return;
    }
  }
  leaveOpen(check, course + ": these steps do not follow the motion closely enough to tell");
}

namespace {

/// Largest magnitude of a member.
double largest(const std::vector<FirstVariation>& all, double FirstVariation::*member) {
  double most = 0;
  for (const FirstVariation& one : all) most = std::max(most, std::abs(one.*member));
  return most;
}

/// A motion by ever more steps, until what must vanish on it is seen to vanish.
class Refinement {
 public:
  Refinement(const Problem& problem, const std::vector<Sines>& variations,
             const ActionOptions& options, scene::Work& work)
      : problem(problem), variations_(variations), options_(options), work_(work) {}

  /// Twice the steps. Where they leave the numbers all begins anew: finer ones may do.
  void follow(int count);
  /// Whether more steps would say nothing new.
  bool tells() const {
    return sharp && !checks.empty() &&
           std::all_of(checks.begin(), checks.end(),
                       [](const CheckResult& c) { return c.verdict == Verdict::kAgree; });
  }

  const Problem& problem;
  int steps = 0;
  std::vector<Node> nodes;
  std::vector<FirstVariation> fine, coarse;  ///< one a variation, by these steps and half of them
  std::vector<CheckResult> checks;           ///< none before two sizes of steps end
  std::vector<Action::Conjugate> conjugates;
  bool sharp = false;  ///< conjugate times are the same at both

 private:
  CheckResult hamilton() const;
  CheckResult late() const;
  CheckResult symmetric() const;
  void compareConjugates();

  const std::vector<Sines>& variations_;
  const ActionOptions& options_;
  scene::Work& work_;
  JacobiFields fields_, fields_coarse_;
  std::vector<StepResidual> seen_hamilton_, seen_late_, seen_symmetric_;
};

void Refinement::follow(int count) {
  nodes = motionOf(problem, count);
  if (!isFinite(nodes.back().slots, nodes.back().qd)) {
    fine.clear();
    checks.clear();
    for (auto* seen : {&seen_hamilton_, &seen_late_, &seen_symmetric_}) seen->clear();
    return;
  }
  steps = count;
  coarse = std::move(fine);
  fine.clear();
  for (const Sines& zeta : variations_) fine.push_back(firstVariation(problem, nodes, zeta));
  seen_hamilton_.emplace_back();
  for (const FirstVariation& one : fine) seen_hamilton_.back().add(one.with_forces, true);
  seen_hamilton_.back().terms = largest(fine, &FirstVariation::size);
  if (problem.conservative) {
    fields_coarse_ = std::move(fields_);
    fields_ = jacobiFields(problem, steps, work_);
    seen_late_.push_back(fields_.late);
    seen_symmetric_.push_back(fields_.unsymmetric);
  }
  if (coarse.empty()) return;
  checks = {hamilton()};
  if (problem.conservative) {
    checks.push_back(late());
    // one alone is symmetric by itself
    if (problem.coordinates && problem.n() > 1) checks.push_back(symmetric());
  }
  compareConjugates();
}

CheckResult Refinement::hamilton() const {
  CheckResult check =
      problem.conservative
          ? describe("Hamilton's principle", "dS(eta) = 0 for every eta that vanishes at both ends",
                     "dS", "T - V")
          : describe("d'Alembert's and Lagrange's principle",
                     "dS(eta) + integral of Q' eta = 0 for every eta that vanishes at both ends",
                     "dS", "T - V, Q");
  check.right = "articulated_body";
  check.seed = options_.seed;
  check.states = options_.paths;
  judgeOrder(
      &check, seen_hamilton_, seen_hamilton_.back().terms,
      [&] { return movedByRounding(problem, nodes); }, steps);
  return check;
}

CheckResult Refinement::late() const {
  CheckResult check =
      describe("a motion and the same a little later are neighbours",
               "(qd, qdd) solves the variational equation", "J", "articulated_body");
  judgeOrder(
      &check, seen_late_, fields_.size_late + fields_.growth, [] { return 0.0; }, steps);
  return check;
}

CheckResult Refinement::symmetric() const {
  CheckResult check = describe("neighbours of one place stay Lagrangian",
                               "A'P = P'A, P the momenta of A", "J", "articulated_body");
  check.right = "composite_body";
  const auto moved = [&] {
    double most = 0;
    for (const auto& now : fields_.shared) most = std::max(most, movedByRounding(problem, now));
    return most * steps;
  };
  judgeOrder(&check, seen_symmetric_, fields_.unsymmetric.terms, moved, steps);
  return check;
}

void Refinement::compareConjugates() {
  conjugates = fields_.conjugates;
  sharp = conjugates.size() == fields_coarse_.conjugates.size();
  for (std::size_t k = 0; k < conjugates.size(); ++k) {
    conjugates[k].error = sharp ? std::abs(conjugates[k].time - fields_coarse_.conjugates[k].time)
                                : std::numeric_limits<double>::infinity();
    sharp = sharp && conjugates[k].error <= options_.duration / kSharp;
  }
}

/// How far T + V is from its value at the start, at most [J].
double energyDrift(const Problem& problem, const std::vector<Node>& nodes) {
  recursive::Workspace<double> ws(problem.model);
  double start = 0, drift = 0;
  for (const Node& node : nodes) {
    const auto x = slotPositions(node.slots);
    double E = recursive::kineticEnergy(problem.model, x, node.qd, ws);
    if (problem.terms.gravity) E += recursive::potentialEnergy(problem.model, x, ws);
    if (&node == &nodes.front()) start = E;
    drift = std::max(drift, std::abs(E - start));
  }
  return drift;
}

/** S(q + zeta) - S(q) of a path that is to decide, by twice the steps and half the amplitude until
    it does: dS, which is 0 but for the steps, falls with their order, higher variations with the
    amplitude. */
void decide(const Refinement& motion, const Sines& zeta, Action::Path* path) {
  std::vector<Node> nodes = motion.nodes;
  for (int steps = motion.steps;; steps *= 2, path->amplitude /= 2) {
    if (steps > motion.steps) nodes = motionOf(motion.problem, steps);
    path->first = firstVariation(motion.problem, nodes, zeta).with_forces;
    const PathAction own = actionOf(motion.problem, nodes, nullptr, 0);
    path->put(changeOf(motion.problem, nodes, own, zeta, path->first, path->amplitude));
    if (path->isSure() || 2 * steps > kMostSteps) return;
  }
}
/// The same of lines, which begin with the steps that they are made of.
void decide(const Refinement& motion, const Lines& eta, Action::Path* path) {
  std::vector<Node> coarse = motionOf(motion.problem, 2 * eta.parts());
  for (int steps = 4 * eta.parts();; steps *= 2, path->amplitude /= 2) {
    std::vector<Node> nodes = motionOf(motion.problem, steps);
    path->put(changeAlong(motion.problem, nodes, coarse, eta, path->amplitude, &path->first));
    if (path->isSure() || steps > kMostSteps) return;
    coarse = std::move(nodes);
  }
}

/// S, S of paths near by, and whether they are as the second variation says of all of them.
void showPaths(const Refinement& motion, const std::vector<Sines>& variations, const Lines& slowest,
               Action* out) {
  using Kind = Action::Path::Kind;
  const Problem& problem = motion.problem;
  const PathAction own = actionOf(problem, motion.nodes, nullptr, 0);
  out->action = own.by_all.value();
  for (std::size_t k = 0; k < variations.size(); ++k) {
    Action::Path path{Kind::kDrawn, fmt::format("path {}", k + 1), kAmplitude,
                      motion.fine[k].with_forces};
    path.put(changeOf(problem, motion.nodes, own, variations[k], path.first, kAmplitude));
    out->paths.push_back(path);
  }
  if (!problem.conservative || out->negative < 0) return;
  CheckResult nearby =
      out->negative == 0
          ? describe("the action is smallest", "S(q + eta) > S(q)", "S", "T - V")
          : describe("the action is a saddle", "S(q + slow) < S(q) < S(q + fast)", "S", "T - V");
  nearby.unit = Unit::kPaths;
  nearby.limit = 0;
  if (out->negative > 0) {
    Sines fast;  // more half waves than directions that lower
    fast.a.assign(problem.n(), Values(4 * std::max(kHalfWaves, out->negative), 0.0));
    fast.a.back().back() = 1;
    out->paths.push_back({Kind::kSlowest, "slow", kAmplitude});
    decide(motion, slowest, &out->paths.back());
    out->paths.push_back({Kind::kFast, "fast", kAmplitude});
    decide(motion, fast, &out->paths.back());
  }
  judgePaths(out->paths, out->negative, &nearby);
  out->checks.push_back(nearby);
}

}  // namespace

Action measureAction(const scene::Scene& scene, const ActionOptions& options) {
  const Problem problem = problemOf(scene, options);
  std::vector<Sines> variations;
  for (int k = 0; k < options.paths; ++k)
    variations.push_back(variation(scene, problem.n(), options.seed, k));
  requireMotionAtStart(problem);
  scene::Work work("neighbouring motions, with twice the steps until they tell", 1);
  Refinement motion(problem, variations, options, work);
  for (int steps = kFirstSteps; steps <= kMostSteps && !motion.tells(); steps *= 2)
    motion.follow(steps);
  if (motion.checks.empty()) refuseUnresolved(problem);

  Action out;
  out.dof = problem.n();
  out.duration = options.duration;
  out.conservative = problem.conservative;
  out.steps = motion.steps;
  out.checks = motion.checks;
  out.conjugates = motion.conjugates;
  if (!problem.conservative) {
    out.with_work = largest(motion.fine, &FirstVariation::with_work);
    out.with_work_coarse = largest(motion.coarse, &FirstVariation::with_work);
  }
  Lines slowest;
  if (problem.conservative) {
    countDirections(problem, motion.nodes, motion.sharp, &out, &slowest);
    out.energy_drift = energyDrift(problem, motion.nodes);
  }
  showPaths(motion, variations, slowest, &out);
  judgePlaces(motion.nodes, &out);
  return out;
}

}  // namespace dynwitness::crosscheck
