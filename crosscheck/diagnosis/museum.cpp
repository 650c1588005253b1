// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/museum.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/diagnosis/check_report.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/system/shell.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/nearest_name.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"
#include "scene/text_tables.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using scene::InputError;

constexpr const char* kEngine = "stranger.py";
/// Of an answer: the machine may have a lot else to do.
constexpr double kSeconds = 120;

/// Kinds in the order of the table, and their titles.
const std::vector<std::pair<std::string, std::string>>& kinds() {
  static const std::vector<std::pair<std::string, std::string>> all = {
      {"reader", "readers: what a file says is not what arrives"},
      {"dynamics", "dynamics: what arrives is not what is computed"}};
  return all;
}

const std::string& oneOf(const scene::Text& text, const std::string& what,
                         const std::vector<std::string>& allowed) {
  if (std::count(allowed.begin(), allowed.end(), text.words) == 0)
    throw InputError(text.where, fmt::format("{}: \"{}\", allowed: {}", what, text.words,
                                             fmt::join(allowed, ", ")));
  return text.words;
}

MuseumPiece pieceOf(const scene::TextTable& table) {
  const auto& text = table.texts;
  MuseumPiece out;
  out.where = table.where;
  out.id = text.at("id").words;
  out.tool = text.at("tool").words;
  out.link = text.at("link").words;
  out.what = text.at("what").words;
  out.plant = text.at("plant").words;
  out.scene = text.at("scene").words;
  std::vector<std::string> allowed;
  for (const auto& [name, title] : kinds()) allowed.push_back(name);
  out.kind = oneOf(text.at("kind"), "exhibit: kind", allowed);
  out.fidelity = oneOf(text.at("fidelity"), "exhibit: fidelity", {"same", "nearest"});
  const scene::Text& year = text.at("year");
  if (year.words.size() != 4 || !std::all_of(year.words.begin(), year.words.end(),
                                             [](unsigned char c) { return std::isdigit(c) != 0; }))
    throw InputError(year.where, "exhibit: year: \"" + year.words + "\", allowed: four digits");
  out.year = std::stoi(year.words);
  if (out.link.rfind("https://", 0) != 0)
    throw InputError(text.at("link").where,
                     "exhibit: link: \"" + out.link + "\", allowed: what begins with https://");
  const auto named = table.lists.find("named");
  if (named == table.lists.end() || named->second.empty())
    throw InputError(table.where, "exhibit \"" + out.id +
                                      "\": has no `named`, allowed: the rules that `check` may "
                                      "name first, [\"com_dropped:link_4\"]");
  out.named = named->second;
  return out;
}

/// "rule:link", or "rule" where it is everywhere; of a pair both.
std::string nameOf(const Examination& e, const CheckFinding& finding) {
  std::string out;
  for (const Explanation& part : finding.parts) {
    out += (out.empty() ? "" : " + ") + part.rule;
    if (part.link >= 0)
      out +=
          ":" + (part.at_joint ? e.joint_names : e.link_names)[static_cast<std::size_t>(part.link)];
  }
  return out;
}

/// The engine with something planted, or nothing, on a scene.
PieceFound examined(const fs::path& engine, const scene::Scene& scene, const std::string& plant,
                    const std::vector<std::string>& named) {
  PieceFound out;
  out.scene = scene.name;
  out.plant = plant;
  std::string command = "python3 " + shellWord(engine.string());
  if (!plant.empty()) command += " --mistake " + shellWord(plant);
  Limits limits;
  limits.seconds = kSeconds;
  CheckOptions options;
  options.smallest = false;  // whoever has to look for it is not named
  Examination e;
  try {
    e = examine(scene, engineKinds({command}, limits, scene).front(), options);
  } catch (const InputError& refused) {
    out.failure = refused.what();
    return out;
  }
  out.failure = e.failure;
  out.text = checkText(e);
  if (!e.failure.empty()) return out;
  out.caught = e.isWrong();
  for (const CheckFinding& finding : e.findings) {
    if (!finding.explains) continue;
    ++out.findings;
    if (out.rank == 0 && std::count(named.begin(), named.end(), nameOf(e, finding)) > 0)
      out.rank = out.findings;
  }
  if (e.isExplained()) {
    out.named_as = nameOf(e, e.findings.front());
    out.sentence = sentenceOf(e.findings.front());
  }
  return out;
}

/// What comes back from another process.
std::string archived(const PieceFound& x) {
  return Json{x.scene,    x.plant,    x.caught,  x.rank, x.findings,
              x.named_as, x.sentence, x.failure, x.text}
      .dump(-1, ' ', true, Json::error_handler_t::replace);
}
PieceFound pieceFoundOf(const std::string& bytes) {
  const Json x = Json::parse(bytes);
  return {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]};
}

std::string verdictOf(const PieceFound& x) {
  if (!x.failure.empty()) return "FAILED: " + x.failure;
  if (!x.caught) return "NOT CAUGHT";
  if (x.rank == 1) return "named";
  if (x.rank > 1) return fmt::format("NAMED ONLY AS NUMBER {}", x.rank);
  return "NOT NAMED";
}

std::string as(const VerdictShown& shown, const std::string& verdict) {
  return shown ? shown(verdict) : verdict;
}

/// "1/3": the first of three that answer the same.
std::string rankOf(const PieceFound& x) {
  return x.rank == 0 ? "-" : fmt::format("{}/{}", x.rank, x.findings);
}

std::string summaryOf(const MuseumFound& all) {
  std::size_t caught = 0, named = 0, right = 0;
  for (std::size_t i = 0; i < all.found.size(); ++i) {
    caught += all.found[i].caught ? 1 : 0;
    named += all.isNamed(i) ? 1 : 0;
  }
  for (const PieceFound& x : all.right) right += x.failure.empty() && !x.caught ? 1 : 0;
  std::string out = fmt::format(
      "{} exhibit{}: {} caught, {} named first; the same engine without a mistake is right on {} of {} scenes\n",
      all.found.size(), all.found.size() == 1 ? "" : "s", caught, named, right, all.right.size());
  for (const PieceFound& x : all.right)
    if (!x.failure.empty() || x.caught)
      out += fmt::format("{}: the engine without a mistake is blamed: {}\n", x.scene,
                         x.failure.empty() ? x.sentence : x.failure);
  return out;
}

}  // namespace

bool MuseumFound::holds() const {
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!isNamed(i)) return false;
  return std::all_of(right.begin(), right.end(),
                     [](const PieceFound& x) { return x.failure.empty() && !x.caught; });
}

Museum readMuseum(const std::string& text, const fs::path& file) {
  const auto tables = scene::readTextTables(
      text, file.string(),
      {{"exhibit",
        {{"id", "tool", "year", "kind", "link", "what", "plant", "scene", "fidelity"},
         {},
         {"named"},
         {}}}});
  Museum museum{file.parent_path(), {}};
  std::set<std::string> ids;
  const auto exhibits = tables.find("exhibit");
  if (exhibits == tables.end())
    throw InputError({file.string(), 0}, "no exhibit, allowed: [[exhibit]], once or more");
  for (const scene::TextTable& table : exhibits->second) {
    museum.pieces.push_back(pieceOf(table));
    if (!ids.insert(museum.pieces.back().id).second)
      throw InputError(table.where, "exhibit \"" + museum.pieces.back().id +
                                        "\": a second one, allowed: each id once");
  }
  return museum;
}

Museum bundledMuseum() {
  const fs::path file = scene::dataFolder() / "museum" / "museum.toml";
  return readMuseum(scene::readTextFile(file, "the museum's list, a TOML file"), file);
}

std::vector<MuseumPiece> selectPieces(const Museum& museum, const std::vector<std::string>& ids) {
  if (ids.empty()) return museum.pieces;
  std::vector<std::string> known;
  for (const MuseumPiece& piece : museum.pieces) known.push_back(piece.id);
  std::vector<MuseumPiece> out;
  for (const std::string& id : ids) {
    const auto at = std::find(known.begin(), known.end(), id);
    if (at == known.end())
      throw InputError({}, fmt::format("no exhibit is called \"{}\"{}, allowed: one of the {} that "
                                       "`dynwitness museum` shows",
                                       id, scene::didYouMean(id, known), known.size()));
    if (std::none_of(out.begin(), out.end(), [&](const MuseumPiece& x) { return x.id == id; }))
      out.push_back(museum.pieces[static_cast<std::size_t>(at - known.begin())]);
  }
  return out;
}

MuseumFound walkThrough(const Museum& museum, const std::vector<MuseumPiece>& pieces,
                        const std::function<scene::Scene(const std::string& scene)>& prepare,
                        int processes) {
  MuseumFound out;
  out.pieces = pieces;
  std::map<std::string, scene::Scene> scenes;
  for (const MuseumPiece& piece : pieces) {
    if (scenes.count(piece.scene) > 0) continue;
    const fs::path own = museum.folder / (piece.scene + ".toml");
    try {
      scenes.emplace(piece.scene, prepare(fs::exists(own) ? own.string() : piece.scene));
    } catch (const InputError& refused) {
      throw InputError(piece.where, fmt::format("exhibit \"{}\": {}", piece.id, refused.what()));
    }
  }
  std::vector<const scene::Scene*> rooms;
  for (const auto& [name, scene] : scenes) rooms.push_back(&scene);
  const auto count = pieces.size();
  scene::Work work("examinations", static_cast<double>(count + rooms.size()));
  const fs::path engine = fs::absolute(museum.folder / kEngine);
  const std::vector<std::string> bytes = inProcesses(
      processes, static_cast<int>(count + rooms.size()),
      [&](int task) {
        const auto i = static_cast<std::size_t>(task);
        if (i >= count) return archived(examined(engine, *rooms[i - count], "", {}));
        return archived(
            examined(engine, scenes.at(pieces[i].scene), pieces[i].plant, pieces[i].named));
      },
      [&](int) { work.done(); });
  for (std::size_t i = 0; i < bytes.size(); ++i)
    (i < count ? out.found : out.right).push_back(pieceFoundOf(bytes[i]));
  return out;
}

std::string museumTable(const MuseumFound& all, const VerdictShown& shown) {
  std::string out;
  for (const auto& [kind, title] : kinds()) {
    std::vector<std::size_t> here;
    for (std::size_t i = 0; i < all.pieces.size(); ++i)
      if (all.pieces[i].kind == kind) here.push_back(i);
    if (here.empty()) continue;
    std::stable_sort(here.begin(), here.end(), [&](std::size_t a, std::size_t b) {
      return all.pieces[a].year < all.pieces[b].year;
    });
    out += fmt::format("{} ({})\n\n  {:<34} {:<34} {:<5} {:<7} {:<5} {}\n", title, here.size(),
                       "exhibit", "tool", "year", "caught", "rank", "named as");
    for (const std::size_t i : here) {
      const MuseumPiece& piece = all.pieces[i];
      const PieceFound& x = all.found[i];
      out += fmt::format("  {:<34} {:<34} {:<5} {} {:<5} {}\n      {}\n", piece.id, piece.tool,
                         piece.year, as(shown, x.caught ? "yes    " : "NO     "), rankOf(x),
                         x.named_as.empty() ? "-" : x.named_as, piece.what);
      if (!all.isNamed(i))
        out += fmt::format("      {}: {} on {} should be {}\n", as(shown, verdictOf(x)),
                           piece.plant, piece.scene, fmt::join(piece.named, " or "));
    }
    out += "\n";
  }
  return out + summaryOf(all);
}

std::string museumInFull(const MuseumFound& all, const VerdictShown& shown) {
  std::string out;
  for (std::size_t i = 0; i < all.pieces.size(); ++i) {
    const MuseumPiece& piece = all.pieces[i];
    const PieceFound& x = all.found[i];
    out += fmt::format(
        "{}: {}, {} ({})\n  {}\n  {}\n  planted as {} on {}: {}\n  has to be named {}\n  {}{}\n\n{}\n",
        piece.id, piece.tool, piece.year, piece.kind, piece.what, piece.link, piece.plant,
        piece.scene,
        piece.fidelity == "same" ? "the same mistake" : "the nearest that shows as this one does",
        fmt::join(piece.named, " or "), as(shown, verdictOf(x)),
        x.named_as.empty() ? "" : fmt::format(": {} (rank {})", x.named_as, rankOf(x)), x.text);
  }
  return out + summaryOf(all);
}

std::string museumJson(const MuseumFound& all, const std::string& version) {
  Json exhibits = Json::array(), right = Json::array();
  for (std::size_t i = 0; i < all.pieces.size(); ++i) {
    const MuseumPiece& piece = all.pieces[i];
    const PieceFound& x = all.found[i];
    Json one = {{"id", piece.id},
                {"tool", piece.tool},
                {"year", piece.year},
                {"kind", piece.kind},
                {"link", piece.link},
                {"what", piece.what},
                {"plant", piece.plant},
                {"scene", piece.scene},
                {"fidelity", piece.fidelity},
                {"expected", piece.named},
                {"caught", x.caught},
                {"named", all.isNamed(i)},
                {"explanations", x.findings}};
    if (x.rank > 0) one["rank"] = x.rank;
    if (!x.named_as.empty()) one["named_as"] = x.named_as;
    if (!x.sentence.empty()) one["sentence"] = x.sentence;
    if (!x.failure.empty()) one["failure"] = x.failure;
    exhibits.push_back(one);
  }
  for (const PieceFound& x : all.right) {
    Json one = {{"scene", x.scene}, {"blamed", x.caught}};
    if (!x.failure.empty()) one["failure"] = x.failure;
    right.push_back(one);
  }
  return Json{{"dynwitness", version},
              {"holds", all.holds()},
              {"exhibits", exhibits},
              {"without_a_mistake", right}}
             .dump(1, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

}  // namespace dynwitness::crosscheck
