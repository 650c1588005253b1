// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's own kernel: what is compiled does what its program says, in every lane; and what
// happens where it cannot be compiled.

#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/emit.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/testimony.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/scene.hpp"
#include "symbolic/program.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using namespace dynwitness::crosscheck::kernel;

namespace {

/// An environment variable, set for as long as this exists.
class Setting {
 public:
  Setting(const Setting&) = delete;
  Setting(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before, was_set_ = true;
    setenv(name, value.c_str(), 1);
  }
  ~Setting() {
    if (was_set_)
      setenv(name_, before_.c_str(), 1);
    else
      unsetenv(name_);
  }

 private:
  const char* name_;
  std::string before_;
  bool was_set_ = false;
};

/// A cache folder of the test's own.
struct Cache {
  Cache() {
    std::string pattern = (fs::temp_directory_path() / "dynwitness_cache_XXXXXX").string();
    folder = mkdtemp(pattern.data());
    setting.emplace("DYNWITNESS_CACHE", folder.string());
  }
  ~Cache() { fs::remove_all(folder); }
  fs::path folder;
  std::optional<Setting> setting;
};
Cache& cache() {
  static Cache only;
  return only;
}
struct UsesCache {
  UsesCache() { cache(); }
};
BOOST_GLOBAL_FIXTURE(UsesCache);

std::vector<int> laneWidths() {
  std::vector<int> all = {2};
  for (int lanes = 4; lanes <= widestLanes(); lanes *= 2) all.push_back(lanes);
  return all;
}

using Function = void (*)(const double*, const double*, const double*, double*);
using ManyFunction = void (*)(const double*, const double*, const double*, double*, long);

/// A compiled program of the test's own making.
struct Compiled {
  Compiled(const symbolic::Graph& graph, const std::vector<symbolic::Node>& outputs, int lanes)
      : program(symbolic::compile(graph, outputs)) {
    const scene::RealNumbers<double> numbers{scene::Mechanism()};
    const symbolic::ProgramRun<double> run(program, numbers);
    CompileOptions options{
        findCompiler(),
        {"-std=gnu11", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-Wno-psabi"},
        cacheFolder()};
    if (lanes == 4) options.flags.push_back("-mavx2");
    if (lanes == 8) options.flags.push_back("-mavx512dq");
    object = compileAndLoad({emitKernel(program, run, "f", lanes)}, options)[0];
    one = reinterpret_cast<Function>(object->symbol("f"));
    many = reinterpret_cast<ManyFunction>(object->symbol("f_many"));
  }
  symbolic::Program program;
  std::shared_ptr<SharedObject> object;
  Function one;
  ManyFunction many;
};

bool sameBits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

struct Flat {
  std::vector<double> q, qd, w;
};
Flat flat(const scene::State<double>& s, Formula formula) {
  Flat f{{}, s.qd, formula == Formula::kForwardDynamics ? s.tau : s.qdd};
  for (const scene::JointPosition<double>& x : s.x) f.q.push_back(x.q);
  return f;
}
void call(const Kernel& kernel, Formula formula, const Flat& f, double* out) {
  if (formula == Formula::kMassMatrix)
    kernel.massMatrix(f.q.data(), out);
  else if (formula == Formula::kForwardDynamics)
    kernel.forwardDynamics(f.q.data(), f.qd.data(), f.w.data(), out);
  else
    kernel.inverseDynamics(f.q.data(), f.qd.data(), f.w.data(), out);
}
void callMany(const Kernel& kernel, Formula formula, const Flat& f, double* out, long count) {
  if (formula == Formula::kMassMatrix)
    kernel.massMatrix(f.q.data(), out, count);
  else if (formula == Formula::kForwardDynamics)
    kernel.forwardDynamics(f.q.data(), f.qd.data(), f.w.data(), out, count);
  else
    kernel.inverseDynamics(f.q.data(), f.qd.data(), f.w.data(), out, count);
}
constexpr Formula kCompiled[] = {Formula::kInverseDynamics, Formula::kMassMatrix,
                                 Formula::kForwardDynamics};
const std::vector<std::string> kScenes = {"double_pendulum", "stanford_arm", "franka_panda"};

}  // namespace

BOOST_AUTO_TEST_SUITE(values)

// At q = 0 cosines and sines are exact, so nothing but the program's own operations rounds: the
// other road is the interpreter, which must round in the same way.
BOOST_DATA_TEST_CASE(compiled_code_is_its_program_bit_for_bit, data::make(kScenes), name) {
  const scene::Scene scene = scene::findScene(name);
  const Kernel kernel(scene.mechanism);
  const scene::RealNumbers<double> numbers(scene.mechanism);
  for (const Formula formula : kCompiled) {
    symbolic::ProgramRun<double> run(kernel.road(formula).program, numbers);
    for (int k = 0; k < 20; ++k) {
      scene::State<double> state = drawState(scene.mechanism, scene.name, 3, k);
      for (scene::JointPosition<double>& x : state.x) x = {0, 1, 0};
      const std::vector<double> expected = run(state);
      std::vector<double> out(expected.size());
      call(kernel, formula, flat(state, formula), out.data());
      for (std::size_t i = 0; i < out.size(); ++i)
        BOOST_TEST(sameBits(out[i], expected[i]), kernel::name(formula)
                                                      << " " << i << ": " << out[i] << ", expected "
                                                      << expected[i]);
    }
  }
}

BOOST_DATA_TEST_CASE(compiled_code_stays_within_the_bound_of_its_program, data::make(kScenes),
                     name) {
  const scene::Scene scene = scene::findScene(name);
  const Kernel kernel(scene.mechanism);
  const RunningErrorNumbers numbers(scene.mechanism);
  for (const Formula formula : kCompiled) {
    symbolic::ProgramRun<RunningError> run(kernel.road(formula).program, numbers);
    for (int k = 0; k < 100; ++k) {
      const scene::State<double> state = drawState(scene.mechanism, scene.name, 4, k);
      scene::State<RunningError> bounded;
      for (const auto& x : state.x) bounded.x.push_back(runningErrorPosition(x.q));
      bounded.qd.assign(state.qd.begin(), state.qd.end());
      bounded.qdd.assign(state.qdd.begin(), state.qdd.end());
      bounded.tau.assign(state.tau.begin(), state.tau.end());
      const std::vector<RunningError> expected = run(bounded);
      std::vector<double> out(expected.size());
      call(kernel, formula, flat(state, formula), out.data());
      // both are within the bound of the true value
      for (std::size_t i = 0; i < out.size(); ++i)
        BOOST_TEST(std::abs(out[i] - expected[i].value()) <= 2 * expected[i].bound());
    }
  }
}

BOOST_DATA_TEST_CASE(every_lane_says_what_one_state_alone_says, data::make(laneWidths()), lanes) {
  const scene::Scene scene = scene::findScene("stanford_arm");
  KernelOptions options;
  options.lanes = lanes;
  const Kernel kernel(scene.mechanism, options);
  const std::size_t n = kernel.dof();
  for (const Formula formula : kCompiled) {
    const std::size_t outputs = formula == Formula::kMassMatrix ? n * n : n;
    for (long count = 1; count <= 2 * lanes + 1; ++count) {
      Flat all{std::vector<double>(n * count), std::vector<double>(n * count),
               std::vector<double>(n * count)};
      std::vector<std::vector<double>> expected;
      for (long k = 0; k < count; ++k) {
        const Flat one =
            flat(drawState(scene.mechanism, scene.name, 5, static_cast<int>(k)), formula);
        for (std::size_t i = 0; i < n; ++i) {
          all.q[i * count + k] = one.q[i];
          all.qd[i * count + k] = one.qd[i];
          all.w[i * count + k] = one.w[i];
        }
        expected.emplace_back(outputs);
        call(kernel, formula, one, expected.back().data());
      }
      constexpr double kGuard = 12345;
      std::vector<double> out(outputs * count + 8, kGuard);
      callMany(kernel, formula, all, out.data(), count);
      bool same = true;
      for (std::size_t i = 0; i < outputs; ++i)
        for (long k = 0; k < count; ++k)
          same = same && sameBits(out[i * count + k], expected[k][i]);
      BOOST_TEST(same, kernel::name(formula) << ", " << count << " states");
      for (std::size_t i = outputs * count; i < out.size(); ++i) BOOST_TEST(out[i] == kGuard);
    }
  }
}

// against 50 digits (Boost.Multiprecision): 2 u = 2^-52 of the value is what the bounds are built
// on
BOOST_DATA_TEST_CASE(cosines_and_sines_are_as_good_as_promised, data::make(laneWidths()), lanes) {
  using Big = boost::multiprecision::cpp_bin_float_50;
  symbolic::Graph graph;
  const Compiled f(
      graph, {graph.input(symbolic::Input::kCos, 0), graph.input(symbolic::Input::kSin, 0)}, lanes);
  std::vector<double> angles = {
      0.0,  -0.0,          1e-300,         -1e-300,
      1e-9, kLargestAngle, -kLargestAngle, std::nextafter(kLargestAngle, 2000.0),
      1e5,  -3e17};
  const double quarter = std::acos(0.0);
  for (int k = -1018; k <= 1018; k += 7)  // the hardest: next to multiples of pi/2, and midway
    for (double x : {k * quarter, (k + 0.5) * quarter})
      for (double y : {std::nextafter(x, -1e9), x, std::nextafter(x, 1e9)}) angles.push_back(y);
  RandomStream random("angles", 1, 0);
  for (int k = 0; k < 2000; ++k) angles.push_back(random.uniform(-4, 4));
  for (int k = 0; k < 2000; ++k) angles.push_back(random.uniform(-1600, 1600));
  std::vector<double> many(2 * angles.size());
  f.many(angles.data(), nullptr, nullptr, many.data(), static_cast<long>(angles.size()));
  double worst = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    double out[2];
    f.one(&angles[i], nullptr, nullptr, out);
    // nothing that stands beside it in a block changes a bit: one angle beyond the limit does not
    // send the others to the C library
    for (int k : {0, 1}) BOOST_TEST(sameBits(out[k], many[k * angles.size() + i]), angles[i]);
    const Big truth[2] = {cos(Big(angles[i])), sin(Big(angles[i]))};
    for (int k : {0, 1}) {
      for (const double value : {out[k], many[k * angles.size() + i]}) {
        const Big error = abs(Big(value) - truth[k]);
        const double relative =
            truth[k] == 0 ? (error == 0 ? 0 : 1e9) : static_cast<double>(error / abs(truth[k]));
        worst = std::max(worst, relative);
        BOOST_TEST(relative <= 0x1p-52, (k ? "sin " : "cos ") << angles[i] << ": " << value);
      }
    }
  }
  BOOST_TEST(worst > 0x1p-54);  // they do round: the comparison above compares something
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double out[2];
  f.one(&nan, nullptr, nullptr, out);
  BOOST_TEST((std::isnan(out[0]) && std::isnan(out[1])));
}

BOOST_AUTO_TEST_CASE(a_planted_error_in_the_compiled_code_is_seen) {
  symbolic::Graph graph;
  const symbolic::Node x = graph.input(symbolic::Input::kVelocity, 0),
                       y = graph.input(symbolic::Input::kVelocity, 1);
  const symbolic::Node third = graph.constant(scene::Rational(1, 3));
  const Compiled right(graph, {graph.add(graph.multiply(x, y), third)}, 2);
  const scene::RealNumbers<double> numbers{scene::Mechanism()};
  symbolic::Program wrong = right.program;
  wrong.body.back().code = symbolic::Program::Code::kSubtract;
  const double u[2] = {1.5, -0.7};
  double out = 0;
  right.one(nullptr, u, nullptr, &out);
  scene::State<double> state;
  state.qd = {u[0], u[1]};
  BOOST_TEST(sameBits(out, symbolic::ProgramRun<double>(right.program, numbers)(state)[0]));
  BOOST_TEST(!sameBits(out, symbolic::ProgramRun<double>(wrong, numbers)(state)[0]));
}

BOOST_AUTO_TEST_CASE(the_same_scene_gives_the_same_bytes) {
  const scene::Scene scene = scene::findScene("puma_560");
  const scene::RealNumbers<double> numbers(scene.mechanism);
  const auto emitted = [&] {
    const auto road = smallestRoad(scene.mechanism, Formula::kInverseDynamics);
    const symbolic::ProgramRun<double> run(road.program, numbers);
    return emitKernel(road.program, run, "f", 4);
  };
  BOOST_TEST((emitted() == emitted()));
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(keeping)

/// A compiler that writes a line into a file each time it is called.
struct CountingCompiler {
  CountingCompiler() {
    const fs::path script = cache().folder / "counting_cc";
    calls = cache().folder / "calls.txt";
    fs::remove(calls);
    std::ofstream(script) << "#!/bin/sh\necho call >> '" << calls.string() << "'\nexec '"
                          << findCompiler()[0] << "' \"$@\"\n";
    fs::permissions(script, fs::perms::owner_all);
    options = {{script.string()}, {"-shared", "-fPIC"}, cacheFolder()};
  }
  int count() const {
    std::ifstream in(calls);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    return lines;
  }
  fs::path calls;
  CompileOptions options;
};

int answer(const SharedObject& object) {
  return reinterpret_cast<int (*)()>(object.symbol("answer"))();
}

BOOST_AUTO_TEST_CASE(what_was_compiled_is_kept_by_content) {
  const CountingCompiler compiler;
  const std::string six = "int answer(void) { return 6; }\n",
                    seven = "int answer(void) { return 7; }\n";
  BOOST_TEST(answer(*compileAndLoad({six}, compiler.options)[0]) == 6);
  BOOST_TEST(compiler.count() == 1);
  BOOST_TEST(answer(*compileAndLoad({six}, compiler.options)[0]) == 6);
  BOOST_TEST(compiler.count() == 1);
  const auto both = compileAndLoad({seven, six}, compiler.options);
  BOOST_TEST(answer(*both[0]) == 7);
  BOOST_TEST(answer(*both[1]) == 6);
  BOOST_TEST(compiler.count() == 2);
  CompileOptions other = compiler.options;
  other.flags.push_back("-O2");
  BOOST_TEST(answer(*compileAndLoad({six}, other)[0]) == 6);
  BOOST_TEST(compiler.count() == 3);
}

BOOST_AUTO_TEST_CASE(what_was_cut_off_or_changed_is_made_again) {
  const CountingCompiler compiler;
  const std::string source = "int answer(void) { return 8; }\n";
  compileAndLoad({source}, compiler.options);
  const auto change = [&](const char* extension, const std::string& text) {
    for (const fs::directory_entry& entry : fs::directory_iterator(cache().folder)) {
      std::ifstream in(entry.path().parent_path() / (entry.path().stem().string() + ".c"));
      std::stringstream kept;
      kept << in.rdbuf();
      if (entry.path().extension() == extension &&
          kept.str().find("return 8") != std::string::npos) {
        fs::remove(entry.path());  // a loaded file must not change under the loader
        std::ofstream(entry.path()) << text;
        return true;
      }
    }
    return false;
  };
  BOOST_TEST(change(".so", "cut off"));
  BOOST_TEST(answer(*compileAndLoad({source}, compiler.options)[0]) == 8);
  BOOST_TEST(compiler.count() == 2);
  BOOST_TEST(change(".c", "something else; return 8"));
  BOOST_TEST(answer(*compileAndLoad({source}, compiler.options)[0]) == 8);
  BOOST_TEST(compiler.count() == 3);
  for (const fs::directory_entry& entry : fs::directory_iterator(cache().folder))
    BOOST_TEST(entry.path().string().find(".txt.") == std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

BOOST_AUTO_TEST_SUITE(bad_input)

template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const CannotCompile& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

BOOST_AUTO_TEST_CASE(a_missing_compiler_is_named) {
  const Setting no_path("PATH", "/nonexistent");
  BOOST_TEST(says(refusal([] { findCompiler(); }), "no C compiler: looked for cc, gcc and clang"));
  const Setting chosen("DYNWITNESS_CC", "no-such-cc");
  BOOST_TEST(says(refusal([] { findCompiler(); }), "DYNWITNESS_CC: 'no-such-cc'"));
}

BOOST_AUTO_TEST_CASE(without_a_compiler_the_witnesses_are_absent_with_the_reason) {
  const Setting chosen("DYNWITNESS_CC", "no-such-cc");
  for (const WitnessKind& kind : {kernelKind(), kernelLanesKind()}) {
    BOOST_TEST(!kind.info.present);
    const MadeWitness made = kind.make(scene::findScene("double_pendulum"));
    BOOST_TEST_REQUIRE(made.isRefused());
    BOOST_TEST(says(made.refusal(), "no-such-cc"), made.refusal());
  }
  const Setting found("DYNWITNESS_CC", "cc");
  BOOST_TEST(kernelKind().info.present);
}

BOOST_AUTO_TEST_CASE(a_source_that_does_not_compile_brings_the_compilers_words) {
  const CompileOptions options{findCompiler(), {"-shared", "-fPIC"}, cacheFolder()};
  const std::string text =
      refusal([&] { compileAndLoad({"int answer(void) { return nothing; }"}, options); });
  BOOST_TEST(says(text, "nothing"), text);
}

BOOST_AUTO_TEST_CASE(a_folder_that_cannot_be_used_is_named) {
  {
    const Setting nowhere("DYNWITNESS_CACHE", "/dev/null/cache");
    BOOST_TEST(says(refusal([] { cacheFolder(); }), "/dev/null/cache"));
  }
  const fs::path open = cache().folder / "open";
  fs::create_directory(open);
  chmod(open.c_str(), 0777);
  const Setting shared("DYNWITNESS_CACHE", open.string());
  BOOST_TEST(says(refusal([] { cacheFolder(); }), "others can write there"));
}

BOOST_AUTO_TEST_CASE(a_formula_whose_straight_line_is_too_long_has_no_code_and_says_why) {
  const scene::Scene humanoid = scene::findScene("humanoid");
  const Kernel kernel(humanoid.mechanism);
  BOOST_TEST(kernel.has(Formula::kInverseDynamics));
  BOOST_TEST(!kernel.has(Formula::kForwardDynamics));
  BOOST_CHECK_THROW(kernel.road(Formula::kForwardDynamics), std::invalid_argument);
  const std::string why = kernel.notUsed().at(Formula::kForwardDynamics);
  BOOST_TEST(says(why, "no kernel of FD is used"), why);
  const auto witness = kernelKind().make(humanoid).value();
  BOOST_TEST(witness->answers(Quantity::kTau));
  BOOST_TEST(!witness->answers(Quantity::kQdd));
  BOOST_TEST(!witness->answers(Quantity::kKinetic));
  // the report has the reason, once a witness and quantity
  Options options;
  options.states = 1;
  Hearing hearing(humanoid, {kernelKind()}, options);
  std::vector<std::string> quantities;
  for (const CheckResult& check : hearing.dismissRefused()) {
    BOOST_TEST((check.verdict == Verdict::kNotAnswerable));
    BOOST_TEST(says(check.reason, "no kernel of"), check.reason);
    quantities.push_back(check.quantity);
  }
  BOOST_TEST(quantities == (std::vector<std::string>{"M", "qdd"}),
             boost::test_tools::per_element());

  const scene::Scene chain = scene::findScene("chain_64");
  BOOST_CHECK_THROW(Kernel(chain.mechanism), NotUsed);
  const MadeWitness made = kernelKind().make(chain);
  BOOST_TEST_REQUIRE(made.isRefused());
  BOOST_TEST(says(made.refusal(), "no kernel of M is used"), made.refusal());
}

BOOST_AUTO_TEST_CASE(a_library_that_fails_its_trial_is_neither_kept_nor_loaded) {
  const CompileOptions options{findCompiler(), {"-shared", "-fPIC"}, cacheFolder()};
  const std::string source = "int answer(void) { return 9; }\n";
  const auto with = [&](const Trial& trial) {
    return refusal([&] { compileAndLoad({source}, options, trial); });
  };
  BOOST_TEST(says(with([](const SharedObject&, std::size_t) { return "it is odd"; }),
                  "of no use: it is odd"));
  const CompileOptions again{findCompiler(), {"-shared", "-fPIC", "-O1"}, cacheFolder()};
  const std::string crashed = refusal([&] {
    compileAndLoad({source}, again,
                   [](const SharedObject&, std::size_t) -> std::string { std::abort(); });
  });
  BOOST_TEST(says(crashed, "signal"), crashed);
}

BOOST_AUTO_TEST_CASE(odd_lanes_and_formulas_are_refused) {
  const scene::Scene scene = scene::findScene("simple_pendulum");
  KernelOptions options;
  options.lanes = 3;
  BOOST_CHECK_THROW(Kernel(scene.mechanism, options), std::invalid_argument);
  options.lanes = 2;
  options.formulas = {Formula::kGravity};
  BOOST_CHECK_THROW(Kernel(scene.mechanism, options), std::invalid_argument);
}

BOOST_AUTO_TEST_CASE(fewer_lanes_than_the_widest_can_be_chosen) {
  {
    const Setting none("DYNWITNESS_LANES", "");
    BOOST_TEST(chosenLanes() == widestLanes());
  }
  {
    const Setting two("DYNWITNESS_LANES", "2");
    BOOST_TEST(chosenLanes() == 2);
    BOOST_TEST(Kernel(scene::findScene("simple_pendulum").mechanism).lanes() == 2);
  }
  for (const char* odd : {"3", "16", "two", "2 "}) {
    const Setting wish("DYNWITNESS_LANES", odd);
    BOOST_CHECK_EXCEPTION(chosenLanes(), scene::InputError, [&](const scene::InputError& error) {
      return says(error.what(), std::string("got '") + odd + "', allowed: 2, 4, 8");
    });
  }
}

BOOST_AUTO_TEST_SUITE_END()
