// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/page.hpp"

#include <algorithm>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"
#include "crosscheck/report/tree_svg.hpp"

namespace dynwitness::crosscheck {
namespace {

/// From a scene's page to the report's folder.
const std::string kUp = "../../";

void putHead(std::string* page, const CrosscheckResult& result, const Environment& environment) {
  const char* sign = exitStatus(result.verdict()) == 0 ? "✓" : "✗";
  *page += pageHead(sign + (" " + result.headline()), environment.version, "", "scenes",
                    "Skip to the scenes");
}

void putVerdict(std::string* page, const CrosscheckResult& result, const Environment& environment) {
  const std::string headline = result.headline();
  const std::size_t cut = headline.find("; ");
  const char* css = cssClass(result.verdict());
  put(page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> crosscheck of "
      "robot dynamics</p>\n<div class=\"verdict {}\">{}\n<h1><span>{}</span>",
      css, icon(css), esc(headline.substr(0, cut)));
  if (cut != std::string::npos)
    put(page, " <span class=\"detail\">{}</span>", esc(headline.substr(cut + 2)));
  put(page, "</h1></div>\n<ul class=\"facts\">\n");
  if (const int n = result.count(Verdict::kDisagree); n > 0)
    put(page, "<li><b>{}</b> disagree</li>\n", n);
  put(page, "<li><b>{}</b> agree</li>\n", result.count(Verdict::kAgree));
  put(page, "<li><b>{}</b> not answerable</li>\n", result.count(Verdict::kNotAnswerable));
  const auto present = std::count_if(result.witnesses.begin(), result.witnesses.end(),
                                     [](const WitnessInfo& w) { return w.present; });
  put(page, "<li><b>{}</b> witness{}</li>\n", present, present == 1 ? "" : "es");
  put(page, "<li><b>{}</b> random state{} a scene</li>\n<li>seed <b>{}</b></li>\n", result.states,
      result.states == 1 ? "" : "s", result.seed);
  put(page, "<li>{}</li>\n</ul>\n<p class=\"soft small\">{}{}</p>\n</header>\n",
      esc(environment.date),
      badge(result.controlMissed() ? Verdict::kDisagree : Verdict::kAgree,
            result.controlMissed() ? "control missed" : "control") +
          " ",
      esc(result.controlLine().substr(std::string("control: ").size())));  // the badge says it
}

/// @param root  the report's folder, seen from the page
void putFooter(std::string* page, const CrosscheckResult& result, const Environment& environment,
               const std::string& root) {
  put(page,
      "</main>\n<footer{}>\n<h2>Compute it again</h2>\n<pre tabindex=\"0\"><code>{}</code></pre>\n"
      "<dl class=\"meta\">\n<dt>dynwitness</dt><dd>{}{}</dd>\n",
      root.empty() ? "" : " class=\"again\"", esc(result.command), esc(environment.version),
      environment.commit.empty() ? "" : ", commit " + esc(environment.commit));
  put(page, "<dt>Compiler</dt><dd>{}</dd>\n", esc(environment.compiler));
  if (!environment.flags.empty())
    put(page, "<dt>Flags</dt><dd><code>{}</code></dd>\n", esc(environment.flags));
  std::string libraries;
  for (const Environment::Library& library : environment.libraries)
    libraries += fmt::format("{}{} {}", libraries.empty() ? "" : ", ", esc(library.name),
                             esc(library.version));
  put(page, "<dt>Libraries</dt><dd>{}</dd>\n<dt>CPU</dt><dd>{}</dd>\n<dt>Date</dt><dd>{}</dd>\n",
      libraries, esc(environment.cpu), esc(environment.date));
  put(page,
      "<dt>Seed</dt><dd>{0}</dd>\n<dt>States</dt><dd>{1} a scene</dd>\n"
      "<dt>For programs</dt><dd><a href=\"{2}report.json\">report.json</a>, "
      "<a href=\"{2}junit.xml\">junit.xml</a>, "
      "<a href=\"{2}digits.md\">digits.md</a></dd>\n</dl>\n</footer>\n</body>\n</html>\n",
      result.seed, result.states, root);
}

}  // namespace

std::string reportPage(const CrosscheckResult& result, const Environment& environment,
                       const std::vector<SceneFiles>& files, const std::string& more) {
  std::string page;
  putHead(&page, result, environment);
  putVerdict(&page, result, environment);
  putDisagreements(&page, result, files);
  putKnownLosses(&page, result);
  putCoverage(&page, result);
  putSceneTable(&page, result, files);
  page += kHowToReadHtml;
  putWitnesses(&page, result);
  page += more;
  putFooter(&page, result, environment, "");
  return page;
}

std::string scenePage(const CrosscheckResult& result, std::size_t k, const Environment& environment,
                      const SceneFiles& files) {
  const SceneResult& scene = result.scenes.at(k);
  const char* sign = count(scene).disagree == 0 ? "✓ " : "✗ ";
  std::string page = pageHead(sign + sceneTitle(scene), environment.version, treeStyle(),
                              files.anchor, "Skip to the scene");
  put(&page,
      "<main>\n<header id=\"top\">\n<p class=\"eyebrow\"><strong>dynwitness</strong> crosscheck of "
      "robot dynamics: <a href=\"{}index.html#scenes\">all scenes</a></p>\n</header>\n",
      kUp);
  putScene(&page, scene, files, kUp);
  putFooter(&page, result, environment, kUp);
  return page;
}

}  // namespace dynwitness::crosscheck
