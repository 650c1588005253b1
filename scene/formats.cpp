// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/formats.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "scene/mjcf.hpp"
#include "scene/written_numbers.hpp"

namespace dynwitness::scene {
namespace {

using written::Numbers;

/// What a URDF's reader supposes, or its writer does not say.
std::vector<std::string> lostInUrdf(const Scene& scene) {
  const Mechanism& m = scene.mechanism;
  const Numbers number(m);
  std::vector<std::string> lost;
  const Vector usual = {0, 0, Expression::parse("-9.81")};
  if (!m.has_gravity)
    lost.push_back("that there is no gravity");
  else if (written::vector(m.gravity, number) != written::vector(usual, number))
    lost.push_back("gravity (" + written::text(written::vector(m.gravity, number)) + ")");
  for (const Link& link : m.links) {
    const Joint& j = link.joint;
    if (number(j.stiffness) != 0) lost.push_back("the spring of joint " + j.name);
    if (j.gyroscopic)
      lost.push_back("the gyroscopic rotor of joint " + j.name + ": its inertia stays");
    if (!j.rotors.empty()) lost.push_back("the rotors of joint " + j.name);
    if (number(j.friction.positive) != number(j.friction.negative))
      lost.push_back("Coulomb friction of joint " + j.name + ", which is not the same both ways");
    if (!j.motion.empty()) lost.push_back("the motion of joint " + j.name);
  }
  if (!m.wrenches.empty()) lost.push_back(fmt::format("{} loads", m.wrenches.size()));
  if (!m.closures.empty()) lost.push_back(fmt::format("{} closures", m.closures.size()));
  if (!m.springs.empty())
    lost.push_back(fmt::format("{} springs between points", m.springs.size()));
  if (!m.acceleration_constraints.empty())
    lost.push_back(fmt::format("{} acceleration constraints", m.acceleration_constraints.size()));
  const auto differ = [&](const std::vector<Number>& a, const std::vector<Number>& b) {
    return !std::equal(a.begin(), a.end(), b.begin(), b.end(),
                       [&](const Number& x, const Number& y) { return number(x) == number(y); });
  };
  if (differ(scene.start_q, m.restPosition()) ||
      differ(scene.start_qd, std::vector<Number>(scene.start_qd.size())))
    lost.push_back("the start");
  return lost;
}

/// Rotors in the words of Drake, which the reader knows.
std::string withRotors(std::string urdf, const Mechanism& mechanism) {
  const Numbers number(mechanism);
  std::string rotors;
  for (const Link& link : mechanism.links) {
    const Joint& j = link.joint;
    if (number(j.rotor_inertia) == 0) continue;
    const std::string name = written::escaped(j.name);
    rotors += fmt::format(
        "  <transmission name=\"{0}.transmission\"><type>SimpleTransmission</type>"
        "<joint name=\"{0}\"/><actuator name=\"{0}.actuator\"><drake:rotor_inertia value=\"{1}\"/>"
        "<drake:gear_ratio value=\"{2}\"/></actuator></transmission>\n",
        name, written::text(number(j.rotor_inertia)), written::text(number(j.gear_ratio)));
  }
  if (rotors.empty()) return urdf;
  urdf.insert(urdf.rfind("</robot>"), rotors);
  const std::size_t end = urdf.find("<robot") + 6;
  return urdf.insert(end, " xmlns:drake=\"https://drake.mit.edu\"");
}

/// In a comment of XML no two dashes may stand together.
std::string xmlComment(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at + 1))
    text.insert(at + 1, " ");
  return "  <!-- " + text + (text.back() == '-' ? " " : "") + " -->\n";
}
std::string tomlComment(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return "# " + text + "\n";
}

}  // namespace

const char* name(Format format) {
  switch (format) {
    case Format::kToml:
      return "toml";
    case Format::kUrdf:
      return "urdf";
    case Format::kMjcf:
      return "mjcf";
  }
  return "";
}

WrittenScene writeSceneAs(const Scene& scene, Format format) {
  WrittenScene out;
  switch (format) {
    case Format::kToml:
      out.text = writeSceneToml(scene);
      break;
    case Format::kUrdf:
      out.lost = lostInUrdf(scene);
      out.text = withRotors(writeSceneUrdf(scene), scene.mechanism);
      break;
    case Format::kMjcf:
      out.text = writeSceneMjcf(scene, &out.lost);
      break;
  }
  const auto comment = format == Format::kToml ? tomlComment : xmlComment;
  std::string comments;
  if (format != Format::kToml && !scene.source.empty()) comments += comment(scene.source);
  for (const std::string& what : scene.not_modelled)
    comments += comment("not read from " + scene.file.filename().string() + ": " + what);
  for (const std::string& what : out.lost) comments += comment("lost: " + what);
  // XML: inside of the outermost element
  out.text.insert(format == Format::kToml ? 0 : out.text.find('\n') + 1, comments);
  return out;
}

}  // namespace dynwitness::scene
