// SPDX-License-Identifier: Apache-2.0
// Holds your answers to golden vectors of dynwitness: verify GOLDEN.csv ANSWERS.csv [FACTOR]
// (c++ -std=c++17 -o verify verify.cpp; verify.py says what is in these files and what comes out)
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>
using std::string, std::vector;

struct Group { string name, sentence, first; int judged = 0, wrong = 0; };

vector<vector<string>> lines(const string& file, char separator) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  vector<vector<string>> out;
  for (string line, cell; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    std::istringstream cells(line);
    for (out.emplace_back(); std::getline(cells, cell, separator);) out.back().push_back(cell);
    out.back().resize(10);
  }
  return out;
}
double number(const string& text) {
  char* end = nullptr;
  const double x = std::strtod(text.c_str(), &end);
  if (text.empty() || *end) throw std::runtime_error("no number: " + text);
  return x;
}

int run(const vector<string>& words) {
  if (words.size() < 2) throw std::runtime_error("verify GOLDEN.csv ANSWERS.csv [FACTOR]");
  const double factor = words.size() > 2 ? number(words[2]) : 1;
  std::map<string, string> said;
  std::set<string> known, unknown, silent;
  vector<vector<string>> answers = lines(words[1], ',');
  for (std::size_t k = 1; k < answers.size(); ++k) {
    const vector<string>& x = answers[k];
    const string place = x[0] + ',' + x[1] + ',' + x[2] + ',' + x[3];
    said[place] = x[4], known.insert(x[1]), unknown.insert(place);
  }
  vector<Group> groups;
  for (const auto& x : lines(words[0], '\n'))
    if (const auto at = x[0].find(": "); x[0].rfind("# group ", 0) == 0)
      groups.push_back({x[0].substr(8, at - 8), x[0].substr(at + 2), "", 0, 0});
  for (const auto& x : lines(words[0], ',')) {  // group,state,role,quantity,row,column,value,digits50,radius,limit
    if (x[0][0] == '#' || x[2] != "wanted") continue;
    const string place = x[1] + ',' + x[3] + ',' + x[4] + ',' + x[5];
    unknown.erase(place);
    if (!known.count(x[3])) silent.insert(x[3]);
    if (!known.count(x[3]) || x[9].empty()) continue;
    const string got = said.count(place) ? said[place] : "nan";
    const bool right = std::abs(number(got) - number(x[6])) <= number(x[9]) * factor;
    for (Group& group : groups)
      if (group.name == x[0] && ++group.judged && !right && ++group.wrong == 1)
        group.first = ", the first " + place + ": got " + got + ", wanted " + x[6] + ", limit " + x[9];
  }
  if (!unknown.empty() || said.empty())
    throw std::runtime_error(words[1] + (said.empty() ? ": no answers" : ": not asked for: " + *unknown.begin()));
  int judged = 0;
  for (const Group& x : groups) judged += x.judged;
  if (!judged) throw std::runtime_error("nothing that was answered has a limit");
  string verdict = "all right";
  for (auto group = groups.rbegin(); group != groups.rend(); ++group)
    if (group->wrong) verdict = "first to fail: " + group->name + ": " + group->sentence;
  for (const Group& x : groups)
    std::cout << x.name << ": " << x.wrong << " of " << x.judged << " numbers wrong" << x.first << "\n";
  for (const string& quantity : silent) std::cout << "not answered: " << quantity << "\n";
  std::cout << verdict << "\n";
  return verdict == "all right" ? 0 : 1;
}

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& problem) {
    return std::cerr << problem.what() << "\n", 2;
  }
}
