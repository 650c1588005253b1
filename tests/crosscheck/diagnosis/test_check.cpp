// SPDX-License-Identifier: GPL-3.0-or-later
// Witnesses on the stand: a right one is never blamed, and a mistake is named. The mistakes are
// made here by another road than in the diagnosis: our sweeps on a mechanism that is not the
// scene's, or formulas over what these answer.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE check
#include "crosscheck/diagnosis/examine.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <nlohmann/json.hpp>

#include "crosscheck/diagnosis/check_report.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "scene/numbers.hpp"

using namespace dynwitness;
using namespace dynwitness::crosscheck;
namespace data = boost::unit_test::data;

namespace {

using scene::Mechanism;
using scene::Number;
using State = scene::State<double>;
using Edit = std::function<void(Mechanism&)>;
/// What is answered in place of the sweeps' answers.
using Formula = std::function<Eigen::MatrixXd(
    Quantity, const State&, const std::function<Eigen::MatrixXd(Quantity, const State&)>& right)>;

/// An engine of sweeps on a mechanism of its own, judged as outside engines are.
class Engine : public Witness {
 public:
  Engine(const scene::Scene& scene, const Edit& edit, Formula formula, std::vector<Quantity> knows)
      : bound_(scene.mechanism),
        solve_bound_(scene.mechanism, SolvedBy::kMassMatrix, kEngineTurns),
        setup_(scene.mechanism, scene::RealNumbers<double>(scene.mechanism)),
        formula_(std::move(formula)),
        knows_(std::move(knows)) {
    if (!edit) return;
    Mechanism other = scene.mechanism;
    edit(other);
    setup_ = Setup<double>(other, scene::RealNumbers<double>(other));
  }
  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override {
    return std::find(knows_.begin(), knows_.end(), quantity) != knows_.end();
  }
  Answer answer(Quantity quantity, const State& state) override {
    const auto sweeps = [this](Quantity asked, const State& at) -> Eigen::MatrixXd {
      return asked == Quantity::kQdd ? CompositeBody::answer(setup_, asked, at)
                                     : NewtonEuler::answer(setup_, asked, at);
    };
    Answer out;
    out.value = formula_ ? formula_(quantity, state, sweeps) : sweeps(quantity, state);
    out.bound = bound_(quantity, state);
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }

 private:
  std::string name_ = "engine";
  EngineBound bound_;
  SolveBound solve_bound_;
  Setup<double> setup_;
  Formula formula_;
  std::vector<Quantity> knows_;
};

const std::vector<Quantity> kAll = {Quantity::kM,         Quantity::kc,        Quantity::kg,
                                    Quantity::kTau,       Quantity::kQdd,      Quantity::kKinetic,
                                    Quantity::kPotential, Quantity::kReactions};

Examination examined(const scene::Scene& scene, const Edit& edit, const Formula& formula = {},
                     const std::vector<Quantity>& knows = kAll, const CheckOptions& options = {}) {
  const WitnessKind kind{{"engine", "1", "a test"}, [=](const PreparedScene& asked) -> MadeWitness {
                           return std::make_unique<Engine>(asked.scene(), edit, formula, knows);
                         }};
  return examine(scene, kind, options);
}

scene::Link& linkOf(Mechanism& mechanism, int i) {
  return mechanism.links.at(static_cast<std::size_t>(i));
}
Number times(const Number& x, int numerator, int denominator = 1) {
  return Number::parse(fmt::format("({}) * {} / {}", x.text(), numerator, denominator));
}
void scaled(scene::MassProperties& m, int factor) {
  for (Number* x : {&m.xy, &m.xz, &m.yz}) *x = times(*x, factor);
}

struct Planted {
  std::string scene, rule, where;  ///< where: a link or a joint; empty: any
  Edit edit;
  Formula formula = {};
};
std::ostream& operator<<(std::ostream& out, const Planted& planted) {
  return out << planted.rule << " in " << planted.scene;
}

Formula ofTau(
    const std::function<Eigen::MatrixXd(const Eigen::MatrixXd& M_qdd, const Eigen::MatrixXd& c,
                                        const Eigen::MatrixXd& rest)>& sum,
    double of_c = 1) {
  return [=](Quantity quantity, const State& state, const auto& right) -> Eigen::MatrixXd {
    if (quantity == Quantity::kc) return of_c * right(quantity, state);
    if (quantity != Quantity::kTau) return right(quantity, state);
    const Eigen::MatrixXd c = right(Quantity::kc, state);
    State still = state;
    still.qdd.assign(state.qdd.size(), 0.0);
    const Eigen::MatrixXd bias = right(Quantity::kTau, still);
    return sum(right(Quantity::kTau, state) - bias, c, bias - c);
  };
}

const std::vector<Planted> kPlanted = {
    {"franka_panda", "gravity_sign", "",
     [](Mechanism& m) {
       for (Number& x : m.gravity) x = times(x, -1);
     }},
    {"puma_560", "gravity_missing", "", [](Mechanism& m) { m.has_gravity = false; }},
    {"double_pendulum", "gravity_twice", "",
     [](Mechanism& m) {
       for (Number& x : m.gravity) x = times(x, 2);
     }},
    {"franka_panda", "gravity_frame", "",
     [](Mechanism& m) { std::swap(m.gravity[0], m.gravity[2]); }},
    {"franka_panda", "mass_wrong", "",
     [](Mechanism& m) { linkOf(m, 4).inertia.mass = times(linkOf(m, 4).inertia.mass, 11, 10); }},
    {"puma_560", "inertia_wrong", "",
     [](Mechanism& m) { linkOf(m, 3).inertia.yy = times(linkOf(m, 3).inertia.yy, 13, 10); }},
    {"franka_panda", "length_wrong", "",
     [](Mechanism& m) {
       scene::Placement& p = linkOf(m, 3).joint.placement;
       for (Number* x : {&p.xyz[1], &p.d}) *x = times(*x, 101, 100);
     }},
    {"puma_560", "rotor_missing", "",
     [](Mechanism& m) { linkOf(m, 4).joint.rotor_inertia = Number(0); }},
    {"puma_560", "rotor_doubled", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links) l.joint.rotor_inertia = times(l.joint.rotor_inertia, 2);
     }},
    {"puma_560", "rotor_sign", "",
     [](Mechanism& m) {
       linkOf(m, 2).joint.rotor_inertia = times(linkOf(m, 2).joint.rotor_inertia, -1);
     }},
    {"franka_panda", "products_dropped", "", [](Mechanism& m) { scaled(linkOf(m, 5).inertia, 0); }},
    {"franka_panda", "product_sign", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links) scaled(l.inertia, -1);
     }},
    {"franka_panda", "com_dropped", "",
     [](Mechanism& m) {
       for (Number& x : linkOf(m, 6).inertia.com) x = Number(0);
     }},
    {"franka_panda", "parallel_axis_missing", "",
     [](Mechanism& m) { linkOf(m, 2).inertia.about = scene::MassProperties::About::kLinkOrigin; }},
    {"prismatic_revolute_mix", "principal_axes_not_rotated", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links) l.inertia.rpy = {Number(0), Number(0), Number(0)};
     }},
    {"stanford_arm", "prismatic_as_revolute", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links)
         if (l.joint.kind == scene::JointKind::kPrismatic)
           l.joint.kind = scene::JointKind::kRevolute;
     }},
    {"puma_560_friction", "damping_sign", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links)
         l.joint.friction.viscous = times(l.joint.friction.viscous, -1);
     }},
    {"puma_560_friction", "friction_missing", "",
     [](Mechanism& m) {
       for (scene::Link& l : m.links) l.joint.friction = {};
     }},
    {"franka_panda",
     "c_twice",
     "",
     {},
     ofTau([](const auto& M_qdd, const auto& c,
              const auto& rest) -> Eigen::MatrixXd { return M_qdd + 2 * c + rest; },
           2)},
    {"puma_560",
     "c_half",
     "",
     {},
     ofTau([](const auto& M_qdd, const auto& c,
              const auto& rest) -> Eigen::MatrixXd { return M_qdd + c / 2 + rest; },
           0.5)},
    {"franka_panda",
     "qdd_ignored",
     "",
     {},
     ofTau(
         [](const auto&, const auto& c, const auto& rest) -> Eigen::MatrixXd { return c + rest; })},
    {"puma_560",
     "triangle_only",
     "",
     {},
     [](Quantity quantity, const State& state, const auto& right) -> Eigen::MatrixXd {
       const Eigen::MatrixXd value = right(quantity, state);
       return quantity == Quantity::kM ? Eigen::MatrixXd(value.triangularView<Eigen::Upper>())
                                       : value;
     }},
    {"puma_560",
     "joint_order",
     "",
     {},
     [](Quantity quantity, const State& state, const auto& right) -> Eigen::MatrixXd {
       State other = state;
       std::swap(other.x[1], other.x[2]);
       for (auto* part : {&other.qd, &other.qdd, &other.tau}) std::swap((*part)[1], (*part)[2]);
       Eigen::MatrixXd value = right(quantity, other);
       if (value.rows() > 1) value.row(1).swap(value.row(2));
       if (value.cols() > 1) value.col(1).swap(value.col(2));
       return value;
     }},
    {"franka_panda",
     "float_precision",
     "",
     {},
     [](Quantity quantity, const State& state, const auto& right) -> Eigen::MatrixXd {
       return right(quantity, state).template cast<float>().template cast<double>();
     }},
};

std::string said(const Examination& e) {
  return checkText(e);
}

}  // namespace

BOOST_DATA_TEST_CASE(a_right_engine_is_never_blamed,
                     data::make({"simple_pendulum", "planar_3r", "puma_560", "kuka_iiwa_14",
                                 "puma_560_friction", "humanoid_floating", "stanford_arm",
                                 "satellite_arm", "lead_screw", "gyroscopic_wrist"}),
                     name) {
  const Examination e = examined(scene::findScene(name), {});
  BOOST_TEST(!e.isWrong(), said(e));
  BOOST_TEST(e.findings.empty());
  for (const QuantityFound& q : e.quantities)
    if (q.name != "momentum") BOOST_TEST((q.verdict == QuantityFound::Verdict::kRight), said(e));
}

BOOST_DATA_TEST_CASE(a_right_engine_is_never_blamed_on_random_trees, data::xrange(12), index) {
  const scene::Scene scene = randomTreeScene(13, static_cast<std::uint64_t>(index), 6);
  const Examination e = examined(scene, {});
  BOOST_TEST(!e.isWrong(), said(e));
}

// Numbers that are rounded to single precision are wrong, until that is what is asked for.
BOOST_AUTO_TEST_CASE(single_precision_is_right_where_it_is_meant) {
  const Formula rounded = [](Quantity quantity, const State& state,
                             const auto& right) -> Eigen::MatrixXd {
    return right(quantity, state).template cast<float>().template cast<double>();
  };
  CheckOptions single;
  single.single = true;
  for (const char* name : {"puma_560", "humanoid_floating"})
    BOOST_TEST(!examined(scene::findScene(name), {}, rounded, kAll, single).isWrong(), name);
}

BOOST_DATA_TEST_CASE(a_mistake_is_named_first, data::make(kPlanted), planted) {
  const Examination e = examined(scene::findScene(planted.scene), planted.edit, planted.formula);
  BOOST_TEST_CONTEXT(said(e)) {
    BOOST_TEST_REQUIRE(e.isWrong());
    BOOST_TEST_REQUIRE(!e.findings.empty());
    BOOST_TEST(e.findings.front().explains);
    BOOST_TEST(e.findings.front().parts.front().rule == planted.rule);
    BOOST_TEST(e.findings.front().parts.size() == 1u);
  }
}

// The same mistakes, of an engine that knows tau alone.
BOOST_DATA_TEST_CASE(a_mistake_is_named_from_tau_alone, data::make(kPlanted), planted) {
  if (planted.rule == "triangle_only") return;  // tau does not show it
  const Examination e =
      examined(scene::findScene(planted.scene), planted.edit, planted.formula, {Quantity::kTau});
  BOOST_TEST_CONTEXT(said(e)) {
    BOOST_TEST_REQUIRE(!e.findings.empty());
    BOOST_TEST(e.findings.front().explains);
    BOOST_TEST(e.findings.front().parts.front().rule == planted.rule);
  }
}

BOOST_AUTO_TEST_CASE(an_estimate_is_the_number_that_was_planted) {
  const scene::Scene scene = scene::findScene("franka_panda");
  const Examination e = examined(scene, [](Mechanism& m) {
    linkOf(m, 4).inertia.mass = times(linkOf(m, 4).inertia.mass, 11, 10);
  });
  BOOST_TEST_REQUIRE(!e.findings.empty());
  const Explanation& found = e.findings.front().parts.front();
  BOOST_TEST(found.link == 4);
  BOOST_TEST_REQUIRE(found.estimates.size() == 1u);
  const Estimate& mass = found.estimates.front();
  BOOST_TEST(std::abs(mass.value - 1.1 * mass.scene) <= mass.uncertainty + 1e-15 * mass.scene);
}

BOOST_AUTO_TEST_CASE(a_pair_of_mistakes_is_named) {
  const Examination e = examined(scene::findScene("puma_560"), [](Mechanism& m) {
    for (Number& x : m.gravity) x = times(x, -1);
    linkOf(m, 4).joint.rotor_inertia = Number(0);
  });
  BOOST_TEST_CONTEXT(said(e)) {
    BOOST_TEST_REQUIRE(e.isExplained());
    BOOST_TEST_REQUIRE(e.findings.front().parts.size() == 2u);
    std::vector<std::string> rules;
    for (const Explanation& part : e.findings.front().parts) rules.push_back(part.rule);
    std::sort(rules.begin(), rules.end());
    BOOST_TEST(rules == (std::vector<std::string>{"gravity_sign", "rotor_missing"}),
               boost::test_tools::per_element());
  }
}

// Forward dynamics without M qdd would solve nothing: whoever leaves it out of tau has it there.
BOOST_AUTO_TEST_CASE(accelerations_ignored_in_tau_are_not_ignored_where_qdd_is_solved_for) {
  const Formula ignored = ofTau(
      [](const auto&, const auto& c, const auto& rest) -> Eigen::MatrixXd { return c + rest; });
  const scene::Scene scene = scene::findScene("puma_560");
  const Examination alone = examined(scene, {}, ignored);
  BOOST_TEST_REQUIRE(alone.isExplained(), said(alone));
  BOOST_TEST(alone.findings.front().spared.empty(), said(alone));
  const Examination both = examined(
      scene,
      [](Mechanism& m) {
        for (Number& x : m.gravity) x = times(x, -1);
      },
      ignored);
  BOOST_TEST_CONTEXT(said(both)) {
    BOOST_TEST_REQUIRE(both.isExplained());
    std::vector<std::string> rules;
    for (const Explanation& part : both.findings.front().parts) rules.push_back(part.rule);
    std::sort(rules.begin(), rules.end());
    BOOST_TEST(rules == (std::vector<std::string>{"gravity_sign", "qdd_ignored"}),
               boost::test_tools::per_element());
  }
}

// Nobody takes the third power of a cosine for a moment: nothing on record explains that.
BOOST_AUTO_TEST_CASE(what_nothing_explains_is_cut_down) {
  const Examination e =
      examined(scene::findScene("puma_560"), {},
               [](Quantity quantity, const State& state, const auto& right) -> Eigen::MatrixXd {
                 Eigen::MatrixXd value = right(quantity, state);
                 if (quantity == Quantity::kg)
                   value(0) += state.x[0].c * state.x[0].c * state.x[0].c;
                 return value;
               });
  BOOST_TEST_CONTEXT(said(e)) {
    BOOST_TEST_REQUIRE(e.isWrong());
    BOOST_TEST(!e.isExplained());
    BOOST_TEST_REQUIRE(e.smallest.has_value());
    BOOST_TEST((e.smallest->quantity == Quantity::kg));
    BOOST_TEST(e.smallest->scene.mechanism.dof() == 1);
    BOOST_TEST(e.smallest->joints.empty());
    const std::string text = scene::writeSceneToml(e.smallest->scene);
    BOOST_TEST(scene::writeSceneToml(scene::readSceneToml(text, "smallest")) == text);
  }
}

BOOST_AUTO_TEST_CASE(where_says_which_terms_are_wrong) {
  const Examination e = examined(scene::findScene("franka_panda"), [](Mechanism& m) {
    for (Number& x : m.gravity) x = times(x, -1);
  });
  const std::vector<std::string> expected = {"M: right", "c: right", "g: wrong",
                                             "friction: right in tau"};
  BOOST_TEST(e.where.terms == expected, boost::test_tools::per_element());
}

// Eight of ten that are not answered are no "right".
BOOST_AUTO_TEST_CASE(the_last_line_names_what_was_judged) {
  const auto lastLine = [](const Examination& e) {
    const std::string text = said(e);
    return text.substr(text.rfind('\n', text.size() - 2) + 1);
  };
  const scene::Scene scene = scene::findScene("simple_pendulum");
  const Examination two = examined(scene, {}, {}, {Quantity::kM, Quantity::kg});
  BOOST_TEST(
      lastLine(two) ==
      "right in M and g; not answered: c, tau, qdd, kinetic, potential, momentum, reactions\n");
  BOOST_TEST(nlohmann::json::parse(checkJson(two, "1")).at("not_answered").size() == 7u);
  Examination whole = examined(scene, {});
  whole.quantities.erase(std::remove_if(whole.quantities.begin(), whole.quantities.end(),
                                        [](const QuantityFound& q) { return !q.reason.empty(); }),
                         whole.quantities.end());
  BOOST_TEST(lastLine(whole) == "right\n");
  BOOST_TEST(nlohmann::json::parse(checkJson(whole, "1")).at("not_answered").empty());
  whole.version = "unknown";
  BOOST_TEST(said(whole).find("by engine (version not told), limits") != std::string::npos);
  // one that is wrong is no less wrong
  const Examination wrong =
      examined(scene, [](Mechanism& m) { m.gravity[2] = times(m.gravity[2], 2); }, {},
               {Quantity::kM, Quantity::kg});
  BOOST_TEST(lastLine(wrong) == "WRONG\n");
}

BOOST_AUTO_TEST_CASE(programs_read_the_rule_first) {
  const Examination e = examined(scene::findScene("double_pendulum"), [](Mechanism& m) {
    for (Number& x : m.gravity) x = times(x, 2);
  });
  const auto json = nlohmann::json::parse(checkJson(e, "1"));
  BOOST_TEST(json.at("verdict") == "wrong");
  BOOST_TEST(json.at("findings").at(0).at("rule") == "gravity_twice");
  BOOST_TEST(json.at("findings").at(0).at("explains") == true);
  BOOST_TEST(json.at("findings").at(0).contains("residual_ulp"));
}
