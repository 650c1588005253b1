// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_protocol.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <deque>
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
#include "crosscheck/witnesses/outside_claims.hpp"
#include "crosscheck/witnesses/outside_judge.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "crosscheck/witnesses/witness_names.hpp"
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

/// What an engine may be asked of a state.
constexpr Quantity kAskable[] = {Quantity::kM,         Quantity::kc,        Quantity::kg,
                                 Quantity::kTau,       Quantity::kQdd,      Quantity::kKinetic,
                                 Quantity::kPotential, Quantity::kMomentum, Quantity::kReactions};
constexpr const char* kModel = "model";  ///< which the handshake holds

std::vector<std::string> askable() {
  std::vector<std::string> out;
  for (const Quantity quantity : kAskable) out.emplace_back(crosscheck::name(quantity));
  out.emplace_back(kJacobian);
  return out;
}

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

double number(const Json& from, const char* key, const std::string& where) {
  const auto at = from.find(key);
  if (at == from.end() || !at->is_number())
    expected(where + " " + key, "a number", at == from.end() ? Json("none") : *at);
  return at->get<double>();
}

/// Three numbers.
Eigen::Vector3d three(const Json& from, const std::string& where) {
  if (!from.is_array() || from.size() != 3 ||
      !std::all_of(from.begin(), from.end(), [](const Json& x) { return x.is_number(); }))
    expected(where, "three numbers", from);
  return {from[0].get<double>(), from[1].get<double>(), from[2].get<double>()};
}

/// What an engine believes a link to be, by the link's name.
struct ToldLink {
  std::string name;
  BelievedLink link;
};

std::vector<ToldLink> toldLinks(const Json& said) {
  if (!said.is_array()) expected(kModel, "a list of links", said);
  std::vector<ToldLink> out;
  for (const Json& one : said) {
    const std::string where = fmt::format("link {} of {}", out.size() + 1, kModel);
    if (!one.is_object() || !one.contains("link") || !one.at("link").is_string())
      expected(where, "the name of a link, mass, com and inertia", one);
    ToldLink told;
    told.name = one.at("link").get<std::string>();
    told.link.mass = number(one, "mass", where);
    told.link.com = three(one.contains("com") ? one.at("com") : Json("none"), where + " com");
    const Json rows = one.contains("inertia") ? one.at("inertia") : Json("none");
    if (!rows.is_array() || rows.size() != 3)
      expected(where + " inertia", "three rows of three numbers", rows);
    for (int i = 0; i < 3; ++i)
      told.link.inertia.row(i) =
          three(rows[static_cast<std::size_t>(i)], where + " inertia").transpose();
    out.push_back(told);
  }
  return out;
}

/// The scene's links of these names. @throws std::runtime_error  there is none, or it comes twice
std::vector<BelievedLink> believedLinks(const std::vector<ToldLink>& told,
                                        const scene::Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const scene::Link& link : mechanism.links) names.push_back(link.name);
  std::vector<BelievedLink> out;
  for (const ToldLink& one : told) {
    const auto at = std::find(names.begin(), names.end(), one.name);
    if (at == names.end())
      expected(kModel, "names of links of the scene, " + listed(names), one.name);
    out.push_back(one.link);
    out.back().link = static_cast<int>(at - names.begin());
    if (std::count_if(out.begin(), out.end(),
                      [&](const BelievedLink& b) { return b.link == out.back().link; }) > 1)
      expected(kModel, "each link once", one.name);
  }
  return out;
}

/// What an engine answers to the greeting.
struct Introduction {
  std::string name, version, refuses;
  std::vector<std::string> quantities, joints;
  std::optional<std::vector<ToldLink>> model;
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
    const std::vector<std::string> allowed = askable();
    for (const std::string& quantity : quantities)
      if (std::find(allowed.begin(), allowed.end(), quantity) == allowed.end())
        expected("quantities", "names among " + listed(allowed), quantity);
    if (said.contains(kModel)) model = toldLinks(said.at(kModel));
    if (quantities.empty() && !model)
      expected("quantities", "at least one of " + listed(allowed), Json::array());
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
/// @param label  what stands in front of its numbers
template <typename Numbers>
void append(std::string_view label, const Numbers& ours, const std::vector<int>& order,
            std::string* to) {
  *to += label;
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

/// How something stands in an answer, and where its entries go.
struct Form {
  enum class Written { kNumber, kList, kRows };
  std::string name;
  Eigen::Index rows = 1, columns = 1;
  Written written = Written::kNumber;
  const std::vector<int>*rows_at = nullptr, *columns_at = nullptr;  ///< none: as they stand
  bool is_row_by_row = false;  ///< a column of ours, the rows one after the other

  bool hasRows() const { return written == Written::kRows; }
  static Eigen::Index placed(const std::vector<int>* at, Eigen::Index i) {
    return at == nullptr ? i : static_cast<Eigen::Index>((*at)[static_cast<std::size_t>(i)]);
  }
  double& entry(Eigen::MatrixXd& value, Eigen::Index i, Eigen::Index j) const {
    return value(placed(rows_at, i), placed(columns_at, j));
  }
  Eigen::MatrixXd ours(Eigen::MatrixXd value) const {
    if (!is_row_by_row) return value;
    return value.reshaped<Eigen::RowMajor>();
  }
};

// ---- the witness

struct Handshake {
  std::unique_ptr<Conversation> program;
  Introduction said;

  /// @throws std::runtime_error  what is wrong with its answer, or why there is none
  Handshake(const std::string& command, const Limits& limits, const scene::Scene& scene)
      : program(std::make_unique<Conversation>(command, limits)),
        said(parsed(program->ask(greetingOf(scene),
                                 kMostIntroduction + kALink * scene.mechanism.links.size()))) {}

 private:
  static constexpr std::size_t kMostIntroduction = 1 << 20, kALink = 1 << 10;
};

class EngineWitness : public OutsideWitness, public OutsideClaims {
 public:
  struct Batch {
    const State* first;
    std::size_t count;
    const State* begin() const { return first; }
    const State* end() const { return first + count; }
  };

  EngineWitness(std::string name, const std::string& command, const Limits& limits,
                const PreparedScene& scene)
      : name_(std::move(name)), mechanism_(scene.mechanism()), judge_(scene) {
    guarded("in the handshake", [&] {
      Handshake made(command, limits, scene.scene());
      program_ = std::move(made.program);
      introduction_.emplace(std::move(made.said));
      if (!introduction_->refuses.empty()) return;
      order_.emplace(mechanism_, *introduction_);
      if (introduction_->model)
        believed_ = crosscheck::believedLinks(*introduction_->model, mechanism_);
    });
  }

  /// Nothing: it failed before it said so.
  const std::optional<Introduction>& introduction() const { return introduction_; }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return !failure_.empty() || knows(quantity); }
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
  /// In our order; or why there is none.
  struct Said {
    Eigen::MatrixXd value;
    std::string reason;
  };
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
            [&] { program_->put(question(states, forms, frame)); });
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
      if (!readPlain(said, batch, states, forms, &answers))
        answers = readAny(parsed(said), batch, states, forms);
    });
    if (!failure_.empty()) throw std::runtime_error(failure_);
    return answers;
  }

  std::string question(const Batch& states, const std::vector<Form>& forms,
                       const FramePoint* frame) const {
    std::string text = fmt::format("{{\"batch\":{},\"quantities\":[", batch_);
    for (const Form& form : forms)
      text += fmt::format("{}\"{}\"", text.back() == '[' ? "" : ",", form.name);
    text += "],";
    if (frame != nullptr) {
      text += fmt::format("\"frame\":{{\"link\":{},\"at\":[", frame->link);
      for (int k = 0; k < 3; ++k) {
        if (k > 0) text += ',';
        append(frame->at(k), &text);
      }
      text += "]},";
    }
    text += "\"states\":[";
    std::vector<double> q;
    for (const State& state : states) {
      q.clear();
      for (const auto& x : state.x) q.push_back(x.q);
      if (text.back() != '[') text += ',';
      append("{\"q\":[", q, order_->positions, &text);
      append(",\"qd\":[", state.qd, order_->rates, &text);
      append(",\"qdd\":[", state.qdd, order_->rates, &text);
      append(",\"tau\":[", state.tau, order_->rates, &text);
      text += '}';
    }
    return text + "]}";
  }

  /// @return  false: it has to be read as any JSON
  static bool readPlain(const std::string& line, long asked, std::size_t states,
                        const std::vector<Form>& forms, std::vector<Said>* answers) {
    PlainJson text(line);
    double batch = 0;
    if (!text.take('{') || !text.key("batch") || !text.number(&batch) ||
        batch != static_cast<double>(asked) || !text.take(',') || !text.key("answers") ||
        !text.take('['))
      return false;
    answers->clear();
    answers->reserve(states * forms.size());
    for (std::size_t k = 0; k < states; ++k) {
      if ((k > 0 && !text.take(',')) || !text.take('{')) return false;
      for (std::size_t m = 0; m < forms.size(); ++m) {
        const Form& form = forms[m];
        if ((m > 0 && !text.take(',')) || !text.key(form.name.c_str())) return false;
        const bool is_list = form.written != Form::Written::kNumber;
        Eigen::MatrixXd value(form.rows, form.columns);
        if (is_list && !text.take('[')) return false;
        for (Eigen::Index i = 0; i < value.rows(); ++i) {
          if ((i > 0 && !text.take(',')) || (form.hasRows() && !text.take('['))) return false;
          for (Eigen::Index j = 0; j < value.cols(); ++j)
            if ((j > 0 && !text.take(',')) || !text.number(&form.entry(value, i, j))) return false;
          if (form.hasRows() && !text.take(']')) return false;
        }
        if (is_list && !text.take(']')) return false;
        answers->push_back({form.ours(std::move(value)), ""});
      }
      if (!text.take('}')) return false;
    }
    return text.take(']') && text.take('}') && text.isAtEnd();
  }

  /// @throws std::runtime_error  what was expected, and what came
  static std::vector<Said> readAny(const Json& said, long asked, std::size_t states,
                                   const std::vector<Form>& forms) {
    std::vector<Said> answers;
    if (!said.contains("batch") || said.at("batch") != asked)
      expected("batch", fmt::format("{}", asked),
               said.contains("batch") ? said.at("batch") : Json("none"));
    if (!said.contains("answers") || !said.at("answers").is_array() ||
        said.at("answers").size() != states)
      expected("answers", fmt::format("a list of {}, one a state", states),
               said.contains("answers") ? said.at("answers") : Json("none"));
    for (std::size_t k = 0; k < states; ++k) {
      const Json& one = said.at("answers").at(k);
      for (const Form& form : forms) {
        const std::string where = fmt::format("{} of state {}", form.name, k + 1);
        if (!one.is_object() || !one.contains(form.name))
          expected(where, "numbers, or a text with the reason why there are none", one);
        const Json& value = one.at(form.name);
        requireShape(form, where, value);
        answers.push_back(read(form, value));
      }
    }
    return answers;
  }

  static void requireShape(const Form& form, const std::string& where, const Json& said) {
    if (said.is_string()) return;  // why there is no value
    const auto rows = static_cast<std::size_t>(form.rows),
               columns = static_cast<std::size_t>(form.columns);
    if (form.written == Form::Written::kNumber) {
      if (!said.is_number()) expected(where, "a number", said);
      return;
    }
    const std::string shape =
        fmt::format("{} {}{}", rows, form.hasRows() ? "row" : "number", rows == 1 ? "" : "s");
    if (!said.is_array() || said.size() != rows)
      expected(where, shape, said.is_array() ? Json(fmt::format("{} of them", said.size())) : said);
    for (const Json& row : said) {
      if (!form.hasRows()) {
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
  static Said read(const Form& form, const Json& said) {
    if (said.is_string()) {
      const std::string reason = plain(said.get<std::string>());
      return {{}, reason.empty() ? "it does not say why" : reason};
    }
    Eigen::MatrixXd out(form.rows, form.columns);
    for (Eigen::Index i = 0; i < out.rows(); ++i)
      for (Eigen::Index j = 0; j < out.cols(); ++j) {
        const Json& row = said.is_array() ? said.at(static_cast<std::size_t>(i)) : said;
        const Json& x = row.is_array() ? row.at(static_cast<std::size_t>(j)) : row;
        form.entry(out, i, j) = x.get<double>();
      }
    return {form.ours(std::move(out)), ""};
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

std::string greetingOf(const scene::Scene& scene) {
  std::vector<std::string> asks = askable();
  asks.emplace_back(kModel);
  const Json greeting = {
      {"protocol", kEngineProtocol}, {"asks", asks}, {"scene", sceneJson(scene)}};
  return greeting.dump(-1, ' ', false, Json::error_handler_t::replace);
}

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
