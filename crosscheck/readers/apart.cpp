// SPDX-License-Identifier: GPL-3.0-or-later
// Readings in copies of this process: an engine that crashes, hangs or eats the memory on a file
// loses its copy, and what it says on its way is its last words.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <memory>
#include <new>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/readers/reader.hpp"
#include "crosscheck/system/processes.hpp"

namespace dynwitness::crosscheck {
namespace {

using nlohmann::json;

// ---- a reading as bytes (CBOR, which keeps every double, NaN included)

template <typename Numbers>
json listOf(const Numbers& numbers) {
  json out = json::array();
  for (Eigen::Index i = 0; i < numbers.size(); ++i) out.push_back(numbers.data()[i]);
  return out;
}
template <typename Numbers>
void fill(const json& list, Numbers* numbers) {
  for (Eigen::Index i = 0; i < numbers->size(); ++i)
    numbers->data()[i] = list.at(static_cast<std::size_t>(i)).get<double>();
}
json optional(const std::optional<double>& x) {
  return x ? json(*x) : json();
}
std::optional<double> optional(const json& x) {
  return x.is_null() ? std::optional<double>() : x.get<double>();
}

json bodyJson(const ReadBody& b) {
  const MassMoments& m = b.moments;
  return {b.link,
          b.joint,
          b.parent,
          static_cast<int>(b.kind),
          listOf(b.placement.matrix()),
          listOf(b.axis),
          {m.mass, listOf(m.first), listOf(m.second), m.reach2},
          b.links,
          optional(b.lower),
          optional(b.upper),
          {b.damping, b.friction, b.armature, b.stiffness, b.rest},
          b.leader,
          {b.multiplier, b.offset}};
}
ReadBody bodyOf(const json& j) {
  ReadBody b;
  std::size_t k = 0;
  const auto next = [&]() -> const json& { return j.at(k++); };
  b.link = next().get<std::string>();
  b.joint = next().get<std::string>();
  b.parent = next().get<int>();
  b.kind = static_cast<scene::JointKind>(next().get<int>());
  fill(next(), &b.placement.matrix());
  fill(next(), &b.axis);
  const json& m = next();
  b.moments.mass = m.at(0).get<double>();
  fill(m.at(1), &b.moments.first);
  fill(m.at(2), &b.moments.second);
  b.moments.reach2 = m.at(3).get<double>();
  b.links = next().get<int>();
  b.lower = optional(next());
  b.upper = optional(next());
  const json& passive = next();
  b.damping = passive.at(0).get<double>();
  b.friction = passive.at(1).get<double>();
  b.armature = passive.at(2).get<double>();
  b.stiffness = passive.at(3).get<double>();
  b.rest = passive.at(4).get<double>();
  b.leader = next().get<std::string>();
  const json& mimic = next();
  b.multiplier = mimic.at(0).get<double>();
  b.offset = mimic.at(1).get<double>();
  return b;
}

std::string packed(const Reading& reading, const std::vector<MassAndGravity>& answers) {
  json bodies = json::array(), said = json::array();
  for (const ReadBody& body : reading.robot.bodies) bodies.push_back(bodyJson(body));
  for (const MassAndGravity& answer : answers) said.push_back({listOf(answer.M), listOf(answer.g)});
  const json all = {reading.refusal,
                    reading.told,
                    reading.shows,
                    reading.not_kept,
                    reading.name,
                    reading.version,
                    listOf(reading.robot.gravity),
                    reading.robot.unturned,
                    bodies,
                    said};
  const std::vector<std::uint8_t> bytes = json::to_cbor(all);
  return {bytes.begin(), bytes.end()};
}

void unpack(const std::string& bytes, ReadApart* out) {
  const json all = json::from_cbor(bytes.begin(), bytes.end());
  Reading& r = out->reading;
  r.refusal = all.at(0).get<std::string>();
  r.told = all.at(1).get<std::vector<std::string>>();
  r.shows = all.at(2).get<bool>();
  r.not_kept = all.at(3).get<std::vector<std::string>>();
  r.name = all.at(4).get<std::string>();
  r.version = all.at(5).get<std::string>();
  fill(all.at(6), &r.robot.gravity);
  r.robot.unturned = all.at(7).get<double>();
  for (const json& body : all.at(8)) r.robot.bodies.push_back(bodyOf(body));
  const auto n = static_cast<Eigen::Index>(r.robot.bodies.size());
  for (const json& said : all.at(9)) {
    MassAndGravity answer{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), {}, {}};
    fill(said.at(0), &answer.M);
    fill(said.at(1), &answer.g);
    out->answers.push_back(std::move(answer));
  }
}

// ---- the copy

/// A file in memory that both processes have: what the copy writes to its streams.
class LastWords {
 public:
  LastWords() : file_(memfd_create("last_words", MFD_CLOEXEC)) {}
  ~LastWords() {
    if (file_ >= 0) close(file_);
  }
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;
  /// In the copy.
  void listen() const {
    dup2(file_, STDOUT_FILENO);
    dup2(file_, STDERR_FILENO);
  }
  /// The last line that says something.
  std::string line() const {
    constexpr off_t kMost = 2000;
    const off_t size = lseek(file_, 0, SEEK_END);
    std::string text(static_cast<std::size_t>(std::clamp<off_t>(size, 0, kMost)), '\0');
    const ssize_t got = pread(file_, text.data(), text.size(),
                              std::max<off_t>(size - static_cast<off_t>(text.size()), 0));
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    for (char& c : text)
      if ((c < ' ' && c != '\n') || c > '~') c = ' ';
    const std::size_t end = text.find_last_not_of(" \n");
    text.resize(end == std::string::npos ? 0 : end + 1);
    const std::size_t begin = text.rfind('\n');
    return begin == std::string::npos ? text : text.substr(begin + 1);
  }

 private:
  int file_;
};

/// That much more address space than this process has: engines, and tools that watch memory, come
/// with some.
void limitMemory(double gigabytes) {
  std::ifstream sizes("/proc/self/statm");
  double pages = 0;
  sizes >> pages;
  const auto bytes =
      static_cast<rlim_t>(pages * static_cast<double>(sysconf(_SC_PAGESIZE)) + gigabytes * 1e9);
  const rlimit memory{bytes, bytes}, none{0, 0};
  setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CORE, &none);
}

constexpr const char* kOutOfMemory = "out of memory";

std::string readHere(const Reader& reader, const std::string& text,
                     const std::filesystem::path& file, int states, std::uint64_t seed) {
  Reading reading;
  std::vector<MassAndGravity> answers;
  try {
    reading = reader.read(text, file);
    const Robot& robot = reading.robot;
    if (reading.refusal.empty() && reading.answer && !robot.bodies.empty() &&
        allHaveOnePosition(robot) && !(reading.shows && isTooLargeToAsk(robot)))
      for (int k = 0; k < states; ++k) {
        answers.push_back(
            reading.answer(drawPositions(robot, seed, static_cast<std::uint64_t>(k))));
        const MassAndGravity& said = answers.back();
        const auto n = static_cast<Eigen::Index>(robot.bodies.size());
        if (said.M.rows() != n || said.M.cols() != n || said.g.size() != n)
          throw std::runtime_error(fmt::format("its M is {} x {} and its g {}, expected {} joints",
                                               said.M.rows(), said.M.cols(), said.g.size(), n));
      }
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(kOutOfMemory);
  } catch (const std::exception& error) {
    if (reader.is_program) throw;  // what it says in words is no exception
    reading.refusal = error.what();
    answers.clear();
  }
  return packed(reading, answers);
}

}  // namespace

bool isTooLargeToAsk(const Robot& robot) {
  constexpr std::size_t kJoints = 200;
  return robot.bodies.size() > kJoints;
}

std::vector<ReadApart> readApart(const std::vector<const Reader*>& readers, const std::string& text,
                                 const std::filesystem::path& file, int states, std::uint64_t seed,
                                 const ReaderLimits& limits) {
  std::vector<ReadApart> out(readers.size());
  std::vector<std::unique_ptr<LastWords>> words;
  for (std::size_t i = 0; i < readers.size(); ++i) words.push_back(std::make_unique<LastWords>());
  const auto work = [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS})
      std::signal(signal, SIG_DFL);
    if (!readers[i]->is_program) limitMemory(limits.gigabytes);
    words[i]->listen();
    return readHere(*readers[i], text, file, states, seed);
  };
  const auto ended = [&](int index, const CopyEnded& copy) {
    const auto i = static_cast<std::size_t>(index);
    if (copy.problem.empty()) {
      unpack(copy.answer, &out[i]);
      return;
    }
    std::string& how = out[i].failure;
    how = copy.problem;
    if (copy.problem == kOutOfMemory)
      how = fmt::format("it asked for more memory than {:g} GB", limits.gigabytes);
    const std::string last = words[i]->line();
    if (!last.empty()) how += "; its last words: " + last;
  };
  inOwnCopies(availableProcessors(), static_cast<int>(readers.size()), limits.seconds, work, ended);
  return out;
}

}  // namespace dynwitness::crosscheck
