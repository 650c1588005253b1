// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are nearly right, thousands of them: each is refused in words or read, and what is
// read is written and read again as the same scene. Under the sanitizers, too (ground_floor).
//
// DYNWITNESS_MUTATIONS=FIRST-LAST asks for those numbers instead of the usual ones: a failure names
// its own, and a night may be asked for.
#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/formats.hpp"
#include "scene/mjcf.hpp"
#include "scene/scene.hpp"
#include "tests/fixtures/mutations.hpp"

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;

namespace {

struct Reader {
  const char* suffix;
  scene::Format format;
  scene::Scene (*read)(const std::string& text, const fs::path& file);
};
std::ostream& operator<<(std::ostream& out, const Reader& reader) {
  return out << reader.suffix;
}
const std::vector<Reader> kReaders = {
    {"toml", scene::Format::kToml, scene::readSceneToml},
    {"urdf", scene::Format::kUrdf, scene::readSceneUrdf},
    {"xml", scene::Format::kMjcf, scene::readSceneMjcf},
};

std::string textOf(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Bundled scenes in the reader's format, and the files of its own tests.
std::vector<std::string> goodTexts(const Reader& reader) {
  std::vector<std::string> texts;
  for (const fs::path& file : scene::bundledScenes()) {
    try {
      const std::string text = reader.format == scene::Format::kToml
                                   ? textOf(file)
                                   : writeSceneAs(scene::readScene(file), reader.format).text;
      if (text.size() < 20000) texts.push_back(text);
    } catch (const scene::InputError&) {  // the format has no word for a joint of it
    }
  }
  const fs::path own = fs::path(DYNWITNESS_SOURCE_DIR) / "tests/scene/mjcf";
  for (const auto& entry : fs::directory_iterator(own))
    if (reader.format == scene::Format::kMjcf) texts.push_back(textOf(entry.path()));
  return texts;
}

/// What is wrong with how the text is read; "" when nothing is.
/// @param read  whether it is
std::string fault(const Reader& reader, const std::string& text, bool* read) {
  *read = false;
  const fs::path file = std::string("mutated.") + reader.suffix;
  std::string written;
  try {
    written = writeSceneToml(reader.read(text, file));
    *read = true;
  } catch (const scene::InputError& refusal) {
    return std::string(refusal.what()).find("mutated.") == std::string::npos
               ? std::string("a refusal that names no file: ") + refusal.what()
               : "";
  } catch (const std::exception& other) {
    return std::string("neither read nor refused: ") + other.what();
  }
  try {
    if (writeSceneToml(scene::readSceneToml(written, "mutated.toml")) != written)
      return "written and read again it is another scene";
  } catch (const std::exception& other) {
    return std::string("what was read cannot be read again: ") + other.what();
  }
  return "";
}

}  // namespace

BOOST_DATA_TEST_CASE(a_file_that_is_nearly_right_is_refused_in_words_or_read, data::make(kReaders),
                     reader) {
  unsigned long first = 0, last = 10000;
  if (const char* asked = std::getenv("DYNWITNESS_MUTATIONS"))
    BOOST_REQUIRE(std::sscanf(asked, "%lu-%lu", &first, &last) == 2);
  const std::vector<std::string> good = goodTexts(reader);
  BOOST_TEST_REQUIRE(good.size() > 20u);
  int read = 0;
  for (unsigned long k = first; k < last; ++k) {
    const std::string text = fixtures::mutated(good, k);
    BOOST_TEST_CHECKPOINT("mutation " << k);  // which is told when a signal ends it
    bool is_read = false;
    const std::string wrong = fault(reader, text, &is_read);
    BOOST_TEST(wrong == "", "mutation " << k << ": " << wrong);
    read += is_read ? 1 : 0;
  }
  BOOST_TEST_MESSAGE(read << " of " << last - first << " are read");
  if (last - first >= 1000) BOOST_TEST(read > static_cast<int>(last - first) / 100);
}
