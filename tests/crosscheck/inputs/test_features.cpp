// SPDX-License-Identifier: GPL-3.0-or-later
// The table of features goes through every pair: small scenes with and without one feature, and
// what each command makes of it. What is called modelled has to change what the command says, what
// has no part must not, what is left out is told, what is refused ends with exit status 2 and the
// reason.
#include "crosscheck/inputs/features.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <sstream>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include "scene/envelope.hpp"
#include "tests/fixtures/program.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;
using fixtures::Outcome;
using fixtures::Program;
using Kind = Treatment::Kind;

namespace {

const std::string kTurn = "kind = \"revolute\"\naxis = [0, 0.6, 0.8]\n";
const std::string kStart = "[start]\nq = [0.3, -0.2]\nqd = [0.7, -0.5]\n";
const std::string kGravity = "gravity = [0, 0, -9.81]\n";
const std::string kTask =
    "[[acceleration_constraint]]\nlink = \"arm\"\nat = [0.25, 0, 0]\ndirection = [0, 0, 1]\n";

/// Two links; what is left out of `joint` and `tables` is what a feature adds.
std::string scene(const std::string& joint, const std::string& tables, const std::string& start,
                  const std::string& gravity = kGravity) {
  return "title = \"Arm\"\nsource = \"chosen here\"\n" + gravity +
         "[[link]]\nname = \"base\"\n"
         "[[link]]\nname = \"arm\"\nparent = \"base\"\nmass = 2\ncom = [0.3, 0.1, 0.05]\n"
         "inertia = { about = \"com\", xx = 0.02, yy = 0.05, zz = 0.06, xy = 0.003 }\n"
         "[link.joint]\nname = \"shoulder\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n"
         "rotor_inertia = 2e-4\ngear_ratio = 50\n"
         "[[link]]\nname = \"tip\"\nparent = \"arm\"\nmass = 1\ncom = [0.2, 0.05, 0.1]\n"
         "inertia = { about = \"com\", xx = 0.01, yy = 0.02, zz = 0.015 }\n"
         "[link.joint]\nname = \"elbow\"\nxyz = [0.5, 0, 0]\n" +
         joint + tables + start;
}

std::string urdf(const std::string& limit) {
  return "<robot name=\"arm\"><link name=\"base\"/><link name=\"tip\"><inertial><mass value=\"1\"/>"
         "<origin xyz=\"0.1 0 0.2\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" "
         "ixz=\"0\" iyz=\"0\"/>"
         "</inertial></link><joint name=\"turn\" type=\"" +
         std::string(limit.empty() ? "continuous" : "revolute") +
         "\"><parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 1 0\"/>" + limit +
         "</joint></robot>";
}

/// A scene that has the feature, and the same without it.
struct Pair {
  std::string with, without;
};

Pair ofJoint(const std::string& joint, const std::string& without = kTurn) {
  return {scene(joint, "", ""), scene(without, "", "")};
}
Pair onJoint(const std::string& more, const std::string& without = "") {
  return {scene(kTurn + more, "", kStart), scene(kTurn + without, "", kStart)};
}
Pair ofTable(const std::string& table, const std::string& start = kStart) {
  return {scene(kTurn, table, start), scene(kTurn, "", start)};
}
/// Closed at q = 0: there the tip's frame stands at x = 0.5, turned like the world.
Pair ofClosure(const std::string& kind, const std::string& more = "", const std::string& z = "0") {
  return ofTable(
      "[[closure]]\nkind = \"" + kind + "\"\n" + more +
          "a = { link = \"tip\", xyz = [0.25, 0, 0] }\nb = { link = \"base\", xyz = [0.75, 0, " +
          z + "] }\n",
      "");
}
Pair ofPoints(const std::string& what) {
  return ofTable(
      "[[spring]]\na = { link = \"tip\", xyz = [0.25, 0, 0] }\n"
      "b = { link = \"base\", xyz = [0.75, 0, 1] }\n" +
      what);
}

Pair scenesOf(Feature feature) {
  const std::string rotor = "rotor_inertia = 1e-4\ngear_ratio = 30\n";
  const std::string load =
      "[[wrench]]\nlink = \"tip\"\nforce = [1, 2, -3]\nmoment = [0.1, 0.2, 0.3]\nat = [0.1, 0, 0]\n";
  switch (feature) {
    case Feature::kFixed:
      return ofTable(
          "[[link]]\nname = \"plate\"\nparent = \"tip\"\nmass = 0.5\ncom = [0, 0.1, 0]\n"
          "[link.joint]\nkind = \"fixed\"\nxyz = [0.1, 0, 0.2]\n");
    case Feature::kRevolute:
      return ofJoint(kTurn, "kind = \"fixed\"\n");
    case Feature::kPrismatic:
      return ofJoint("kind = \"prismatic\"\naxis = [0, 0.6, 0.8]\n");
    case Feature::kHelical:
      return ofJoint("kind = \"helical\"\naxis = [0, 0.6, 0.8]\npitch = 0.05\n");
    case Feature::kCylindrical:
      return ofJoint("kind = \"cylindrical\"\naxis = [0, 0.6, 0.8]\n");
    case Feature::kUniversal:
      return ofJoint("kind = \"universal\"\n");
    case Feature::kPlanar:
      return ofJoint("kind = \"planar\"\n");
    case Feature::kSpherical:
      return ofJoint("kind = \"spherical\"\n");
    case Feature::kFloating:
      return ofJoint("kind = \"floating\"\n");
    case Feature::kGravity:
      return {scene(kTurn, "", kStart), scene(kTurn, "", kStart, "")};
    case Feature::kRotor:
      return onJoint(rotor);
    case Feature::kGyroscopicRotor:
      return onJoint(rotor + "gyroscopic = true\n", rotor);
    case Feature::kGearedRotor:
      return ofJoint("kind = \"universal\"\nrotors = [{ inertia = 1e-4, ratio = [30, 20] }]\n",
                     "kind = \"universal\"\n");
    case Feature::kViscousFriction:
      return onJoint("friction = { viscous = 10 }\n");
    case Feature::kCoulombFriction:
      return onJoint("friction = { coulomb = 0.3 }\n");
    case Feature::kJointSpring:
      return onJoint("stiffness = 3\nrest = 0.1\n");
    case Feature::kMimic: {
      const std::string second =
          "[[link]]\nname = \"second\"\nparent = \"tip\"\nmass = 0.5\ncom = [0.2, 0.1, 0]\n"
          "inertia = { xx = 0.01, yy = 0.02, zz = 0.02 }\n"
          "[link.joint]\nxyz = [0.5, 0, 0]\nrpy = [0.3, 0, 0]\n";
      return {scene(kTurn,
                    second + "kind = \"revolute\"\n"
                             "mimic = { joint = \"elbow\", multiplier = -2, offset = 0.1 }\n",
                    kStart),
              scene(kTurn, second + "kind = \"fixed\"\n", kStart)};
    }
    case Feature::kLinkWrench:
      return ofTable(load + "axes = \"link\"\n");
    case Feature::kWorldWrench:
      return ofTable(load + "axes = \"world\"\n");
    case Feature::kDistanceClosure:
      return ofClosure("distance", "length = 1\n", "1");
    case Feature::kPlaneClosure:
      return ofClosure("plane");
    case Feature::kPlanarPointClosure:
      return ofTable(  // the arm moves in a's xy plane, and is bent
          "[[closure]]\nkind = \"planar_point\"\n"
          "a = { link = \"tip\", xyz = [0.25, 0, 0.2], rpy = [\"pi/2\", 0, 0] }\n"
          "b = { link = \"base\", xyz = [0.75, 0, 0.2], rpy = [\"pi/2\", 0, 0] }\n",
          "");
    case Feature::kPointClosure:
      return ofClosure("point");
    case Feature::kHingeClosure:
      return ofClosure("hinge");
    case Feature::kWeldClosure:
      return ofClosure("weld");
    case Feature::kSkateClosure:  // across the blade is up
      return ofTable(
          "[[closure]]\nkind = \"skate\"\na = { link = \"base\" }\n"
          "b = { link = \"tip\", xyz = [0.25, 0, 0], rpy = [\"pi/2\", 0, 0] }\n",
          "");
    case Feature::kRollingClosure:  // about y, its lowest point on the plane at q = 0
      return ofTable(
          "[[closure]]\nkind = \"rolling\"\nradius = 0.3\n"
          "a = { link = \"base\", xyz = [0, 0, -0.3] }\n"
          "b = { link = \"tip\", xyz = [0.25, 0, 0], rpy = [\"pi/2\", 0, 0] }\n",
          "");
    case Feature::kPointSpring:
      return ofPoints("stiffness = 50\nrest = 0.5\n");
    case Feature::kPointDamper:
      return ofPoints("damping = 2\n");
    case Feature::kDrivenJoint:
      return onJoint("motion = \"-0.2 - t/2 + t^2\"\n");
    case Feature::kAccelerationConstraint:
      return ofTable(
          "[[acceleration_constraint]]\nlink = \"tip\"\nat = [0.25, 0, 0]\ndirection = [1, 0, 0]\n");
    case Feature::kStart:
      return {scene(kTurn, "", kStart), scene(kTurn, "", "")};
    case Feature::kNotModelled:
      return {urdf("<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"), urdf("")};
  }
  return {};
}

/// A call of a command, and the file that has what it says (none: standard output).
struct Call {
  std::string words, file;
};

Call callOf(Command command) {
  switch (command) {
    case Command::kCrosscheck:
      return {
          "crosscheck scene --witness newton_euler,lagrange --random 2 --no-charts "
          "--error-probability 0.5 "
          "--processes 1 -o report",
          "report/report.json"};
    case Command::kCheck:
      return {"check scene --engine 'python3 engine.py' --engine-seconds 200 --format json", ""};
    case Command::kCheckFormulas:
      return {"check scene --answers formulas --format json", ""};
    case Command::kGolden:
      return {"golden scene --random 2 --format csv", ""};
    case Command::kGrade:
      return {"grade submissions --rubric rubric.toml", "grades/gradescope/arm.py/results.json"};
    case Command::kDerive:
      return {"derive scene", ""};
    case Command::kDerivePrograms:
      return {"derive scene --format c", ""};
    case Command::kDeriveOperations:
      return {"derive scene --operations", ""};
    case Command::kDeriveCode:
      return {"derive scene --format c --quantity tau,qdd", ""};
    case Command::kEvaluateTree:
      return {"evaluate scene --quantity M,c,g,kinetic,potential,momentum", ""};
    case Command::kEvaluateJoints:
      return {"evaluate scene --quantity X,M_A,PF", ""};
    case Command::kEvaluatePoints:
      return {"evaluate scene --quantity position,velocity,jacobian,jacobian_rate", ""};
    case Command::kEvaluateForces:
      return {"evaluate scene --quantity tau", ""};
    case Command::kEvaluateMotion:
      return {"evaluate scene --quantity qdd", ""};
    case Command::kEvaluateTasks:
      return {"evaluate scene --quantity Lambda,task_torque", ""};
    case Command::kEvaluateDerivatives:
      return {"evaluate scene --quantity dtau_dq,dtau_dqd,dqdd_dq,dqdd_dqd,dqdd_dtau", ""};
    case Command::kDrift:
      return {"drift scene --duration 0.1 --step 0.01,0.005", ""};
    case Command::kChart:
      return {"chart scene --random 20 --witness simbody", ""};
    case Command::kSimulate:
      return {"simulate scene --duration 0.05 --outputs 2 --csv motion.csv", "motion.csv"};
    case Command::kRotors:
      return {"rotors scene --random 2", ""};
    case Command::kParameters:
      return {"parameters scene --random 3", ""};
    case Command::kGeometry:
      return {"geometry scene --duration 0.1", ""};
    case Command::kAction:
      return {"action scene --duration 0.1", ""};
    case Command::kImpulse:
      return {"impulse scene --impulse 1,2,3", ""};
    case Command::kImpedance:
      return {"impedance scene --stretch 0.1,0,0.2", ""};
    case Command::kLinearize:
      return {"linearize scene", ""};
    case Command::kSweep:
      return {"sweep scene", ""};
    case Command::kEnvelope:
      return {"envelope scene.toml --quantity tau,M,c,g,T,V,energy,reactions --json bounds.json",
              "bounds.json"};
    case Command::kReduce:
      return {"reduce scene.toml --tolerance 30% --json reduction.json", "reduction.json"};
    case Command::kNeed:
      return {"need scene --duration 0.05 --json ladder.json", "ladder.json"};
    case Command::kAdvise:
      return {"advise scene --error 0.001 --duration 0.05 --method runge_kutta4", ""};
    case Command::kShow:
      return {"show scene", ""};
  }
  return {};
}

/// A right engine that knows every feature: `evaluate`, once for all states of a batch. tau belongs
/// to trees alone.
const char* const kEngine =
    R"(import json, subprocess, sys
PARTS = {'c': ['q', 'qd'], 'g': ['q'], 'tau': ['q', 'qd', 'qdd']}
def ask(quantity, states):
    width = {part: range(len(states[0][part])) for part in PARTS[quantity]}
    names = ['%s%d' % (part, i + 1) for part in PARTS[quantity] for i in width[part]]
    rows = [[repr(x) for part in PARTS[quantity] for x in state[part]] for state in states]
    said = subprocess.run([')" DYNWITNESS_PROGRAM
    R"(', 'evaluate', 'asked', '--states', '-', '--convention', 'dynwitness',
                             '--quantity', quantity],
                          input='\n'.join(','.join(row) for row in [names] + rows) + '\n',
                          capture_output=True, text=True, check=True).stdout
    return [[float(x) for x in line.split(',')] for line in said.splitlines()[1:]]
for line in sys.stdin:
    asked = json.loads(line)
    if 'scene' in asked:
        scene, known = asked['scene'], ['c', 'g', 'tau']
        open('asked', 'w').write(scene['toml'])
        zeros = [0.0] * scene['dof']
        try:
            ask('tau', [{'q': [1.0] * scene['positions'], 'qd': zeros, 'qdd': zeros}])
        except subprocess.CalledProcessError:
            known.remove('tau')
        print(json.dumps({'protocol': 1, 'quantities': known}), flush=True)
        continue
    said = {quantity: ask(quantity, asked['states']) for quantity in asked['quantities']}
    count = range(len(asked['states']))
    answers = [{quantity: said[quantity][k] for quantity in said} for k in count]
    print(json.dumps({'batch': asked['batch'], 'answers': answers}), flush=True)
)";

/// Another one, in a cell that hides the program.
const std::string kSubmission = "import stranger\nstranger.main([])\n";
const std::string kRubric =
    "command = \"/usr/bin/python3 {file}\"\nfiles = [\"" DYNWITNESS_STRANGER
    "\"]\n[[task]]\nscene = \"scene\"\n[task.marks]\n"
    "M = 1\nc = 1\ng = 1\ntau = 1\nqdd = 1\nkinetic = 1\npotential = 1\nmomentum = 1\n";

/// The table of a chart without its times.
std::string withoutTimes(const std::string& csv) {
  std::istringstream lines(csv);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    std::size_t end = 0;
    for (int field = 0; field < 5 && end != std::string::npos;
         ++field)  // quantity, method, scalar, two errors
      end = line.find(',', end + 1);
    if (line[0] != '#') kept += line.substr(0, end) + "\n";
  }
  return kept;
}

/// Numbers alone: what is said about them names parts of the scene.
std::string withoutComments(const std::string& csv) {
  std::istringstream lines(csv);
  std::string kept;
  for (std::string line; std::getline(lines, line);)
    if (line[0] != '#') kept += line + "\n";
  return kept;
}

/// T, V and what can be asked of tau, all said to be 0: what is missing names every term.
std::string formulasOf(const std::string& text) {
  const scene::Mechanism mechanism =
      (text[0] == '<' ? scene::readSceneUrdf(text, "scene") : scene::readSceneToml(text, "scene"))
          .mechanism;
  std::string lines = "T = 0\nV = 0\n";
  for (const scene::Link& link : mechanism.links)
    if (link.joint.friction.isCoulomb()) return lines;
  for (int i = 1; i <= mechanism.dof(); ++i) lines += "tau" + std::to_string(i) + " = 0\n";
  return lines;
}

struct Said {
  int status;
  std::string output, errors;
};

bool isReduction(Command command) {
  return command == Command::kEnvelope || command == Command::kReduce;
}

Said ask(const Program& program, Command command, std::string text) {
  const Call call = callOf(command);
  if (command == Command::kEvaluateTasks && text[0] != '<') {
    const std::size_t at = text.find("[start]");
    text.insert(at == std::string::npos ? text.size() : at, kTask);
  }
  if (isReduction(command)) {
    const scene::Scene read = scene::readSceneToml(text, "scene");
    const auto rates = static_cast<std::size_t>(read.mechanism.dof());
    text += scene::writeEnvelope(read, {rates, {{-0.5, 1}, {-1, 2}, {-3, 1}}});
  }
  program.write(isReduction(command) ? "scene.toml" : "scene", text);
  if (command == Command::kCheck) program.write("engine.py", kEngine);
  if (command == Command::kGrade) {
    program.write("submissions/arm.py", kSubmission);
    program.write("rubric.toml", kRubric);
  }
  if (command == Command::kCheckFormulas) program.write("formulas", formulasOf(text));
  const Outcome outcome = program.run(call.words, "2> errors");
  Said said{outcome.status, call.file.empty() ? outcome.out : program.read(call.file),
            program.read("errors")};
  // formulas are wrong, as they are meant to be
  if (command == Command::kCheckFormulas && said.status == 1) said.status = 0;
  if (command == Command::kChart) said.output = withoutTimes(said.output);
  if (command == Command::kGolden) said.output = withoutComments(said.output);
  return said;
}

/// What a command says about scenes, each asked about once: many features are added to the same.
class Asked {
 public:
  explicit Asked(Command command) : command_(command) {}
  const Said& operator()(const std::string& text) {
    const auto found = known_.find(text);
    if (found != known_.end()) return found->second;
    return known_.emplace(text, ask(program_, command_, text)).first->second;
  }

 private:
  Program program_;
  Command command_;
  std::map<std::string, Said> known_;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

BOOST_TEST_DONT_PRINT_LOG_VALUE(Command)
BOOST_TEST_DONT_PRINT_LOG_VALUE(Feature)

BOOST_DATA_TEST_CASE(every_command_makes_of_every_feature_what_the_table_says,
                     data::make(kAllCommands), command) {
  setenv("SOURCE_DATE_EPOCH", "0", 1);
  Asked said(command);
  for (const Feature feature : kAllFeatures) {
    // URDF has no tasks
    if (command == Command::kEvaluateTasks && feature == Feature::kNotModelled) continue;
    // no ranges
    if (isReduction(command) && feature == Feature::kNotModelled) continue;
    // and no rotors
    if (command == Command::kRotors && feature == Feature::kNotModelled) continue;
    const Pair pair = scenesOf(feature);
    const Treatment t = treatment(command, feature);
    const Said with = said(pair.with);
    BOOST_TEST_CONTEXT(name(command) << ", " << name(feature) << "\n"
                                     << with.output << with.errors) {
      if (t.kind == Kind::kRefused) {
        BOOST_TEST(with.status == 2);
        // the joint that has them is refused first, or the task that is added here
        const bool is_second = feature == Feature::kGearedRotor &&
                               (isReduction(command) || command == Command::kEvaluateTasks);
        if (!is_second) BOOST_TEST(has(with.errors, t.reason));
        continue;
      }
      BOOST_TEST(with.status == 0);
      BOOST_TEST(!with.output.empty());
      BOOST_TEST(!has(with.output, "nan"));
      if (t.kind == Kind::kTold) {
        BOOST_TEST(has(with.errors, t.reason));
        continue;
      }
      const Said& without = said(pair.without);
      BOOST_TEST(without.status == 0);
      if (t.kind == Kind::kModelled)
        BOOST_TEST((with.output != without.output));
      else
        BOOST_TEST(with.output == without.output);
    }
  }
}

// Otherwise a pair above would be about another feature.
BOOST_DATA_TEST_CASE(the_scene_of_a_feature_has_it_and_the_other_has_not, data::make(kAllFeatures),
                     feature) {
  const auto hasIt = [feature](const std::string& text) {
    const std::vector<FoundFeature> found = featuresOf(
        text[0] == '<' ? scene::readSceneUrdf(text, "scene") : scene::readSceneToml(text, "scene"));
    return std::any_of(found.begin(), found.end(),
                       [feature](const FoundFeature& f) { return f.feature == feature; });
  };
  const Pair pair = scenesOf(feature);
  BOOST_TEST(hasIt(pair.with), name(feature));
  // the shoulder turns and has a rotor in all of them
  if (feature != Feature::kRevolute && feature != Feature::kRotor)
    BOOST_TEST(!hasIt(pair.without), name(feature));
}

BOOST_AUTO_TEST_CASE(every_cell_that_is_not_modelled_has_its_reason) {
  for (const Command command : kAllCommands)
    for (const Feature feature : kAllFeatures) {
      const Treatment t = treatment(command, feature);
      BOOST_TEST((std::string(t.reason).empty() == (t.kind == Kind::kModelled)),
                 name(command) << ", " << name(feature));
    }
}

BOOST_AUTO_TEST_CASE(a_refusal_names_the_part_the_reason_and_who_models_it) {
  try {
    requireTreated(scene::findScene("kapitza_pendulum"), Command::kDrift);
    BOOST_TEST(false, "it was let in");
  } catch (const scene::InputError& error) {
    const std::string text = error.what();
    for (const char* part : {"kapitza_pendulum.toml:", "joint 'pivot' is driven",
                             "energy is not constant", "dynwitness simulate"})
      BOOST_TEST(has(text, part), text);
  }
}

BOOST_AUTO_TEST_CASE(the_documentation_shows_the_table_of_the_code) {
  std::ifstream file(std::string(DYNWITNESS_SOURCE_DIR) + "/crosscheck/inputs/features.md");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  BOOST_TEST((text == featuresMarkdown()),
             "write it anew: dynwitness scenes --features > crosscheck/inputs/features.md");
}
