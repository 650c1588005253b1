// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader's program shows of what it has read, as JSON
// (crosscheck/witnesses/engine_protocol.md, "Readers").
#pragma once

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace dynwitness::programs {

inline nlohmann::json shown(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}
inline nlohmann::json shown(const Eigen::Matrix3d& m) {
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
  return rows;
}
inline nlohmann::json shown(const Eigen::Isometry3d& X) {
  return {{"R", shown(Eigen::Matrix3d(X.linear()))},
          {"p", shown(Eigen::Vector3d(X.translation()))}};
}

inline std::string textOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace dynwitness::programs
