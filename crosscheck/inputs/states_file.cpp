// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/states_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scene/error.hpp"
#include "scene/faults.hpp"
#include "scene/mimic.hpp"
#include "scene/nearest_name.hpp"
#include "scene/text_file.hpp"
#include "scene/words.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::InputError;
using scene::SourceLocation;

enum Group { kQ, kQd, kQdd, kTau };
constexpr std::array<const char*, 4> kGroups = {"q", "qd", "qdd", "tau"};

using scene::trimmed;

void split(std::string_view line, std::vector<std::string_view>* cells) {
  cells->clear();
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    cells->push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return;
    begin = comma + 1;
  }
}

/// Lines of an open file. A line is gone when the next is asked for.
class Lines {
 public:
  Lines(int descriptor, std::string name) : descriptor_(descriptor), where_{std::move(name), 0} {
    struct stat status;
    if (fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode))
      size_ = static_cast<double>(status.st_size);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;
  ~Lines() {
    if (descriptor_ != STDIN_FILENO) close(descriptor_);
  }

  const SourceLocation& where() const { return where_; }  ///< of the last line
  double fraction() const { return size_ > 0 ? std::min(1.0, bytes_ / size_) : -1; }
  bool isRegular() const { return size_ >= 0; }
  /// No whole line is at hand, and it is no regular file that has one.
  bool mayWait() const {
    return size_ < 0 && !at_end_ && buffer_.find('\n', searched_) == std::string::npos;
  }
  void setLongest(std::size_t bytes) { longest_ = bytes; }

  bool next(std::string_view* line) {
    std::size_t end;
    while ((end = buffer_.find('\n', searched_)) == std::string::npos && !at_end_) {
      buffer_.erase(0, begin_);
      begin_ = 0;
      searched_ = buffer_.size();
      if (searched_ > longest_) refuse(fmt::format("a line of more than {} bytes", longest_));
      read();
    }
    if (end == std::string::npos) {
      if (begin_ == buffer_.size()) return false;
      end = buffer_.size();
    }
    *line = std::string_view(buffer_).substr(begin_, end - begin_);
    if (where_.line == 0 && line->substr(0, 3) == "\xEF\xBB\xBF")
      line->remove_prefix(3);  // byte order mark
    ++where_.line;
    begin_ = searched_ = std::min(end + 1, buffer_.size());
    return true;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError({where_.file, where_.line + 1}, what + ", allowed: a CSV file of states");
  }

  void read() {
    std::array<char, 1 << 16> chunk;
    ssize_t got;
    while ((got = ::read(descriptor_, chunk.data(), chunk.size())) < 0 && errno == EINTR) {
    }
    if (got < 0)
      throw InputError({where_.file}, fmt::format("cannot be read: {}", std::strerror(errno)));
    at_end_ = got == 0;
    bytes_ += static_cast<double>(got);
    buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  }

  int descriptor_;
  SourceLocation where_;
  std::string buffer_;
  std::size_t begin_ = 0,
              searched_ = 0;  ///< of what is not handed out, of what may hold a line's end
  std::size_t longest_ = std::size_t{1} << 20;
  double size_ = -1, bytes_ = 0;
  bool at_end_ = false;
};

void requireQuaternions(const scene::Mechanism& mechanism, const scene::State<double>& state,
                        const SourceLocation& where) {
  int slot = 0;
  for (const scene::Link& link : mechanism.links) {
    const std::vector<scene::SlotKind>& slots = scene::positionSlots(link.joint.kind);
    slot += static_cast<int>(slots.size());
    if (slots.empty() || slots.back() != scene::SlotKind::kQuaternion) continue;
    double size = 0;
    for (int k = slot - 4; k < slot; ++k) size += std::abs(state.x[k].q);
    if (size == 0)
      throw InputError(where,
                       fmt::format("q{} to q{} are the quaternion of joint '{}' and all zero, "
                                   "allowed: any other (1, 0, 0, 0 is no turn)",
                                   slot - 3, slot, link.joint.name));
  }
}

}  // namespace

struct StatesReader::Parts {
  Parts(int descriptor, const std::string& name, const scene::Mechanism& of,
        const OtherColumns& allowed)
      : lines(descriptor, name),
        mechanism(&of),
        given(scene::givenSlots(of)),
        positions(static_cast<int>(given.size())),
        others(allowed) {}

  int count(int group) const { return group == kQ ? positions : mechanism->dof(); }

  /// What a comment says of the convention.
  void seeComment(std::string_view comment) {
    constexpr std::string_view kWord = "convention:";
    const std::string_view text = trimmed(comment.substr(1));  // behind #
    if (text.compare(0, kWord.size(), kWord) != 0) return;
    if (!names.empty())
      throw InputError(lines.where(),
                       fmt::format("read '# {}' below the header, allowed: above it", text));
    told = trimmed(text.substr(kWord.size()));
  }

  /// Of what is given and what the file says.
  void settle(std::optional<CoordinateConvention> asked) {
    if (!told.empty()) {
      CoordinateConvention own;
      try {
        own = conventionNamed(told);
      } catch (const InputError& error) {
        throw InputError(lines.where(), error.what());
      }
      if (asked && *asked != own && hasOrientations(*mechanism))
        throw InputError(
            lines.where(),
            fmt::format("the file's convention is {}, and {} is read, allowed: that of "
                        "the file, or a file without that line",
                        told, name(*asked)));
      asked = own;
    }
    if (!asked && hasOrientations(*mechanism))
      throw InputError(
          lines.where(),
          fmt::format(
              "the scene has spherical or floating joints, and whose coordinates the file has "
              "of them is not said; allowed: --convention, or a first line \"# convention: "
              "dynwitness\", with one of {}",
              fmt::join(conventionNames(), ", ")));
    convention = asked.value_or(CoordinateConvention::kDynwitness);
    if (convention == CoordinateConvention::kDynwitness) return;
    coordinates.emplace(*mechanism, convention);
    positions = coordinates->positions();
  }

  /// The next line that says something, as cells.
  bool nextCells() {
    std::string_view line;
    while (lines.next(&line)) {
      split(line, &cells);
      if (cells[0].substr(0, 1) == "#")
        seeComment(cells[0]);
      else if (cells.size() > 1 || !cells[0].empty())
        return true;
    }
    return false;
  }

  std::string allowedColumns() const {
    return fmt::format(
        "q1..q{1}, qd1..qd{0}, and qdd1..qdd{0} or tau1..tau{0}{3}{2}", mechanism->dof(), positions,
        others.names.empty() ? "" : fmt::format(", and {}", fmt::join(others.names, ", ")),
        columnsOfJoints().empty()
            ? ""
            : fmt::format(" (or by joint: {0}, {0}.qd, {0}.qdd, {0}.tau, ...)",
                          mechanism->rateLabels().front()));
  }

  /** What columns may be called by joints: "elbow" and "elbow.q" are q of that joint, "elbow.qd"
      its rate, "elbow.qdd", "elbow.tau"; "hip.turn.qd" where a joint has several. Without joints
      whose positions are not counted as their rates are, and in dynwitness' own coordinates. */
  std::unordered_map<std::string, std::string> columnsOfJoints() const {
    std::unordered_map<std::string, std::string> columns;
    if (coordinates || mechanism->positions() != mechanism->dof()) return columns;
    const std::vector<std::string> labels = mechanism->rateLabels();
    for (std::size_t k = 0; k < labels.size(); ++k)
      for (const char* group : kGroups) {
        const std::string column = group + std::to_string(k + 1);
        columns.emplace(labels[k] + "." + group, column);
        if (std::string_view(group) == "q") columns.emplace(labels[k], column);
      }
    // a joint of the name of a column, or of another that is asked for, is called as ever
    for (std::size_t group = 0; group < kGroups.size(); ++group)
      for (int i = 1; i <= count(static_cast<int>(group)); ++i)
        columns.erase(kGroups[group] + std::to_string(i));
    for (const std::string& name : others.names) columns.erase(name);
    return columns;
  }

  /// The number that a cell is, as no name of a column is; none: it is another word.
  static std::optional<double> numberIn(std::string_view cell) {
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size()) return {};
    return value;
  }

  /// Lines that are no header of ours, whatever the scene.
  void refuseOtherForms() const {
    const std::size_t mark = cells[0].find_first_of(";\t ");
    // a joint may have a name of two words
    if (cells.size() == 1 && mark != std::string_view::npos &&
        columnsOfJoints().count(std::string(cells[0])) == 0)
      throw InputError(
          lines.where(),
          fmt::format("the header's columns are separated by {}, allowed: commas, and points in "
                      "numbers",
                      cells[0][mark] == ';'    ? "\";\""
                      : cells[0][mark] == '\t' ? "tabs"
                                               : "blanks"));
    if (std::all_of(cells.begin(), cells.end(),
                    [](std::string_view cell) { return numberIn(cell).has_value(); }))
      throw InputError(lines.where(),
                       fmt::format("'{}' where the header is expected, allowed as the first line: "
                                   "names of columns, {}",
                                   cells[0].substr(0, 80), allowedColumns()));
  }

  /// " (did you mean qd1, qd2?)": of columns that the header has not.
  std::string meant(const std::vector<std::string>& unknown) const {
    std::vector<std::string> free, near;
    const auto add = [&](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) free.push_back(name);
    };
    for (std::size_t group = 0; group < kGroups.size(); ++group)
      for (int i = 1; i <= count(static_cast<int>(group)); ++i)
        add(kGroups[group] + std::to_string(i));
    for (const std::string& name : others.names) add(name);
    for (const auto& [name, column] : columnsOfJoints()) add(name);
    std::sort(free.begin(), free.end());
    constexpr std::size_t kMostGuesses = 8;  // of a file of other numbers nobody wants more
    for (std::size_t k = 0; k < std::min(unknown.size(), kMostGuesses); ++k)
      if (const std::string one = scene::nearestName(unknown[k], free); !one.empty())
        near.push_back(one);
    return near.empty() ? "" : fmt::format(" (did you mean {}?)", fmt::join(near, ", "));
  }

  void readHeader(std::optional<CoordinateConvention> asked) {
    // 64 bytes are more than a number or a name of a column takes
    std::size_t columns = others.names.size();
    for (std::size_t group = 0; group < kGroups.size(); ++group)
      columns += static_cast<std::size_t>(count(group));
    lines.setLongest((std::size_t{1} << 16) + 64 * columns);
    if (!nextCells()) throw InputError(lines.where(), "no header, expected " + allowedColumns());
    settle(asked);
    refuseOtherForms();
    const std::string allowed = allowedColumns();

    const std::unordered_map<std::string, std::string> of_joints = columnsOfJoints();
    std::unordered_map<std::string, int> at;  // column name -> place in the row
    for (const std::string_view cell : cells) {
      names.emplace_back(cell);
      const auto of_joint = of_joints.find(names.back());
      const std::string& column = of_joint == of_joints.end() ? names.back() : of_joint->second;
      if (!at.emplace(column, static_cast<int>(names.size()) - 1).second)
        throw InputError(lines.where(), fmt::format("column '{}' stands twice", cell));
    }
    std::size_t known = 0;
    for (std::size_t group = 0; group < kGroups.size(); ++group) {
      std::string missing;
      for (int i = 1; i <= count(group); ++i) {
        const std::string column = kGroups[group] + std::to_string(i);
        const auto found = at.find(column);
        if (found == at.end() && missing.empty()) missing = column;
        if (found == at.end()) continue;
        places[group].push_back(found->second);
        at.erase(found);
        ++known;
      }
      if (missing.empty() || (places[group].empty() && (group != kQ || !others.has_positions)))
        continue;
      if (first_missing.empty()) first_missing = missing;
    }
    for (const std::string& name : others.names)
      if (const auto found = at.find(name); found != at.end()) {
        other_names.push_back(name);
        other_places.push_back(found->second);
        at.erase(found);
        ++known;
      }
    std::vector<std::string> unknown;
    for (std::size_t k = 0; k < names.size() && known < names.size(); ++k) {
      const auto left = at.find(names[k]);
      if (left == at.end() || left->second != static_cast<int>(k)) continue;
      unknown.push_back(fmt::format("'{}'", names[k]));
      kept_names.push_back(names[k]);
      kept_places.push_back(static_cast<int>(k));
    }
    std::vector<std::string> faults;
    const bool has_unknown = !unknown.empty() && !others.are_kept;
    if (has_unknown)
      faults.push_back(fmt::format("column{} {} {} unknown{}", unknown.size() > 1 ? "s" : "",
                                   fmt::join(unknown, ", "), unknown.size() > 1 ? "are" : "is",
                                   meant(kept_names)));
    if (!first_missing.empty())
      faults.push_back(fmt::format("column '{}' is missing", first_missing));
    if (!faults.empty())
      throw InputError(lines.where(), fmt::format("{}, allowed: {}{}", fmt::join(faults, "; "),
                                                  allowed, has_unknown ? others.remedy : ""));
  }

  double number(int place) const {
    const std::string_view cell = cells[static_cast<std::size_t>(place)];
    const std::optional<double> value = numberIn(cell);
    if (!value || !std::isfinite(*value))
      throw InputError(lines.where(),
                       fmt::format("{} is '{}', allowed: a finite number",
                                   names[static_cast<std::size_t>(place)], cell.substr(0, 80)));
    return *value;
  }

  void fill(int group, std::vector<double>* values) const {
    values->assign(static_cast<std::size_t>(count(group)), 0.0);
    for (std::size_t i = 0; i < places[group].size(); ++i) (*values)[i] = number(places[group][i]);
  }

  /// The row at hand as a state. @throws InputError  its first fault
  void readRow(scene::State<double>* state) {
    if (cells.size() != names.size())
      throw InputError(lines.where(),
                       fmt::format("{} entries, the header names {}", cells.size(), names.size()));
    if (coordinates) {
      fill(kQ, &q);
      fill(kQd, &state->qd);
      fill(kQdd, &state->qdd);
      fill(kTau, &state->tau);
      try {
        coordinates->read(q, state);
      } catch (const InputError& error) {
        throw InputError(lines.where(), error.what());
      }
      return;
    }
    state->x.resize(static_cast<std::size_t>(mechanism->positions()));
    for (std::size_t i = 0; i < places[kQ].size(); ++i)
      state->x[static_cast<std::size_t>(given[i])] = scene::jointPosition(number(places[kQ][i]));
    if (!places[kQ].empty()) {
      scene::followLeaders(*mechanism, &state->x);
      requireQuaternions(*mechanism, *state, lines.where());
    }
    fill(kQd, &state->qd);
    fill(kQdd, &state->qdd);
    fill(kTau, &state->tau);
    for (const int place : other_places) number(place);
  }

  /// What is wrong with the row at hand: each of its cells, or else what readRow() says.
  void findFaults(scene::State<double>* state, scene::Faults& faults) {
    std::size_t right = 0, all = 0;
    for (const std::vector<int>* group :
         {&places[kQ], &places[kQd], &places[kQdd], &places[kTau], &other_places})
      for (const int place : *group) {
        ++all;
        if (cells.size() == names.size()) faults.collect([&] { number(place), ++right; });
      }
    if (right == all || cells.size() != names.size()) faults.collect([&] { readRow(state); });
  }

  Lines lines;
  const scene::Mechanism* mechanism;
  std::vector<int> given;  ///< slots of q that have a column: those of followers have none
  int positions;           ///< how many columns q has
  std::string told;        ///< the convention's name in the file
  CoordinateConvention convention = CoordinateConvention::kDynwitness;
  std::optional<Coordinates> coordinates;  ///< none: those of scene::State
  std::vector<double> q;                   ///< of the last row, theirs
  std::vector<std::string> names;          ///< of the columns
  std::array<std::vector<int>, 4> places;  ///< of each group's columns in a row; empty: not given
  OtherColumns others;
  std::vector<std::string> other_names;
  std::vector<int> other_places;
  std::vector<std::string> kept_names;
  std::vector<int> kept_places;
  std::string first_missing;
  bool has_rows = false;                ///< below the header, so far
  std::vector<std::string_view> cells;  ///< of the last line
};

StatesReader::StatesReader(const std::filesystem::path& file, const scene::Mechanism& mechanism,
                           const OtherColumns& others,
                           std::optional<CoordinateConvention> convention) {
  const bool is_piped = file == "-";
  const int descriptor =
      is_piped ? STDIN_FILENO
               : scene::openRegularFile(file, "a CSV file of states, or - for standard input");
  parts_ = std::make_unique<Parts>(descriptor, is_piped ? "standard input" : file.string(),
                                   mechanism, others);
  parts_->readHeader(convention);
}
StatesReader::~StatesReader() = default;

bool StatesReader::gives(const std::string& group) const {
  const auto found = std::find(kGroups.begin(), kGroups.end(), group);
  return found != kGroups.end() &&
         !parts_->places[static_cast<std::size_t>(found - kGroups.begin())].empty();
}

const std::vector<std::string>& StatesReader::otherNames() const {
  return parts_->other_names;
}
std::vector<double> StatesReader::others() const {
  std::vector<double> out;
  for (const int place : parts_->other_places) out.push_back(parts_->number(place));
  return out;
}

const std::vector<std::string>& StatesReader::keptNames() const {
  return parts_->kept_names;
}
std::vector<std::string> StatesReader::kept() const {
  std::vector<std::string> out;
  for (const int place : parts_->kept_places)
    out.emplace_back(parts_->cells[static_cast<std::size_t>(place)]);
  return out;
}
CoordinateConvention StatesReader::convention() const {
  return parts_->convention;
}

bool StatesReader::mayWait() const {
  return parts_->lines.mayWait();
}

double StatesReader::fraction() const {
  return parts_->lines.fraction();
}

bool StatesReader::next(scene::State<double>* state) {
  Parts& p = *parts_;
  if (!p.nextCells()) {
    if (!p.has_rows)
      throw InputError(p.lines.where(), "no state after the header, expected at least one row");
    return false;
  }
  p.has_rows = true;
  try {
    p.readRow(state);
    return true;
  } catch (const InputError&) {
  }
  scene::Faults faults;
  p.findFaults(state, faults);
  // the rest of a file is there; who writes into a pipe may wait for us
  while (p.lines.isRegular() && p.nextCells()) p.findFaults(state, faults);
  faults.raise();
  return false;
}

}  // namespace dynwitness::crosscheck
