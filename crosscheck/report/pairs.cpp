// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/pairs.hpp"

#include <nlohmann/json.hpp>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"

namespace dynwitness::crosscheck {
namespace {

/// "rotor; prismatic: 4 mechanisms, first cart_pole"
std::string told(const PairTable& pairs, PairRelation relation, std::size_t row,
                 std::size_t column) {
  const PairTable::Cell& cell = pairs.at(relation, row, column);
  const std::string pair =
      fmt::format("{}; {}", PairTable::rows(relation)[row], PairTable::columns(relation)[column]);
  if (cell.mechanisms == 0) return pair + ": in none";
  return fmt::format("{}: {}, first {}", pair, plural(cell.mechanisms, "mechanism"), cell.first);
}

void putCell(std::string* page, const PairTable& pairs, PairRelation relation, std::size_t row,
             std::size_t column) {
  const PairNeed need = PairTable::need(relation, row, column);
  const int count = pairs.at(relation, row, column).mechanisms;
  const bool is_missing = need == PairNeed::kWanted && count == 0;
  if (need == PairNeed::kCannotOccur)
    put(page, "<td class=\"n never\"></td>");
  else
    put(page, "<td class=\"n{}\" title=\"{}\">{}</td>", is_missing ? " missing" : "",
        esc(told(pairs, relation, row, column)),
        count > 0    ? std::to_string(count)
        : is_missing ? "✗"
                     : "–");
}

void putRelation(std::string* page, const PairTable& pairs, PairRelation relation) {
  const int covered = pairs.covered(relation), wanted = pairs.wanted(relation);
  put(page, "<details{}><summary>{} {}: {} of {}</summary>\n", covered < wanted ? " open" : "",
      badge(covered < wanted ? Verdict::kDisagree : Verdict::kAgree,
            covered < wanted ? fmt::format("{} missing", wanted - covered) : "all"),
      esc(name(relation)), covered, wanted);
  openScroll(page, fmt::format("Pairs {}", name(relation)));
  put(page, "<table class=\"pairs\"><thead><tr><th></th>");
  const auto& columns = PairTable::columns(relation);
  for (const char* column : columns)
    put(page, "<th scope=\"col\"><span>{}</span></th>", esc(column));
  put(page, "</tr></thead>\n<tbody>\n");
  for (std::size_t row = 0; row < PairTable::rows(relation).size(); ++row) {
    put(page, "<tr><th scope=\"row\">{}</th>", esc(PairTable::rows(relation)[row]));
    for (std::size_t column = 0; column < columns.size(); ++column)
      putCell(page, pairs, relation, row, column);
    put(page, "</tr>\n");
  }
  put(page, "</tbody></table></div></details>\n");
}

}  // namespace

std::string pairsSection(const PairTable& pairs) {
  std::string page;
  put(&page,
      "<section aria-labelledby=\"pairs\">\n<h2 id=\"pairs\">Pairs of features</h2>\n<p>In how many "
      "of the {} scenes each pair is. A fault that only a missing pair (<span "
      "class=\"missing\">✗</span>) shows passes this run; random mechanisms that have every "
      "pair between them are checked by <code>dynwitness crosscheck --pairs</code>, which is a "
      "test. – is in none, and is not drawn at random either; what is empty cannot occur.</p>\n",
      pairs.mechanisms());
  for (const PairRelation relation : kAllPairRelations) putRelation(&page, pairs, relation);
  put(&page, "</section>\n");
  return page;
}

std::string pairsJson(const PairTable& pairs) {
  using Json = nlohmann::ordered_json;
  Json json{
      {"mechanisms", pairs.mechanisms()}, {"missing", Json::array()}, {"relations", Json::array()}};
  for (const PairTable::Pair& pair : pairs.missing())
    json["missing"].push_back({name(pair.relation), pair.row, pair.column});
  for (const PairRelation relation : kAllPairRelations) {
    Json one{{"relation", name(relation)},
             {"wanted", pairs.wanted(relation)},
             {"covered", pairs.covered(relation)},
             {"pairs", Json::array()}};
    for (std::size_t row = 0; row < PairTable::rows(relation).size(); ++row)
      for (std::size_t column = 0; column < PairTable::columns(relation).size(); ++column) {
        const PairTable::Cell& cell = pairs.at(relation, row, column);
        if (cell.mechanisms == 0) continue;
        one["pairs"].push_back(
            {{"features", {PairTable::rows(relation)[row], PairTable::columns(relation)[column]}},
             {"mechanisms", cell.mechanisms},
             {"first", cell.first}});
      }
    json["relations"].push_back(one);
  }
  return json.dump();
}

}  // namespace dynwitness::crosscheck
