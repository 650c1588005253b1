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

}  // namespace dynwitness::crosscheck
