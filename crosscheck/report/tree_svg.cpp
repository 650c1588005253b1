// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/tree_svg.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

// all lengths in CSS pixels
constexpr double kCharacter = 7.3;       // widest usual average of 13 px sans-serif
constexpr double kSmallCharacter = 6.5;  // the same of 11.5 px
constexpr double kBoxHeight = 28, kBoxPadding = 10;
constexpr double kMargin = 14;
constexpr double kWidestRow = 1040;  // what fits the page without scrolling
constexpr int kLongestName = 22;

enum class Kind { kRevolute, kPrismatic, kFixed, kOther };

struct Node {
  std::string name, box_text, joint, joint_text;
  Kind kind = Kind::kOther;
  int parent = -1, depth = 0;
  std::vector<int> children;
  double box_width = 0, label_width = 0;
  double across = 0;    // slot position, orthogonal to base-to-tip
  double x = 0, y = 0;  // centre of the box
};

std::string shortened(const std::string& text, int longest) {
  if (codePoints(text) <= longest) return text;
  std::string cut;
  int count = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80 && ++count == longest) break;
    cut += c;
  }
  return cut + "…";
}

/// Splits the kind off a joint label: "shoulder (revolute)" is the label "shoulder" with a pin
/// glyph.
Kind takeKind(std::string* label) {
  const std::pair<const char*, Kind> kinds[] = {{" (revolute)", Kind::kRevolute},
                                                {" (prismatic)", Kind::kPrismatic},
                                                {" (fixed)", Kind::kFixed}};
  for (const auto& [end, kind] : kinds) {
    const std::size_t size = std::string_view(end).size();
    if (label->size() < size || label->compare(label->size() - size, size, end) != 0) continue;
    label->resize(label->size() - size);
    return kind;
  }
  return Kind::kOther;
}

const char* kindWord(Kind kind) {
  switch (kind) {
    case Kind::kRevolute:
      return "revolute";
    case Kind::kPrismatic:
      return "prismatic";
    case Kind::kFixed:
      return "fixed";
    case Kind::kOther:
      break;
  }
  return "joint";
}

std::vector<Node> readTree(const SceneResult& scene) {
  std::vector<Node> nodes(scene.link_names.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Node& node = nodes[i];
    node.name = oneLine(scene.link_names[i]);
    node.box_text = shortened(node.name, kLongestName);
    if (i < scene.joint_labels.size()) node.joint = oneLine(scene.joint_labels[i]);
    std::string label = node.joint;
    node.kind = takeKind(&label);
    node.joint_text = shortened(label, kLongestName);
    const int parent = i < scene.parents.size() ? scene.parents[i] : -1;
    if (parent >= 0 && parent < static_cast<int>(i)) {  // topological order, else it stands alone
      node.parent = parent;
      node.depth = nodes[parent].depth + 1;
      nodes[parent].children.push_back(static_cast<int>(i));
    }
    node.box_width = std::max(36.0, codePoints(node.box_text) * kCharacter + 2 * kBoxPadding);
    node.label_width = codePoints(node.joint_text) * kSmallCharacter;
  }
  return nodes;
}

/// Tips get slots one after the other in depth-first order, and parents sit amid their children.
/// `room(node)` is the slot that a node needs. Returns the sum of all slots.
template <typename Room>
double placeAcross(std::vector<Node>* nodes, Room room) {
  double next = 0;
  std::vector<int> order;  // depth first
  std::vector<int> stack;
  for (int i = static_cast<int>(nodes->size()) - 1; i >= 0; --i)
    if ((*nodes)[i].parent < 0) stack.push_back(i);
  while (!stack.empty()) {
    const int i = stack.back();
    stack.pop_back();
    order.push_back(i);
    const auto& children = (*nodes)[i].children;
    stack.insert(stack.end(), children.rbegin(), children.rend());
  }
  // a chain is as wide as its widest member, up to where it branches off
  for (const int i : order) {
    Node& tip = (*nodes)[i];
    if (!tip.children.empty()) continue;
    double slot = room(tip);
    for (int p = tip.parent; p >= 0 && (*nodes)[p].children.size() == 1; p = (*nodes)[p].parent)
      slot = std::max(slot, room((*nodes)[p]));
    tip.across = next + slot / 2;
    next += slot;
  }
  for (auto it = order.rbegin(); it != order.rend(); ++it) {
    Node& node = (*nodes)[*it];
    if (node.children.empty()) continue;
    node.across =
        ((*nodes)[node.children.front()].across + (*nodes)[node.children.back()].across) / 2;
  }
  return next;
}

std::string glyph(Kind kind, double x, double y) {
  switch (kind) {
    case Kind::kRevolute:
      return fmt::format(
          R"svg(<g class="revolute" transform="translate({:.1f} {:.1f})"><circle r="7"/><circle class="dot" r="2"/></g>)svg",
          x, y);
    case Kind::kPrismatic:
      return fmt::format(
          R"svg(<g class="prismatic" transform="translate({:.1f} {:.1f})"><rect x="-10" y="-6" width="20" height="12" rx="2"/><path d="M-6 0H6M-3 -3L-6 0L-3 3M3 -3L6 0L3 3"/></g>)svg",
          x, y);
    case Kind::kFixed:
      return fmt::format(
          R"svg(<g class="fixed" transform="translate({:.1f} {:.1f})"><rect x="-5" y="-5" width="10" height="10"/></g>)svg",
          x, y);
    case Kind::kOther:
      return fmt::format(
          R"svg(<g class="other" transform="translate({:.1f} {:.1f})"><circle r="4"/></g>)svg", x,
          y);
  }
  return {};
}

/// The root's ground is hatched on the side that no edge leaves from.
std::string box(const Node& node, bool ground_above) {
  const double left = node.x - node.box_width / 2, top = node.y - kBoxHeight / 2;
  std::string text = fmt::format(
      R"svg(<g class="link{}"><title>{}</title><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.0f}" rx="6"/>)svg"
      R"svg(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)svg",
      node.parent < 0 ? " root" : "",
      escapeMarkup(node.parent < 0
                       ? node.name + ", at rest in the world"
                       : fmt::format("{}, carried by {}", node.name,
                                     node.joint.empty() ? kindWord(node.kind) : node.joint)),
      left, top, node.box_width, kBoxHeight, node.x, node.y + 4.5, escapeMarkup(node.box_text));
  if (node.parent < 0) {
    const double ground = ground_above ? top - 3 : top + kBoxHeight + 3;
    text += fmt::format(R"svg(<path class="ground" d="M{:.1f} {:.1f}h{:.1f})svg", left + 4, ground,
                        node.box_width - 8);
    for (double x = left + 10; x < left + node.box_width - 5; x += 8)
      text += fmt::format("M{:.1f} {:.1f}l{} 6", x, ground_above ? ground - 6 : ground,
                          ground_above ? 5 : -5);
    text += R"svg("/>)svg";
  }
  return text + "</g>\n";
}

std::string legend(const std::vector<Node>& nodes, double x, double y) {
  std::string text = R"svg(<g class="legend">)svg";
  for (const Kind kind : {Kind::kRevolute, Kind::kPrismatic, Kind::kFixed}) {
    if (std::none_of(nodes.begin(), nodes.end(), [&](const Node& n) { return n.kind == kind; }))
      continue;
    text += glyph(kind, x + 10, y);
    text += fmt::format(R"svg(<text x="{:.1f}" y="{:.1f}">{}</text>)svg", x + 26, y + 4,
                        kindWord(kind));
    x += 36 + codePoints(kindWord(kind)) * kSmallCharacter + 10;
  }
  return text + "</g>\n";
}

bool hasLegend(const std::vector<Node>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(),
                     [](const Node& n) { return n.parent >= 0 && n.kind != Kind::kOther; });
}

struct Drawing {
  std::string body;
  double width = 0, height = 0;
};

/// Base to tip from left to right: each depth is a column.
Drawing drawAcross(std::vector<Node> nodes) {
  int depth = 0;
  for (const Node& node : nodes) depth = std::max(depth, node.depth);
  std::vector<double> box_width(depth + 1, 0), gap(depth + 1, 0), column(depth + 1, 0);
  for (const Node& node : nodes) {
    box_width[node.depth] = std::max(box_width[node.depth], node.box_width);
    if (node.depth > 0) gap[node.depth] = std::max({gap[node.depth], node.label_width + 18, 44.0});
  }
  for (std::size_t d = 1; d < nodes.size(); ++d)  // an elbow needs its own room
    if (nodes[d].parent >= 0 && nodes[nodes[d].parent].children.size() > 1)
      gap[nodes[d].depth] = std::max(gap[nodes[d].depth], nodes[d].label_width + 36);
  double x = kMargin;
  for (int d = 0; d <= depth; ++d) {
    x += gap[d];
    column[d] = x;
    x += box_width[d];
  }
  const double slots = placeAcross(&nodes, [](const Node&) { return kBoxHeight + 26; });
  for (Node& node : nodes) {
    node.x = column[node.depth] + node.box_width / 2;
    node.y = kMargin + node.across;
  }
  Drawing drawing;
  std::string labels;
  for (const Node& node : nodes) {
    if (node.parent < 0) continue;
    const Node& parent = nodes[node.parent];
    const double from = parent.x + parent.box_width / 2, to = node.x - node.box_width / 2;
    const double elbow = column[node.depth] - gap[node.depth] + 14;
    if (parent.y == node.y) {
      drawing.body +=
          fmt::format(R"svg(<path class="edge" d="M{:.1f} {:.1f}H{:.1f}"/>)svg", from, node.y, to);
    } else {
      const double turn = node.y > parent.y ? 8 : -8;
      drawing.body += fmt::format(
          R"svg(<path class="edge" d="M{0:.1f} {1:.1f}H{2:.1f}Q{3:.1f} {1:.1f} {3:.1f} {4:.1f}V{5:.1f}Q{3:.1f} {6:.1f} {7:.1f} {6:.1f}H{8:.1f}"/>)svg",
          from, parent.y, elbow - 8, elbow, parent.y + turn, node.y - turn, node.y, elbow + 8, to);
    }
    const bool straight = parent.children.size() == 1;
    const double middle = straight ? (from + to) / 2 : (elbow + 8 + to) / 2;
    labels += glyph(node.kind, middle, node.y);
    labels += fmt::format(
        R"svg(<text class="joint" x="{:.1f}" y="{:.1f}" text-anchor="middle">{}<title>{}</title></text>)svg"
        "\n",
        middle, node.y - 13, escapeMarkup(node.joint_text), escapeMarkup(node.joint));
  }
  drawing.body += "\n" + labels;
  for (const Node& node : nodes) drawing.body += box(node, false);
  drawing.width = x + kMargin;
  drawing.height = slots + 2 * kMargin;
  return drawing;
}

/// Base to tip from top to bottom: each depth is a row, the joint's label right of its edge.
Drawing drawDown(std::vector<Node> nodes) {
  constexpr double kRow = 62;
  int depth = 0;
  for (const Node& node : nodes) depth = std::max(depth, node.depth);
  const double slots = placeAcross(&nodes, [](const Node& node) {
    return std::max(node.box_width + 18, 2 * (node.label_width + 20));
  });
  for (Node& node : nodes) {
    node.x = kMargin + node.across;
    node.y = kMargin + kBoxHeight / 2 + node.depth * kRow;
  }
  Drawing drawing;
  std::string labels;
  for (const Node& node : nodes) {
    if (node.parent < 0) continue;
    const Node& parent = nodes[node.parent];
    const double from = parent.y + kBoxHeight / 2, to = node.y - kBoxHeight / 2;
    if (std::abs(parent.x - node.x) < 0.05) {
      drawing.body +=
          fmt::format(R"svg(<path class="edge" d="M{:.1f} {:.1f}V{:.1f}"/>)svg", node.x, from, to);
    } else {
      const double turn = node.x > parent.x ? 6 : -6;
      const double elbow = from + 8;
      drawing.body += fmt::format(
          R"svg(<path class="edge" d="M{0:.1f} {1:.1f}V{2:.1f}Q{0:.1f} {3:.1f} {4:.1f} {3:.1f}H{5:.1f}Q{6:.1f} {3:.1f} {6:.1f} {7:.1f}V{8:.1f}"/>)svg",
          parent.x, from, elbow - 6, elbow, parent.x + turn, node.x - turn, node.x, elbow + 6, to);
    }
    const double middle = to - 13;
    labels += glyph(node.kind, node.x, middle);
    labels += fmt::format(
        R"svg(<text class="joint" x="{:.1f}" y="{:.1f}">{}<title>{}</title></text>)svg"
        "\n",
        node.x + 14, middle + 4, escapeMarkup(node.joint_text), escapeMarkup(node.joint));
  }
  drawing.body += "\n" + labels;
  for (const Node& node : nodes) drawing.body += box(node, true);
  drawing.width = slots + 2 * kMargin;
  drawing.height = (depth + 1) * kRow - (kRow - kBoxHeight) + 2 * kMargin + 6;
  return drawing;
}

// for a picture that stands alone; the page brings variables of the same names
constexpr const char* kFileVariables =
    ":root{--ink:#1d2430;--soft:#5b6675;--card:#fff;--sunk:#eef1f5;--line:#c4ccd6;"
    "--revolute:#0072b2;--prismatic:#b04a00}\n"
    "@media (prefers-color-scheme:dark){:root{--ink:#e7eaee;--soft:#a3adba;--card:#1a2029;"
    "--sunk:#252d39;--line:#4a5565;--revolute:#56b4e9;--prismatic:#f0904f}}\n"
    "svg{background:var(--card);font-family:system-ui,'Segoe UI',Roboto,'Liberation "
    "Sans',sans-serif}\n";

}  // namespace

const char* treeStyle() {
  return ".tree .edge{fill:none;stroke:var(--soft);stroke-width:1.6}\n"
         ".tree .link rect{fill:var(--sunk);stroke:var(--line);stroke-width:1.2}\n"
         ".tree .link text{fill:var(--ink);font-size:13px}\n"
         ".tree .root rect{fill:var(--card);stroke:var(--soft)}\n"
         ".tree .ground{fill:none;stroke:var(--soft);stroke-width:1.1}\n"
         ".tree .joint,.tree .legend text{fill:var(--soft);font-size:11.5px}\n"
         ".tree .revolute circle{fill:var(--card);stroke:var(--revolute);stroke-width:2}\n"
         ".tree .revolute .dot{fill:var(--revolute);stroke:none}\n"
         ".tree .prismatic rect{fill:var(--card);stroke:var(--prismatic);stroke-width:1.8}\n"
         ".tree .prismatic path{fill:none;stroke:var(--prismatic);stroke-width:1.5}\n"
         ".tree .fixed rect{fill:var(--soft)}\n"
         ".tree .other circle{fill:var(--soft)}\n";
}

std::string treeSentence(const SceneResult& scene) {
  const std::vector<Node> nodes = readTree(scene);
  int tips = 0, depth = 0;
  for (const Node& node : nodes) {
    tips += node.children.empty() ? 1 : 0;
    depth = std::max(depth, node.depth);
  }
  const auto plural = [](int n, const char* word) {
    return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
  };
  const std::string links = plural(static_cast<int>(nodes.size()), "link");
  if (tips <= 1) return links + " in one chain";
  return fmt::format("{}, {}, at most {} from base to tip", links, plural(tips, "tip"),
                     plural(depth, "joint"));
}

std::string treeSvg(const SceneResult& scene, SvgUse use) {
  if (scene.link_names.empty() || static_cast<int>(scene.link_names.size()) > kLargestTree)
    return {};
  const std::vector<Node> nodes = readTree(scene);
  Drawing drawing = drawAcross(nodes);
  if (drawing.width > kWidestRow) drawing = drawDown(nodes);
  if (hasLegend(nodes)) {
    drawing.body += legend(nodes, kMargin, drawing.height + 6);
    drawing.height += 24;
    drawing.width = std::max(drawing.width, 300.0);
  }
  std::string label = fmt::format("Tree of {}: {}", scene.title.empty() ? scene.name : scene.title,
                                  treeSentence(scene));
  const char* start = use == SvgUse::kFile ? "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" : "";
  std::string style;
  if (use == SvgUse::kFile)
    style = fmt::format("<style>\n{}{}</style>\n", kFileVariables, treeStyle());
  return fmt::format(
      R"svg({}<svg xmlns="http://www.w3.org/2000/svg" class="tree" role="img" aria-label="{}" )svg"
      R"svg(width="{:.0f}" height="{:.0f}" viewBox="0 0 {:.0f} {:.0f}">)svg"
      "\n<title>{}</title>\n{}{}</svg>\n",
      start, escapeMarkup(label), drawing.width, drawing.height, drawing.width, drawing.height,
      escapeMarkup(label), style, drawing.body);
}

}  // namespace dynwitness::crosscheck
