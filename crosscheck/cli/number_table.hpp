// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of numbers as CSV, or as JSON with an object a line.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::cli {

/// Rows of numbers under these names: CSV, or an object a line.
class NumberTable {
 public:
  /// @param comment  a line before those of CSV
  NumberTable(const std::vector<std::string>& names, bool is_json, const std::string& comment);
  const std::string& header() const { return header_; }
  /// A number at full double precision.
  void append(double value, std::string* row);
  /// What a file has, as it stands there; in JSON a number where it is one.
  void append(const std::string& cell, std::string* row);
  void end(std::string* row);

 private:
  bool is_json_;
  std::string header_;
  std::vector<std::string> keys_;  ///< what stands before each number
  std::size_t at_ = 0;
};

}  // namespace dynwitness::cli
