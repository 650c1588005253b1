// SPDX-License-Identifier: GPL-3.0-or-later
// The tables over the whole run: its scenes, and its witnesses with their convention cards.
#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"

namespace dynwitness::crosscheck {

void putSceneTable(std::string* page, const CrosscheckResult& result,
                   const std::vector<SceneFiles>& files) {
  put(page, "<section aria-labelledby=\"scenes\">\n<h2 id=\"scenes\">Scenes</h2>\n");
  openScroll(page, "Table of scenes");
  put(page,
      "<table>\n<caption><span>Each scene, with the check that comes nearest to its "
      "limit.</span></caption>\n"
      "<thead><tr><th scope=\"col\">Scene</th><th scope=\"col\">Verdict</th>"
      "<th scope=\"col\" class=\"n\">Degrees of<br>freedom</th><th scope=\"col\" "
      "class=\"n\">Links</th>"
      "<th scope=\"col\" class=\"n\">Checks</th><th scope=\"col\" "
      "class=\"n\">Not<br>answerable</th>"
      "<th scope=\"col\">Nearest to its limit</th><th scope=\"col\">in the "
      "check</th></tr></thead>\n"
      "<tbody>\n");
  for (std::size_t i = 0; i < result.scenes.size(); ++i) {
    const SceneResult& scene = result.scenes[i];
    const SceneCounts counts = count(scene);
    const std::string word = counts.disagree > 0 ? fmt::format("{} disagree", counts.disagree)
                             : counts.agree > 0  ? "all agree"
                                                 : "not answerable";
    put(page,
        "<tr{}><th scope=\"row\"><a href=\"{}\">{}</a><span "
        "class=\"sub\">{}</span></th><td>{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td>",
        counts.disagree > 0 ? " class=\"bad\"" : "", files[i].page, esc(sceneTitle(scene)),
        esc(scene.name), badge(counts.verdict(), word), scene.dof, scene.links, counts.answered(),
        counts.not_answerable == 0 ? "–" : std::to_string(counts.not_answerable));
    if (counts.worst != nullptr)
      put(page,
          "<td class=\"share\">{}<span class=\"sub\">{}</span></td><td class=\"which\">{} "
          "<span class=\"soft\">{}</span><span class=\"sub\">{}</span></td></tr>\n",
          share(*counts.worst), esc(worstOfLimit(*counts.worst)), esc(counts.worst->quantity),
          esc(counts.worst->name()), witnessesOf(*counts.worst));
    else
      put(page, "<td>–</td><td>–</td></tr>\n");
  }
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

namespace {

/// The convention card of a witness: lines of "label: text".
void putConventions(std::string* page, const std::string& conventions) {
  put(page, "<details><summary>conventions</summary><dl>");
  for (std::size_t begin = 0; begin < conventions.size();) {
    const std::size_t end = std::min(conventions.find('\n', begin), conventions.size());
    const std::string line = conventions.substr(begin, end - begin);
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos)
      put(page, "<dd>{}</dd>", esc(line));
    else
      put(page, "<dt>{}</dt><dd>{}</dd>", esc(line.substr(0, colon)), esc(line.substr(colon + 2)));
    begin = end + 1;
  }
  put(page, "</dl></details>");
}

}  // namespace

void putWitnesses(std::string* page, const CrosscheckResult& result) {
  put(page, "<section aria-labelledby=\"witnesses\">\n<h2 id=\"witnesses\">Witnesses</h2>\n");
  openScroll(page, "Table of witnesses");
  put(page,
      "<table>\n<caption><span>Who testifies, and how each one "
      "computes.</span></caption>\n<thead><tr>"
      "<th scope=\"col\">Witness</th><th scope=\"col\">Version</th><th scope=\"col\">How it "
      "computes"
      "</th></tr></thead>\n<tbody>\n");
  for (const WitnessInfo& witness : result.witnesses) {
    put(page, "<tr><th scope=\"row\">{}</th><td class=\"nowrap\">{}</td><td>{}", esc(witness.name),
        witness.version.empty() ? "–" : esc(witness.version), esc(witness.method));
    if (!witness.present)
      put(page, " {}", badge(Verdict::kNotAnswerable, "absent: " + witness.absent));
    if (!witness.conventions.empty()) putConventions(page, witness.conventions);
    put(page, "</td></tr>\n");
  }
  put(page, "</tbody>\n</table>\n</div>\n</section>\n");
}

}  // namespace dynwitness::crosscheck
