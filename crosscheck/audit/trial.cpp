// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/trial.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace dynwitness::audit {
namespace {

constexpr double kErrorProbability = 1e-30;
constexpr int kMostDiscarded = 20;

std::string pointsText(int points) {
  return fmt::format("{} point{}", points, points == 1 ? "" : "s");
}

/// "moment (entry 2 of 3)" for each comparison that is not zero, "" when all are.
std::string whatDiffers(const std::vector<Difference<PrimeField>>& differences) {
  std::string text;
  for (const auto& difference : differences) {
    const auto& entries = difference.entries;
    const auto first =
        std::find_if(entries.begin(), entries.end(), [](PrimeField x) { return !x.isZero(); });
    if (first == entries.end()) continue;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", difference.what);
    if (entries.size() > 1)
      text +=
          fmt::format(" (first at entry {} of {})", first - entries.begin() + 1, entries.size());
  }
  return text;
}

Outcome runExact(const ExactStatement& statement, const std::string& name, std::uint64_t seed) {
  Outcome outcome;
  outcome.method = "prime field";
  // how large the formulas are, and with that how many points it takes
  double chance = 0;
  std::size_t entries = 0;
  {
    const crosscheck::FormulaSizes sizes;
    Point point(FieldSource(name, seed, 0));
    statement(point);
    for (const auto& difference : point.differences()) {
      entries += difference.entries.size();
      outcome.our_code |= difference.what.compare(0, 8, "our code") == 0;
      for (const PrimeField& entry : difference.entries)
        chance = std::max(chance, errorProbability(entry, sizes));
    }
  }
  if (entries == 0) throw std::logic_error(name + ": the statement compares nothing");
  if (!(chance < 1)) throw std::logic_error(name + ": the formulas are too large for the field");
  const int needed = chance > 0 ? crosscheck::pointsNeeded(chance, kErrorProbability) : 1;

  int discarded = 0;
  for (std::uint64_t index = 0; outcome.points < needed; ++index) {
    const PrimeField::Modulus modulus(crosscheck::drawPrime(name, seed, index));
    Point point(FieldSource(name, seed, index));
    try {
      statement(point);
    } catch (const crosscheck::DivisionByZero&) {
      if (++discarded < kMostDiscarded) continue;
      outcome.residual = fmt::format("no value: a divisor is 0 at all of {} points", discarded);
      return outcome;
    }
    ++outcome.points;
    if (const std::string differs = whatDiffers(point.differences()); !differs.empty()) {
      outcome.residual = "not 0: " + differs;
      return outcome;
    }
  }
  outcome.zero = true;
  outcome.chance = std::pow(chance, outcome.points);
  outcome.residual = chance > 0 ? fmt::format("0 at {} modulo p, chance of error <= {:.0e}",
                                              pointsText(outcome.points), outcome.chance)
                                : "0 before any number is put in";
  return outcome;
}

Outcome opposite(Outcome outcome) {
  if (!outcome.zero && outcome.points == 0) return outcome;  // no value at all shows no difference
  outcome.zero = !outcome.zero;
  outcome.residual =
      outcome.zero ? "differs, as said: " + outcome.residual : "no difference: " + outcome.residual;
  if (outcome.zero) outcome.method = "counterexample";
  return outcome;
}

}  // namespace

Trial exact(ExactStatement statement) {
  return [statement = std::move(statement)](const std::string& name, std::uint64_t seed) {
    return runExact(statement, name, seed);
  };
}

Trial differs(ExactStatement statement) {
  return [same = exact(std::move(statement))](const std::string& name, std::uint64_t seed) {
    return opposite(same(name, seed));
  };
}

Trial both(Trial first, Trial second) {
  return [first = std::move(first), second = std::move(second)](const std::string& name,
                                                                std::uint64_t seed) {
    const Outcome a = first(name, seed);
    if (!a.zero) return a;
    Outcome b = second(name, seed);
    if (b.method != a.method) b.method = a.method + ", " + b.method;
    b.chance += a.chance;
    b.our_code |= a.our_code;
    if (b.zero) b.residual = a.residual + "; " + b.residual;
    return b;
  };
}

Trial certified(std::function<void(RealPoint&)> statement, int points) {
  return [statement = std::move(statement), points](const std::string& name, std::uint64_t seed) {
    constexpr long kMostBits = 2048;
    Outcome outcome;
    outcome.method = "certified digits";
    double least = HUGE_VAL;
    for (int index = 0; index < points; ++index) {
      for (long bits = 128;; bits *= 2) {
        const crosscheck::BallPrecision precision(bits);
        RealPoint point(name, seed, static_cast<std::uint64_t>(index));
        statement(point);
        if (point.claims().empty()) throw std::logic_error(name + ": the statement claims nothing");
        const auto unsharp =
            std::find_if(point.claims().begin(), point.claims().end(), [](auto& c) {
              return !c.second.isFinite() || (c.second.containsZero() && !c.second.isZero());
            });
        if (unsharp != point.claims().end()) {
          if (bits < kMostBits) continue;
          throw std::logic_error(name + ": " + unsharp->first + ": sign not decided at " +
                                 std::to_string(bits) + " bits");
        }
        ++outcome.points;
        for (const auto& [what, value] : point.claims()) {
          if (!value.isZero() && value.mid() > 0) {
            least = std::min(least, value.atLeast());
            continue;
          }
          outcome.residual = fmt::format("{} is {} at point {}", what,
                                         value.isZero() ? "0" : value.text(4), index + 1);
          return outcome;
        }
        break;
      }
    }
    outcome.zero = true;
    outcome.residual =
        fmt::format("positive at {}, certified; the least is {:.2g}", pointsText(points), least);
    return outcome;
  };
}

Trial decided(std::string method, std::function<Decision()> compute) {
  return [method = std::move(method), compute = std::move(compute)](const std::string&,
                                                                    std::uint64_t) {
    const Decision decision = compute();
    return Outcome{decision.holds, 1, 0, method, decision.found};
  };
}

}  // namespace dynwitness::audit
