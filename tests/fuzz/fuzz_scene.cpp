// SPDX-License-Identifier: GPL-3.0-or-later
// A reader of scenes under libFuzzer: that of the format FUZZ_FORMAT (scene::Format).
#include "tests/fixtures/near_files.hpp"
#include "tests/fuzz/target.hpp"

using namespace dynwitness;

namespace {

const fixtures::FileReader& reader() {
  return fixtures::fileReaders()[FUZZ_FORMAT];
}
const std::vector<std::string>& good() {
  static const std::vector<std::string> texts = fixtures::goodTexts(reader());
  return texts;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  fuzz::writeSeedsIfAsked(*count, *words, good());
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return fuzz::mutate(data, size, most, seed, good());
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bool read = false;
  fuzz::require(fixtures::readerFault(reader(), std::string(data, data + size), &read));
  return 0;
}
