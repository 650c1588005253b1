// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/merge.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <set>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/campaign/shard.hpp"
#include "crosscheck/exact/exact.hpp"
#include "crosscheck/report/pairs.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/growing_file.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using scene::InputError;

std::string atLine(const fs::path& file, long line) {
  return fmt::format("{}:{}", file.string(), line);
}

/// Of the entries of one case, which follow each other, the one that counts.
const LedgerEntry& countingOf(const LedgerEntry* begin, const LedgerEntry* end,
                              const std::vector<ShardLedger>& ledgers) {
  const LedgerEntry* best = begin;
  for (const LedgerEntry* one = begin + 1; one != end; ++one) {
    if (!one->has_failed && !best->has_failed && one->hash != best->hash)
      throw InputError(
          {ledgers[static_cast<std::size_t>(one->file)].file.string(), 0},
          fmt::format("case {} has another record than in {}: what a case comes to must not depend "
                      "on who runs it",
                      one->number, ledgers[static_cast<std::size_t>(best->file)].file.string()));
    if (std::tuple(one->has_failed, one->hash) < std::tuple(best->has_failed, best->hash))
      best = one;
  }
  return *best;
}

void nameDamaged(const ShardLedger& ledger, std::vector<std::string>* left_out) {
  for (const long line : ledger.damaged)
    left_out->push_back(
        fmt::format("{}: {}", atLine(ledger.file, line),
                    ledger.ends_in_a_line || line != ledger.damaged.back()
                        ? "the line is damaged: its seal does not fit"
                        : "the line has no end: its process was ended, or is at it"));
}

void findMissing(GatheredLedgers* out) {
  long next = 0;
  const auto gap = [&](long end) {  // cases next .. end - 1
    if (end <= next) return;
    out->missing.push_back(end == next + 1 ? fmt::format("{}", next)
                                           : fmt::format("{}-{}", next, end - 1));
    out->missing_cases += end - next;
  };
  for (const LedgerEntry& entry : out->entries) {
    gap(entry.number);
    next = entry.number + 1;
  }
  gap(out->head.cases);
}

/// Reads records where they stand, with few files open at a time.
class Records {
 public:
  explicit Records(const GatheredLedgers& gathered) : gathered_(gathered) {
    streams_.resize(gathered.ledgers.size());
  }
  std::string operator()(const LedgerEntry& entry) {
    std::unique_ptr<std::ifstream>& stream = streams_[static_cast<std::size_t>(entry.file)];
    const fs::path& file = gathered_.ledgers[static_cast<std::size_t>(entry.file)].file;
    if (!stream) {
      if (++open_ > kMostOpen) {
        for (auto& other : streams_) other.reset();
        open_ = 1;
      }
      stream = std::make_unique<std::ifstream>(file, std::ios::binary);
    }
    std::string text(entry.size, '\0');
    stream->seekg(static_cast<std::streamoff>(entry.offset));
    if (!stream->read(text.data(), static_cast<std::streamsize>(text.size())))
      throw std::runtime_error(fmt::format("{}: cannot be read again", file.string()));
    return text;
  }

 private:
  static constexpr int kMostOpen = 200;
  const GatheredLedgers& gathered_;
  std::vector<std::unique_ptr<std::ifstream>> streams_;
  int open_ = 0;
};

/// What stands in a record as a bit each, four a digit.
std::vector<int> bitsOfHex(const std::string& digits) {
  std::vector<int> set;
  for (int k = 0; k < 4 * static_cast<int>(digits.size()); ++k) {
    const char digit = digits[static_cast<std::size_t>(k) / 4];
    const int value = digit <= '9' ? digit - '0' : digit - 'a' + 10;
    if ((value & (8 >> (k % 4))) != 0) set.push_back(k);
  }
  return set;
}

/// By pair: its two features.
std::vector<std::pair<std::string, std::string>> featuresOfPairs() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const PairRelation relation : kAllPairRelations)
    for (const char* row : PairTable::rows(relation))
      for (const char* column : PairTable::columns(relation)) out.emplace_back(row, column);
  return out;
}

/// Features of a mechanism.
std::set<std::string> termsOf(const std::vector<int>& pairs) {
  static const auto kFeatures = featuresOfPairs();
  std::set<std::string> terms;
  for (const int pair : pairs) {
    terms.insert(kFeatures[static_cast<std::size_t>(pair)].first);
    terms.insert(kFeatures[static_cast<std::size_t>(pair)].second);
  }
  return terms;
}

void addMechanism(const Json& record, CampaignSum* sum) {
  const bool agrees = record.at("verdict") == "agree";
  ++sum->mechanisms;
  sum->mechanisms_that_agree += agrees ? 1 : 0;
  const long exact = record.at("exact").get<long>();
  sum->exact_checks += exact;
  sum->not_answerable += record.at("not_answerable").get<long>();
  sum->comparisons += record.at("comparisons").get<long>();
  sum->chance += static_cast<double>(exact) * record.at("chance").get<double>();
  CampaignCoverage& met = sum->coverage;
  for (const auto& [kind, count] : record.at("kinds").items()) met.kinds[kind] += count.get<long>();
  ++met.rates[record.at("rates").get<int>()];
  ++met.depths[record.at("depth").get<int>()];
  ++met.branches[record.at("branches").get<int>()];
  const std::vector<int> pairs = bitsOfHex(record.at("pairs").get<std::string>());
  met.pairs.add(record.at("name").get<std::string>(), pairs);
  if (agrees)
    for (const std::string& term : termsOf(pairs)) ++met.terms[term];
  const std::vector<std::string>& names = exactCheckNames();
  for (const std::string& name : names) met.laws[name];  // with zeros
  std::size_t k = 0;
  for (const char* how : {"decided", "idle", "not_answerable"}) {
    for (const int law : bitsOfHex(record.at("laws").at(how).get<std::string>()))
      ++met.laws[names.at(static_cast<std::size_t>(law))][k];
    ++k;
  }
}

void addRecord(const std::string& text, CampaignSum* sum) {
  const Json record = Json::parse(text);
  const auto verdict = record.at("verdict").get<std::string>(),
             of = record.at("of").get<std::string>();
  ++sum->cases;
  ++sum->verdicts[verdict];
  ++sum->of[of][verdict];
  if (of == "mechanisms" && record.contains("pairs")) addMechanism(record, sum);
  if (of == "scenes" && record.contains("exact"))
    sum->exact_checks += record.at("exact").get<long>();
  if (!record.contains("cause")) return;
  CampaignSum::Cause& cause = sum->causes[record.at("cause").get<std::string>()];
  if (cause.cases++ == 0) {
    cause.first = record.at("case").get<long>();
    cause.record = text;
  }
}

template <typename Counts>
Json listOf(const Counts& counts, const char* what) {
  Json out = Json::array();
  for (const auto& [key, count] : counts) out.push_back({{what, key}, {"count", count}});
  return out;
}

const char* verdictOf(const GatheredLedgers& gathered, const CampaignSum& sum) {
  return !sum.isRight() ? "disagree" : gathered.missing_cases > 0 ? "incomplete" : "agree";
}

std::string indented(const std::string& text) {
  std::string out = "  ";
  for (const char c : text) out += c == '\n' ? std::string("\n  ") : std::string(1, c);
  return out;
}

std::string smallStateText(const Json& state) {
  const auto row = [&](const char* name) {
    std::vector<std::string> entries;
    for (const Json& entry : state.at(name))
      entries.push_back(entry.is_string() ? entry.get<std::string>() : entry.dump());
    return fmt::format("{} = [{}]", name, fmt::join(entries, ", "));
  };
  return fmt::format("  at {}, {}, {}, {}\n", row("q"), row("qd"), row("qdd"), row("tau"));
}

}  // namespace

double GatheredLedgers::seconds() const {
  double all = 0;
  for (const LedgerEntry& entry : entries) all += entry.seconds;
  return all;
}

GatheredLedgers gatherLedgers(const std::vector<fs::path>& folders) {
  GatheredLedgers out;
  out.head.version = campaignVersion();
  std::vector<LedgerEntry> all;
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder))
      throw InputError({folder.string(), 0}, "is no folder, allowed: folders of shards");
    const std::vector<fs::path> files = ledgersIn(folder);
    if (files.empty())
      throw InputError({folder.string(), 0},
                       "has no shard-I-of-N.jsonl, allowed: folders that `campaign` has written");
    for (const fs::path& file : files) {
      const std::size_t before = all.size();
      const ShardLedger ledger = readShardLedger(
          file, static_cast<int>(out.ledgers.size()),
          [&](const LedgerEntry& entry, std::string_view) { all.push_back(entry); });
      nameDamaged(ledger, &out.left_out);
      if (!ledger.has_head || ledger.head.version != out.head.version) {
        all.resize(before);
        out.left_out.push_back(
            ledger.has_head
                ? fmt::format("{}: {} cases by version {}, this is {}", file.string(),
                              ledger.entries, ledger.head.version, out.head.version)
                : fmt::format("{}: its first line is missing or damaged, so that nobody knows "
                              "which campaign it is of",
                              file.string()));
        continue;
      }
      if (!out.ledgers.empty() && ledger.head.plan != out.head.plan)
        throw InputError(
            {file.string(), 0},
            fmt::format("is of another plan than {}: read '{}', allowed: '{}'",
                        out.ledgers.front().file.string(), ledger.head.plan, out.head.plan));
      out.head = ledger.head;
      out.ledgers.push_back(ledger);
    }
  }
  if (out.ledgers.empty())
    throw InputError({folders.front().string(), 0},
                     fmt::format("no ledger that counts: {}", fmt::join(out.left_out, "; ")));
  std::sort(all.begin(), all.end(), [](const LedgerEntry& a, const LedgerEntry& b) {
    return std::tuple(a.number, a.file, a.offset) < std::tuple(b.number, b.file, b.offset);
  });
  for (std::size_t i = 0; i < all.size();) {
    std::size_t end = i + 1;
    while (end < all.size() && all[end].number == all[i].number) ++end;
    if (all[i].number >= 0 && all[i].number < out.head.cases)
      out.entries.push_back(countingOf(&all[i], all.data() + end, out.ledgers));
    out.twice += end - i > 1 ? 1 : 0;
    i = end;
  }
  findMissing(&out);
  return out;
}

double shareAtMostOf(long agreeing) {
  return agreeing == 0 ? 1 : -std::expm1(std::log(0.05) / static_cast<double>(agreeing));
}

double CampaignSum::shareAtMost() const {
  return mechanisms_that_agree < mechanisms ? 1 : shareAtMostOf(mechanisms);
}

bool CampaignSum::isRight() const {
  return std::all_of(verdicts.begin(), verdicts.end(),
                     [](const auto& one) { return crosscheck::isRight(one.first); });
}

CampaignSum writeMerged(const GatheredLedgers& gathered, const fs::path& folder) {
  fs::create_directories(folder);
  CampaignSum sum;
  Records recordAt(gathered);
  GrowingFile cases(folder / "cases.jsonl");
  LedgerHead head = gathered.head;
  head.shard = head.shards = 1;
  cases.write(sealedLine(head.text(), "{}"));
  for (const LedgerEntry& entry : gathered.entries) {
    const std::string record = recordAt(entry);
    addRecord(record, &sum);
    cases.write(sealedLine(record, "{}"));
  }
  writeWholeFile(folder / "campaign.json", campaignSumJson(gathered, sum));
  cases.finish();
  return sum;
}

std::string campaignSumJson(const GatheredLedgers& gathered, const CampaignSum& sum) {
  const CampaignCoverage& met = sum.coverage;
  Json json{{"dynwitness", DYNWITNESS_VERSION},
            {"command", "campaign merge"},
            {"version", gathered.head.version},
            {"plan", gathered.head.plan},
            {"verdict", verdictOf(gathered, sum)},
            {"cases", gathered.head.cases},
            {"missing_cases", gathered.missing_cases},
            {"missing", gathered.missing},
            {"verdicts", Json::array()},
            {"exact_checks", sum.exact_checks},
            {"exact_not_answerable", sum.not_answerable},
            {"comparisons_in_double", sum.comparisons},
            {"chance_that_a_wrong_formula_passed", sum.chance},
            {"mechanisms", sum.mechanisms},
            {"share_at_most", sum.shareAtMost()}};
  for (const auto& [of, verdicts] : sum.of)
    for (const auto& [verdict, count] : verdicts)
      json["verdicts"].push_back({{"of", of}, {"verdict", verdict}, {"count", count}});
  json["coverage"] = {{"kinds", listOf(met.kinds, "kind")},
                      {"rates", listOf(met.rates, "rates")},
                      {"depths", listOf(met.depths, "depth")},
                      {"branches", listOf(met.branches, "branch")},
                      {"pairs", Json::parse(pairsJson(met.pairs))},
                      {"terms", Json::array()},
                      {"laws", Json::array()}};
  for (const auto& [term, count] : met.terms)
    json["coverage"]["terms"].push_back(
        {{"term", term}, {"mechanisms", count}, {"share_at_most", shareAtMostOf(count)}});
  for (const auto& [law, counts] : met.laws)
    json["coverage"]["laws"].push_back(
        {{"law", law}, {"decided", counts[0]}, {"idle", counts[1]}, {"not_answerable", counts[2]}});
  json["causes"] = Json::array();
  for (const auto& [text, cause] : sum.causes)
    json["causes"].push_back({{"cause", text},
                              {"cases", cause.cases},
                              {"first", cause.first},
                              {"record", Json::parse(cause.record)}});
  return json.dump(2) + "\n";
}

std::string describeSum(const GatheredLedgers& gathered, const CampaignSum& sum) {
  std::string text = fmt::format("{} of {} cases", sum.cases, gathered.head.cases);
  for (const auto& [of, verdicts] : sum.of) {
    text += fmt::format("; {}:", of);
    for (const auto& [verdict, count] : verdicts) text += fmt::format(" {} {}", count, verdict);
  }
  text += fmt::format("\n{} exact checks; chance that a wrong formula passed any at most {:.1g}\n",
                      sum.exact_checks, sum.chance);
  if (sum.comparisons > 0) text += fmt::format("{} comparisons in double\n", sum.comparisons);
  if (sum.mechanisms > 0) {
    const CampaignCoverage& met = sum.coverage;
    text += "joints by kind:";
    for (const auto& [kind, count] : met.kinds) text += fmt::format(" {} {}", kind, count);
    text += "\nmechanisms by rates:";
    for (const auto& [rates, count] : met.rates) text += fmt::format(" {}: {}", rates, count);
    text += "\nby depth:";
    for (const auto& [depth, count] : met.depths) text += fmt::format(" {}: {}", depth, count);
    text += "\nby most joints on one link:";
    for (const auto& [most, count] : met.branches) text += fmt::format(" {}: {}", most, count);
    int wanted = 0, covered = 0;
    for (const PairRelation relation : kAllPairRelations)
      wanted += met.pairs.wanted(relation), covered += met.pairs.covered(relation);
    text += fmt::format("\npairs of features that occurred: {} of {} wanted\n", covered, wanted);
    text +=
        "mechanisms that agree by what they have, and the share of such mechanisms whose formulas "
        "differ, at most (95 %):\n";
    for (const auto& [term, count] : met.terms)
      text += fmt::format("  {:34} {:7}  {:.1e}\n", term, count, shareAtMostOf(count));
    text +=
        "mechanisms by exact check: where it was decided, had nothing to ask, was not "
        "answerable:\n";
    for (const auto& [law, counts] : met.laws)
      text += fmt::format("  {:42} {:7} {:7} {:7}\n", law, counts[0], counts[1], counts[2]);
    if (sum.shareAtMost() < 1)
      text += fmt::format(
          "of all mechanisms that are drawn like these at most {:.2g} have formulas that differ, "
          "with 95 % confidence\n",
          sum.shareAtMost());
  }
  for (const auto& [name, cause] : sum.causes) {
    const Json record = Json::parse(cause.record);
    text += fmt::format("\n{}: {} case{}, the first is {}\n", name, cause.cases,
                        cause.cases == 1 ? "" : "s", cause.first);
    if (record.contains("small")) {
      const Json& small = record.at("small");
      text += "  the smallest scene that shows it:\n" +
              indented(small.at("scene").get<std::string>()) + "\n";
      if (small.contains("state")) text += smallStateText(small.at("state"));
    } else if (record.contains("failure")) {
      text += indented(record.at("failure").get<std::string>()) + "\n";
    }
  }
  for (const std::string& one : gathered.left_out) text += fmt::format("left out: {}\n", one);
  if (gathered.twice > 0)
    text += fmt::format("{} cases stand there more than once, and count once\n", gathered.twice);
  if (gathered.missing_cases > 0) {
    constexpr std::size_t kShown = 10;
    std::vector<std::string> shown(
        gathered.missing.begin(), gathered.missing.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                 kShown, gathered.missing.size())));
    if (gathered.missing.size() > kShown) shown.emplace_back("...");
    text += fmt::format("INCOMPLETE: {} cases are missing: {}\n", gathered.missing_cases,
                        fmt::join(shown, ", "));
  }
  return text;
}

}  // namespace dynwitness::crosscheck
