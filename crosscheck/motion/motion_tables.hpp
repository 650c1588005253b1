// SPDX-License-Identifier: GPL-3.0-or-later
// Published motions (data/reference/motion/): positions at given times, from somebody else's
// simulation, or by a road of our own that shares nothing with simulate().
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/simulate.hpp"

namespace dynwitness::crosscheck {

/// One file; its layout is in data/reference/README.md.
struct MotionTable {
  struct Column {
    enum class Of { kPosition, kRate, kMultiplier, kPoint };
    std::string name;  ///< "q1", "eps^2/L lambda1", "rod3 (0, 0, l) x"
    Of of = Of::kPoint;
    int index = -1;           ///< of q, qd or lambda (from 0), or
    scene::Attachment point;  ///< a point of a link,
    int axis = 0;             ///< its x, y or z in the world
    double scale = 1;         ///< printed value = scale times ours
    std::string unit;         ///< "rad", "m/s", "1" of a quaternion; "" of multipliers and scaled
  };
  struct Row {
    double time;
    std::vector<double> values;
  };
  std::string title, source;
  std::string own;     ///< where the figures come from that nobody prints; empty: they are printed
  std::string note;    ///< why the limit
  scene::Scene scene;  ///< what is moved
  std::vector<Column> columns;
  std::vector<Row> rows;
  double step_error = 0;              ///< that it takes to meet the limit; 0: any will do
  double absolute = 0, relative = 0;  ///< limit of a value: absolute + relative |value|

  double duration() const;  ///< time of the last row [s]
};

/// The tables that move this scene: a bundled scene, or a member of a family, named there,
/// or the scene file beside them.
/// @throws scene::InputError  a table that cannot be read
std::vector<MotionTable> motionTables(const scene::Scene& scene);
/// Those that stand in the report of this scene: they name it, and move it or the file beside them.
std::vector<MotionTable> reportedMotionTables(const scene::Scene& scene);

struct MotionVerdict {
  /// The value of a column that lies closest to its limit, or passes it furthest.
  struct Entry {
    int column = 0;
    double time = 0, printed = 0, simulated = 0, limit = 0;
    double largest = 0;  ///< |printed| of that column

    double difference() const;
    double ratio() const { return difference() / limit; }
    /// Decimal digits to which the two agree, counted against the largest printed; 17 at most.
    double digits() const;
  };
  std::vector<Entry> entries;  ///< one a column that has values
  double worst = 0;            ///< largest |simulated - printed|
  double worst_time = 0;       ///< where it comes closest to its limit, or passes it furthest
  double ratio = 0;            ///< there: |simulated - printed| / limit; agreement is ratio <= 1
  int values = 0;              ///< how many lay within the simulated time
};
/// The simulation must have been asked for the table's times (SimulateOptions::more_times).
MotionVerdict compareMotion(const scene::Scene& scene, const Simulation& simulation,
                            const MotionTable& table);

/// What simulate() must be asked so that the table's limit can be met: its times, its duration, its
/// error of a step.
SimulateOptions optionsFor(const MotionTable& table);

}  // namespace dynwitness::crosscheck
