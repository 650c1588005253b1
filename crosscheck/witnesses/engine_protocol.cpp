// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_protocol.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/outside_judge.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;
using State = scene::State<double>;

// ---- the scene, as numbers

/// The numbers of a scene as JSON, rounded once.
class Resolved {
 public:
  explicit Resolved(const scene::Mechanism& mechanism) : number_(mechanism) {}

  Json operator()(const scene::Number& x) const { return static_cast<double>(number_(x)); }
  Json vector(const scene::Vector& v) const { return of(number_.vector(v)); }
  Json unit(const scene::Vector& v) const { return of(number_.vector(v).normalized()); }

  /// Frame to frame: x_outer = R x_inner + p.
  Json frame(const std::vector<scene::Step>& steps) const {
    const ToldNumbers::Frame X = number_.frame(steps);
    return {{"R", of(X.R)}, {"p", of(X.p)}};
  }
  Json inertia(const scene::MassProperties& given) const {
    const ToldNumbers::Inertia told = number_.inertia(given);
    return {
        {"mass", static_cast<double>(told.mass)}, {"com", of(told.com)}, {"inertia", of(told.I)}};
  }

 private:
  static Json of(const ToldNumbers::Vector3& v) {
    Json out = Json::array();
    for (int i = 0; i < 3; ++i) out.push_back(static_cast<double>(v(i)));
    return out;
  }
  static Json of(const ToldNumbers::Matrix3& m) {
    using Row = ToldNumbers::Vector3;
    return {of(Row(m.row(0))), of(Row(m.row(1))), of(Row(m.row(2)))};
  }

  ToldNumbers number_;
};

Json jointJson(const scene::Joint& joint, const Resolved& number, int q, int qd) {
  Json out = {{"name", joint.name},
              {"kind", scene::name(joint.kind)},
              {"q", q},
              {"positions", scene::positionSlots(joint.kind).size()},
              {"qd", qd},
              {"rates", scene::degreesOfFreedom(joint.kind)},
              {"before", number.frame(joint.placement.beforeJoint())},
              {"after", number.frame(joint.placement.afterJoint())}};
  if (scene::hasAxis(joint.kind)) out["axis"] = number.unit(joint.axis);
  if (joint.kind == scene::JointKind::kHelical) out["pitch"] = number(joint.pitch);
  out["rotor_inertia"] = number(joint.rotor_inertia);
  out["gear_ratio"] = number(joint.gear_ratio);
  out["gyroscopic"] = joint.gyroscopic;
  out["viscous"] = number(joint.friction.viscous);
  out["coulomb"] = {number(joint.friction.positive), number(joint.friction.negative)};
  out["stiffness"] = number(joint.stiffness);
  out["rest"] = number(joint.rest);
  return out;
}

Json sceneJson(const scene::Scene& scene) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const Resolved number(mechanism);
  Json joints = Json::array(), links = Json::array(), wrenches = Json::array();
  int q = 0, qd = 0;
  for (const scene::Link& link : mechanism.links) {
    Json one = {{"name", link.name}, {"parent", link.parent}};
    one.update(number.inertia(link.inertia));
    if (link.parent >= 0) one["joint"] = jointJson(link.joint, number, q, qd);
    const int rates = scene::degreesOfFreedom(link.joint.kind);
    if (rates > 0) joints.push_back(link.joint.name);
    q += static_cast<int>(scene::positionSlots(link.joint.kind).size());
    qd += rates;
    links.push_back(one);
  }
  for (const scene::Wrench& w : mechanism.wrenches)
    wrenches.push_back({{"link", w.link},
                        {"axes", w.axes == scene::Wrench::Axes::kLink ? "link" : "world"},
                        {"force", number.vector(w.force)},
                        {"moment", number.vector(w.moment)},
                        {"at", number.vector(w.at)}});
  const scene::Vector zero{scene::Number(0), scene::Number(0), scene::Number(0)};
  return {{"name", scene.name},
          {"positions", q},
          {"dof", qd},
          {"joints", joints},
          {"gravity", number.vector(mechanism.has_gravity ? mechanism.gravity : zero)},
          {"links", links},
          {"wrenches", wrenches},
          {"toml", scene::writeSceneToml(scene)}};
}

/// What an engine may be asked.
constexpr Quantity kAskable[] = {Quantity::kM,         Quantity::kc,       Quantity::kg,
                                 Quantity::kTau,       Quantity::kQdd,     Quantity::kKinetic,
                                 Quantity::kPotential, Quantity::kMomentum};

// ---- what an engine says of itself

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "nothing" : text;
}

/// A value as it came, short enough for a sentence.
std::string shown(const Json& value) {
  constexpr std::size_t kShown = 80;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return text;
}

[[noreturn]] void expected(const std::string& where, const std::string& what, const Json& came) {
  throw std::runtime_error(where + ": expected " + what + ", got " + shown(came));
}

std::vector<std::string> words(const Json& from, const char* key) {
  std::vector<std::string> out;
  const Json& list = from.at(key);
  if (!list.is_array()) expected(key, "a list of names", list);
  for (const Json& word : list) {
    if (!word.is_string()) expected(key, "a list of names", list);
    out.push_back(word.get<std::string>());
  }
  return out;
}

std::string textOr(const Json& from, const char* key, const std::string& otherwise) {
  const auto at = from.find(key);
  if (at == from.end()) return otherwise;
  if (!at->is_string()) expected(key, "text", *at);
  return at->get<std::string>();
}

/// Text that somebody else wrote, fit for a line of a report.
std::string plain(std::string text) {
  constexpr std::size_t kMost = 300;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return text;
}

/// Whether a word stands where a number might.
bool holdsWord(const std::string& line, const std::string& word) {
  const std::string before = "[:, -", after = "],} ";
  for (std::size_t at = line.find(word, 1); at != std::string::npos; at = line.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if (end < line.size() && before.find(line[at - 1]) != std::string::npos &&
        after.find(line[end]) != std::string::npos)
      return true;
  }
  return false;
}

/// One JSON object of a line.
Json parsed(const std::string& line) {
  constexpr int kDeepest = 8;  // what is nested more deeply is left out: nothing of ours is
  Json out = Json::parse(
      line, [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; }, false);
  if (out.is_object()) return out;
  const std::string start = plain(line.substr(0, 80));
  for (const char* word : {"NaN", "nan", "Infinity", "inf"})
    if (out.is_discarded() && holdsWord(line, word))
      throw std::runtime_error(fmt::format(
          "expected numbers, got {}, which JSON has not: give a text with the reason in place of "
          "a quantity that has no value, in '{}'",
          word, start));
  throw std::runtime_error(fmt::format("expected a JSON object on one line, got '{}'", start));
}

/// What an engine answers to the greeting.
struct Introduction {
  std::string name, version, refuses;
  std::vector<std::string> quantities, joints;
  bool wxyz = true;  ///< false: quaternions come as (x, y, z, w)

  explicit Introduction(const Json& said) {
    const auto version_at = said.find("protocol");
    if (version_at == said.end() || *version_at != kEngineProtocol)
      expected("protocol", fmt::format("version {}", kEngineProtocol),
               version_at == said.end() ? Json("none") : *version_at);
    name = plain(textOr(said, "name", ""));
    version = plain(textOr(said, "version", ""));
    refuses = plain(textOr(said, "refuses", ""));
    if (said.contains("refuses")) {
      if (refuses.empty()) refuses = "no, and not why";
      return;
    }
    if (!said.contains("quantities")) expected("quantities", "a list of names", "none");
    quantities = words(said, "quantities");
    if (said.contains("joints")) joints = words(said, "joints");
    const std::string quaternion = textOr(said, "quaternion", "wxyz"),
                      rates = textOr(said, "rates", "link");
    wxyz = quaternion == "wxyz";
    if (!wxyz && quaternion != "xyzw") expected("quaternion", "\"wxyz\" or \"xyzw\"", quaternion);
    if (rates != "link")
      expected("rates", "\"link\" (of spherical and floating joints, in the link's axes)", rates);
    std::string allowed;
    for (const Quantity quantity : kAskable)
      allowed += (allowed.empty() ? "" : ", ") + std::string(crosscheck::name(quantity));
    for (const std::string& quantity : quantities)
      if (std::none_of(std::begin(kAskable), std::end(kAskable),
                       [&](Quantity q) { return quantity == crosscheck::name(q); }))
        expected("quantities", "names among " + allowed, quantity);
    if (quantities.empty()) expected("quantities", "at least one of " + allowed, Json::array());
  }
};

/** Where the engine keeps our slots: theirs[i] = ours[of[i]]. A joint's slots stay together, in
    their order but for those of a quaternion. */
struct Order {
  std::vector<int> positions, rates;

  Order(const scene::Mechanism& mechanism, const Introduction& engine) {
    struct Place {
      int q, qd, link;
    };
    std::map<std::string, Place> places;
    std::vector<std::string> ours;
    int q = 0, qd = 0;
    for (const int i : mechanism.movingLinks()) {
      const scene::Joint& joint = mechanism.links[i].joint;
      places[joint.name] = {q, qd, i};
      ours.push_back(joint.name);
      q += static_cast<int>(scene::positionSlots(joint.kind).size());
      qd += scene::degreesOfFreedom(joint.kind);
    }
    std::vector<std::string> theirs = engine.joints.empty() ? ours : engine.joints, sorted = theirs;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::string> all = ours;
    std::sort(all.begin(), all.end());
    if (sorted != all) expected("joints", "all of " + listed(ours) + ", in any order", theirs);
    is_ours = theirs == ours;
    for (const std::string& name : theirs) {
      const Place& place = places.at(name);
      const scene::JointKind kind = mechanism.links[place.link].joint.kind;
      const std::vector<scene::SlotKind>& slots = scene::positionSlots(kind);
      const int count = static_cast<int>(slots.size());
      for (int k = 0; k < count; ++k) {
        int from = k;
        if (slots[k] == scene::SlotKind::kQuaternion && !engine.wxyz)
          from = k + 1 < count ? k + 1 : count - 4;  // x, y, z, w of w, x, y, z
        positions.push_back(place.q + from);
      }
      for (int k = 0; k < scene::degreesOfFreedom(kind); ++k) rates.push_back(place.qd + k);
    }
  }
  bool is_ours = true;
};

// ---- batches: written and read as they are, since a tree of them takes longer than most engines

/// The shortest decimals that are this double again, with what shows that it is no integer.
void append(double x, std::string* to) {
  char digits[32];
  const std::string_view shortest(
      digits,
      static_cast<std::size_t>(std::to_chars(digits, digits + sizeof digits, x).ptr - digits));
  *to += shortest;
  if (shortest.find_first_of(".e") == std::string_view::npos) *to += ".0";
}

/// One part of a state, with places in the engine's own arrays.
template <typename Numbers>
void append(const char* name, const Numbers& ours, const std::vector<int>& order, std::string* to) {
  *to += fmt::format("\"{}\":[", name);
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0) *to += ',';
    append(ours.empty() ? 0.0 : ours[static_cast<std::size_t>(order[k])], to);
  }
  *to += ']';
}

/// Reads what is as short and plain as it can be; false for anything else, which JSON may be.
class PlainJson {
 public:
  explicit PlainJson(const std::string& line) : at_(line.data()), end_(at_ + line.size()) {}
  bool take(char expected) {
    skip();
    if (at_ == end_ || *at_ != expected) return false;
    ++at_;
    return true;
  }
  bool key(const char* name) {
    if (!take('"')) return false;
    for (; *name != '\0'; ++name, ++at_)
      if (at_ == end_ || *at_ != *name) return false;
    return at_ != end_ && *at_++ == '"' && take(':');
  }
  bool number(double* x) {
    skip();
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    const char* const first = at_ != end_ && *at_ == '-' ? at_ + 1 : at_;
    if (first == end_ || !isDigit(*first)) return false;  // from_chars knows inf and nan
    const auto [after, error] = std::from_chars(at_, end_, *x);
    if (error != std::errc() || !isDigit(after[-1])) return false;
    at_ = after;
    return true;
  }
  bool isAtEnd() {
    skip();
    return at_ == end_;
  }

 private:
  void skip() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r')) ++at_;
  }
  const char *at_, *end_;
};

// ---- the witness

struct Handshake {
  std::unique_ptr<Conversation> program;
  Introduction said;

  /// @throws std::runtime_error  what is wrong with its answer, or why there is none
  Handshake(const std::string& command, const Limits& limits, const scene::Scene& scene)
      : program(std::make_unique<Conversation>(command, limits)),
        said(parsed(program->ask(greetingOf(scene), kMostIntroduction))) {}

 private:
  static constexpr std::size_t kMostIntroduction = 1 << 20;
};

class EngineWitness : public OutsideWitness {
 public:
  EngineWitness(std::string name, const std::string& command, const Limits& limits,
                const PreparedScene& scene)
      : name_(std::move(name)), mechanism_(scene.mechanism()), judge_(scene) {
    guarded("in the handshake", [&] {
      Handshake made(command, limits, scene.scene());
      program_ = std::move(made.program);
      introduction_.emplace(std::move(made.said));
      if (introduction_->refuses.empty()) order_.emplace(mechanism_, *introduction_);
    });
  }

  /// Nothing: it failed before it said so.
  const std::optional<Introduction>& introduction() const { return introduction_; }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    if (!failure_.empty()) return quantity != Quantity::kReactions;
    return knows(quantity);
  }
  std::vector<std::pair<Quantity, std::string>> leftOut() const override {
    std::vector<std::pair<Quantity, std::string>> out;
    if (!failure_.empty()) return out;
    for (const Quantity quantity : kAskable)
      if (!knows(quantity))
        out.emplace_back(
            quantity, fmt::format("{} does not know {}, it said that it knows {}", name_,
                                  crosscheck::name(quantity), listed(introduction_->quantities)));
    return out;
  }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> out;
    if (order_ && !order_->is_ours)
      out.push_back(fmt::format("{} has its joints in another order than the scene ({}): undone",
                                name_, listed(introduction_->joints)));
    if (introduction_ && !introduction_->wxyz)
      out.push_back(name_ + " has quaternions as (x, y, z, w): undone");
    return out;
  }
  std::string askedAhead(const std::vector<State>& states) override {
    std::vector<Quantity> all;
    for (const Quantity quantity : kAskable)
      if (failure_.empty() && knows(quantity)) all.push_back(quantity);
    return askedAhead(states, all);
  }
  void forget() { answers_.clear(); }
  /// About these quantities alone.
  std::string askedAhead(const std::vector<State>& states, const std::vector<Quantity>& all) {
    for (std::size_t from = 0; from < states.size() && failure_.empty(); from += kEngineBatch) try {
        const Batch batch{&states[from], std::min(kEngineBatch, states.size() - from)};
        std::vector<Said> said = ask(batch, all);
        for (std::size_t k = 0; k < said.size(); ++k)
          answers_[keyOf(all[k % all.size()], batch.first[k / all.size()])] = std::move(said[k]);
      } catch (const std::runtime_error&) {
        return failure_;  // set by ask()
      }
    return failure_;
  }

  Answer answer(Quantity quantity, const State& state) override {
    return judge_.judged(quantity, state, value(quantity, state));
  }
  Eigen::MatrixXd value(Quantity quantity, const State& state) override {
    if (!failure_.empty()) throw std::runtime_error(failure_);
    const auto known = answers_.find(keyOf(quantity, state));
    if (known == answers_.end()) return valueOf(quantity, ask({&state, 1}, {quantity}).at(0));
    return valueOf(quantity, known->second);
  }

 private:
  using Key = std::vector<double>;
  /// In our order; or why there is none.
  struct Said {
    Eigen::MatrixXd value;
    std::string reason;
  };
  struct Batch {
    const State* first;
    std::size_t count;
    const State* begin() const { return first; }
    const State* end() const { return first + count; }
  };

  Eigen::MatrixXd valueOf(Quantity quantity, const Said& said) const {
    if (said.reason.empty()) return said.value;
    throw std::runtime_error(
        fmt::format("{} has no {}: {}", name_, crosscheck::name(quantity), said.reason));
  }

  bool knows(Quantity quantity) const {
    const auto& names = introduction_->quantities;
    return std::find(names.begin(), names.end(), crosscheck::name(quantity)) != names.end();
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

  Eigen::Index rowsOf(Quantity quantity) const {
    if (quantity == Quantity::kKinetic || quantity == Quantity::kPotential) return 1;
    return quantity == Quantity::kMomentum ? 6 : static_cast<Eigen::Index>(order_->rates.size());
  }
  Eigen::Index columnsOf(Quantity quantity) const {
    return quantity == Quantity::kM ? rowsOf(quantity) : 1;
  }

  /// Asks about a batch; answers are complete and of the right shapes.
  /// @return  all quantities of the first state, then of the second, ...
  /// @throws std::runtime_error  failure_
  std::vector<Said> ask(const Batch& states, const std::vector<Quantity>& quantities) {
    std::vector<Said> answers;
    ++batch_;
    guarded(
        fmt::format("at batch {} ({} state{})", batch_, states.count, states.count == 1 ? "" : "s"),
        [&] {
          std::size_t numbers = 0;
          for (const Quantity quantity : quantities)
            numbers += static_cast<std::size_t>(rowsOf(quantity) * columnsOf(quantity)) + 8;
          // a double has 24 characters at most; twice that, and room for words
          constexpr std::size_t kPerNumber = 48, kWords = 1 << 16;
          const std::string said = program_->ask(question(states, quantities),
                                                 kWords + kPerNumber * numbers * states.count);
          if (!readPlain(said, states.count, quantities, &answers))
            answers = readAny(parsed(said), states.count, quantities);
        });
    if (!failure_.empty()) throw std::runtime_error(failure_);
    return answers;
  }

  std::string question(const Batch& states, const std::vector<Quantity>& quantities) const {
    std::string text = fmt::format("{{\"batch\":{},\"quantities\":[", batch_);
    for (const Quantity quantity : quantities)
      text += fmt::format("{}\"{}\"", text.back() == '[' ? "" : ",", crosscheck::name(quantity));
    text += "],\"states\":[";
    std::vector<double> q;
    for (const State& state : states) {
      q.clear();
      for (const auto& x : state.x) q.push_back(x.q);
      text += text.back() == '[' ? "{" : ",{";
      append("q", q, order_->positions, &text);
      text += ',';
      append("qd", state.qd, order_->rates, &text);
      text += ',';
      append("qdd", state.qdd, order_->rates, &text);
      text += ',';
      append("tau", state.tau, order_->rates, &text);
      text += '}';
    }
    return text + "]}";
  }

  /// Where an entry of theirs is in ours.
  Eigen::Index placed(Quantity quantity, Eigen::Index i) const {
    switch (quantity) {
      case Quantity::kKinetic:
      case Quantity::kPotential:
      case Quantity::kMomentum:
        return i;
      default:
        return static_cast<Eigen::Index>(order_->rates[static_cast<std::size_t>(i)]);
    }
  }

  /// @return  false: it has to be read as any JSON
  bool readPlain(const std::string& line, std::size_t states,
                 const std::vector<Quantity>& quantities, std::vector<Said>* answers) const {
    PlainJson text(line);
    double batch = 0;
    if (!text.take('{') || !text.key("batch") || !text.number(&batch) ||
        batch != static_cast<double>(batch_) || !text.take(',') || !text.key("answers") ||
        !text.take('['))
      return false;
    answers->clear();
    answers->reserve(states * quantities.size());
    for (std::size_t k = 0; k < states; ++k) {
      if ((k > 0 && !text.take(',')) || !text.take('{')) return false;
      for (std::size_t m = 0; m < quantities.size(); ++m) {
        const Quantity quantity = quantities[m];
        if ((m > 0 && !text.take(',')) || !text.key(crosscheck::name(quantity))) return false;
        const bool is_list = quantity != Quantity::kKinetic && quantity != Quantity::kPotential;
        const bool has_rows = quantity == Quantity::kM;
        Eigen::MatrixXd value(rowsOf(quantity), columnsOf(quantity));
        if (is_list && !text.take('[')) return false;
        for (Eigen::Index i = 0; i < value.rows(); ++i) {
          if ((i > 0 && !text.take(',')) || (has_rows && !text.take('['))) return false;
          for (Eigen::Index j = 0; j < value.cols(); ++j)
            if ((j > 0 && !text.take(',')) ||
                !text.number(&value(placed(quantity, i), has_rows ? placed(quantity, j) : j)))
              return false;
          if (has_rows && !text.take(']')) return false;
        }
        if (is_list && !text.take(']')) return false;
        answers->push_back({std::move(value), ""});
      }
      if (!text.take('}')) return false;
    }
    return text.take(']') && text.take('}') && text.isAtEnd();
  }

  /// @throws std::runtime_error  what was expected, and what came
  std::vector<Said> readAny(const Json& said, std::size_t states,
                            const std::vector<Quantity>& quantities) const {
    std::vector<Said> answers;
    if (!said.contains("batch") || said.at("batch") != batch_)
      expected("batch", fmt::format("{}", batch_),
               said.contains("batch") ? said.at("batch") : Json("none"));
    if (!said.contains("answers") || !said.at("answers").is_array() ||
        said.at("answers").size() != states)
      expected("answers", fmt::format("a list of {}, one a state", states),
               said.contains("answers") ? said.at("answers") : Json("none"));
    for (std::size_t k = 0; k < states; ++k) {
      const Json& one = said.at("answers").at(k);
      for (const Quantity quantity : quantities) {
        const std::string where = fmt::format("{} of state {}", crosscheck::name(quantity), k + 1);
        if (!one.is_object() || !one.contains(crosscheck::name(quantity)))
          expected(where, "numbers, or a text with the reason why there are none", one);
        const Json& value = one.at(crosscheck::name(quantity));
        requireShape(quantity, where, value);
        answers.push_back(read(quantity, value));
      }
    }
    return answers;
  }

  void requireShape(Quantity quantity, const std::string& where, const Json& said) const {
    if (said.is_string()) return;  // why there is no value
    const auto rows = static_cast<std::size_t>(rowsOf(quantity)),
               columns = static_cast<std::size_t>(columnsOf(quantity));
    if (quantity == Quantity::kKinetic || quantity == Quantity::kPotential) {
      if (!said.is_number()) expected(where, "a number", said);
      return;
    }
    const std::string shape = fmt::format(
        "{} {}{}", rows, quantity == Quantity::kM ? "row" : "number", rows == 1 ? "" : "s");
    if (!said.is_array() || said.size() != rows)
      expected(where, shape, said.is_array() ? Json(fmt::format("{} of them", said.size())) : said);
    for (const Json& row : said) {
      if (quantity != Quantity::kM) {
        if (!row.is_number()) expected(where, shape, said);
        continue;
      }
      if (!row.is_array() || row.size() != columns)
        expected(where, fmt::format("rows of {} numbers", columns), row);
      for (const Json& x : row)
        if (!x.is_number()) expected(where, fmt::format("rows of {} numbers", columns), row);
    }
  }

  /// Of the right shape.
  Said read(Quantity quantity, const Json& said) const {
    if (said.is_string()) {
      const std::string reason = plain(said.get<std::string>());
      return {{}, reason.empty() ? "it does not say why" : reason};
    }
    Eigen::MatrixXd out(rowsOf(quantity), columnsOf(quantity));
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      for (Eigen::Index j = 0; j < out.cols(); ++j) {
        const Json& row = said.is_array() ? said.at(static_cast<std::size_t>(i)) : said;
        const Json& x = row.is_array() ? row.at(static_cast<std::size_t>(j)) : row;
        out(placed(quantity, i), quantity == Quantity::kM ? placed(quantity, j) : j) =
            x.get<double>();
      }
    return {out, ""};
  }

  std::string name_;
  scene::Mechanism mechanism_;
  OutsideJudge judge_;
  std::unique_ptr<Conversation> program_;
  std::optional<Introduction> introduction_;
  std::optional<Order> order_;
  std::string failure_;
  std::map<Key, Said> answers_;
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

std::string greetingOf(const scene::Scene& scene) {
  const Json greeting = {{"protocol", kEngineProtocol}, {"scene", sceneJson(scene)}};
  return greeting.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<WitnessKind> engineKinds(const std::vector<std::string>& commands, const Limits& limits,
                                     const scene::Scene& scene) {
  std::vector<WitnessKind> kinds;
  // once a process: to list the kernel among them a program is compiled
  static const std::vector<std::string> ours = [] {
    std::vector<std::string> names = {"table", "control"};
    for (const WitnessKind& kind : witnessKinds()) names.push_back(kind.info.name);
    return names;
  }();
  std::vector<std::string> taken = ours;
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

}  // namespace dynwitness::crosscheck
