// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/trigonometric.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Tensor = std::vector<RunningError>;

/// cos and sin of 2 pi k / 5 and 2 pi k / 3, by the surds that they are.
scene::CosSin<RunningError> rootOfUnity(int k, int of) {
  const auto R = [](double x) { return RunningError(x); };
  k = ((k % of) + of) % of;
  if (k == 0) return {R(1), R(0)};
  const bool lower = 2 * k > of;
  const int j = lower ? of - k : k;
  RunningError c, s;
  if (of == 3) {
    c = R(-0.5);
    s = sqrt(R(3)) / R(2);
  } else {
    const RunningError five = sqrt(R(5));
    c = j == 1 ? (five - R(1)) / R(4) : -((five + R(1)) / R(4));
    s = j == 1 ? sqrt(R(10) + R(2) * five) / R(4) : sqrt(R(10) - R(2) * five) / R(4);
  }
  return {c, lower ? -s : s};
}

/// What of one joint's degree: how many values, and how they become coefficients.
struct Axis {
  int degree;
  bool slides;
  int size() const { return degree == 0 ? 1 : slides ? degree + 1 : 2 * degree + 1; }

  scene::JointPosition<RunningError> at(int k) const {
    if (degree == 0) return {RunningError(0), RunningError(1), RunningError(0)};
    if (slides) return {RunningError(k == 2 ? -1 : k), RunningError(1), RunningError(0)};
    const scene::CosSin<RunningError> cs = rootOfUnity(k, size());
    return {RunningError(0), cs.c, cs.s};
  }

  /// Values to coefficients of 1, cos, sin, cos 2, sin 2, or of 1, q, q^2.
  std::vector<RunningError> coefficients(const std::vector<RunningError>& f) const {
    const int n = size();
    if (n == 1) return f;
    if (slides && degree == 1) return {f[0], f[1] - f[0]};
    if (slides)
      return {f[0], (f[1] - f[2]) / RunningError(2), (f[1] + f[2]) / RunningError(2) - f[0]};
    std::vector<RunningError> out(static_cast<std::size_t>(n));
    for (int b = 0; b < n; ++b) {
      RunningError sum = 0;
      for (int k = 0; k < n; ++k) {
        const scene::CosSin<RunningError> cs = rootOfUnity((b + 1) / 2 * k, n);
        sum += f[static_cast<std::size_t>(k)] * (b % 2 == 1 || b == 0 ? cs.c : cs.s);
      }
      out[static_cast<std::size_t>(b)] = (b == 0 ? sum : RunningError(2) * sum) / RunningError(n);
    }
    return out;
  }
};

std::size_t sizeOf(const std::vector<Axis>& axes) {
  std::size_t size = 1;
  for (const Axis& axis : axes) size *= static_cast<std::size_t>(axis.size());
  return size;
}

/// Joint 0 runs fastest.
std::vector<int> indicesAt(const std::vector<Axis>& axes, std::size_t at) {
  std::vector<int> k;
  for (const Axis& axis : axes) {
    const auto size = static_cast<std::size_t>(axis.size());
    k.push_back(static_cast<int>(at % size));
    at /= size;
  }
  return k;
}

Polynomial polynomialOf(Tensor values, const std::vector<Axis>& axes) {
  std::size_t stride = 1;
  for (const Axis& axis : axes) {
    const auto size = static_cast<std::size_t>(axis.size());
    std::vector<RunningError> line(size);
    for (std::size_t at = 0; size > 1 && at < values.size(); ++at) {
      if (at / stride % size != 0) continue;
      for (std::size_t k = 0; k < size; ++k) line[k] = values[at + k * stride];
      const std::vector<RunningError> turned = axis.coefficients(line);
      for (std::size_t k = 0; k < size; ++k) values[at + k * stride] = turned[k];
    }
    stride *= size;
  }
  Polynomial out;
  for (std::size_t at = 0; at < values.size(); ++at) {
    if (values[at].value() == 0 && values[at].bound() == 0) continue;
    Monomial m = 0, power = 1;
    for (const int k : indicesAt(axes, at)) {
      m += static_cast<Monomial>(k) * power;
      power *= kBasis;
    }
    out.emplace_hint(out.end(), m, values[at]);  // they rise with the place
  }
  return out;
}

using Positions = std::vector<scene::JointPosition<RunningError>>;

template <typename Visit>
void onGrid(const std::vector<Axis>& axes, Visit visit) {
  Positions x(axes.size());
  for (std::size_t at = 0; at < sizeOf(axes); ++at) {
    const std::vector<int> k = indicesAt(axes, at);
    for (std::size_t i = 0; i < axes.size(); ++i) x[i] = axes[i].at(k[i]);
    visit(at, x);
  }
}

}  // namespace

namespace {

/// Of what polynomials are made: degrees by joint, and a model that is asked.
struct Asked {
  recursive::Model<RunningError> model;
  std::vector<bool> slides;
  std::vector<Axis> of_M, of_g;
};

/// @throws scene::InputError  as trigonometricModel()
Asked askedModel(const scene::Scene& scene) {
  requireTreated(scene, Command::kEnvelope);
  requireMotion(scene);
  const auto refuse = [&](const std::string& what, int most, const std::string& like) {
    throw scene::InputError({scene.file.string()},
                            fmt::format("{}, allowed: up to {} ({})", what, most, like));
  };
  if (scene.mechanism.dof() > kMostJoints)
    refuse(fmt::format("{} joints move", scene.mechanism.dof()), kMostJoints,
           "seven where they turn in a chain");
  const auto requireWithin = [&](const std::vector<Axis>& axes, int most, const char* what) {
    if (const std::size_t size = sizeOf(axes); size > static_cast<std::size_t>(most))
      refuse(fmt::format("{} would be asked at {} positions", what, size), most,
             "seven joints in a chain that turn, ten side by side");
  };
  Asked out{
      recursive::buildModel(scene.mechanism, RunningErrorNumbers(scene.mechanism)), {}, {}, {}};
  const std::vector<scene::SlotKind> slots = scene.mechanism.slots();
  for (const int i : out.model.link_of_dof) {
    const auto& link = out.model.links[static_cast<std::size_t>(i)];
    out.slides.push_back(slots[out.slides.size()] == scene::SlotKind::kLength);
    out.of_M.push_back({link.parent < 0 ? 0 : 2, out.slides.back()});
    out.of_g.push_back({1, out.slides.back()});
  }
  requireWithin(out.of_M, kMostGridPoints, "M");
  requireWithin(out.of_g, kMostGravityPoints, "gravity");
  return out;
}

std::vector<std::vector<Polynomial>> massMatrix(const Asked& asked) {
  const auto n = static_cast<std::size_t>(asked.model.dof());
  recursive::Workspace<RunningError> ws(asked.model);
  std::vector<Tensor> M(n * n, Tensor(sizeOf(asked.of_M)));
  recursive::MatrixX<RunningError> entries(asked.model.dof(), asked.model.dof());
  onGrid(asked.of_M, [&](std::size_t at, const Positions& x) {
    recursive::massMatrix(asked.model, x, ws, entries);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i; j < n; ++j)
        M[i * n + j][at] = entries(static_cast<int>(i), static_cast<int>(j));
  });
  std::vector<std::vector<Polynomial>> out(n, std::vector<Polynomial>(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j)
      out[i][j] = out[j][i] = polynomialOf(std::move(M[i * n + j]), asked.of_M);
  return out;
}

/// gravity, loads and potential.
void addPotential(const Asked& asked, TrigonometricModel* out) {
  const auto n = static_cast<std::size_t>(asked.model.dof());
  recursive::Workspace<RunningError> ws(asked.model);
  auto without_springs = asked.model;
  for (auto& link : without_springs.links) link.stiffness = 0;
  std::vector<Tensor> g(n, Tensor(sizeOf(asked.of_g))), loads = g;
  Tensor potential(g.front().size());
  const std::vector<RunningError> zero(n);
  std::vector<RunningError> tau(n);
  const auto ask = [&](const Positions& x, recursive::Terms terms, std::size_t at,
                       std::vector<Tensor>* into) {
    recursive::inverseDynamics(asked.model, x, zero, zero, ws, tau, terms);
    for (std::size_t i = 0; i < n; ++i) (*into)[i][at] = tau[i];
  };
  onGrid(asked.of_g, [&](std::size_t at, const Positions& x) {
    ask(x, {true, false, false, false}, at, &g);
    ask(x, {false, false, true, false}, at, &loads);
    potential[at] = recursive::potentialEnergy(without_springs, x, ws);
  });
  for (std::size_t i = 0; i < n; ++i) {
    out->gravity.push_back(polynomialOf(std::move(g[i]), asked.of_g));
    out->loads.push_back(polynomialOf(std::move(loads[i]), asked.of_g));
  }
  out->potential = polynomialOf(std::move(potential), asked.of_g);
}

}  // namespace

TrigonometricModel trigonometricModel(const scene::Scene& scene) {
  const Asked asked = askedModel(scene);
  const scene::Work work("M as a polynomial", 1);
  TrigonometricModel out;
  out.dof = asked.model.dof();
  out.slides = asked.slides;
  for (const int i : asked.model.link_of_dof) {
    const auto& link = asked.model.links[static_cast<std::size_t>(i)];
    out.stiffness.push_back(link.stiffness);
    out.rest.push_back(link.rest);
    out.viscous.push_back(link.viscous);
    out.positive.push_back(link.positive);
    out.negative.push_back(link.negative);
  }
  out.M = massMatrix(asked);
  addPotential(asked, &out);
  return out;
}

std::array<std::vector<EnvelopePart>, 6> reactionParts(const scene::Scene& scene, int rate) {
  const Asked asked = askedModel(scene);
  const int n = asked.model.dof();
  const auto& places = asked.model.joints;
  const auto place = std::find_if(places.begin() + 1, places.end(), [&](const auto& joint) {
    return joint.link == asked.model.link_of_dof[static_cast<std::size_t>(rate)];
  });
  recursive::Workspace<RunningError> ws(asked.model);
  const std::vector<RunningError> zero(static_cast<std::size_t>(n));
  std::vector<RunningError> tau = zero;
  using Wrench = recursive::Vector6<RunningError>;
  const auto wrench = [&](const Positions& x, const std::vector<RunningError>& qd,
                          const std::vector<RunningError>& qdd, recursive::Terms terms) -> Wrench {
    recursive::inverseDynamics(asked.model, x, qd, qdd, ws, tau, terms);
    return (place->X * ws.f[static_cast<std::size_t>(place->link)]).vector();
  };
  const auto unit = [&](int a, int b) {
    std::vector<RunningError> v = zero;
    v[static_cast<std::size_t>(a)] = v[static_cast<std::size_t>(b)] = 1;
    return v;
  };
  std::array<std::vector<EnvelopePart>, 6> out;
  const auto take = [&](const std::vector<Axis>& axes, int j, int k, const auto& ask) {
    std::vector<Tensor> values(6, Tensor(sizeOf(axes)));
    onGrid(axes, [&](std::size_t at, const Positions& x) {
      const Wrench w = ask(x);
      for (std::size_t c = 0; c < 6; ++c) values[c][at] = w(static_cast<Eigen::Index>(c));
    });
    for (std::size_t c = 0; c < 6; ++c)
      if (Polynomial f = polynomialOf(std::move(values[c]), axes); j < 0 || !f.empty())
        out[c].push_back({std::move(f), j, k});
  };
  const scene::Work work("reaction as a polynomial", 1 + n + n * (n + 1) / 2.0);
  const recursive::Terms none = recursive::Terms::none();
  take(asked.of_g, -1, -1, [&](const Positions& x) {
    return wrench(x, zero, zero, {true, false, true, false});
  });
  for (int a = 0; a < n; ++a)
    take(asked.of_M, a, -1, [&](const Positions& x) { return wrench(x, zero, unit(a, a), none); });
  for (int a = 0; a < n; ++a)
    for (int b = a; b < n; ++b)
      take(asked.of_M, a, b, [&](const Positions& x) -> Wrench {
        const Wrench both = wrench(x, unit(a, b), zero, none);
        if (a == b) return both;
        return both - wrench(x, unit(a, a), zero, none) - wrench(x, unit(b, b), zero, none);
      });
  return out;
}

int digit(Monomial m, int k) {
  for (; k > 0; --k) m /= kBasis;
  return static_cast<int>(m % kBasis);
}

double mostOfFactor(int digit, bool slides, double reach, int order) {
  if (!slides) return std::pow((digit + 1) / 2, order);
  double most = order <= digit ? std::pow(reach, digit - order) : 0;
  for (int k = 0; k < order; ++k) most *= digit - k;
  return most;
}

Polynomial derivative(const Polynomial& f, int k, bool slides) {
  Monomial power = 1;
  for (int i = 0; i < k; ++i) power *= kBasis;
  std::vector<Polynomial::value_type> terms;
  terms.reserve(f.size());
  for (const auto& [m, coefficient] : f) {
    const int d = digit(m, k);
    if (d == 0) continue;
    const Monomial rest = m - static_cast<Monomial>(d) * power;
    int to = 0, factor = 0;
    if (slides) {  // q -> 1, q^2 -> 2 q
      to = d - 1;
      factor = d;
    } else {  // cos h q -> -h sin h q, sin h q -> h cos h q
      const int harmonic = (d + 1) / 2;
      to = d % 2 == 1 ? d + 1 : d - 1;
      factor = d % 2 == 1 ? -harmonic : harmonic;
    }
    terms.emplace_back(rest + static_cast<Monomial>(to) * power,
                       coefficient * RunningError(factor));
  }
  return Polynomial(terms.begin(), terms.end());
}

void add(const Polynomial& b, double factor, Polynomial* a) {
  Polynomial sum;
  sum.reserve(a->size() + b.size());
  auto x = a->begin();
  for (const auto& [m, coefficient] : b) {
    for (; x != a->end() && x->first < m; ++x) sum.emplace_hint(sum.end(), *x);
    RunningError total;
    if (x != a->end() && x->first == m) total = (x++)->second;
    total += coefficient * RunningError(factor);
    sum.emplace_hint(sum.end(), m, total);
  }
  for (; x != a->end(); ++x) sum.emplace_hint(sum.end(), *x);
  *a = std::move(sum);
}

}  // namespace dynwitness::crosscheck
