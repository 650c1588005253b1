// SPDX-License-Identifier: GPL-3.0-or-later
// `envelope` and `reduce` as their user calls them: changes of the scene against the closed form of
// a pendulum, and what they cannot answer is refused at once.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "tests/fixtures/program.hpp"

using dynwitness::fixtures::Outcome;
using dynwitness::fixtures::Program;

namespace {

const std::string kBase =
    "[[link]]\nname = \"base\"\nmass = 1\ninertia = { xx = 1, yy = 1, zz = 1 }\n";

/// A point of 2 kg at 0.5 m.
const std::string kPendulum =
    "gravity = [0, 0, -9.81]\n[parameters]\nl = 0.5\n" + kBase +
    "[[link]]\nname = \"rod\"\nparent = \"base\"\nmass = 2\ncom = [0, 0, \"-l\"]\n"
    "[link.joint]\nname = \"hinge\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n"
    "[envelope]\nhinge = { q = [0, 1.5], qd = [\"-2*l\", 2], qdd = [-3, \"8*l\"] }\n";

std::string envelope(int joints) {
  std::string text = "\n[envelope]\n";
  for (int k = 1; k <= joints; ++k)
    text += fmt::format("joint{} = {{ q = [0, 1], qd = [0, 1], qdd = [0, 1] }}\n", k);
  return text;
}

void bothRefuse(const Program& program, const std::string& words, const std::string& reason) {
  for (const char* command : {"envelope ", "reduce "})
    dynwitness::fixtures::refuses(program, command + words, reason);
}

}  // namespace

// By hand: tau = m l^2 qdd + m gravity l sin q, largest where q = 1.5 and qdd is.
BOOST_AUTO_TEST_CASE(bounds_are_those_of_the_changed_scene) {
  const Program program;
  program.write("pendulum.toml", kPendulum);
  const auto holds = [&](const std::string& changes, double expected) {
    const Outcome outcome =
        program.run("envelope pendulum.toml --ratio 1.01 --json bounds.json " + changes);
    BOOST_TEST_CONTEXT(changes << "\n" << outcome.out) {
      BOOST_REQUIRE(outcome.status == 0);
      const auto tau = nlohmann::json::parse(program.read("bounds.json")).at("bounds").at(0);
      BOOST_TEST(tau.at("at_most").get<double>() >= expected * (1 - 1e-15));
      BOOST_TEST(tau.at("at_most").get<double>() <= 1.01 * expected);
      BOOST_TEST(tau.at("at_least").get<double>() <= expected * (1 + 1e-15));
    }
  };
  const double s = std::sin(1.5);
  holds("", 2 + 9.81 * s);
  holds("--gravity 0,0,-1.62", 2 + 1.62 * s);
  holds("--gravity 0,0,0", 2);
  holds("--set mass:rod=6", 6 + 3 * 9.81 * s);
  // ranges are expressions in the same parameters: qdd up to 8
  holds("--set l=1", 2 * 8 + 2 * 9.81 * s);

  const Outcome outcome =
      program.run("reduce pendulum.toml --gravity 0,0,-1.62 --toml reduced.toml");
  BOOST_TEST(outcome.status == 0, outcome.out);
  BOOST_TEST((program.read("reduced.toml").find("1.62") != std::string::npos));

  // one rod has no parameter that 5 % could do without
  const Outcome kept = program.run("reduce pendulum.toml --tolerance 5%");
  BOOST_TEST((kept.out.find("nothing was found that may be left out within 5 %: it stays the "
                            "scene's own program") != std::string::npos),
             kept.out);
  BOOST_TEST((kept.out.find("certified: no state of [envelope] errs by more") != std::string::npos),
             kept.out);
  BOOST_TEST((program.run("reduce scara --tolerance 50%").out.find("nothing was found") ==
              std::string::npos));

  // a file of the changed scene has them as numbers, one of other joints has none and says so
  program.run("write pendulum.toml --set l=1 --format toml -o long.toml");
  BOOST_TEST((program.read("long.toml").find("qd = [-2, 2], qdd = [-3, 8]") != std::string::npos),
             program.read("long.toml"));
  for (const char* change : {"--root rod", "--base floating"}) {
    const Outcome written =
        program.run(std::string("write pendulum.toml --format toml -o other.toml ") + change);
    BOOST_TEST((written.out.find("left out of the file: [envelope]") != std::string::npos),
               written.out);
    BOOST_TEST((program.read("other.toml").find("[envelope]") == std::string::npos));
  }
}

// By hand: tau = m (l^2 qdd + gravity l sin q), at the rows and with m 5 % more; between rows the
// box of both.
BOOST_AUTO_TEST_CASE(bounds_along_a_motion_and_of_heavier_links) {
  const Program program;
  program.write("pendulum.toml", kPendulum);
  program.write(
      "motion.csv",
      "t,q1,qd1,qdd1,tau1\n0,0.1,0,1,2\n0.1,0.4,1,-1,0.5\n0.2,0.3,-1,1,1\n0.3,0.1,0,0,-3\n");
  const auto asked = [&](const std::string& options) {
    const Outcome outcome =
        program.run("envelope pendulum.toml --ratio 1.001 --json bounds.json " + options);
    BOOST_TEST_CONTEXT(outcome.out) {
      BOOST_REQUIRE(outcome.status == 0);
    }
    return nlohmann::json::parse(program.read("bounds.json"));
  };
  const auto holds = [&](const std::string& options, double expected) {
    const auto bound = asked(options).at("bounds").at(0);
    BOOST_TEST(bound.at("at_most").get<double>() >= expected * (1 - 1e-15), options);
    BOOST_TEST(bound.at("at_most").get<double>() <= 1.001 * expected, options);
    BOOST_TEST(bound.at("at_least").get<double>() <= expected * (1 + 1e-15), options);
  };
  const double along = 2 * (0.25 + 9.81 * 0.5 * std::sin(0.4));  // qdd = 1 in the first box
  holds("--along motion.csv", along);
  holds("--along motion.csv --masses-within 5%", 1.05 * along);
  // rows 3 and 4: tau and q differ in sign: (3 + 2 gravity l sin 0.3) / (m l^2)
  holds("--along motion.csv --quantity qdd", (3 + 9.81 * std::sin(0.3)) / 0.5);
  const auto all = asked("--along motion.csv --masses-within 0.05");
  BOOST_TEST(all.at("boxes_of_motion") == 3);
  BOOST_TEST(all.at("masses_within") == 0.05);
  BOOST_TEST(all.at("bounds").at(0).at("heavier") == nlohmann::json({"rod"}));
  BOOST_TEST(all.at("envelope").at(0).at("q") == nlohmann::json({0.1, 0.4}));

  program.write("still.csv", "q1,qd1\n0,0\n");
  const auto refuses = [&](const std::string& options, const std::string& reason) {
    dynwitness::fixtures::refuses(program, "envelope pendulum.toml " + options, reason);
  };
  refuses("--along still.csv", "no columns of qdd, expected qdd1 to qdd1");
  refuses("--along still.csv --quantity qdd", "no columns of tau");
  refuses("--quantity qdd", "no tau of joint 'hinge'");
  refuses("--along motion.csv --quantity qdd --masses-within 5%", "not linear in them");
  refuses("--masses-within 120%", "--masses-within: got '120%'");
  refuses("--masses-within pi", "allowed: a share from 0 to 1");
  refuses("--along none.csv", "cannot be read");
  program.write("empty.csv", "q1,qd1,qdd1\n");
  refuses("--along empty.csv", "empty.csv:1: no state after the header");
}

// By hand: tau = m (l^2 qdd + gravity l sin q) with m up to 2.5, or 10 % more; in l it is no line.
BOOST_AUTO_TEST_CASE(bounds_of_a_parameter_that_is_not_known) {
  const Program program;
  std::string scene = kPendulum;
  scene.replace(scene.find("l = 0.5"), 7, "l = 0.5\nm = 2");
  scene.replace(scene.find("mass = 2"), 8, "mass = \"m\"");
  const auto write = [&](const std::string& parameters) {
    program.write("pendulum.toml", scene + "[envelope.parameters]\n" + parameters);
  };
  const auto bound = [&](const std::string& options) {
    const Outcome outcome =
        program.run("envelope pendulum.toml --ratio 1.001 --json bounds.json " + options);
    BOOST_TEST_CONTEXT(outcome.out) {
      BOOST_REQUIRE(outcome.status == 0);
    }
    return nlohmann::json::parse(program.read("bounds.json"));
  };
  const auto holds = [&](const std::string& options, double mass) {
    const double expected = mass * (0.25 * 4 + 9.81 * 0.5 * std::sin(1.5));
    const auto tau = bound(options).at("bounds").at(0);
    BOOST_TEST(tau.at("at_most").get<double>() >= expected * (1 - 1e-15), options);
    BOOST_TEST(tau.at("at_most").get<double>() <= 1.001 * expected, options);
    BOOST_TEST(tau.at("at_least").get<double>() <= expected * (1 + 1e-15), options);
  };
  write("m = { relative = 0.1 }\n");
  holds("", 2.2);
  holds("--nominal", 2);
  holds("--set m=3", 3.3);
  holds("--masses-within 5%", 2.2 * 1.05);
  const auto all = bound("");
  BOOST_TEST(all.at("uncertain_parameters").at(0).at("high") == 2.2);
  BOOST_TEST(all.at("bounds").at(0).at("parameters").at(0).at("value") == 2.2);
  BOOST_TEST((program.run("envelope pendulum.toml").out.find("; m = 2.2") != std::string::npos));
  write("m = [1.5, \"5*l\"]\n");
  holds("", 2.5);
  holds("--nominal --set m=3", 3);
  dynwitness::fixtures::refuses(program, "envelope pendulum.toml --set m=3",
                                "its value 3 is not in");
  const Outcome reduced = program.run("reduce pendulum.toml --tolerance 1% --set m=3");
  BOOST_TEST(reduced.status == 0);
  BOOST_TEST(reduced.out.find("[envelope.parameters] is left out") != std::string::npos);
  dynwitness::fixtures::refuses(program, "reduce pendulum.toml --set m=3 --toml small.toml",
                                "its value 3 is not in");
  BOOST_TEST(program.run("reduce pendulum.toml --toml small.toml").status == 0);
  BOOST_TEST(program.run("envelope small.toml --json small.json").status == 0);
  BOOST_TEST(nlohmann::json::parse(program.read("small.json")).at("uncertain_parameters") ==
             bound("").at("uncertain_parameters"));
  BOOST_TEST(program.run("write pendulum.toml --format toml -o again.toml").status == 0);
  BOOST_TEST(program.run("envelope again.toml --json again.json").status == 0);
  BOOST_TEST(nlohmann::json::parse(program.read("again.json")).at("uncertain_parameters") ==
             bound("").at("uncertain_parameters"));

  const auto refuses = [&](const std::string& parameters, const std::string& reason) {
    write(parameters);
    dynwitness::fixtures::refuses(program, "envelope pendulum.toml", reason);
  };
  refuses("l = { relative = 0.1 }\n", "l: the com of rod is");
  refuses("k = { relative = 0.1 }\n", "unknown key \"k\", allowed: l, m");
  refuses("m = { relative = 1.5 }\n", "allowed: a share from 0 to 1");
  refuses("m = [2.5, 3]\n", "its value 2 is not in [2.5, 3]");
  refuses("m = 3\n", "{ relative = share } or [lowest, highest]");
  for (const char* mass : {"m*m/2", "m^2/2", "4/m"}) {
    std::string square = scene;
    square.replace(square.find("mass = \"m\""), 10, fmt::format("mass = \"{}\"", mass));
    program.write("square.toml", square + "[envelope.parameters]\nm = { relative = 0.1 }\n");
    dynwitness::fixtures::refuses(program, "envelope square.toml", "the mass of rod is");
  }
  write("m = { relative = 0.1 }\n");
  program.write("motion.csv", "q1,qd1,tau1\n0,0,1\n");
  dynwitness::fixtures::refuses(program, "envelope pendulum.toml --along motion.csv --quantity qdd",
                                "qdd with uncertain parameters");
}

// Two rods whose lower one is balanced but for a tenth of a millimetre.
BOOST_AUTO_TEST_CASE(accelerations_of_a_reduced_scene_stay_near) {
  const Program program;
  const auto rod = [](const std::string& name, const std::string& parent, const std::string& rest) {
    return "[[link]]\nname = \"" + name + "\"\nparent = \"" + parent + "\"\nmass = 1\n" + rest +
           "inertia = { about = \"com\", xx = 0.02, yy = 0.02, zz = 0.001 }\n[link.joint]\nname = "
           "\"joint_" +
           name + "\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n";
  };
  program.write("rods.toml",
                "gravity = [0, 0, -9.81]\n" + kBase +
                    rod("upper", "base", "com = [0, 0, -0.25]\n") +
                    rod("lower", "upper", "com = [0.0001, 0, -0.25]\n") +
                    "xyz = [0, 0, -0.5]\n[envelope]\n"
                    "joint_upper = { q = [-2, 2], qd = [-2, 2], qdd = [0, 0], tau = [-20, 20] }\n"
                    "joint_lower = { q = [-3, 3], qd = [-3, 3], qdd = [0, 0], tau = [-9, 9] }\n");
  const Outcome outcome = program.run(
      "reduce rods.toml --of qdd --tolerance 5% --toml reduced.toml --c reduced.c --json r.json");
  BOOST_REQUIRE(outcome.status == 0);
  BOOST_TEST((outcome.out.find("qdd_2") != std::string::npos), outcome.out);
  BOOST_TEST((program.read("reduced.c").find("reduced_forward_dynamics") != std::string::npos));
  const auto json = nlohmann::json::parse(program.read("r.json"));
  BOOST_TEST(json.at("of") == "qdd");
  const auto model = json.at("models").at(0);
  BOOST_TEST(model.at("parameters_dropped").size() == 1U);
  // the program's own answers of both scenes where the bound's search saw the most
  for (std::size_t i = 0; i < 2; ++i) {
    const auto force = model.at("forces").at(i);
    const auto list = [&](const char* what) {
      return fmt::format("{:.17g},{:.17g}", force.at(what).at(0).get<double>(),
                         force.at(what).at(1).get<double>());
    };
    const auto qdd = [&](const std::string& file) {
      const Outcome run = program.run("evaluate " + file + " --quantity qdd --q=" + list("q") +
                                      " --qd=" + list("qd") + " --tau=" + list("tau"));
      BOOST_REQUIRE(run.status == 0);
      std::istringstream row(run.out.substr(run.out.find('\n') + 1));
      double x = 0;
      char comma = 0;
      row >> x;
      if (i == 1) row >> comma >> x;
      return x;
    };
    const double off = std::abs(qdd("rods.toml") - qdd("reduced.toml"));
    BOOST_TEST(off <= force.at("error_at_most").get<double>());
    BOOST_TEST(std::abs(off - force.at("error_at_least").get<double>()) <= 1e-9 * off);
  }
  const auto refuses = [&](const std::string& words, const std::string& reason) {
    dynwitness::fixtures::refuses(program, "reduce " + words, reason);
  };
  refuses("scara --of trajectory", "dynwitness advise");
  refuses("scara --of qdd --armstrong 0.01", "his rule");
  refuses("puma_560 --of energy", "--of: ");
}

BOOST_AUTO_TEST_CASE(word_lengths_are_told_and_their_code_is_written) {
  const Program program;
  const Outcome outcome =
      program.run("advise planar_3r --fixed-point --error 1e-3 --c fixed.c --json fixed.json");
  BOOST_TEST(outcome.status == 0, outcome.out);
  const auto json = nlohmann::json::parse(program.read("fixed.json"));
  for (const auto& force : json.at("forces")) {
    BOOST_TEST(force.at("error_at_most").get<double>() <= 1e-3);
    BOOST_TEST(force.at("error_measured").get<double>() <= force.at("error_at_most").get<double>());
  }
  BOOST_TEST((program.read("fixed.c").find("int32_t") != std::string::npos));
  const auto refuses = [&](const std::string& words, const std::string& reason) {
    dynwitness::fixtures::refuses(program, "advise " + words, reason);
  };
  refuses("planar_3r --fixed-point", "--error: not given");
  refuses("planar_3r --fixed-point --error 1e-3 --duration 2", "--fixed-point");
  refuses("planar_3r --c fixed.c --error 1e-3", "--fixed-point");
  refuses("double_pendulum --fixed-point --error 1e-3", "no [envelope]");
}

// Neither fits the ranges of [envelope], which are of joints that turn or slide.
BOOST_AUTO_TEST_CASE(a_base_that_floats_is_refused) {
  const Program program;
  program.write("pendulum.toml", kPendulum);
  bothRefuse(program, "pendulum.toml --root rod", "is floating");
  bothRefuse(program, "pendulum.toml --base floating", "is floating");
}

BOOST_AUTO_TEST_CASE(what_has_no_answer_is_refused_at_once) {
  const Program program;
  const std::string fixed =
      "[[link]]\nname = \"rod\"\nparent = \"base\"\nmass = 2\n[link.joint]\nkind = \"fixed\"\n";
  program.write("none.toml", kBase);
  program.write("fixed.toml", kBase + fixed);
  for (const char* file : {"none.toml", "fixed.toml"})
    bothRefuse(program, file, std::string(file) + ": no joint moves, expected at least one");
  bothRefuse(program, "chain_100", "no [envelope]");
  bothRefuse(program, "acrobot", "no [envelope]");
  bothRefuse(program, "heavy_top", "heavy_top.toml:");
  bothRefuse(program, "heavy_top", "is spherical");
  BOOST_TEST(program.run("write chain_100 --format toml -o chain.toml").status == 0);
  program.write("long.toml", program.read("chain.toml") + envelope(100));
  bothRefuse(program, "long.toml", "long.toml: 100 joints move, allowed: up to 13");
  // in a chain M is what grows; side by side it is constant, and gravity is not
  BOOST_TEST(program.run("write chain_8 --format toml -o chain.toml").status == 0);
  program.write("eight.toml", program.read("chain.toml") + envelope(8));
  bothRefuse(program, "eight.toml", "M would be asked at 78125 positions, allowed: up to 15625");
  const auto writeStar = [&](int joints) {
    std::string star = "gravity = [0, 0, -9.81]\n" + kBase;
    for (int k = 1; k <= joints; ++k)
      star += fmt::format(
          "[[link]]\nname = \"arm{0}\"\nparent = \"base\"\nmass = 1\ncom = [1, 0, 0]\n"
          "[link.joint]\nname = \"joint{0}\"\nkind = \"revolute\"\naxis = [0, 1, 0]\n",
          k);
    program.write("star.toml", star + envelope(joints));
  };
  writeStar(11);
  bothRefuse(program, "star.toml", "gravity would be asked at 177147 positions");
  writeStar(14);
  bothRefuse(program, "star.toml", "14 joints move");
  writeStar(8);
  BOOST_TEST(program.run("envelope star.toml").status == 0);
}

// The commands that `advise` prints are run, and their end is held to that of the scene itself by
// another method.
BOOST_AUTO_TEST_CASE(what_is_advised_is_done_by_the_commands_that_are_printed) {
  const Program program;
  const double asked = 0.02;
  const Outcome outcome = program.run(fmt::format(
      "advise puma_560 --error {} --duration 1 --method runge_kutta4 --json advice.json", asked));
  BOOST_REQUIRE(outcome.status == 0);
  const auto advice = nlohmann::json::parse(program.read("advice.json"));
  const auto chosen = advice.at("candidates").at(advice.at("chosen").get<std::size_t>());
  BOOST_TEST(chosen.at("model") != "full");
  BOOST_TEST(chosen.at("arithmetic") == "float");
  const auto endOf = [&](const std::string& words) {
    const Outcome run = program.run(words + " --csv motion.csv --outputs 1");
    BOOST_REQUIRE(run.status == 0);
    const std::string csv = program.read("motion.csv");
    const std::size_t last = csv.rfind('\n', csv.size() - 2) + 1;
    std::vector<double> row;
    std::istringstream cells(csv.substr(last));
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell.empty() ? 0 : std::stod(cell));
    return std::vector<double>(row.begin() + 1, row.begin() + 13);  // after time: q, qd
  };
  std::vector<double> end;
  for (const auto& command : advice.at("commands")) {
    const std::string words = command.get<std::string>().substr(std::string("dynwitness ").size());
    if (words.rfind("simulate", 0) == 0)
      end = endOf(words);
    else
      BOOST_TEST(program.run(words).status == 0, words);
  }
  BOOST_TEST((program.read("code/reduced.c").find("float") != std::string::npos));
  const std::vector<double> reference =
      endOf("simulate puma_560 --method gauss_6 --step 0.001 --duration 1");
  BOOST_REQUIRE(end.size() == 12U);
  double error = 0;
  for (std::size_t k = 0; k < end.size(); ++k)
    error = std::max(error, std::abs(end[k] - reference[k]));
  BOOST_TEST(error <= asked);
  BOOST_TEST(error > 1e-3 * asked);  // the cheapest wastes little of it
}

BOOST_AUTO_TEST_CASE(advice_that_nobody_can_give_is_refused) {
  const Program program;
  const auto refuses = [&](const std::string& words, const std::string& reason) {
    dynwitness::fixtures::refuses(program, "advise " + words, reason);
  };
  refuses("double_pendulum", "--error: not given");
  refuses("double_pendulum --error 1e-17", "roundings of double alone");
  refuses("double_pendulum --error 1e-3 --duration 60", "chaotic");
  refuses("double_pendulum --error 1e-3 --method gauss_4", "solve no equations");
  refuses("andrews_squeezer --error 1e-3", "open trees");
  refuses("puma_560_friction --error 1e-3", "jumps where a joint turns back");

  const Outcome late =
      program.run("advise double_pendulum --error 1e-3 --duration 1 --time-budget 1e-9");
  BOOST_TEST(late.status == 1);
  BOOST_TEST((late.out.find("none keeps it within 1e-09 s") != std::string::npos), late.out);
  const Outcome full = program.run("advise double_pendulum --error 1e-3 --duration 1");
  BOOST_TEST(full.status == 0);
  BOOST_TEST(
      (full.out.find("the full model only: the scene has no [envelope]") != std::string::npos),
      full.out);
}

// Held joints are fixed: the same bounds as those of the scene that has them fixed by hand, tau of
// the others alone.
BOOST_AUTO_TEST_CASE(what_an_envelope_holds_is_fixed) {
  const Program program;
  const std::string hand =
      "[[link]]\nname = \"hand\"\nparent = \"rod\"\nmass = 1\ncom = [0.1, 0, 0]\n"
      "inertia = { about = \"com\", xx = 0.1, yy = 0.2, zz = 0.2 }\n[link.joint]\nname = \"wrist\"\n"
      "xyz = [0, 0, -0.5]\n";
  const std::size_t at = kPendulum.find("[envelope]");
  const auto with = [&](const std::string& joint, const std::string& ranges) {
    return kPendulum.substr(0, at) + hand + joint + kPendulum.substr(at) + ranges;
  };
  program.write("fixed.toml", with("kind = \"fixed\"\n", ""));
  program.write("held.toml", with("kind = \"revolute\"\naxis = [1, 0, 0]\nrotor_inertia = 0.1\n",
                                  "wrist = { q = [0, 0], qd = [0, 0], qdd = [0, 0] }\n"));
  const auto bounds = [&](const std::string& file) {
    const Outcome outcome = program.run("envelope " + file + " --json bounds.json");
    BOOST_REQUIRE(outcome.status == 0);
    return nlohmann::json::parse(program.read("bounds.json")).at("bounds");
  };
  const auto held = bounds("held.toml");
  BOOST_TEST(held.size() == 1U);
  BOOST_TEST(held == bounds("fixed.toml"));
  const Outcome told = program.run("reduce held.toml --toml reduced.toml", "2>&1");
  BOOST_TEST(told.status == 0, told.out);
  BOOST_TEST(
      (told.out.find("holds 1 joints at 0, which are fixed here: wrist") != std::string::npos),
      told.out);
  BOOST_TEST(program.run("evaluate reduced.toml --quantity tau --qdd 1").status == 0);
}
