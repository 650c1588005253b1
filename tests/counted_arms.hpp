// SPDX-License-Identifier: GPL-3.0-or-later
// The arms whose operations the literature counts, and how few it reached.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/kernel/roads.hpp"
#include "scene/scene.hpp"

namespace dynwitness::counted {

/// The scene with links of ten parameters each that no zero hides behind, without rotors or
/// springs.
inline scene::Scene withGeneralInertias(scene::Scene scene) {
  int k = 3;
  const auto next = [&] {
    k = k * 37 % 1009;
    return scene::Number(scene::Rational(k + 1, 1013));
  };
  for (scene::Link& link : scene.mechanism.links) {
    scene::MassProperties& m = link.inertia;
    m.mass = next();
    for (scene::Number& x : m.com) x = next();
    for (scene::Number* x : {&m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz}) *x = next();
    link.joint.rotor_inertia = link.joint.stiffness = 0;
  }
  return scene;
}

struct Row {
  std::string mdh, inertia;  ///< modified Denavit-Hartenberg row; mass properties
  std::string kind = "revolute";
};

/// A serial arm without rotors.
inline scene::Scene arm(const std::string& name, const std::vector<Row>& rows) {
  std::string text = "title = \"" + name +
                     "\"\nsource = \"chosen here\"\ngravity = [0, 0, -9.81]\n" +
                     "[[link]]\nname = \"link_0\"\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string k = std::to_string(i + 1);
    text += "[[link]]\nname = \"link_" + k + "\"\nparent = \"link_" + std::to_string(i) + "\"\n" +
            rows[i].inertia + "\n[link.joint]\nname = \"joint_" + k + "\"\nkind = \"" +
            rows[i].kind + "\"\nmdh = {" + rows[i].mdh + "}\n";
  }
  return scene::readSceneToml(text, name + ".toml");
}

/// Armstrong, Khatib and Burdick's PUMA 560 (1986): the zeros are theirs, as the matlab toolbox has
/// them (mdl_puma560akb); two moments are changed so that a body can have them, where that moves no
/// zero.
inline scene::Scene armstrongsPuma() {
  return arm("akb",
             {{"", "mass = 1\ninertia = {about = \"com\", xx = 0.2, yy = 0.2, zz = 0.35}"},
              {"alpha = \"-pi/2\", d = 0.2435",
               "mass = 17.4\ncom = [0.068, 0.006, -0.016]\n"
               "inertia = {about = \"com\", xx = 0.13, yy = 0.524, zz = 0.539}"},
              {"a = 0.4318, d = -0.0934",
               "mass = 4.8\ncom = [0, -0.07, 0.014]\n"
               "inertia = {about = \"com\", xx = 0.066, yy = 0.0225, zz = 0.086}"},
              {"alpha = \"pi/2\", a = -0.0203, d = 0.4331",
               "mass = 0.82\ncom = [0, 0, -0.019]\n"
               "inertia = {about = \"com\", xx = 0.0018, yy = 0.0018, zz = 0.0013}"},
              {"alpha = \"-pi/2\"",
               "mass = 0.34\ninertia = {about = \"com\", xx = 0.0003, yy = 0.0003, zz = 0.0004}"},
              {"alpha = \"pi/2\"",
               "mass = 0.09\ncom = [0, 0, 0.032]\n"
               "inertia = {about = \"com\", xx = 0.00015, yy = 0.00015, zz = 0.00004}"}});
}

/// "Symmetric": no products of inertia, centres of mass along the links.
inline scene::Scene symmetricRx90() {
  const std::string moments = "inertia = {about = \"com\", xx = 0.11, yy = 0.12, zz = 0.13}";
  return arm("rx90", {{"", "mass = 6\n" + moments},
                      {"alpha = \"pi/2\"", "mass = 5\ncom = [0.2, 0, 0]\n" + moments},
                      {"a = 0.45", "mass = 4\ncom = [0, 0.1, 0]\n" + moments},
                      {"alpha = \"-pi/2\", d = 0.5", "mass = 3\ncom = [0, 0, -0.1]\n" + moments},
                      {"alpha = \"pi/2\"", "mass = 2\ncom = [0, 0.02, 0]\n" + moments},
                      {"alpha = \"-pi/2\"", "mass = 1\ncom = [0, 0, 0.05]\n" + moments}});
}
inline scene::Scene symmetricStanford() {
  scene::Scene stanford = scene::findScene("stanford_arm");
  for (scene::Link& link : stanford.mechanism.links)
    link.joint.rotor_inertia = link.joint.stiffness = 0;
  return stanford;
}

/// The fewest that the literature and earlier programs reached. Khalil and Dombre, Modeling,
/// Identification and Control of Robots (2002), chapter 9, count in the same way: sin and cos are
/// free, products with parameters are not. Armstrong's count is of both together.
struct Fewest {
  const char* arm;
  scene::Scene (*make)();
  crosscheck::kernel::Formula formula;
  int multiplications, additions, in_all;  ///< 0: not said
};
inline std::vector<Fewest> fewest() {
  using crosscheck::kernel::Formula;
  const auto puma = [] { return withGeneralInertias(scene::findScene("puma_560")); };
  const auto iiwa = [] { return withGeneralInertias(scene::findScene("kuka_iiwa_14")); };
  return {{"PUMA 560 (general)", puma, Formula::kInverseDynamics, 263, 238, 0},
          {"PUMA 560 (general)", puma, Formula::kMassMatrix, 142, 116, 0},
          {"PUMA 560 (general)", puma, Formula::kMassCoriolisGravity, 415, 342, 0},
          {"PUMA 560 (Armstrong)", armstrongsPuma, Formula::kInverseDynamics, 0, 0, 321},
          {"iiwa 14 (general)", iiwa, Formula::kInverseDynamics, 300, 273, 0},
          {"iiwa 14 (general)", iiwa, Formula::kMassMatrix, 165, 126, 0},
          {"RX-90 (symmetric)", symmetricRx90, Formula::kInverseDynamics, 156, 104, 0},
          {"Stanford (symmetric)", symmetricStanford, Formula::kInverseDynamics, 140, 96, 0}};
}

}  // namespace dynwitness::counted
