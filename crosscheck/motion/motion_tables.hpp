// SPDX-License-Identifier: GPL-3.0-or-later
// Published motions (data/reference/motion/): positions at given times, from somebody else's
// simulation.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/simulate.hpp"

namespace dynwitness::crosscheck {

/// One file; its layout is in data/reference/README.md.
struct MotionTable {
  struct Column {
    enum class Of { kPosition, kRate, kMultiplier, kPoint };
    Of of = Of::kPoint;
    int index = -1;           ///< of q, qd or lambda (from 0), or
    scene::Attachment point;  ///< a point of a link,
    int axis = 0;             ///< its x, y or z in the world
    double scale = 1;         ///< printed value = scale times ours
  };
  struct Row {
    double time;
    std::vector<double> values;
  };
  std::string title, source;
  std::vector<Column> columns;
  std::vector<Row> rows;
  double step_error = 0;              ///< that it takes to meet the limit; 0: any will do
  double absolute = 0, relative = 0;  ///< limit of a value: absolute + relative |value|
};

/// The tables about this scene: a bundled scene, or a member of a family, of the name they give.
/// @throws scene::InputError  a table that cannot be read
std::vector<MotionTable> motionTables(const scene::Scene& scene);

struct MotionVerdict {
  double worst = 0;       ///< largest |simulated - printed|
  double worst_time = 0;  ///< where it comes closest to its limit, or passes it furthest
  double ratio = 0;       ///< there: |simulated - printed| / limit; agreement is ratio <= 1
  int values = 0;         ///< how many lay within the simulated time
};
/// The simulation must have been asked for the table's times (SimulateOptions::more_times).
MotionVerdict compareMotion(const scene::Scene& scene, const Simulation& simulation,
                            const MotionTable& table);

}  // namespace dynwitness::crosscheck
