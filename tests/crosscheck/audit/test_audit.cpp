// SPDX-License-Identifier: GPL-3.0-or-later
// The audit of the chapter: complete, computed, and able to fail.
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "crosscheck/audit/audit.hpp"
#include "crosscheck/audit/audit_report.hpp"
#include "crosscheck/audit/ours.hpp"
#include "crosscheck/audit/truths.hpp"
#include "crosscheck/report/ascii_math.hpp"
#include "scene/error.hpp"

using namespace dynwitness;
using namespace dynwitness::audit;

namespace {

/// How many of the chapter's numbered equations the audit has.
constexpr int kEquations = 74;

/// The whole audit, computed once.
const Audit& wholeAudit() {
  static const Audit audit = runAudit(1);
  return audit;
}

const Entry& entry(const std::string& id) {
  const auto& entries = wholeAudit().entries;
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.id == id; });
  if (found == entries.end()) throw std::invalid_argument("no entry " + id);
  return *found;
}

Trial alwaysZero() {
  return decided("count", [] { return Decision{true, "0"}; });
}
Trial neverZero() {
  return decided("count", [] { return Decision{false, "not 0"}; });
}

}  // namespace

// ---- complete ----------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(every_numbered_equation_has_one_entry_and_ids_are_unique) {
  std::map<std::string, int> seen;
  for (const Entry& e : wholeAudit().entries) ++seen[e.id];
  for (const auto& [id, count] : seen) BOOST_TEST(count == 1, id);
  int equations = 0;
  for (const Entry& e : wholeAudit().entries) equations += e.isEquation() ? 1 : 0;
  BOOST_TEST(equations == kEquations);
  for (int i = 1; i <= kEquations; ++i) BOOST_TEST(seen["eq" + std::to_string(i)] == 1, i);
}

BOOST_AUTO_TEST_CASE(every_entry_is_complete_and_points_at_a_file_that_is_there) {
  for (const Entry& e : wholeAudit().entries) {
    BOOST_TEST_CONTEXT(e.id) {
      BOOST_TEST(!e.section.empty());
      BOOST_TEST(!e.title.empty());
      BOOST_TEST(!e.printed.empty());
      BOOST_TEST(!e.why.empty());
      BOOST_TEST(!e.residual_printed.residual.empty());
      BOOST_TEST(!e.residual_printed.method.empty());
      BOOST_TEST(e.corrected.empty() == !e.residual_corrected.has_value());
      BOOST_TEST(e.condition.empty() == !e.residual_condition.has_value());
      BOOST_TEST(std::filesystem::is_regular_file(std::filesystem::path(DYNWITNESS_SOURCE_DIR) /
                                                  e.implemented_in),
                 e.implemented_in);
      for (const std::string& text : {e.title, e.printed, e.corrected, e.condition, e.why})
        BOOST_TEST(std::count(text.begin(), text.end(), '`') % 2 == 0, text);
    }
  }
}

/// What the chapter prints and what is not so: a lecturer puts it on the board.
BOOST_AUTO_TEST_CASE(every_wrong_equation_has_a_counterexample_in_numbers) {
  int seen = 0;
  for (const Entry& e : wholeAudit().entries) {
    if (!e.isEquation() || e.holds == Holds::kTrue) continue;
    BOOST_TEST_CONTEXT(e.id) {
      if (e.id == "eq60") {  // the rows are the sides
        BOOST_REQUIRE(e.numbers.has_value());
        BOOST_TEST(e.numbers->rows[0].back() != e.numbers->rows[1].back());
      } else {
        BOOST_REQUIRE(e.numbers.has_value());
        const auto& head = e.numbers->head;
        const auto column = [&](const char* word) {
          const auto found = std::find_if(head.begin(), head.end(), [&](const std::string& cell) {
            return cell.compare(0, 2, word, 2) == 0;
          });
          BOOST_REQUIRE(found != head.end() || e.id == "eq64");
          return static_cast<std::size_t>(found - head.begin());
        };
        const std::size_t printed = column("printed"), so = column("so");
        BOOST_TEST(
            std::any_of(e.numbers->rows.begin(), e.numbers->rows.end(), [&](const auto& row) {
              return e.id == "eq64" ? row.back().compare(0, 7, "neither") == 0
                                    : row[printed] != row[so];
            }));
      }
    }
    ++seen;
  }
  BOOST_TEST(seen == 20);
}

/// So has every wrong sentence; those on cost have what was counted.
BOOST_AUTO_TEST_CASE(wrong_sentences_have_numbers_on_both_sides) {
  for (const Entry& e : wholeAudit().entries) {
    if (!e.isPrinted() || e.isEquation() || e.holds != Holds::kFalse) continue;
    BOOST_TEST(e.numbers.has_value(), e.id);
    if (!e.numbers) continue;
    BOOST_TEST(std::any_of(e.numbers->rows.begin(), e.numbers->rows.end(),
                           [](const auto& row) { return row[row.size() - 2] != row.back(); }),
               e.id);
  }
}

// The figures of boards by hand: both sides, from masses, lengths and angles of the scenes' files.
BOOST_AUTO_TEST_CASE(boards_show_what_comes_out_by_hand) {
  // all columns but the first, row by row; a board has four digits
  const auto has = [](const std::string& id, const std::vector<std::vector<double>>& expected) {
    BOOST_TEST_CONTEXT(id) {
      const Rows& rows = entry(id).numbers.value().rows;
      BOOST_REQUIRE(rows.size() == expected.size());
      for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t k = 0; k < expected[i].size(); ++k) {
          const std::string& cell = rows[i][rows[i].size() - expected[i].size() + k];
          BOOST_TEST(
              std::abs(std::stod(cell) - expected[i][k]) <= 5.1e-4 * std::abs(expected[i][k]),
              cell << " for " << expected[i][k]);
        }
    }
  };
  const double g = 9.81, l_1 = 0.5, l_2 = 0.4, m_1 = 1, m_2 = 0.8, s = std::sin(0.5),
               c = std::cos(0.5);
  has("eq14", {{-l_1, -l_1, 0}, {0, 0, 0}, {0, 0, 0}});
  has("eq17", {{0, 0.539 - 0.52}, {0, 0.126 - 0.539}, {0, 0.52 - 0.126}});
  const double about_middle = m_1 * l_1 * l_1 / 12, about_end = m_1 * l_1 * l_1 / 3;
  has("eq19", {{about_middle, about_middle, about_end}, {about_middle, about_middle, about_end}});
  has("eq66", {{0, -2}, {0, -4}});
  has("eq68", {{0.5, 0.5 + 0.1 - 0.4, 0.6}, {0.5, 0.5 + 0.1 - 0.4, 0.1}});
  has("eq74", {{0.001, 0.0011}, {0, 0.001}});
  has("centripetal", {{m_1 * l_1 / 2, -m_1 * l_1 / 2}});
  has("tip_inertia", {{0, m_2 * l_2 * l_2 / 3}});
  const double elbow = m_2 * g * l_2 / 2 * std::sin(1.0),
               shoulder = (m_1 * l_1 / 2 + m_2 * l_1) * g * s + elbow;
  has("gravity_start", {{-shoulder, shoulder}, {-elbow, elbow}});
  const double push = (l_2 / 2) / (l_2 * l_2 / 3);  // across the lower rod, for 1 N m at the elbow
  has("id_order", {{0, -push * s}, {0, push * c}, {0, 1 + l_1 * push * c}});
  has("b_curvature", {{0, -1 / 0.5}});
  has("other_impedances", {{-90, -100}, {90, 100}, {0, 100}, {100, 110}, {0, -100}, {100, 110}});
  // and where a board has what its sides are made of
  for (const auto& row : entry("eq33").numbers.value().rows) {
    const double d = std::stod(row[1]), link = std::stod(row[2]);
    BOOST_TEST(std::abs(std::stod(row[3]) - (link - d)) <= 1e-3 * (link + d), row[0]);
    BOOST_TEST(std::abs(std::stod(row[4]) - (link + d)) <= 1e-3 * (link + d), row[0]);
  }
  for (const auto& row : entry("eq36").numbers.value().rows) {
    const double d = std::stod(row[1]), link = std::stod(row[2]);
    BOOST_TEST(row[3] == "0");
    BOOST_TEST(std::abs(std::stod(row[4]) - d / (d + link)) <= 1e-3, row[0]);
  }
  for (const auto& row : entry("eq63").numbers.value().rows)
    BOOST_TEST(std::abs(std::stod(row[1]) - 2 * std::stod(row[2])) <= 1e-3 * std::stod(row[1]));
}

/// Neither what is left open nor what readers may conclude is the chapter's error.
BOOST_AUTO_TEST_CASE(what_the_chapter_does_not_print_is_not_counted) {
  for (const char* id :
       {"coriolis_choice", "spatial_recursion", "prismatic_acceleration", "plain_pseudo_inverse",
        "shared_subtree", "E0_overconstrained", "force_signs", "six_joints"})
    BOOST_TEST(!entry(id).isPrinted(), id);
  for (const char* id : {"eq36", "gravity_start", "euler_pdes", "fully_equivalent"})
    BOOST_TEST(entry(id).isPrinted(), id);
  int equations = 0, sentences = 0, others = 0;
  for (const Entry& e : wholeAudit().entries)
    ++(!e.isPrinted() ? others : e.isEquation() ? equations : sentences);
  const std::string said = wholeAudit().headline();
  BOOST_TEST(said.find(std::to_string(sentences) + " sentences: ") != std::string::npos, said);
  BOOST_TEST(said.find("not counted: " + std::to_string(others)) != std::string::npos, said);
  BOOST_TEST(!wholeAudit().chapter.criterion.empty());
}

/// One rule: what a passage cites belongs to it, in (38) as in (40), in (45) as in (44) and (48).
BOOST_AUTO_TEST_CASE(equations_of_one_passage_are_read_alike) {
  for (const char* id : {"eq38", "eq40", "eq44", "eq45", "eq48", "eq69"})
    BOOST_TEST((entry(id).holds == Holds::kTrue), id);
}

// ---- sentences and trials ----------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(every_statement_has_its_trials_and_every_trial_its_statement) {
  const Chapter chapter = bundledChapter();
  const std::vector<Trials> trials = allTrials();
  const std::vector<Claim> claims = joined(chapter, trials);
  BOOST_TEST(claims.size() == chapter.statements.size());
  BOOST_TEST(claims.size() == trials.size());
  for (const Claim& claim : claims) BOOST_TEST(claim.statement.id == claim.trials.id);
}

namespace {

const std::string kChapter =
    "[chapter]\nauthor = \"a\"\ntitle = \"t\"\nyear = \"1\"\ncriterion = [\"r\"]\nsections = [\"one\", \"two\"]\n";

/// A statement of section 1 whose lines begin at line 8 of a file that starts with kChapter.
std::string statement(const std::string& id, const std::string& more = "") {
  return "\n[[statement]]\nid = \"" + id +
         "\"\nsection = \"1\"\ntitle = \"t\"\nprinted = \"p\"\nwhy = \"w\"\n"
         "implemented_in = \"f\"\n" +
         more;
}

/// What the audit of a file with these sentences, computed by these trials, says against it.
std::string refusal(const std::string& text, const std::vector<Trials>& trials) {
  try {
    joined(readChapter(text, "c.toml"), trials);
  } catch (const scene::InputError& error) {
    return error.what();
  }
  return "not refused";
}

Trials trialsOf(const std::string& id) {
  return Trials(id).printed(alwaysZero());
}

}  // namespace

BOOST_AUTO_TEST_CASE(sentences_that_do_not_fit_the_trials_are_refused) {
  const std::vector<Trials> one = {trialsOf("a")};
  const auto refused = [](const std::string& text, const std::vector<Trials>& trials,
                          const std::string& words) { BOOST_TEST(refusal(text, trials) == words); };
  const std::string a = kChapter + statement("a");
  refused(a, one, "not refused");
  refused(a + statement("b"), one,
          "c.toml:16: statement \"b\": crosscheck/audit/ computes no such statement, allowed: "
          "none, each that it computes is there");
  refused(kChapter + statement("b"), one,
          "c.toml:8: statement \"b\": crosscheck/audit/ computes no such statement, allowed: a");
  refused(a, {one[0], trialsOf("b")},
          "c.toml: lacks statements that crosscheck/audit/ computes: b");
  refused(a + "corrected = \"c\"\n", one,
          "c.toml:8: statement \"a\": has a correction that crosscheck/audit/ does not compute, "
          "allowed: none");
  refused(a, {trialsOf("a").condition(neverZero())},
          "c.toml:8: statement \"a\": has no condition, allowed: one, as crosscheck/audit/ "
          "computes it");
  refused(a + "numbers_caption = \"c\"\n", {trialsOf("a").numbers(definitenessRows)},
          "c.toml:8: statement \"a\": has no numbers_head, allowed: one, as crosscheck/audit/ "
          "computes it");
  BOOST_CHECK_THROW(joined(readChapter(a, "c.toml"), {one[0], one[0]}), std::logic_error);
}

BOOST_AUTO_TEST_CASE(a_file_of_sentences_is_refused_with_file_and_line) {
  const std::vector<Trials> one = {trialsOf("a")};
  const auto refused = [&](const std::string& text, const std::string& words) {
    const std::string said = refusal(text, one);
    BOOST_TEST(said.compare(0, words.size(), words) == 0, said);
  };
  const std::string a = kChapter + statement("a");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = a;
    text.replace(text.rfind(from), from.size(), to);
    return text;
  };
  refused(a + "whi = \"w\"\n",
          "c.toml:15: statement: unknown key \"whi\" (did you mean why?), allowed: id, section");
  refused(a + "[[statment]]\n", "c.toml:15: file: unknown key \"statment\"");
  refused(with("why = \"w\"\n", ""), "c.toml:8: statement: has no why, allowed: a text");
  refused(with("\"w\"", "\" \""), "c.toml:13: statement: why: an empty string, allowed: a text");
  refused(with("\"w\"", "7"), "c.toml:13: statement: why: an integer, allowed: a string");
  refused(with("\"w\"", "\"`x\""), "c.toml:13: statement: why: an odd number of backticks");
  refused(with("\"w\"", "w"), "c.toml:13: not TOML");
  refused(with("\"1\"", "\"3\""), "c.toml:8: statement \"a\": section \"3\", allowed: 1 to 2");
  refused(with("\"1\"", "\"1..2\""), "c.toml:8: statement \"a\": section \"1..2\", allowed");
  refused(a + "left_open = 1\n", "c.toml:15: statement: left_open: an integer, allowed: true");
  refused(with("\"1\"", "\"1.1\"") + statement("b"),
          "c.toml:16: statement \"b\": section \"1\" after a later one");
  refused(a + statement("a"), "c.toml:16: statement \"a\": a second one");
  refused(statement("a"), "c.toml");
  for (const std::string key : {"criterion", "sections"}) {
    std::string text = a;
    text.replace(text.find(key), text.find('\n', text.find(key)) + 1 - text.find(key), "");
    refused(text, "c.toml:1: chapter: has no " + key + ", allowed: an array of ");
  }
  BOOST_TEST(
      readChapter(with("\"w\"", "\"\"\"\na\n  b `c\nd`\"\"\""), "c.toml").statements[0].why ==
      "a b `c d`");
}

BOOST_AUTO_TEST_CASE(a_table_has_as_many_columns_as_heads) {
  Claim claim{{}, trialsOf("a").numbers([] { return Rows{{"1", "2"}}; })};
  claim.statement.numbers_head = {"one"};
  BOOST_CHECK_THROW(evaluate(claim, 1), scene::InputError);
  claim.statement.numbers_head.push_back("two");
  BOOST_TEST(evaluate(claim, 1).numbers->head.size() == 2u);
}

// ---- computed ----------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(every_correction_and_every_condition_is_found_to_hold) {
  for (const Entry& e : wholeAudit().entries) {
    BOOST_TEST_CONTEXT(e.id) {
      BOOST_TEST(e.isSound());
      if (e.holds != Holds::kTrue) BOOST_REQUIRE(e.residual_corrected.has_value());
      if (e.residual_corrected)
        BOOST_TEST(e.residual_corrected->zero, e.residual_corrected->residual);
      if (e.residual_condition)
        BOOST_TEST(e.residual_condition->zero, e.residual_condition->residual);
      for (const auto& outcome : {std::optional<Outcome>(e.residual_printed), e.residual_corrected})
        if (outcome && outcome->zero) BOOST_TEST(outcome->chance <= 1e-30);
    }
  }
}

// Every verdict, as the entries were read against the chapter one by one: a trial that decides
// otherwise has changed what it asks, or the chapter is read otherwise.
BOOST_AUTO_TEST_CASE(each_entry_has_the_verdict_with_which_it_was_read) {
  const std::set<std::string> wrong = {"shared_subtree",
                                       "inverse_reason",
                                       "bias_vanishes",
                                       "centripetal",
                                       "diagonal_mass",
                                       "coupling_force",
                                       "coupling_acceleration",
                                       "eq32",
                                       "free_projection",
                                       "eq33",
                                       "eq36",
                                       "rotor_cost",
                                       "prismatic_acceleration",
                                       "spatial_recursion",
                                       "eq50",
                                       "force_signs",
                                       "tip_inertia",
                                       "eq51",
                                       "id_order",
                                       "gravity_start",
                                       "inertia_sweep_shared",
                                       "b_curvature",
                                       "eq54",
                                       "eq56",
                                       "eq58",
                                       "eq60",
                                       "task_torques",
                                       "E0_overconstrained",
                                       "plain_pseudo_inverse",
                                       "parameter_linearity",
                                       "coriolis_choice",
                                       "eq63",
                                       "euler_pdes",
                                       "eq68",
                                       "similarity",
                                       "other_impedances"};
  const std::set<std::string> under_condition = {"eq14",
                                                 "eq15_spatial",
                                                 "eq17",
                                                 "eq19",
                                                 "rotor_projection",
                                                 "six_joints",
                                                 "eq52",
                                                 "eq55",
                                                 "balance",
                                                 "N_definite",
                                                 "eq59",
                                                 "null_motion",
                                                 "E0_rank",
                                                 "coasting",
                                                 "explicit_form",
                                                 "composite_order",
                                                 "composite_efficiency",
                                                 "eq64",
                                                 "least_action",
                                                 "eq66",
                                                 "fully_equivalent",
                                                 "invariance",
                                                 "eq74"};
  for (const Entry& e : wholeAudit().entries) {
    const Holds read = wrong.count(e.id) != 0             ? Holds::kFalse
                       : under_condition.count(e.id) != 0 ? Holds::kUnderCondition
                                                          : Holds::kTrue;
    BOOST_TEST((e.holds == read), e.id + ": " + name(e.holds) + ", read as " + name(read));
  }
}

// Verdicts by another road: known errata of the chapter, and equations as the books have them
// (R. Featherstone, Rigid Body Dynamics Algorithms, chapters 2 and 7).
BOOST_AUTO_TEST_CASE(known_errata_are_found_and_textbook_equations_hold) {
  for (const char* id : {"eq32", "eq33", "eq36", "eq50", "free_projection", "diagonal_mass"})
    BOOST_TEST((entry(id).holds == Holds::kFalse), id);
  for (const char* id : {"eq14", "eq17", "eq19", "rotor_projection"})
    BOOST_TEST((entry(id).holds == Holds::kUnderCondition), id);
  for (const char* id :
       {"eq1", "eq4", "eq13", "eq16", "eq18", "eq23", "eq28", "eq30", "eq34", "eq49"})
    BOOST_TEST((entry(id).holds == Holds::kTrue), id);
}

BOOST_AUTO_TEST_CASE(verdicts_do_not_depend_on_the_seed) {
  const Audit other = runAudit(20251121);
  BOOST_REQUIRE(other.entries.size() == wholeAudit().entries.size());
  for (std::size_t i = 0; i < other.entries.size(); ++i)
    BOOST_TEST((other.entries[i].holds == wholeAudit().entries[i].holds), other.entries[i].id);
}

// ---- able to fail ------------------------------------------------------------------------------

// What is wrong in the chapter, planted as a correction: the entry must not stand.
BOOST_AUTO_TEST_CASE(a_wrong_correction_is_noticed_in_every_entry_that_has_one) {
  int planted = 0;
  for (Claim claim : joined(bundledChapter(), allTrials())) {
    if (!claim.trials.corrected_trial) continue;
    claim.trials.corrected_trial = claim.trials.printed_trial;
    const bool stands = evaluate(claim, 3).isSound();
    BOOST_TEST(stands == (entry(claim.trials.id).holds == Holds::kTrue), claim.trials.id);
    ++planted;
  }
  BOOST_TEST(planted > 10);
}

BOOST_AUTO_TEST_CASE(a_flipped_sign_in_a_right_equation_is_noticed) {
  const auto shifted = [](int sign) {
    return exact([sign](Point& at) {
      const Vector3<T> p_1 = at.vector(), p_2 = at.vector(), place = at.vector(), f = at.vector();
      const Vector3<T> r = (p_2 - p_1) * T(sign);
      at.equal("moment", (place - p_1).cross(f), (place - p_2).cross(f) + r.cross(f));
    });
  };
  BOOST_TEST(shifted(1)("shift", 1).zero);
  const Outcome wrong = shifted(-1)("shift", 1);
  BOOST_TEST(!wrong.zero);
  BOOST_TEST(wrong.residual == "not 0: moment (first at entry 1 of 3)");
}

BOOST_AUTO_TEST_CASE(holds_follows_from_the_residuals_alone) {
  const auto made = [](Trial printed, Trial corrected, Trial condition) {
    return evaluate({{},
                     Trials("some")
                         .printed(std::move(printed))
                         .corrected(std::move(corrected))
                         .condition(std::move(condition))},
                    1);
  };
  BOOST_TEST((made(alwaysZero(), {}, {}).holds == Holds::kTrue));
  BOOST_TEST((made(neverZero(), alwaysZero(), {}).holds == Holds::kFalse));
  BOOST_TEST((made(neverZero(), alwaysZero(), alwaysZero()).holds == Holds::kUnderCondition));
  BOOST_TEST((made(neverZero(), alwaysZero(), neverZero()).holds == Holds::kFalse));
  BOOST_TEST(made(neverZero(), alwaysZero(), {}).isSound());
  BOOST_TEST(!made(neverZero(), {}, {}).isSound());  // wrong, and no word of what is right
  BOOST_TEST(!made(neverZero(), neverZero(), {}).isSound());
  BOOST_TEST(!made(neverZero(), alwaysZero(), neverZero()).isSound());
  BOOST_CHECK_THROW(evaluate({{}, Trials("none")}, 1), std::logic_error);
}

// A fault of ours is not the chapter's.
BOOST_AUTO_TEST_CASE(what_our_code_answers_decides_soundness_alone) {
  for (const bool is_right : {true, false}) {
    const Entry made = evaluate(
        {{}, Trials("some").printed(alwaysZero()).ours(is_right ? alwaysZero() : neverZero())}, 1);
    BOOST_TEST((made.holds == Holds::kTrue));
    BOOST_TEST(made.isSound() == is_right);
    BOOST_TEST(made.comparesOurCode());
  }
  const auto asks_us = exact([](Point& at) { at.equal("our code: 1", T(1), T(1)); });
  BOOST_CHECK_THROW(evaluate({{}, Trials("some").printed(asks_us)}, 1), std::logic_error);
  BOOST_CHECK_THROW(
      evaluate({{}, Trials("some").printed(neverZero()).corrected(alwaysZero()).condition(asks_us)},
               1),
      std::logic_error);
}

/// What stands under "Code" was asked, in every entry that names a file of recursive/.
BOOST_AUTO_TEST_CASE(an_entry_that_names_a_file_of_ours_compares_its_answer) {
  int seen = 0;
  for (const Entry& e : wholeAudit().entries) {
    if (e.implemented_in.compare(0, 10, "recursive/") != 0) continue;
    BOOST_TEST(e.comparesOurCode(), e.id + ": " + e.implemented_in);
    if (e.residual_ours) BOOST_TEST(e.residual_ours->zero, e.residual_ours->residual);
    ++seen;
  }
  BOOST_TEST(seen > 100);
  BOOST_TEST(!oursOf("crosscheck/audit/lagrange.cpp"));
}

BOOST_AUTO_TEST_CASE(a_trial_that_compares_nothing_is_refused) {
  BOOST_CHECK_THROW(exact([](Point& at) { at.number(); })("nothing", 1), std::logic_error);
  BOOST_CHECK_THROW(certified([](RealPoint& at) { at.vector(); })("nothing", 1), std::logic_error);
}

BOOST_AUTO_TEST_CASE(a_formula_without_a_value_does_not_pass_as_zero) {
  const Outcome outcome = exact([](Point& at) {
    const T x = at.number();
    at.zero("1 / (x - x)", T(1) / (x - x));
  })("no value", 1);
  BOOST_TEST(!outcome.zero);
}

BOOST_AUTO_TEST_CASE(certified_signs_are_those_of_the_numbers) {
  const auto square_plus = [](int shift) {
    return certified([shift](RealPoint& at) {
      const Ball x = at.number(-1, 1);
      at.positive("x^2 + shift", x * x + Ball(shift));
    });
  };
  BOOST_TEST(square_plus(0)("square", 1).zero);
  BOOST_TEST(!square_plus(-1)("square", 1).zero);
  // an exact 0 is not positive
  BOOST_TEST(!certified([](RealPoint& at) { at.positive("0", Ball(0)); })("zero", 1).zero);
}

BOOST_AUTO_TEST_CASE(differs_and_both_say_what_they_say) {
  const Trial square = exact([](Point& at) {
    const auto x = at.number(), y = at.number();
    at.equal("(x + y)(x - y)", (x + y) * (x - y), x * x - y * y);
  });
  const auto sum = [](Point& at) {
    const auto x = at.number(), y = at.number();
    at.equal("(x + y)^2", (x + y) * (x + y), x * x + y * y);
  };
  BOOST_TEST(square("square", 1).zero);
  BOOST_TEST(!exact(sum)("sum", 1).zero);
  BOOST_TEST(differs(sum)("sum", 1).zero);
  BOOST_TEST(both(square, differs(sum))("both", 1).zero);
  BOOST_TEST(!both(square, exact(sum))("both", 1).zero);
  BOOST_TEST(!both(exact(sum), square)("both", 1).zero);
}

// ---- the truths, by still other roads ----------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_path_stays_a_rotation_and_its_rates_are_those_of_known_motions) {
  const Outcome rotation = exact([](Point& at) {
    const Path<T> path = anyPath(at);
    const Matrix3<Jet<T>> product = path.R.transpose() * path.R;
    at.equal("R'R", now<T, 3, 3>(product), Matrix3<T>::Identity());
    at.zero("its rate", rate<T, 3, 3>(product));
    at.zero("its second rate", secondRate<T, 3, 3>(product));
  })("rotation", 1);
  BOOST_TEST(rotation.zero, rotation.residual);
  // a frame that turns about z of the world: w = (0, 0, qd), wd = (0, 0, qdd); a place on it at
  // distance r has the accelerations -r qd^2 inward and r qdd along
  const Outcome circle = exact([](Point& at) {
    const Vector3<T> none = Vector3<T>::Zero();
    const Matrix3<T> one = Matrix3<T>::Identity();
    const Path<T> world{still<T, 3, 3>(one), still<T, 3, 1>(none)};
    const JointMotion<T> joint = anyJointMotion(at);
    const scene::CosSin<T> angle = at.angle();
    const Path<T> turning = turned<T>(world, one, none, angle, joint);
    at.equal("w", turning.omega(), Vector3<T>(T(0), T(0), joint.qd));
    at.equal("wd", turning.alpha(), Vector3<T>(T(0), T(0), joint.qdd));
    const T r = at.number();
    const Vector3<T> radial(angle.c, angle.s, T(0)), along(-angle.s, angle.c, T(0));
    at.equal("acceleration", secondRate<T, 3, 1>(turning.place(Vector3<T>(r, T(0), T(0)))),
             Vector3<T>(along * (r * joint.qdd) - radial * (r * joint.qd * joint.qd)));
  })("circle", 1);
  BOOST_TEST(circle.zero, circle.residual);
}

BOOST_AUTO_TEST_CASE(a_joint_problem_with_known_answer_is_solved) {
  // a point mass m at distance r of a z axis, a motor with inertia J behind a gear n, torque tau:
  // (m r^2 + I + n^2 J) qdd = tau
  const Outcome outcome = exact([](Point& at) {
    const T m = at.number(), r = at.number(), I = at.number();
    JointProblem<T> problem;
    problem.M_2 = massMatrix6<T>(m, Vector3<T>(m * r, T(0), T(0)),
                                 Matrix3<T>(Matrix3<T>::Identity() * (I + m * r * r)));
    problem.Z = Vector6<T>::Zero();
    problem.Z(5) = T(1);
    problem.gear = at.number();
    problem.rotor = at.number();
    problem.tau = at.number();
    const auto solution = solveJoint(problem);
    at.equal("tau", (m * r * r + I + problem.gear * problem.gear * problem.rotor) * solution.qdd,
             problem.tau);
    at.equal("tangential force", solution.transmitted(1), m * r * solution.qdd);
  })("joint", 1);
  BOOST_TEST(outcome.zero, outcome.residual);
}

// ---- read by programs and people ---------------------------------------------------------------

BOOST_AUTO_TEST_CASE(json_says_what_the_entries_say) {
  const auto json = nlohmann::json::parse(crosscheck::auditJson(wholeAudit(), {}));
  BOOST_REQUIRE(json["entries"].size() == wholeAudit().entries.size());
  BOOST_TEST(json["sound"].get<bool>());
  for (const auto& e : json["entries"]) {
    const Entry& computed = entry(e["id"].get<std::string>());
    if (computed.holds == Holds::kUnderCondition)
      BOOST_TEST(e["holds"].get<std::string>() == "under condition");
    else
      BOOST_TEST(e["holds"].get<bool>() == (computed.holds == Holds::kTrue));
    BOOST_TEST(e["corrected"].is_null() == computed.corrected.empty());
    BOOST_TEST(e["printed"].get<std::string>().find('`') == std::string::npos);
  }
}

BOOST_AUTO_TEST_CASE(the_readme_says_what_the_audit_finds) {
  std::map<Holds, int> count;
  for (const Entry& e : wholeAudit().entries)
    if (e.isEquation()) ++count[e.holds];
  std::ifstream file(std::string(DYNWITNESS_SOURCE_DIR) + "/README.md");
  std::string readme(std::istreambuf_iterator<char>(file), {});
  std::replace(readme.begin(), readme.end(), '\n', ' ');
  const std::string expected = "Of its " + std::to_string(kEquations) + " numbered equations " +
                               std::to_string(count[Holds::kTrue]) + " hold, " +
                               std::to_string(count[Holds::kUnderCondition]) +
                               " hold under a condition and " +
                               std::to_string(count[Holds::kFalse]) + " are wrong";
  BOOST_TEST(readme.find(expected) != std::string::npos, expected);
}

BOOST_AUTO_TEST_CASE(formulas_are_set_as_they_are_meant) {
  using crosscheck::mathMl;
  const auto has = [](const std::string& text, const std::string& part) {
    BOOST_TEST(text.find(part) != std::string::npos, text << " lacks " << part);
  };
  has(mathMl("M_2 Z"), "<msub><mi>M</mi><mrow><mn>2</mn></mrow></msub>");
  has(mathMl("Z' M"), "<msup><mi>Z</mi><mi mathvariant=\"normal\">T</mi></msup>");
  has(mathMl("r x x"), "<mi>r</mi><mo>×</mo><mi>x</mi>");
  has(mathMl("x' M x"), "<mi>x</mi></mrow></math>");
  has(mathMl("qdd"), "<mover accent=\"true\"><mi>q</mi><mo>¨</mo></mover>");
  has(mathMl("D^-1"), "<msup><mi>D</mi><mrow><mo>−</mo><mn>1</mn></mrow></msup>");
  has(mathMl("T_F_12"), "<msubsup><mi>T</mi><mrow><mn>12</mn></mrow><mi>F</mi></msubsup>");
  has(mathMl("P_(i+1)"), "<msub><mi>P</mi><mrow><mi>i</mi><mo>+</mo><mn>1</mn></mrow></msub>");
  has(mathMl("Jd"), "<mover accent=\"true\"><mi>J</mi><mo>˙</mo></mover>");
  has(mathMl("Jbar"), "<mover accent=\"true\"><mi>J</mi><mo>¯</mo></mover>");
  has(mathMl("d2L/dt2"), "<mrow><msup><mi>d</mi><mn>2</mn></msup><mi>L</mi></mrow>");
  has(mathMl("d2L/dt2"), "<msup><mi>t</mi><mn>2</mn></msup>");
  has(mathMl("Gamma^i_jk"),
      "<msubsup><mi>Γ</mi><mrow><mi>j</mi><mi>k</mi></mrow><mi>i</mi></msubsup>");
  has(mathMl("(P M)_ij"), "</mrow><mrow><mi>i</mi><mi>j</mi></mrow></msub>");
  has(mathMl("hat(r_12)"), "<msub><mover accent=\"true\"><mi>r</mi><mo>^</mo></mover>");
  has(mathMl("hat(r)"), "<mrow><mover accent=\"true\"><mi>r</mi><mo>^</mo></mover></mrow>");
  has(mathMl("[1, 0; A, 1]"), "<mtr><mtd><mrow><mi>A</mi></mrow></mtd><mtd>");
  has(mathMl("a < b"), "<mo>&lt;</mo>");
  has(crosscheck::textWithMath("a & `b`"), "a &amp; <math");
  // whatever is written, tags close: the browser test reads every formula of the page
  for (const char* text : {"(", ")", "[", "a^", "hat(", "x_", "'", "[a, (b; c"})
    has(mathMl(text), "</math>");
}
