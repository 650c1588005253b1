// SPDX-License-Identifier: GPL-3.0-or-later
// The reader of states under libFuzzer. It reads regular files: one, written anew for each text.
#include "tests/fixtures/files.hpp"
#include "tests/fixtures/near_states.hpp"
#include "tests/fuzz/target.hpp"

using namespace dynwitness;

extern "C" int LLVMFuzzerInitialize(int* count, char*** words) {
  fuzz::writeSeedsIfAsked(*count, *words, fixtures::kGoodStates);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return fuzz::mutate(data, size, most, seed, fixtures::kGoodStates);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const files::TemporaryFolder folder;
  const std::filesystem::path file = folder.path / "states.csv";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  bool read = false;
  fuzz::require(fixtures::statesFault(file, &read));
  return 0;
}
