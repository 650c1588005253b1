// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "symbolic/derivation.hpp"
#include "symbolic/mathml_pieces.hpp"
#include "symbolic/sentence.hpp"

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

/// A name of a formula within a sentence.
std::string nameInText(const std::string& name, Style style) {
  const std::string shown = printName(name, style);
  return style == Style::kLatex    ? "$" + shown + "$"
         : style == Style::kMathml ? "<math>" + shown + "</math>"
                                   : shown;
}

/// "N m s/rad" as a person sees it: exponents raised.
std::string unitText(const std::string& unit, Style style) {
  std::string out;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit[i] == '^' && style != Style::kText) {
      ++i;
      out += style == Style::kLatex ? std::string("^{") + unit[i] + "}"
             : unit[i] == '2'       ? "&#xb2;"
                                    : "&#xb3;";
    } else {
      out += unit[i] == ' ' && style == Style::kLatex ? "\\," : std::string(1, unit[i]);
    }
  }
  return style == Style::kLatex ? "\\,\\mathrm{" + out + "}" : " " + out;
}

/// "link_3: velocity v3x, t4 [m/s]; angular velocity omega3x [rad/s]"; more than two lines that are
/// counted in a row as t4 ... t9.
std::string headingText(const LineGroup& group, Style style) {
  const auto number = [](const std::string& name) {
    return name.front() == 't' && name.size() > 1 &&
                   name.find_first_not_of("0123456789", 1) == std::string::npos
               ? std::stol(name.substr(1))
               : -1;
  };
  std::string text;
  for (const LineGroup::Kind& kind : group.kinds) {
    text += text.empty() ? "" : "; ";
    if (!kind.noun.empty()) text += printText(kind.noun, style) + " ";
    for (std::size_t k = 0; k < kind.names.size();) {
      std::size_t last = k;
      while (last + 1 < kind.names.size() && number(kind.names[last]) > 0 &&
             number(kind.names[last + 1]) == number(kind.names[last]) + 1)
        ++last;
      if (last < k + 2) last = k;
      text += (k == 0 ? "" : ", ") + nameInText(kind.names[k], style);
      if (last > k) text += " ... " + nameInText(kind.names[last], style);
      k = last + 1;
    }
    if (!kind.unit.empty())
      text += style == Style::kLatex ? " [$" + unitText(kind.unit, style).substr(2) + "$]"
                                     : " [" + unitText(kind.unit, style).substr(1) + "]";
  }
  return (group.of.empty() ? "" : printText(group.of, style) + ": ") + text;
}

/// "with m1 = 2 kg, l1 = 0.5 m"
std::string parametersText(const Step& step, Style style) {
  std::string text;
  for (const ShownParameter& p : step.parameters) {
    const std::string value = p.decimal.empty() ? print(p.value, style) : p.decimal,
                      unit = p.unit.empty() ? "" : unitText(p.unit, style),
                      name = printName(p.name, style);
    text += text.empty() ? "with " : ", ";
    if (style == Style::kLatex)
      text += "$" + name + " = " + value + unit + "$";
    else if (style == Style::kMathml)
      text += "<math><mrow>" + name + "<mo>=</mo>" +
              (p.decimal.empty() ? value : "<mn>" + value + "</mn>") + "</mrow></math>" + unit;
    else
      text += name + " = " + value + unit;
  }
  return text;
}

/// The equations of a step. In print and on a page lines of a program stand side by side.
std::string equationsText(const Step& step, Style style) {
  std::string text;
  bool in_row = false;
  const auto endRow = [&] {
    if (in_row)
      text += style == Style::kLatex ? "\\par}\n\n" : style == Style::kMathml ? "</div>\n" : "";
    in_row = false;
  };
  for (const StepEquation& e : step.equations) {
    const bool is_in_row = e.isLine() || e.heading;  // a result may be the first of its group
    if (e.heading || !is_in_row) endRow();
    if (e.heading) {
      const std::string heading = headingText(*e.heading, style);
      text += style == Style::kLatex    ? "{\\small\\hangpara " + heading + ":\n"
              : style == Style::kMathml ? "<p class=\"group\">" + heading + "</p>\n"
                                        : "   " + heading + "\n";
    }
    switch (style) {
      case Style::kLatex:
        if (is_in_row && !in_row && !e.heading) text += "{\\small\\hangpara\n";
        text += std::string(is_in_row ? "\\quad " : "\\hangpara ") + "$\\displaystyle " +
                print(e, style) + "$\n" + (is_in_row ? "" : "\n");
        break;
      case Style::kMathml:
        if (is_in_row && !in_row) text += "<div class=\"lines\">\n";
        text += "<div class=\"equation\" data-latex=\"" +
                printText(print(e, Style::kLatex), style) + "\"><span class=\"formula\">" +
                inPieces(print(e, style)) + "</span></div>\n";
        break;
      default:
        text += "     " + print(e, Style::kText) + "\n";
    }
    in_row = is_in_row;
  }
  endRow();
  return text;
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
    const std::string parameters = parametersText(step, style);
    if (style == Style::kMathml)
      text += columnTag(derivation.steps, static_cast<std::size_t>(number));
    ++number;
    const std::string head = std::to_string(number) + ". " + printText(step.name, style);
    const std::string sentence = printSentence(step.sentence, style);
    const std::string verdict =
        printSentence(step.check, style) + (step.holds ? ": holds" : ": DOES NOT HOLD");
    const bool told = (checks && !step.check.empty()) || !step.holds;
    const std::vector<std::string> after = linesAfter(step);
    switch (style) {
      case Style::kLatex:
        text += "\\paragraph{" + head + "} " + sentence + "\n\n";
        text += equationsText(step, style);
        if (!parameters.empty()) text += "{\\small " + parameters + ".}\n\n";
        for (const std::string& line : after) text += printSentence(line, style) + "\n\n";
        if (told) text += "{\\small Check: " + verdict + ".}\n\n";
        break;
      case Style::kMathml:
        text += "<details class=\"step\" open=\"open\"><summary>" + head + "</summary>\n<p>" +
                sentence + "</p>\n";
        text += equationsText(step, style);
        if (!parameters.empty()) text += "<p class=\"values\">" + parameters + "</p>\n";
        for (const std::string& line : after) text += "<p>" + printSentence(line, style) + "</p>\n";
        if (told)
          text += "<details class=\"" + std::string(step.holds ? "holds" : "fails") +
                  "\"><summary>" + (step.holds ? "Checked exactly" : "DOES NOT HOLD") +
                  "</summary><p>" + verdict + "</p></details>";
        text += "</details>\n";
        break;
      default:
        text += head + "\n   " + sentence + "\n";
        text += equationsText(step, style);
        if (!parameters.empty()) text += "   " + parameters + "\n";
        for (const std::string& line : after) text += "   " + line + "\n";
        if (told) text += "   check: " + verdict + "\n";
        text += "\n";
    }
  }
  return text;
}

}  // namespace dynwitness::symbolic
