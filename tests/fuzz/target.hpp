// SPDX-License-Identifier: GPL-3.0-or-later
// What the fuzz targets share: their seeds and their mutations are those of the mutation tests.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/fixtures/mutations.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace dynwitness::fuzz {

/// Ends the run, which keeps the text.
inline void require(const std::string& wrong) {
  if (wrong.empty()) return;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  std::abort();
}

/// With the argument --seeds=FOLDER: writes the seeds there, and ends.
inline void writeSeedsIfAsked(int count, char** words, const std::vector<std::string>& good) {
  const std::string key = "--seeds=";
  for (int i = 1; i < count; ++i) {
    if (std::string(words[i]).compare(0, key.size(), key) != 0) continue;
    const std::filesystem::path folder = words[i] + key.size();
    for (std::size_t k = 0; k < good.size(); ++k)
      std::ofstream(folder / std::to_string(k), std::ios::binary) << good[k];
    std::exit(0);
  }
}

/// Bytes as the fuzzer changes them, or words and lines as the mutation tests do, also from others.
inline std::size_t mutate(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed,
                          const std::vector<std::string>& good) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  std::vector<std::string> two = {std::string(data, data + size)};
  if (seed % 8 == 1) two.push_back(good[seed / 8 % good.size()]);
  const std::string text = fixtures::mutated(two, seed);
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}

}  // namespace dynwitness::fuzz
