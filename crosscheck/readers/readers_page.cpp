// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/readers/readers_page.hpp"

#include <algorithm>
#include <unordered_map>

#include "crosscheck/report/page_words.hpp"
#include "crosscheck/report/view.hpp"
#include "scene/mjcf.hpp"

namespace dynwitness::crosscheck {
namespace {

/// "agree", "disagree" or "none" of the style sheet.
const char* classOf(const ReaderResult& reader) {
  if (!reader.findings.empty()) return "disagree";
  return reader.has_read ? "agree" : "none";
}

std::string wordOf(const ReaderResult& reader) {
  if (!reader.present) return "absent";
  if (!reader.failure.empty() && !reader.has_read) return "fails";
  if (!reader.has_read) return "does not read it";
  return reader.findings.empty() ? "has the robot of the file" : "has another robot";
}

/// A file's name in a link, where some characters end the path.
std::string linkTo(const std::string& file) {
  std::string out;
  for (const char c : file)
    out += c == '%' || c == '#' || c == '?' ? fmt::format("%{:02X}", static_cast<int>(c))
                                            : std::string(1, c);
  return out;
}

void putHeadline(std::string* page, const ReadersResult& result, const std::string& picture) {
  long read = 0, wrong = 0;
  for (const ReaderResult& reader : result.readers) {
    read += reader.has_read ? 1 : 0;
    wrong += reader.findings.empty() ? 0 : 1;
  }
  const char* const css = wrong > 0 ? "disagree" : read > 0 ? "agree" : "none";
  const std::string headline =
      wrong > 0  ? fmt::format("{} another robot",
                              wrong == 1 ? "1 reader has" : fmt::format("{} readers have", wrong))
       : read > 0 ? (read == 1 ? "The reader has" : fmt::format("All {} readers have", read)) +
                       std::string(" the robot of the file")
                 : "No reader reads the file";
  put(page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> readers of "
      "{}</p>\n<div class=\"verdict {}\">{}\n<h1><span>{}</span> <span class=\"detail\">{}, {} by "
      "joints of their own; {} read the file</span></h1></div>\n",
      esc(result.file), css, icon(css), esc(headline), plural(result.links, "link"),
      result.bodies.size() == 1 ? "1 moved" : fmt::format("{} moved", result.bodies.size()),
      plural(read, "reader"));
  put(page,
      "<p>Each engine was given the file's own bytes, with no option set. What it has read is "
      "compared with what the file says, once links that are fixed to each other are one; a "
      "mistake is named when it gives exactly what was read, and a remedy when it was "
      "tried.</p>\n");
  if (!picture.empty())
    put(page,
        "<p><a href=\"{}\">In space, to be moved</a>: inertia as written, and as engines have read "
        "it.</p>\n",
        esc(linkTo(picture)));
  put(page, "</header>\n");
}

// what a page shows of large files
constexpr std::size_t kMostRows = 200, kMostFindings = 100;

void putMore(std::string* page, std::size_t all, std::size_t most, const char* what) {
  if (all > most)
    put(page,
        "<p class=\"soft\">{} of {} {}; all of them: <code>--all-links --json FILE</code></p>\n",
        most, all, what);
}

void putTable(std::string* page, const ReadersResult& result) {
  std::vector<const ReaderResult*> columns;
  for (const ReaderResult& reader : result.readers)
    if (reader.present) columns.push_back(&reader);
  put(page, "<h2 id=\"table\">Link by link</h2>\n");
  openScroll(page, "What each reader has of each link");
  put(page, "<table>\n<thead><tr><th scope=\"col\">link</th>");
  for (const ReaderResult* reader : columns)
    put(page, "<th scope=\"col\">{}<span class=\"sub\">{}</span></th>", esc(reader->name),
        esc(reader->version));
  put(page, "</tr></thead>\n<tbody>\n");
  const std::vector<std::string> rows = result.rows();
  for (std::size_t i = 0; i < std::min(rows.size(), kMostRows); ++i) {
    const std::string& link = rows[i];
    put(page, "<tr><th scope=\"row\">{}</th>",
        link.empty() ? "<span class=\"soft\">the whole robot</span>" : esc(link));
    for (const ReaderResult* reader : columns) {
      const std::string cell = cellOf(*reader, link);
      const bool differs =
          std::any_of(reader->findings.begin(), reader->findings.end(),
                      [&](const Misreading& finding) { return finding.link == link; });
      put(page, "<td>{}</td>",
          differs             ? badge("disagree", cell)
          : !reader->has_read ? badge("none", cell)
                              : badge("agree", cell));
    }
    put(page, "</tr>\n");
  }
  put(page, "</tbody></table></div>\n");
  putMore(page, rows.size(), kMostRows, "links");
}

void putFinding(std::string* page, const ReaderResult& reader, const Misreading& finding) {
  put(page,
      "<article class=\"entry disagree\">\n<h3><span class=\"id\">{}</span><span>{}</span>{}"
      "</h3>\n<dl>\n",
      finding.link.empty() ? "the whole robot" : "link " + esc(finding.link),
      finding.rule.empty() ? "another, by none of the mistakes that are tried" : esc(finding.rule),
      badge("disagree", finding.quantity));
  if (const std::string effect = effectText(finding); !effect.empty())
    put(page, "<dt>Effect</dt><dd>{}</dd>\n", esc(effect));
  if (!finding.ours.empty())
    put(page, "<dt>{}</dt><dd>{}</dd>\n",
        finding.where.line > 0 ? fmt::format("The file, line {}", finding.where.line) : "The file",
        esc(finding.ours));
  if (!finding.theirs.empty())
    put(page, "<dt>{}</dt><dd>{}</dd>\n", esc(reader.name), esc(finding.theirs));
  for (const std::string& record : finding.records)
    put(page, "<dt>On record</dt><dd>{}</dd>\n", esc(record));
  put(page, "</dl>\n</article>\n");
}

void putReader(std::string* page, const ReaderResult& reader) {
  put(page, "<h3>{} {}</h3>\n", esc(title(reader)), badge(classOf(reader), wordOf(reader)));
  if (!reader.absence.empty()) put(page, "<p>{}</p>\n", esc(reader.absence));
  if (!reader.refusal.empty()) put(page, "<p>In its words: {}</p>\n", esc(reader.refusal));
  if (!reader.told.empty()) {
    put(page, "<ul class=\"reasons\">\n");
    for (const std::string& told : reader.told) put(page, "<li>{}</li>\n", esc(told));
    put(page, "</ul>\n");
  }
  for (std::size_t i = 0; i < std::min(reader.findings.size(), kMostFindings); ++i)
    putFinding(page, reader, reader.findings[i]);
  putMore(page, reader.findings.size(), kMostFindings, "findings");
  if (!reader.remedy.empty())
    put(page, "<p><strong>Remedy:</strong> <code>{}</code></p>\n", esc(reader.remedy));
}

}  // namespace

std::string readersPage(const ReadersResult& result, const Environment& environment,
                        const std::string& picture) {
  std::string page =
      pageHead("Readers of " + result.file, environment.version, "", "table", "Skip to the table");
  putHeadline(&page, result, picture);
  if (!result.remarks.empty()) {
    put(&page, "<h2>Remarks on the file</h2>\n<ul class=\"reasons\">\n");
    for (const std::string& text : result.remarks) put(&page, "<li>{}</li>\n", esc(text));
    put(&page, "</ul>\n");
  }
  if (!result.impossible.empty()) {
    put(&page, "<h2>Inertias that no body has</h2>\n<ul class=\"reasons\">\n");
    for (const std::string& text : result.impossible) put(&page, "<li>{}</li>\n", esc(text));
    put(&page, "</ul>\n<p><code>--mend OUT.urdf</code> writes the nearest possible ones.</p>\n");
  }
  if (!result.not_compared.empty()) {
    put(&page, "<h2>Not compared</h2>\n<ul class=\"reasons\">\n");
    for (const std::string& text : result.not_compared) put(&page, "<li>{}</li>\n", esc(text));
    put(&page, "</ul>\n");
  }
  putTable(&page, result);
  put(&page, "<h2>Reader by reader</h2>\n");
  for (const ReaderResult& reader : result.readers) putReader(&page, reader);
  put(&page,
      "</main>\n<footer>\n<h2>Read it again</h2>\n<pre tabindex=\"0\"><code>dynwitness readers {} "
      "--random {} --seed {}</code></pre>\n<dl class=\"meta\">\n<dt>dynwitness</dt><dd>{}{}</dd>\n"
      "<dt>Date</dt><dd>{}</dd>\n</dl>\n</footer>\n</body>\n</html>\n",
      esc(result.file), result.states, result.seed, esc(environment.version),
      environment.commit.empty() ? "" : ", commit " + esc(environment.commit),
      esc(environment.date));
  return page;
}

std::string readersPicture(const std::string& text, const std::filesystem::path& file,
                           const ReadersResult& result, const std::string& version) {
  const bool is_mjcf = scene::isMjcf(text);
  const scene::Urdf urdf = is_mjcf ? scene::Urdf{scene::readSceneMjcf(text, file), {}}
                                   : scene::readUrdfAsWritten(text, file);
  const FileParts parts = is_mjcf ? FileParts(urdf.scene.mechanism) : FileParts(urdf);
  View view = viewOf(urdf.scene, urdf.parts);
  std::unordered_map<std::string, int> links;
  for (const scene::Link& link : urdf.scene.mechanism.links)
    links.emplace(link.name, static_cast<int>(links.size()));
  view.bodies.clear();
  const auto add = [&](const std::string& link, const std::string& who, const MassMoments& m) {
    if (const auto at = links.find(link); at != links.end())
      view.bodies.push_back({at->second, who, m.mass, m.com(), m.aboutCom()});
  };
  for (const ReadBody& body : parts.robot().bodies) add(body.link, "", body.moments);
  std::string list;
  std::size_t listed = 0;
  for (const ReaderResult& reader : result.readers)
    for (const Misreading& finding : reader.findings) {
      if (!finding.read) continue;
      add(finding.link, title(reader), *finding.read);
      if (++listed > kMostRows) continue;
      put(&list, "<li>{} has {}: {}</li>\n", esc(title(reader)), esc(finding.link),
          finding.rule.empty() ? "another inertia" : esc(finding.rule));
    }
  std::string more;
  putMore(&more, listed, kMostRows, "readings");
  const std::string summary = fmt::format(
      "<p class=\"soft\"><code>{}</code> as written, grey, and where an engine has read another mass, "
      "centre of mass or inertia, that in red. Links that are fixed to each other are one body; what "
      "rests in the world has no part in it.</p>\n",
      esc(result.file));
  return viewPage(view, version, summary,
                  list.empty() ? "<p>No engine has read another inertia.</p>\n"
                               : "<h2>Read otherwise</h2>\n<ul>\n" + list + "</ul>\n" + more);
}

}  // namespace dynwitness::crosscheck
