// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {

std::string printText(const std::string& text, Style style) {
  std::string out;
  for (char ch : text) {
    if (style == Style::kMathml && ch == '<') {
      out += "&lt;";
    } else if (style == Style::kMathml && ch == '>') {
      out += "&gt;";
    } else if (style == Style::kMathml && ch == '&') {
      out += "&amp;";
    } else if (style == Style::kLatex && std::string("_%$#&{}").find(ch) != std::string::npos) {
      out += std::string("\\") + ch;
    } else if (style == Style::kLatex && (ch == '^' || ch == '~' || ch == '\\')) {
      out += ch == '\\' ? "\\textbackslash{}" : std::string("\\") + ch + "{}";
    } else {
      out += ch;
    }
  }
  return out;
}

namespace {

/// "0: M13, M23" and what else is said after the equations, a line each.
std::vector<std::string> linesAfter(const Step& step) {
  std::vector<std::string> lines;
  if (!step.zeros.empty()) {
    std::string names;
    for (const std::string& name : step.zeros) names += (names.empty() ? "" : ", ") + name;
    lines.push_back("0: " + names);
  }
  lines.insert(lines.end(), step.remarks.begin(), step.remarks.end());
  return lines;
}

/// What stands before a step on a page where two roads are in two columns.
std::string columnTag(const std::vector<Step>& steps, std::size_t k) {
  const auto besides = [](const Step& step) { return step.is_beside; };
  if (std::none_of(steps.begin(), steps.end(), besides)) return "";
  if (k == 0) return "<div class=\"columns\"><div>\n";
  if (steps[k].is_beside == steps[k - 1].is_beside) return "";
  return steps[k].is_beside ? "</div><div>\n" : "</div></div>\n";
}

}  // namespace

std::string print(const Derivation& derivation, Style style, bool checks) {
  std::string text;
  int number = 0;
  for (const Step& step : derivation.steps) {
    if (style == Style::kMathml)
      text += columnTag(derivation.steps, static_cast<std::size_t>(number));
    ++number;
    const std::string head = std::to_string(number) + ". " + printText(step.name, style);
    const std::string sentence = printText(step.sentence, style);
    const std::string verdict =
        printText(step.check, style) + (step.holds ? ": holds" : ": DOES NOT HOLD");
    const bool told = checks || !step.holds;
    const std::vector<std::string> after = linesAfter(step);
    switch (style) {
      case Style::kLatex:
        text += "\\paragraph{" + head + "} " + sentence + "\n\n";
        for (const Equation& e : step.equations)
          text += "\\hangpara $\\displaystyle " + print(e, style) + "$\n\n";
        for (const std::string& line : after) text += printText(line, style) + "\n\n";
        if (told) text += "{\\small Check: " + verdict + ".}\n\n";
        break;
      case Style::kMathml:
        text += "<details class=\"step\" open=\"open\"><summary>" + head + "</summary>\n<p>" +
                sentence + "</p>\n";
        for (const Equation& e : step.equations)
          text += "<div class=\"equation\" data-latex=\"" +
                  printText(print(e, Style::kLatex), style) + "\">" + print(e, style) + "</div>\n";
        for (const std::string& line : after) text += "<p>" + printText(line, style) + "</p>\n";
        if (told)
          text += "<details class=\"" + std::string(step.holds ? "holds" : "fails") +
                  "\"><summary>" + (step.holds ? "Checked exactly" : "DOES NOT HOLD") +
                  "</summary><p>" + verdict + "</p></details>";
        text += "</details>\n";
        break;
      default:
        text += head + "\n   " + sentence + "\n";
        for (const Equation& e : step.equations) text += "     " + print(e, Style::kText) + "\n";
        for (const std::string& line : after) text += "   " + line + "\n";
        if (told) text += "   check: " + verdict + "\n";
        text += "\n";
    }
  }
  return text;
}

}  // namespace dynwitness::symbolic
