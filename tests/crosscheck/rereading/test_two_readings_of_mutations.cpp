// SPDX-License-Identifier: GPL-3.0-or-later
// Both readers of TOML and URDF on thousands of files that are nearly right: what the first one
// reads as a scene, the second one reads as the same numbers at the same places, or one of them is
// wrong. Neither expects anything of the text itself.
//
// DYNWITNESS_MUTATIONS=FIRST-LAST asks for those numbers instead of the usual ones.
#include "crosscheck/verdicts/check_reading.hpp"

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/error.hpp"
#include "tests/fixtures/mutations.hpp"
#include "tests/fixtures/near_files.hpp"

namespace data = boost::unit_test::data;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

namespace {

std::optional<scene::Scene> sceneOf(const fixtures::FileReader& reader, const std::string& text) {
  try {
    return reader.read(text, std::string("mutated.") + reader.suffix);
  } catch (const scene::InputError&) {
    return std::nullopt;
  }
}

/// What the second reading says against the first one.
std::string dispute(const scene::Scene& scene, const std::string& text) {
  try {
    std::string against;
    for (const CheckResult& check :
         compareReading(scene, PreparedScene(scene).model<RunningError>(),
                        rereading::described(text, scene.file, scene::bundledScenes()), 1))
      if (check.verdict == Verdict::kDisagree)
        against += check.quantity + ": " + check.reason + "\n";
    return against;
  } catch (const std::exception& failure) {
    return std::string("cannot be read a second time: ") + failure.what();
  }
}

}  // namespace

BOOST_DATA_TEST_CASE(what_one_reader_reads_the_other_reads_alike, data::xrange(2), format) {
  unsigned long first = 0, last = 20000;
  if (const char* asked = std::getenv("DYNWITNESS_MUTATIONS"))
    BOOST_REQUIRE(std::sscanf(asked, "%lu-%lu", &first, &last) == 2);
  const fixtures::FileReader& reader = fixtures::fileReaders()[static_cast<std::size_t>(format)];
  const std::vector<std::string> good = fixtures::goodTexts(reader);
  int read = 0;
  for (unsigned long k = first; k < last; ++k) {
    const std::string text = fixtures::mutated(good, k);
    BOOST_TEST_CHECKPOINT("mutation " << k << " of " << reader.suffix);
    const std::optional<scene::Scene> scene = sceneOf(reader, text);
    if (!scene) continue;
    ++read;
    const std::string against = dispute(*scene, text);
    BOOST_TEST(against == "", "mutation " << k << " of " << reader.suffix << ": " << against);
  }
  BOOST_TEST_MESSAGE(read << " of " << last - first << " are read");
  if (last - first >= 1000) BOOST_TEST(read > static_cast<int>(last - first) / 100);
}
