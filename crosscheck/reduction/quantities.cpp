// SPDX-License-Identifier: GPL-3.0-or-later
// What can be bounded: its parts as polynomials, and its value at one state by the sweeps.
#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/reduction/envelope.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using Kind = EnvelopeQuantity::Kind;

}  // namespace

const std::vector<std::string> kEnvelopeQuantities = {"tau", "qdd", "M",      "c",        "g",
                                                      "T",   "V",   "energy", "reactions"};

std::vector<EnvelopeQuantity> envelopeQuantities(int dof, const std::vector<std::string>& names) {
  const auto isAsked = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<EnvelopeQuantity> out;
  const auto addOneEach = [&](const char* name, Kind kind) {
    for (int i = 0; isAsked(name) && i < dof; ++i) out.push_back({kind, i, 0});
  };
  addOneEach("tau", Kind::kTau);
  addOneEach("qdd", Kind::kQdd);
  for (int i = 0; isAsked("M") && i < dof; ++i)
    for (int j = i; j < dof; ++j) out.push_back({Kind::kM, i, j});
  addOneEach("c", Kind::kC);
  addOneEach("g", Kind::kG);
  if (isAsked("T")) out.push_back({Kind::kT, 0, 0});
  if (isAsked("V")) out.push_back({Kind::kV, 0, 0});
  if (isAsked("energy")) out.push_back({Kind::kEnergy, 0, 0});
  for (int i = 0; isAsked("reactions") && i < dof; ++i)
    for (int k = 0; k < 6; ++k) out.push_back({Kind::kReaction, i, k});
  return out;
}

std::string EnvelopeQuantity::name() const {
  static constexpr const char* kWrench[] = {"fx", "fy", "fz", "mx", "my", "mz"};
  switch (kind) {
    case Kind::kTau:
      return fmt::format("tau_{}", i + 1);
    case Kind::kM:
      return fmt::format("M_{},{}", i + 1, j + 1);
    case Kind::kC:
      return fmt::format("c_{}", i + 1);
    case Kind::kG:
      return fmt::format("g_{}", i + 1);
    case Kind::kT:
      return "T";
    case Kind::kV:
      return "V";
    case Kind::kEnergy:
      return "T + V";
    case Kind::kReaction:
      return fmt::format("reaction_{}.{}", i + 1, kWrench[j]);
    case Kind::kQdd:
      return fmt::format("qdd_{}", i + 1);
  }
  return "";
}

std::vector<EnvelopePart> envelopeParts(const TrigonometricModel& model,
                                        const EnvelopeQuantity& quantity) {
  const auto i = static_cast<std::size_t>(quantity.i), j = static_cast<std::size_t>(quantity.j);
  const int n = model.dof;
  std::vector<EnvelopePart> parts(1);
  if (quantity.kind == Kind::kM) parts[0].f = model.M[i][j];
  if (quantity.kind == Kind::kV || quantity.kind == Kind::kEnergy) parts[0].f = model.potential;
  if (quantity.kind == Kind::kG || quantity.kind == Kind::kTau) parts[0].f = model.gravity[i];
  if (quantity.kind == Kind::kTau) {
    add(model.loads[i], 1, &parts[0].f);
    for (int a = 0; a < n; ++a) parts.push_back({model.M[i][static_cast<std::size_t>(a)], a, -1});
  }
  const auto M = [&](int a, int b) -> const Polynomial& {
    return model.M[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  };
  const auto d = [&](const Polynomial& f, int by) {
    return derivative(f, by, model.slides[static_cast<std::size_t>(by)]);
  };
  for (int a = 0; a < n; ++a)
    for (int b = a; b < n; ++b) {
      Polynomial f;
      if (quantity.kind == Kind::kT || quantity.kind == Kind::kEnergy) {
        add(M(a, b), a == b ? 0.5 : 1, &f);
      } else if (quantity.kind == Kind::kTau || quantity.kind == Kind::kC) {
        // c_i = sum (dM_ia/dq_b - dM_ab/dq_i / 2) qd_a qd_b, both orders of a pair together
        add(d(M(quantity.i, a), b), 1, &f);
        if (a != b) add(d(M(quantity.i, b), a), 1, &f);
        add(d(M(a, b), quantity.i), a == b ? -0.5 : -1, &f);
      }
      if (!f.empty()) parts.push_back({f, a, b});
    }
  return parts;
}

RunningError sweptQuantity(const scene::Scene& scene, const EnvelopeQuantity& quantity,
                           const EnvelopeState& state) {
  const auto model = recursive::buildModel(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  recursive::Workspace<RunningError> ws(model);
  std::vector<scene::JointPosition<RunningError>> x;
  for (const double q : state.q) x.push_back(runningErrorPosition(q));
  const std::vector<RunningError> zero(state.q.size()), qd(state.qd.begin(), state.qd.end()),
      qdd(state.qdd.begin(), state.qdd.end()), given(state.tau.begin(), state.tau.end());
  std::vector<RunningError> tau = zero;
  const auto i = static_cast<std::size_t>(quantity.i);
  switch (quantity.kind) {
    case Kind::kTau:
      recursive::inverseDynamics(model, x, qd, qdd, ws, tau);
      return tau[i];
    case Kind::kC:
      recursive::inverseDynamics(model, x, qd, zero, ws, tau, recursive::Terms::none());
      return tau[i];
    case Kind::kG:
      recursive::inverseDynamics(model, x, zero, zero, ws, tau, recursive::Terms::potential());
      return tau[i];
    case Kind::kQdd:
      recursive::forwardDynamics(model, x, qd, given, ws, tau);
      return tau[i];
    case Kind::kReaction:
      recursive::inverseDynamics(model, x, qd, qdd, ws, tau);
      for (const auto& joint : model.joints)
        if (joint.link == model.link_of_dof[i])
          return (joint.X * ws.f[static_cast<std::size_t>(joint.link)]).vector()(quantity.j);
      return 0;
    case Kind::kT:
      return recursive::kineticEnergy(model, x, qd, ws);
    case Kind::kV:
      return recursive::potentialEnergy(model, x, ws);
    case Kind::kEnergy:
      return recursive::kineticEnergy(model, x, qd, ws) + recursive::potentialEnergy(model, x, ws);
    case Kind::kM:
      break;
  }
  recursive::MatrixX<RunningError> M(model.dof(), model.dof());
  recursive::massMatrix(model, x, ws, M);
  return M(quantity.i, quantity.j);
}

}  // namespace dynwitness::crosscheck
