// SPDX-License-Identifier: GPL-3.0-or-later
// The witness that asks a program. What is sent and what comes back: engine_greeting,
// engine_introduction, engine_batches.
#include "crosscheck/witnesses/engine_protocol.hpp"

#include <algorithm>
#include <cctype>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/engine_batches.hpp"
#include "crosscheck/witnesses/engine_greeting.hpp"
#include "crosscheck/witnesses/engine_introduction.hpp"
#include "crosscheck/witnesses/engine_words.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "crosscheck/witnesses/outside_judge.hpp"
#include "crosscheck/witnesses/witness_names.hpp"

namespace dynwitness::crosscheck {
namespace {

using engine::Batch;
using engine::Form;
using engine::Introduction;
using engine::Order;
using engine::Said;
using engine::State;

struct Handshake {
  std::unique_ptr<Conversation> program;
  Introduction said;

  /// @throws std::runtime_error  what is wrong with its answer, or why there is none
  Handshake(const std::string& command, const Limits& limits, const scene::Scene& scene)
      : program(std::make_unique<Conversation>(command, limits)),
        said(engine::parsed(program->ask(
            greetingOf(scene), kMostIntroduction + kALink * scene.mechanism.links.size()))) {}

 private:
  static constexpr std::size_t kMostIntroduction = 1 << 20, kALink = 1 << 10;
};

class EngineWitness : public OutsideWitness, public OutsideClaims {
 public:
  EngineWitness(std::string name, const std::string& command, const Limits& limits,
                const PreparedScene& scene)
      : name_(std::move(name)), mechanism_(scene.mechanism()), judge_(scene) {
    guarded(fmt::format("in the handshake (started as {})", engine::plain(command)), [&] {
      Handshake made(command, limits, scene.scene());
      program_ = std::move(made.program);
      introduction_.emplace(std::move(made.said));
      if (!introduction_->refuses.empty()) return;
      order_.emplace(mechanism_, *introduction_);
      if (introduction_->model)
        believed_ = engine::believedLinks(*introduction_->model, mechanism_);
    });
  }

  /// Nothing: it failed before it said so.
  const std::optional<Introduction>& introduction() const { return introduction_; }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return !failure_.empty() || knows(quantity); }
  std::vector<std::pair<Quantity, std::string>> leftOut() const override {
    std::vector<std::pair<Quantity, std::string>> out;
    if (!failure_.empty()) return out;
    for (const Quantity quantity : engine::kAskable)
      if (!knows(quantity))
        out.emplace_back(quantity, fmt::format("{} does not know {}, it said that it knows {}",
                                               name_, crosscheck::name(quantity),
                                               engine::listed(introduction_->quantities)));
    return out;
  }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> out;
    if (order_ && !order_->is_ours)
      out.push_back(fmt::format("{} has its joints in another order than the scene ({}): undone",
                                name_, engine::listed(introduction_->joints)));
    if (introduction_ && !introduction_->wxyz)
      out.push_back(name_ + " has quaternions as (x, y, z, w): undone");
    return out;
  }
  std::string askedAhead(const std::vector<State>& states) override {
    std::vector<Quantity> all;
    for (const Quantity quantity : engine::kAskable)
      if (failure_.empty() && knows(quantity)) all.push_back(quantity);
    return askedAhead(states, all);
  }
  void forget() { answers_.clear(); }
  /// About these quantities alone: a batch is sent before the answers to the one before are read,
  /// so that the program computes while we read and write.
  std::string askedAhead(const std::vector<State>& states, const std::vector<Quantity>& all) {
    if (all.empty()) return failure_;
    std::size_t sent = 0, read = 0;
    const auto send = [&] {
      if (sent == states.size()) return;
      const std::size_t count = std::min(kEngineBatch, states.size() - sent);
      sendAhead({&states[sent], count}, all);
      sent += count;
    };
    if (failure_.empty()) send();
    while (read < sent && failure_.empty()) {
      send();
      read += std::min(kEngineBatch, states.size() - read);
      receiveAhead();
    }
    return failure_;
  }
  /// Sends a question; nobody waits for its answer yet. What goes wrong, value() says.
  void sendAhead(const Batch& batch, const std::vector<Quantity>& all) {
    if (!failure_.empty()) return;
    const std::vector<Form> forms = formsOf(all);
    try {
      put(batch, forms, nullptr);
    } catch (const std::runtime_error&) {
      return;
    }
    underway_.push_back({batch_, forms, {}});
    for (const State& state : batch)
      for (const Quantity quantity : all) underway_.back().keys.push_back(keyOf(quantity, state));
  }
  /// Reads the answer to the first of the questions that are under way.
  void receiveAhead() {
    if (!failure_.empty() || underway_.empty()) return;
    Question asked = std::move(underway_.front());
    underway_.pop_front();
    try {
      std::vector<Said> said =
          take(asked.batch, asked.keys.size() / asked.forms.size(), asked.forms);
      for (std::size_t k = 0; k < said.size(); ++k)
        answers_[std::move(asked.keys[k])] = std::move(said[k]);
    } catch (const std::runtime_error&) {
      return;  // failure_ is set
    }
  }

  std::optional<std::vector<BelievedLink>> believedLinks() const override { return believed_; }
  bool knowsJacobian() const override {
    return failure_.empty() && introduction_->refuses.empty() && knows(kJacobian);
  }
  std::vector<SaidJacobian> jacobians(const FramePoint& point,
                                      const std::vector<State>& states) override {
    if (!failure_.empty()) throw std::runtime_error(failure_);
    Form form;
    form.name = kJacobian;
    form.rows = 6;
    form.columns = static_cast<Eigen::Index>(order_->rates.size());
    form.written = Form::Written::kRows;
    form.columns_at = &order_->rates;
    std::vector<SaidJacobian> out;
    for (std::size_t from = 0; from < states.size(); from += kEngineBatch) {
      const Batch batch{&states[from], std::min(kEngineBatch, states.size() - from)};
      put(batch, {form}, &point);
      for (Said& said : take(batch_, batch.count, {form}))
        out.push_back({std::move(said.value), std::move(said.reason)});
    }
    return out;
  }

  Answer answer(Quantity quantity, const State& state) override {
    return judge_.judged(quantity, state, value(quantity, state));
  }
  Eigen::MatrixXd value(Quantity quantity, const State& state) override {
    if (!failure_.empty()) throw std::runtime_error(failure_);
    const auto known = answers_.find(keyOf(quantity, state));
    if (known != answers_.end()) return valueOf(quantity, known->second);
    while (!underway_.empty() && failure_.empty()) receiveAhead();
    const std::vector<Form> forms = formsOf({quantity});
    put({&state, 1}, forms, nullptr);
    return valueOf(quantity, take(batch_, 1, forms).at(0));
  }

 private:
  using Key = std::vector<double>;
  /// One that has been sent.
  struct Question {
    long batch;
    std::vector<Form> forms;
    std::vector<Key> keys;  ///< all of the first state, then of the second, ...
  };

  Eigen::MatrixXd valueOf(Quantity quantity, const Said& said) const {
    if (said.reason.empty()) return said.value;
    throw std::runtime_error(
        fmt::format("{} has no {}: {}", name_, crosscheck::name(quantity), said.reason));
  }

  bool knows(Quantity quantity) const { return knows(crosscheck::name(quantity)); }
  bool knows(const std::string& name) const {
    const auto& names = introduction_->quantities;
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  /// What goes wrong is the end of the witness: the reason is kept, and the program goes.
  template <typename Step>
  void guarded(const std::string& when, const Step& step) {
    try {
      step();
    } catch (const std::exception& error) {
      failure_ = fmt::format("{} failed {}: {}", name_, when, error.what());
      program_.reset();
    }
  }

  static Key keyOf(Quantity quantity, const State& state) {
    Key key;
    key.reserve(1 + state.x.size() + 3 * state.qd.size());
    key.push_back(static_cast<double>(quantity));
    for (const auto& x : state.x) key.push_back(x.q);
    for (const auto* part : {&state.qd, &state.qdd, &state.tau})
      key.insert(key.end(), part->begin(), part->end());
    return key;
  }

  Form formOf(Quantity quantity) const {
    const auto n = static_cast<Eigen::Index>(order_->rates.size());
    Form out;
    out.name = crosscheck::name(quantity);
    switch (quantity) {
      case Quantity::kKinetic:
      case Quantity::kPotential:
        return out;
      case Quantity::kMomentum:
        out.rows = 6;
        out.written = Form::Written::kList;
        return out;
      case Quantity::kReactions:
        out.rows = static_cast<Eigen::Index>(mechanism_.links.size()) - 1;
        out.columns = 6;
        out.written = Form::Written::kRows;
        out.is_row_by_row = true;
        return out;
      case Quantity::kM:
        out.rows = out.columns = n;
        out.written = Form::Written::kRows;
        out.rows_at = out.columns_at = &order_->rates;
        return out;
      default:
        out.rows = n;
        out.written = Form::Written::kList;
        out.rows_at = &order_->rates;
        return out;
    }
  }
  std::vector<Form> formsOf(const std::vector<Quantity>& quantities) const {
    std::vector<Form> out;
    for (const Quantity quantity : quantities) out.push_back(formOf(quantity));
    return out;
  }

  static std::string whenAsked(long batch, std::size_t states) {
    return fmt::format("at batch {} ({} state{})", batch, states, states == 1 ? "" : "s");
  }
  /// Sends a batch. @throws std::runtime_error  failure_
  void put(const Batch& states, const std::vector<Form>& forms, const FramePoint* frame) {
    if (!failure_.empty()) throw std::runtime_error(failure_);
    ++batch_;
    guarded(whenAsked(batch_, states.count),
            [&] { program_->put(engine::question(batch_, states, forms, *order_, frame)); });
    if (!failure_.empty()) throw std::runtime_error(failure_);
  }
  /// The answer to the first batch that waits for one, complete and of the right shapes.
  /// @return  all forms of the first state, then of the second, ...
  /// @throws std::runtime_error  failure_
  std::vector<Said> take(long batch, std::size_t states, const std::vector<Form>& forms) {
    std::vector<Said> answers;
    guarded(whenAsked(batch, states), [&] {
      std::size_t numbers = 0;
      for (const Form& form : forms)
        numbers += static_cast<std::size_t>(form.rows * form.columns) + 8;
      // a double has 24 characters at most; twice that, and room for words
      constexpr std::size_t kPerNumber = 48, kWords = 1 << 16;
      const std::string said = program_->take(kWords + kPerNumber * numbers * states);
      answers = engine::answersIn(said, batch, states, forms);
    });
    if (!failure_.empty()) throw std::runtime_error(failure_);
    return answers;
  }

  std::string name_;
  scene::Mechanism mechanism_;
  OutsideJudge judge_;
  std::unique_ptr<Conversation> program_;
  std::optional<Introduction> introduction_;
  std::optional<Order> order_;
  std::optional<std::vector<BelievedLink>> believed_;
  std::string failure_;
  std::map<Key, Said> answers_;
  std::deque<Question> underway_;
  long batch_ = 0;
};

constexpr const char* kProgram = "the program ";  ///< then its command

bool isName(const std::string& text) {
  constexpr std::size_t kLongest = 40;
  return !text.empty() && text.size() <= kLongest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
         });
}

}  // namespace

std::vector<WitnessKind> engineKinds(const std::vector<std::string>& commands, const Limits& limits,
                                     const scene::Scene& scene) {
  std::vector<WitnessKind> kinds;
  std::vector<std::string> taken = witnessNames();
  taken.insert(taken.end(), {"table", "control"});
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const std::string& command = commands[k];
    WitnessInfo info;
    info.name = fmt::format("engine_{}", k + 1);
    info.version = "unknown";
    info.method = kProgram + command;
    try {
      const Introduction said =
          Handshake(command, limits, PreparedScene(scene).tree().scene()).said;
      if (isName(said.name) && std::count(taken.begin(), taken.end(), said.name) == 0)
        info.name = said.name;
      if (!said.version.empty()) info.version = said.version;
    } catch (const std::exception&) {
      // its witnesses will say why
    }
    taken.push_back(info.name);
    const std::string name = info.name;
    kinds.push_back(overTree({info, [=](const PreparedScene& asked) -> MadeWitness {
                                MadeWitness made =
                                    makeWitness<EngineWitness>(name, command, limits, asked);
                                if (made.isRefused()) return made;
                                const auto& said =
                                    dynamic_cast<const EngineWitness&>(**made).introduction();
                                if (said && !said->refuses.empty())
                                  return Refusal{name + " says: " + said->refuses};
                                return made;
                              }}));
  }
  return kinds;
}

bool isProgram(const WitnessKind& kind) {
  return kind.info.method.rfind(kProgram, 0) == 0;
}

void askEngineAhead(Witness& witness, Quantity quantity, const std::vector<State>& states) {
  auto* const engine = dynamic_cast<EngineWitness*>(&witness);
  if (!engine) return;
  engine->forget();
  engine->askedAhead(states, {quantity});
}

void sendEngineAhead(Witness& witness, Quantity quantity, const std::vector<State>& states) {
  if (auto* const engine = dynamic_cast<EngineWitness*>(&witness); engine && !states.empty())
    engine->sendAhead({states.data(), states.size()}, {quantity});
}

void receiveEngineAhead(Witness& witness) {
  auto* const engine = dynamic_cast<EngineWitness*>(&witness);
  if (!engine) return;
  engine->forget();
  engine->receiveAhead();
}

}  // namespace dynwitness::crosscheck
