// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/number_table.hpp"

#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

namespace dynwitness::cli {

NumberTable::NumberTable(const std::vector<std::string>& names, bool is_json,
                         const std::string& comment)
    : is_json_(is_json) {
  if (!is_json) header_ = comment;
  for (const std::string& name : names) {
    const char* before = keys_.empty() ? "" : ",";
    keys_.push_back(is_json ? (keys_.empty() ? "{" : ",") + nlohmann::json(name).dump() + ":"
                            : before);
    if (!is_json) header_ += before + name;
  }
  if (!is_json) header_ += '\n';
}

void NumberTable::append(double value, std::string* row) {
  char digits[32];  // 17 digits, a sign, a point and an exponent are 24
  const auto end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 17).ptr;
  *row += keys_[at_++];
  row->append(digits, end);
}

void NumberTable::append(const std::string& cell, std::string* row) {
  *row += keys_[at_++];
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool is_number =
      error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value);
  *row += !is_json_ ? cell : is_number ? nlohmann::json(value).dump() : nlohmann::json(cell).dump();
}

void NumberTable::end(std::string* row) {
  *row += is_json_ ? "}\n" : "\n";
  at_ = 0;
}

}  // namespace dynwitness::cli
