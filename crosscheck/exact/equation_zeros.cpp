// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/equation_zeros.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using F = PrimeField;
using recursive::Force;
using recursive::Motion;
using recursive::Terms;
using FieldVector = recursive::Vector3<F>;
using FieldModel = recursive::Model<F>;
using FieldState = scene::State<F>;

/// Rates beyond which M is not looked through: it has n^2 entries, and n more matrices for c.
constexpr int kMostOfM = 128;
/// And products of rates: n^2 / 2 sweeps.
constexpr int kMostOfProducts = 40;
/// Points in a row without a value before it is given up: all of a divisor that vanishes by chance.
constexpr int kMostLost = 8;

enum class Why {
  kNone,
  kBranches,
  kSlidesAcross,
  kSlideAlongTurn,
  kWeightless,
  kBalancedAcross,
  kBalancedSlide,
  kPlaneOfAxis,
  kSlidesInPlane,
  kNoGravity,
  kGravityAlong,
  kGravityAcross,
  kCenterOnAxis,
  kConstantM,
  kConstantMomentum,
  kUnchanged,
  kCancel
};

const char* words(Why why) {
  switch (why) {
    case Why::kNone:
      return Ledger::kNoSimpleReason;
    case Why::kBranches:
      return "independent branches: neither carries the other";
    case Why::kSlidesAcross:
      return "two slides at right angles";
    case Why::kSlideAlongTurn:
      return "a slide along the axis of a turn";
    case Why::kWeightless:
      return "nothing that it carries weighs anything";
    case Why::kBalancedAcross:
      return "the outer joint's load is balanced about its axis, and the axes are at right angles";
    case Why::kBalancedSlide:
      return "the outer joint's load is balanced about its axis: no slide feels it turn";
    case Why::kPlaneOfAxis:
      return "symmetry: the outer joint's load moves in a plane in which the inner axis lies";
    case Why::kSlidesInPlane:
      return "the centre of mass slides in a plane with the axis of the turn";
    case Why::kNoGravity:
      return "no gravity";
    case Why::kGravityAlong:
      return "gravity is along the axis";
    case Why::kGravityAcross:
      return "the slide is at right angles to gravity";
    case Why::kCenterOnAxis:
      return "the centre of mass of all that it carries is on its axis";
    case Why::kConstantM:
      return "M does not depend on q";
    case Why::kConstantMomentum:
      return "its row of M is constant, and M does not change with it";
    case Why::kUnchanged:
      return "no joint's motion changes an entry of M that would be felt";
    case Why::kCancel:
      return "what their motion changes in M cancels";
  }
  return "";
}

/// Holds whatever the links weigh.
bool isOfAxesAlone(Why why) {
  return why == Why::kBranches || why == Why::kSlidesAcross || why == Why::kSlideAlongTurn ||
         why == Why::kGravityAlong || why == Why::kGravityAcross;
}
/// Does not.
bool isOfMasses(Why why) {
  return why == Why::kWeightless || why == Why::kBalancedAcross || why == Why::kBalancedSlide ||
         why == Why::kPlaneOfAxis || why == Why::kSlidesInPlane || why == Why::kCenterOnAxis;
}

bool isZero(const FieldVector& v) {
  return v.x().isZero() && v.y().isZero() && v.z().isZero();
}
bool isZero(const Force<F>& f) {
  return isZero(f.force) && isZero(f.moment);
}

// ---- one point ----------------------------------------------------------------------------------

/// The entries, in the order of the list that is printed.
struct Entries {
  std::vector<F> M, c, products, g;  ///< M_ij with i <= j, c_i, c_ijk with j <= k, g_i
};

/// By the sweeps.
class Sweeps {
 public:
  explicit Sweeps(const FieldModel& model) : model_(model), ws_(model) {}

  recursive::MatrixX<F> M(const FieldState& state) {
    recursive::MatrixX<F> M(model_.dof(), model_.dof());
    recursive::massMatrix(model_, state.x, ws_, M);
    return M;
  }
  std::vector<F> c(const FieldState& state, const std::vector<F>& qd) {
    return inverse(state, qd, Terms::none());
  }
  Entries entries(const FieldState& state, bool with_products = true) {
    const int n = model_.dof();
    Entries out;
    out.c = c(state, state.qd);
    out.g = inverse(state, zeros(), Terms::potential());
    if (n <= kMostOfM) {
      const recursive::MatrixX<F> all = M(state);
      for (int i = 0; i < n; ++i)
        for (int j = i; j < n; ++j) out.M.push_back(all(i, j));
    }
    if (with_products && n <= kMostOfProducts) products(state, &out);
    return out;
  }

 private:
  std::vector<F> zeros() const {
    return std::vector<F>(static_cast<std::size_t>(model_.dof()), F(0));
  }
  std::vector<F> inverse(const FieldState& state, const std::vector<F>& qd, Terms terms) {
    std::vector<F> tau = zeros();
    recursive::inverseDynamics(model_, state.x, qd, zeros(), ws_, tau, terms);
    return tau;
  }
  void products(const FieldState& state, Entries* out) {
    const std::size_t n = zeros().size();
    std::vector<std::vector<F>> squares, all;
    for (std::size_t j = 0; j < n; ++j) {
      std::vector<F> one = zeros();
      one[j] = F(1);
      squares.push_back(c(state, one));
    }
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = j; k < n; ++k) {
        if (j == k) {
          all.push_back(squares[j]);
          continue;
        }
        std::vector<F> both = zeros();
        both[j] = both[k] = F(1);
        std::vector<F> product = c(state, both);
        for (std::size_t i = 0; i < n; ++i) product[i] -= squares[j][i] + squares[k][i];
        all.push_back(std::move(product));
      }
    for (std::size_t i = 0; i < n; ++i)
      for (const std::vector<F>& product : all) out->products.push_back(product[i]);
  }

  const FieldModel& model_;
  recursive::Workspace<F> ws_;
};

/// Axes, and what they carry, in the world's axes about its origin.
class Layout {
 public:
  Layout(const FieldModel& model, const FieldState& state) : model_(model) {
    const std::size_t links = model.links.size();
    for (std::size_t l = 0; l < links; ++l) {
      const recursive::LinkModel<F>& link = model.links[l];
      const recursive::Transform<F> X_up = recursive::AnyJoints::transform(link, state.x);
      X_.push_back(link.parent < 0 ? X_up : X_up * X_[static_cast<std::size_t>(link.parent)]);
      carried_.push_back(X_.back().inverseTimes(link.M));
    }
    for (std::size_t l = links; l-- > 0;)
      if (const int parent = model.links[l].parent; parent >= 0)
        carried_[static_cast<std::size_t>(parent)] =
            carried_[static_cast<std::size_t>(parent)] + carried_[l];
    for (int d = 0; d < model.dof(); ++d) {
      const int l = model.link_of_dof[static_cast<std::size_t>(d)];
      const recursive::LinkModel<F>& link = model.links[static_cast<std::size_t>(l)];
      const recursive::Vector6<F> z = recursive::jointAxis(link, d - link.dof);
      axes_.push_back(X_[static_cast<std::size_t>(l)].inverseTimes(
          Motion<F>{z.template head<3>(), z.template tail<3>()}));
    }
  }

  /// Has an axis of its own: no other joint moves with this rate, and no rotor with others besides.
  bool isOwn(int d) const {
    for (const recursive::LinkModel<F>& link : model_.links)
      if (link.dof == d && (link.follows || link.adds)) return false;
    return std::none_of(model_.rotors.begin(), model_.rotors.end(), [d](const auto& rotor) {
      return rotor.dof <= d && d < rotor.dof + static_cast<int>(rotor.ratio.size());
    });
  }
  bool slides(int d) const { return isZero(axis(d).angular); }
  bool turns(int d) const {
    const Motion<F> own = X_[link(d)] * axis(d);
    return !isZero(own.angular) && own.angular.dot(own.linear).isZero();
  }
  bool isWeightless(int d) const {
    const recursive::RigidInertia<F>& W = carried_[link(d)];
    return W.mass.isZero() && isZero(W.h) && isZero(W * axis(d));
  }

  Why ofM(int i, int j) const {
    if (!isOwn(i) || !isOwn(j)) return Why::kNone;
    if (!carries(i, j)) {
      if (!carries(j, i)) return Why::kBranches;
      std::swap(i, j);
    }
    const Motion<F>&a = axis(i), &b = axis(j);
    if (slides(i) && slides(j))
      return a.linear.dot(b.linear).isZero() ? Why::kSlidesAcross
             : isWeightless(j)               ? Why::kWeightless
                                             : Why::kNone;
    if (isSpinFelt(i, j)) return Why::kNone;
    if (slides(i) && turns(j) && isZero(FieldVector(a.linear.cross(b.angular))))
      return Why::kSlideAlongTurn;
    if (turns(i) && slides(j) && isZero(FieldVector(b.linear.cross(a.angular))))
      return Why::kSlideAlongTurn;
    if (isWeightless(j)) return Why::kWeightless;
    if (turns(j)) return ofTurn(i, j);
    return turns(i) && slides(j) && slidesInPlane(i, j) ? Why::kSlidesInPlane : Why::kNone;
  }

  Why ofGravity(int i) const {
    const FieldVector& gamma = model_.gravity;
    if (isZero(gamma)) return hasSpring(i) ? Why::kNone : Why::kNoGravity;
    if (!isOwn(i) || hasSpring(i)) return Why::kNone;
    if (slides(i) && axis(i).linear.dot(gamma).isZero()) return Why::kGravityAcross;
    if (turns(i) && isZero(FieldVector(axis(i).angular.cross(gamma)))) return Why::kGravityAlong;
    const recursive::RigidInertia<F>& W = carried_[link(i)];
    if (W.mass.isZero() && isZero(W.h)) return Why::kWeightless;
    const FieldVector h = W.h - origin(i) * W.mass;
    if (turns(i) && isZero(FieldVector(h.cross(axis(i).angular)))) return Why::kCenterOnAxis;
    return Why::kNone;
  }

 private:
  std::size_t link(int d) const {
    return static_cast<std::size_t>(model_.link_of_dof[static_cast<std::size_t>(d)]);
  }
  const Motion<F>& axis(int d) const { return axes_[static_cast<std::size_t>(d)]; }
  /// On the axis: the origin of its link.
  const FieldVector& origin(int d) const { return X_[link(d)].p; }
  bool carries(int inner, int outer) const {
    const auto wanted = static_cast<int>(link(inner));
    int l = static_cast<int>(link(outer));
    while (l >= 0 && l != wanted) l = model_.links[static_cast<std::size_t>(l)].parent;
    return l == wanted;
  }
  bool hasSpring(int d) const {
    return std::any_of(model_.links.begin(), model_.links.end(),
                       [d](const auto& link) { return link.dof == d && !link.stiffness.isZero(); });
  }
  /// The rotor of j on the link inboard, about the axis of j, when i turns that link.
  bool isSpinFelt(int i, int j) const {
    const FieldVector z = X_[link(j)].R.row(2).transpose();
    return !model_.links[link(j)].spin.isZero() && !axis(i).angular.dot(z).isZero();
  }

  /// j turns; its load's momentum is a force across z, and a moment.
  Why ofTurn(int i, int j) const {
    const FieldVector& z = axis(j).angular;
    const Force<F> momentum = carried_[link(j)] * axis(j);
    const FieldVector& f = momentum.force;
    const FieldVector n = momentum.moment - origin(j).cross(f);
    const FieldVector tilt =
        n * z.dot(z) - z * z.dot(n);  // z'z times the moment's part across the axis
    const bool is_balanced = isZero(f) && isZero(tilt);
    if (slides(i)) return is_balanced ? Why::kBalancedSlide : Why::kNone;
    if (!turns(i) || !axis(i).angular.dot(z).isZero()) return Why::kNone;
    if (is_balanced) return Why::kBalancedAcross;
    // about the point t z from there the moment is along z, if there is one: n - t z x f
    const FieldVector across = z.cross(f);
    if (isZero(f) || !isZero(FieldVector(tilt.cross(across)))) return Why::kNone;
    const F t = tilt.dot(across) / (across.dot(across) * z.dot(z));
    return (origin(i) - origin(j) - z * t).dot(z).isZero() ? Why::kPlaneOfAxis : Why::kNone;
  }
  bool slidesInPlane(int i, int j) const {
    const recursive::RigidInertia<F>& W = carried_[link(j)];
    const FieldVector h = W.h - origin(i) * W.mass;
    return axis(i).angular.dot(h.cross(axis(j).linear)).isZero();
  }

  const FieldModel& model_;
  std::vector<recursive::Transform<F>> X_;  ///< world to link
  std::vector<recursive::RigidInertia<F>> carried_;
  std::vector<Motion<F>> axes_;
};

/// Which entries of M change when which joints move.
class Changes {
 public:
  Changes(const scene::Mechanism& mechanism, const FieldSource& source, const FieldModel& model,
          const FieldState& state) {
    Sweeps sweeps(model);
    const recursive::MatrixX<F> M = sweeps.M(state);
    const FieldState other = indeterminateState(mechanism, source);
    moved_by_all_ = differences(M, sweeps.M(other));
    for (int k = 0; k < model.dof(); ++k) {
      const recursive::LinkModel<F>& link =
          model.links[static_cast<std::size_t>(model.link_of_dof[static_cast<std::size_t>(k)])];
      FieldState moved = state;
      moved.x[static_cast<std::size_t>(link.slot)] = other.x[static_cast<std::size_t>(link.slot)];
      moved_by_.push_back(differences(M, sweeps.M(moved)));
    }
  }

  Why ofC(int i) const {
    if (!moved_by_all_.any()) return Why::kConstantM;
    if (!moved_by_all_.row(i).any() && !moved_by_[static_cast<std::size_t>(i)].any())
      return Why::kConstantMomentum;
    for (int j = 0; j < static_cast<int>(moved_by_.size()); ++j)
      for (int k = j; k < static_cast<int>(moved_by_.size()); ++k)
        if (!isUnchanged(i, j, k)) return Why::kNone;
    return Why::kUnchanged;
  }
  /// c_ijk = (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) / 2; of i = j dM_jk/dq_i is there twice.
  bool isUnchanged(int i, int j, int k) const {
    const auto by = [this](int q, int row, int column) {
      return moved_by_[static_cast<std::size_t>(q)](row, column);
    };
    if (i == j) return !by(k, i, i);
    if (i == k) return !by(j, i, i);
    return !by(k, i, j) && !by(j, i, k) && !by(i, j, k);
  }

 private:
  using Flags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;
  static Flags differences(const recursive::MatrixX<F>& a, const recursive::MatrixX<F>& b) {
    Flags out(a.rows(), a.cols());
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      for (Eigen::Index j = 0; j < a.cols(); ++j) out(i, j) = a(i, j) != b(i, j);
    return out;
  }
  Flags moved_by_all_;
  std::vector<Flags> moved_by_;
};

/// The model with other bodies, whatever they weigh.
FieldModel withAnyBodies(FieldModel model, const FieldSource& source) {
  int k = 0;
  const auto any = [&] { return source.element(fmt::format("body {}", k++)); };
  for (recursive::LinkModel<F>& link : model.links) {
    link.M.mass = any();
    for (F* x : {&link.M.h.x(), &link.M.h.y(), &link.M.h.z(), &link.M.I.xx, &link.M.I.yy,
                 &link.M.I.zz, &link.M.I.xy, &link.M.I.xz, &link.M.I.yz})
      *x = any();
  }
  return model;
}

// ---- all points ---------------------------------------------------------------------------------

/// What is known of one entry so far.
struct Known {
  bool zero = true;         ///< at all points
  bool zero_of_any = true;  ///< with any bodies
  std::optional<Why> why;   ///< by rule, the same at all points
  void add(Why here) { why = !why || *why == here ? here : Why::kNone; }
};

class Search {
 public:
  Search(const scene::Scene& scene, std::uint64_t seed, double error_probability)
      : scene_(scene), seed_(seed) {
    double chance = 0;
    {
      const FormulaSizes sizes;
      const FieldSource source(scene.name, seed, 0);
      const FieldModel model = modelOf(source);
      n_ = model.dof();
      Entries entries = Sweeps(model).entries(indeterminateState(scene.mechanism, source), false);
      // c of rates 0 and 1 is no larger a formula than of any, and a product is three of these
      if (n_ <= kMostOfProducts)
        for (const F& c : entries.c)
          entries.products.insert(entries.products.end(),
                                  static_cast<std::size_t>(n_ * (n_ + 1) / 2), c + c + c);
      std::size_t count = 0;
      for (const std::vector<F>* list : {&entries.M, &entries.c, &entries.products, &entries.g})
        for (const F& entry : *list) {
          chance = std::max(chance, errorProbability(entry, sizes));
          ++count;
        }
      const double all = static_cast<double>(std::max<std::size_t>(count, 1));
      if (!(chance * all < 1)) return;
      points_ = pointsNeeded(chance, error_probability / all);
      out_.error_probability = all * std::pow(chance, points_);
    }
    M_.resize(n_ <= kMostOfM ? static_cast<std::size_t>(n_ * (n_ + 1) / 2) : 0);
    products_.resize(n_ <= kMostOfProducts ? static_cast<std::size_t>(n_ * n_ * (n_ + 1) / 2) : 0);
    c_.resize(static_cast<std::size_t>(n_));
    g_.resize(static_cast<std::size_t>(n_));
  }

  EquationZeros run() {
    int found = 0, lost = 0;
    for (int index = 0; found < points_ && lost < kMostLost; ++index) {
      const PrimeField::Modulus modulus(drawPrime(scene_.name, seed_, index));
      try {
        add(index);
        ++found, lost = 0;
      } catch (const DivisionByZero&) {
        ++lost;
      }
    }
    const std::string failure = points_ == 0 ? "the formulas are too large for primes below 2^63"
                                : found < std::max(points_, 1) ? "no value at any point"
                                                               : "";
    report("M", M_, failure, kMostOfM, [&](auto put) {
      for (int i = 0; i < n_; ++i)
        for (int j = i; j < n_; ++j) put(fmt::format("M_{},{}", i + 1, j + 1));
    });
    const auto ofJoints = [&](const char* letter) {
      return [this, letter](auto put) {
        for (int i = 0; i < n_; ++i) put(fmt::format("{}_{}", letter, i + 1));
      };
    };
    report("c", c_, failure, n_, ofJoints("c"));
    report("c_ijk", products_, failure, kMostOfProducts, [&](auto put) {
      for (int i = 0; i < n_; ++i)
        for (int j = 0; j < n_; ++j)
          for (int k = j; k < n_; ++k) put(fmt::format("c_{},{},{}", i + 1, j + 1, k + 1));
    });
    report("g", g_, failure, n_, ofJoints("g"));
    return std::move(out_);
  }

 private:
  FieldModel modelOf(const FieldSource& source) const {
    return recursive::buildModel(scene_.mechanism, FieldNumbers(scene_.mechanism, source));
  }

  void add(int index) {
    const FieldSource source(scene_.name, seed_, static_cast<std::uint64_t>(index));
    const FieldSource other(scene_.name + ", moved", seed_, static_cast<std::uint64_t>(index));
    const FieldState state = indeterminateState(scene_.mechanism, source);
    const FieldModel model = modelOf(source);
    const FieldModel any = withAnyBodies(model, other);
    const Entries entries = Sweeps(model).entries(state), of_any = Sweeps(any).entries(state);
    const auto note = [](const std::vector<F>& values, const std::vector<F>& others,
                         std::vector<Known>* known) {
      for (std::size_t e = 0; e < known->size(); ++e) {
        (*known)[e].zero = (*known)[e].zero && values[e].isZero();
        (*known)[e].zero_of_any = (*known)[e].zero_of_any && others[e].isZero();
      }
    };
    note(entries.M, of_any.M, &M_);
    note(entries.c, of_any.c, &c_);
    note(entries.products, of_any.products, &products_);
    note(entries.g, of_any.g, &g_);

    const Layout layout(model, state);
    for (std::size_t i = 0; i < g_.size(); ++i) g_[i].add(layout.ofGravity(static_cast<int>(i)));
    std::size_t e = 0;
    for (int i = 0; i < n_ && !M_.empty(); ++i)
      for (int j = i; j < n_; ++j) M_[e++].add(i == j ? Why::kNone : layout.ofM(i, j));
    addRulesOfC(model, layout, other, state);
  }

  void addRulesOfC(const FieldModel& model, const Layout& layout, const FieldSource& other,
                   const FieldState& state) {
    bool are_derivatives = n_ <= kMostOfM;
    for (int d = 0; d < n_ && are_derivatives; ++d)
      are_derivatives =
          layout.isOwn(d) &&
          recursive::axisCount(
              model.links[static_cast<std::size_t>(model.link_of_dof[static_cast<std::size_t>(d)])]
                  .kind) == 1;
    if (!are_derivatives) return;
    const Changes changes(scene_.mechanism, other, model, state);
    for (int i = 0; i < n_; ++i) c_[static_cast<std::size_t>(i)].add(changes.ofC(i));
    std::size_t e = 0;
    for (int i = 0; i < n_ && !products_.empty(); ++i)
      for (int j = 0; j < n_; ++j)
        for (int k = j; k < n_; ++k)
          products_[e++].add(changes.isUnchanged(i, j, k) ? Why::kUnchanged : Why::kNone);
    are_derivatives_ = true;
  }

  template <typename Names>
  void report(const char* quantity, const std::vector<Known>& known, const std::string& failure,
              int most, const Names& names) {
    Ledger::Zeros zeros;
    zeros.quantity = quantity;
    zeros.not_examined = failure;
    if (n_ > most) zeros.not_examined = fmt::format("not looked for beyond {} rates", most);
    zeros.entries = static_cast<int>(known.size());
    if (zeros.not_examined.empty()) {
      std::size_t e = 0;
      names([&](const std::string& name) { note(name, known[e++], &zeros); });
    }
    out_.of.push_back(std::move(zeros));
  }

  void note(const std::string& name, const Known& entry, Ledger::Zeros* zeros) {
    Why why = entry.why.value_or(Why::kNone);
    if (!entry.zero) {
      if (why != Why::kNone)
        out_.disputes.push_back(fmt::format("{} is not zero, but: {}", name, words(why)));
      return;
    }
    if ((isOfAxesAlone(why) && !entry.zero_of_any) || (isOfMasses(why) && entry.zero_of_any))
      out_.disputes.push_back(fmt::format("{} with other masses is {}zero, but: {}", name,
                                          entry.zero_of_any ? "" : "not ", words(why)));
    // two derivatives of M or three that are not zero, and a sum of them that is
    if (why == Why::kNone && are_derivatives_ && zeros->quantity == "c_ijk") why = Why::kCancel;
    ++zeros->zero;
    auto& groups = zeros->groups;
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const auto& g) { return g.reason == words(why); });
    if (group == groups.end()) group = groups.insert(groups.end(), {words(why), {}});
    group->entries.push_back(name);
  }

  const scene::Scene& scene_;
  std::uint64_t seed_;
  int n_ = 0, points_ = 0;
  bool are_derivatives_ = false;
  std::vector<Known> M_, c_, products_, g_;
  EquationZeros out_;
};

}  // namespace

EquationZeros equationZeros(const scene::Scene& scene, std::uint64_t seed,
                            double error_probability) {
  return Search(scene, seed, error_probability).run();
}

}  // namespace dynwitness::crosscheck
