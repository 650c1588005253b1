// SPDX-License-Identifier: GPL-3.0-or-later
// Calls sweeps with and without their estimates of rounding as often as it is told, for a tool that
// counts instructions:
//     valgrind --tool=callgrind count_warnings 20 franka_panda
// Every sweep is a function of its own name, `plain_...` and `warned_...`.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/fast/warned_dynamics.hpp"
#include "recursive/newton_euler.hpp"
#include "scene/scene.hpp"

using namespace dynwitness;

namespace {

#define DYNWITNESS_COUNTED extern "C" __attribute__((noinline))  // names as written

struct Sweeps {
  explicit Sweeps(const scene::Mechanism& mechanism)
      : model(recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism))),
        ws(model),
        filter(model, 1e-3),
        plain(model),
        warned(model),
        x(model.positions),
        q(model.positions),
        qd(model.dof()),
        w(model.dof()),
        out(model.dof()),
        M(model.dof(), model.dof()) {}
  void place(int call) {
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] = 0.3 + 0.1 * static_cast<double>(i) + 0.01 * call;
      x[i] = scene::jointPosition(q[i]);
    }
    for (std::size_t i = 0; i < w.size(); ++i)
      qd[i] = 0.7 - 0.2 * static_cast<double>(i), w[i] = 1.1 + 0.3 * static_cast<double>(i);
  }

  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  recursive::RoundingFilter<double> filter;
  recursive::fast::Dynamics plain;
  recursive::fast::WarnedDynamics warned;
  std::vector<scene::JointPosition<double>> x;
  std::vector<double> q, qd, w, out;
  recursive::MatrixX<double> M;
};

DYNWITNESS_COUNTED void plain_fast_ID(Sweeps& s) {
  s.plain.inverseDynamics(s.q.data(), s.qd.data(), s.w.data(), s.out.data());
}
DYNWITNESS_COUNTED double warned_fast_ID(Sweeps& s) {
  return s.warned.inverseDynamics(s.q.data(), s.qd.data(), s.w.data(), s.out.data());
}
DYNWITNESS_COUNTED void plain_fast_M(Sweeps& s) {
  s.plain.massMatrix(s.q.data(), s.M.data());
}
DYNWITNESS_COUNTED double warned_fast_M(Sweeps& s) {
  return s.warned.massMatrix(s.q.data(), s.M.data());
}
DYNWITNESS_COUNTED void plain_fast_FD(Sweeps& s) {
  s.plain.forwardDynamics(s.q.data(), s.qd.data(), s.w.data(), s.out.data());
}
DYNWITNESS_COUNTED double warned_fast_FD(Sweeps& s) {
  return s.warned.forwardDynamics(s.q.data(), s.qd.data(), s.w.data(), s.out.data());
}
DYNWITNESS_COUNTED void plain_sweep_ID(Sweeps& s) {
  recursive::inverseDynamics(s.model, s.x, s.qd, s.w, s.ws, s.out);
}
DYNWITNESS_COUNTED double warned_sweep_ID(Sweeps& s) {
  recursive::inverseDynamics(s.model, s.x, s.qd, s.w, s.ws, s.out);
  return s.filter.inverseDynamics(s.x.data(), s.qd.data(), s.w.data(), s.out.data());
}
DYNWITNESS_COUNTED void plain_sweep_FD(Sweeps& s) {
  recursive::forwardDynamics(s.model, s.x, s.qd, s.w, s.ws, s.out);
}
DYNWITNESS_COUNTED double warned_sweep_FD(Sweeps& s) {
  recursive::forwardDynamics(s.model, s.x, s.qd, s.w, s.ws, s.out);
  return s.filter.forwardDynamics(s.model, s.x, s.qd, s.w, s.ws, s.out);
}
void solve(Sweeps& s) {
  const std::vector<double> rest(s.w.size(), 0);
  recursive::massMatrix(s.model, s.x, s.ws, s.M);
  recursive::inverseDynamics(s.model, s.x, s.qd, rest, s.ws, s.out);
  for (std::size_t i = 0; i < s.w.size(); ++i) s.out[i] = s.w[i] - s.out[i];
  recursive::factorize(s.M);
  recursive::solve(s.M, s.out);
}
DYNWITNESS_COUNTED void plain_solved_FD(Sweeps& s) {
  solve(s);
}
DYNWITNESS_COUNTED double warned_solved_FD(Sweeps& s) {
  solve(s);
  return s.filter.solved(s.x, s.qd, s.w, s.M, s.out);
}

}  // namespace

int main(int argc, char** argv) {
  const int calls = argc > 1 ? std::atoi(argv[1]) : 0;
  double worst = 0;
  for (int a = 2; a < argc; ++a) {
    Sweeps s(scene::findScene(argv[a]).mechanism);
    for (int call = 0; call < calls; ++call) {
      s.place(call);
      plain_sweep_ID(s), plain_sweep_FD(s), plain_solved_FD(s);
      for (double lost : {warned_sweep_ID(s), warned_sweep_FD(s), warned_solved_FD(s)})
        worst = std::max(worst, lost);
      // valgrind does not know an instruction that loads the angles of fewer joints
      if (s.q.size() < 6) continue;
      plain_fast_ID(s), plain_fast_M(s), plain_fast_FD(s);
      for (double lost : {warned_fast_ID(s), warned_fast_M(s), warned_fast_FD(s)})
        worst = std::max(worst, lost);
    }
  }
  std::printf("%.2g\n", worst);
}
