// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/recorded.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/outside_judge.hpp"

namespace dynwitness::crosscheck {
namespace {

using State = scene::State<double>;

/// What a table may hold beside tau and qdd, which are columns of states as well.
constexpr Quantity kOthers[] = {Quantity::kM,        Quantity::kc,         Quantity::kg,
                                Quantity::kKinetic,  Quantity::kPotential, Quantity::kMomentum,
                                Quantity::kReactions};

Eigen::MatrixXd asColumn(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

class RecordedWitness : public Witness {
 public:
  RecordedWitness(std::string name, const Recorded& recorded, const PreparedScene& scene)
      : name_(std::move(name)), recorded_(recorded), judge_(scene) {
    for (std::size_t k = 0; k < recorded_.states.size(); ++k)
      rows_[keyOf(recorded_.states[k])].push_back(k);
  }
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return answersOf(quantity) != nullptr; }
  Answer answer(Quantity quantity, const State& state) override {
    const auto* const all = answersOf(quantity);
    const auto found = rows_.find(keyOf(state));
    if (all == nullptr || found == rows_.end())
      throw std::runtime_error(
          fmt::format("{} has no {} at this state", name_, crosscheck::name(quantity)));
    // rows of the same state are answered in turn
    std::size_t& turn = turns_[{quantity, found->second.front()}];
    const std::size_t row = found->second[turn++ % found->second.size()];
    return judge_.judged(quantity, state, (*all)[row]);
  }

 private:
  using Key = std::vector<double>;
  static Key keyOf(const State& state) {
    Key key;
    for (const auto& x : state.x) key.push_back(x.q);
    for (const auto* part : {&state.qd, &state.qdd, &state.tau})
      key.insert(key.end(), part->begin(), part->end());
    return key;
  }
  const std::vector<Eigen::MatrixXd>* answersOf(Quantity quantity) const {
    for (const auto& [which, all] : recorded_.answers)
      if (which == quantity) return &all;
    return nullptr;
  }

  std::string name_;
  Recorded recorded_;
  OutsideJudge judge_;
  std::map<Key, std::vector<std::size_t>> rows_;
  std::map<std::pair<Quantity, std::size_t>, std::size_t> turns_;
};

/// T' x, column by column.
Eigen::MatrixXd turnedBack(const Coordinates& from, const State& state, Eigen::MatrixXd x) {
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    x.col(j) = asColumn(from.ours(state, std::vector<double>(x.col(j).begin(), x.col(j).end())));
  return x;
}

/// An answer in the coordinates of scene::State. tau and qdd are the reader's.
Eigen::MatrixXd inOurs(const Coordinates& from, Quantity quantity, const State& state,
                       const Eigen::MatrixXd& value, const scene::SourceLocation& file) {
  if (from.isOurs()) return value;
  switch (quantity) {
    case Quantity::kc: {
      const std::vector<double> gained = from.turning(state);
      // undone, it would have the roundings of a product with M, which no limit of c has room for
      if (std::any_of(gained.begin(), gained.end(), [](double x) { return x != 0; }))
        throw scene::InputError(
            file,
            fmt::format("c1.. in coordinates of {}, which has a part of M qdd in it, allowed: "
                        "tau1.., M11.., g1..",
                        name(from.convention())));
      return turnedBack(from, state, value);
    }
    case Quantity::kg:
      return turnedBack(from, state, value);
    case Quantity::kM:
      return turnedBack(from, state, turnedBack(from, state, value).transpose());
    default:
      return value;
  }
}

}  // namespace

Recorded readRecorded(const scene::Scene& scene, const std::filesystem::path& answers,
                      const std::filesystem::path& states,
                      std::optional<CoordinateConvention> convention) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const scene::SourceLocation file{answers.string(), 0};
  OtherColumns allowed;
  for (const Quantity quantity : kOthers)
    for (const std::string& column : columnNames(quantity, mechanism))
      allowed.names.push_back(column);
  allowed.has_positions = states.empty();
  StatesReader table(answers, mechanism, allowed, convention);
  const Coordinates coordinates(mechanism, table.convention());
  std::optional<StatesReader> beside;
  if (!states.empty()) {
    if (!coordinates.isOurs())
      throw scene::InputError(
          file, fmt::format("answers in coordinates of {}, and states in another file, allowed: "
                            "columns of the states in this one",
                            name(coordinates.convention())));
    beside.emplace(states, mechanism, OtherColumns(), table.convention());
    for (const char* group : {"q", "qd"})
      if (table.gives(group))
        throw scene::InputError(file, fmt::format("columns {}1.. stand in {} too, allowed: states "
                                                  "in one file",
                                                  group, states.string()));
  }
  const StatesReader& given = beside ? *beside : table;

  Recorded out;
  std::vector<std::vector<std::size_t>> places;  // of each quantity's columns; none: tau and qdd
  const std::vector<std::string>& there = table.otherNames();
  const auto place = [&](const std::string& column) {
    return static_cast<std::size_t>(std::find(there.begin(), there.end(), column) - there.begin());
  };
  for (const Quantity quantity : kOthers) {
    std::vector<std::size_t> columns;
    std::string missing;
    const std::vector<std::string> names = columnNames(quantity, mechanism);
    for (const std::string& column : names)
      if (place(column) < there.size())
        columns.push_back(place(column));
      else if (missing.empty())
        missing = column;
    if (columns.empty()) continue;
    if (!missing.empty())
      throw scene::InputError(file, fmt::format("column '{}' is missing, expected {} to {}",
                                                missing, names.front(), names.back()));
    out.answers.emplace_back(quantity, std::vector<Eigen::MatrixXd>());
    places.push_back(columns);
  }
  const auto addGroup = [&](Quantity quantity, const char* needed) {
    if (!table.gives(crosscheck::name(quantity))) return;
    if (!given.gives(needed))
      throw scene::InputError(file,
                              fmt::format("{0}1.. without {1}1..: it is judged as the answer to "
                                          "q, qd and {1}, allowed: {1}1.. with it",
                                          crosscheck::name(quantity), needed));
    out.answers.emplace_back(quantity, std::vector<Eigen::MatrixXd>());
    places.emplace_back();
  };
  for (const auto& [quantity, all] : out.answers)
    if (quantity == Quantity::kReactions && !given.gives("qdd"))
      throw scene::InputError(file,
                              "reactions without qdd1..: they are judged as the answer to q, qd "
                              "and qdd, allowed: qdd1.. with them");
  addGroup(Quantity::kTau, "qdd");
  if (beside) addGroup(Quantity::kQdd, "tau");
  if (out.answers.empty())
    throw scene::InputError(
        file, fmt::format("no answers, allowed: columns as evaluate writes them: {}{}",
                          beside ? "qdd1.., " : "",
                          "tau1.., M11.., c1.., g1.., kinetic, "
                          "potential, momentum1.., JOINT.fx to JOINT.mz of all joints"));

  State state, row;
  for (;;) {
    const bool has_row = table.next(&row), has_state = beside ? beside->next(&state) : has_row;
    if (has_row != has_state)
      throw scene::InputError(file, fmt::format("{} rows than {}, expected as many",
                                                has_row ? "more" : "fewer", states.string()));
    if (!has_row) break;
    if (!beside) state = row;
    out.states.push_back(state);
    const std::vector<double> values = table.others();
    for (std::size_t i = 0; i < out.answers.size(); ++i) {
      auto& [quantity, all] = out.answers[i];
      if (quantity == Quantity::kTau || quantity == Quantity::kQdd) {
        all.push_back(asColumn(quantity == Quantity::kTau ? row.tau : row.qdd));
        continue;
      }
      std::vector<double> said;
      for (const std::size_t k : places[i]) said.push_back(values[k]);
      Eigen::MatrixXd value = asColumn(said);
      if (quantity == Quantity::kM)
        value = Eigen::MatrixXd(value.reshaped<Eigen::RowMajor>(mechanism.dof(), mechanism.dof()));
      all.push_back(inOurs(coordinates, quantity, state, value, file));
    }
  }
  return out;
}

WitnessKind recordedKind(Recorded recorded, const std::string& name) {
  WitnessInfo info;
  info.name = name;
  info.version = "(recorded)";
  info.method = "answers that have been given already";
  return {info, [name, recorded = std::move(recorded)](const PreparedScene& scene) -> MadeWitness {
            return std::make_unique<RecordedWitness>(name, recorded, scene);
          }};
}

}  // namespace dynwitness::crosscheck
