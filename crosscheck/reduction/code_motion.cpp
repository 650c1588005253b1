// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/code_motion.hpp"

#include <algorithm>
#include <string>

#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

using kernel::CodeLanguage;
using kernel::CodeQuantity;
using kernel::CodeScalar;

class LoadedCode {
 public:
  LoadedCode(const kernel::ControllerCode& code, CodeScalar scalar) {
    std::string header, source;
    for (const auto& [name, text] : code.files(CodeLanguage::kC, scalar, {})) {
      if (name == code.identifier() + ".h") header = text;
      if (name == code.identifier() + ".c") source = text;
    }
    const std::string include = "#include \"" + code.identifier() + ".h\"\n";
    if (const std::size_t at = source.find(include); at != std::string::npos)
      source.replace(at, include.size(), header);
    object_ = kernel::compileAndLoad({source},
                                     {kernel::findCompiler(),
                                      {"-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fPIC"},
                                      kernel::cacheFolder()})
                  .front();
    qdd = object_->symbol(code.identifier() + "_qdd");
  }
  void* qdd;

 private:
  std::shared_ptr<kernel::SharedObject> object_;
};

AccelerationCode::AccelerationCode(const scene::Scene& scene)
    : code_(scene, {CodeQuantity::kQdd}, std::nullopt) {}

int AccelerationCode::operations() const {
  const kernel::CodeCount c = count();
  return c.multiplications + c.additions + c.divisions + c.trigonometric + c.comparisons;
}

CodeMotion::CodeMotion(const scene::Scene& scene, const AccelerationCode& code, CodeScalar scalar)
    : tree_(scene.mechanism),
      model_(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
      loaded_(std::make_shared<LoadedCode>(code.code(), scalar)),
      function_(loaded_->qdd),
      is_float_(scalar == CodeScalar::kFloat),
      x_(model_.positions),
      qd_(model_.dof()),
      q_rate_(model_.positions) {}

template <typename T>
void CodeMotion::accelerate(const State& y, State* rate) {
  using Function = void (*)(const T*, const T*, const T*, T*);
  const std::vector<T> q(y.begin(), y.begin() + positions()), qd(qd_.begin(), qd_.end()),
      tau(qd_.size(), T(0));
  std::vector<T> qdd(qd_.size());
  reinterpret_cast<Function>(function_)(q.data(), qd.data(), tau.data(), qdd.data());
  std::copy(qdd.begin(), qdd.end(), rate->begin() + positions());
}

void CodeMotion::rate(const State& y, double /*time*/, State* rate) {
  ++calls;
  for (int i = 0; i < positions(); ++i) x_[i] = scene::jointPosition(y[i]);
  std::copy_n(y.begin() + positions(), dof(), qd_.begin());
  recursive::positionRates(model_, x_, qd_, q_rate_);
  std::copy(q_rate_.begin(), q_rate_.end(), rate->begin());
  if (is_float_)
    accelerate<float>(y, rate);
  else
    accelerate<double>(y, rate);
  rate->back() = 0;
}

LaneMotion::LaneMotion(const scene::Scene& scene)
    : tree_(scene.mechanism),
      model_(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
      kernel_(scene.mechanism, {{kernel::Formula::kForwardDynamics}, kernel::chosenLanes()}),
      x_(model_.positions),
      one_qd_(model_.dof()),
      q_rate_(model_.positions) {
  if (!kernel_.has(kernel::Formula::kForwardDynamics))
    throw kernel::NotUsed(kernel_.notUsed().at(kernel::Formula::kForwardDynamics));
  const auto count = static_cast<std::size_t>(lanes());
  q_.resize(count * static_cast<std::size_t>(positions()));
  qd_.resize(count * static_cast<std::size_t>(dof()));
  tau_.assign(qd_.size(), 0);
  qdd_.resize(qd_.size());
}

int LaneMotion::operations() const {
  const kernel::Road& road = kernel_.road(kernel::Formula::kForwardDynamics);
  const auto& loads = road.program.loads;
  return road.operations() +
         static_cast<int>(std::count_if(loads.begin(), loads.end(), [](const auto& load) {
           return load.input == symbolic::Input::kCos || load.input == symbolic::Input::kSin;
         }));
}

void LaneMotion::rate(const State& y, double /*time*/, State* rate) {
  ++calls;
  for (int i = 0; i < positions(); ++i) x_[i] = scene::jointPosition(y[i]);
  std::copy_n(y.begin() + positions(), dof(), one_qd_.begin());
  recursive::positionRates(model_, x_, one_qd_, q_rate_);
  std::copy(q_rate_.begin(), q_rate_.end(), rate->begin());
  for (int i = 0; i < positions(); ++i) std::fill_n(q_.begin() + i * lanes(), lanes(), y[i]);
  for (int i = 0; i < dof(); ++i) std::fill_n(qd_.begin() + i * lanes(), lanes(), one_qd_[i]);
  kernel_.forwardDynamics(q_.data(), qd_.data(), tau_.data(), qdd_.data(), lanes());
  // a different lane for each joint: all have to be right
  for (int i = 0; i < dof(); ++i) (*rate)[positions() + i] = qdd_[i * lanes() + i % lanes()];
  rate->back() = 0;
}

}  // namespace dynwitness::crosscheck
