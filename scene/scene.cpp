// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.hpp"
#include "scene/families.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mjcf.hpp"
#include "scene/nearest_name.hpp"
#include "scene/text_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace dynwitness::scene {
namespace {

namespace fs = std::filesystem;

/// "Double pendulum", "double-pendulum" and "double_pendulum" name the same scene.
std::string normalized(std::string name) {
  for (char& c : name) {
    if (c == ' ' || c == '-') c = '_';
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return name;
}

constexpr int kMostWindows = 200;

bool isFourBars(const std::string& name, int* windows) {
  const std::string prefix = "four_bars_";
  if (name.compare(0, prefix.size(), prefix) != 0) return false;
  const std::string digits = name.substr(prefix.size());
  if (digits.empty() || digits.size() > 3 ||
      !std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); })) {
    return false;
  }
  *windows = std::stoi(digits);
  return *windows >= 1 && *windows <= kMostWindows && std::to_string(*windows) == digits;
}

}  // namespace

Scene::Scene() = default;
Scene::Scene(const Scene&) = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(const Scene&) = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Scene fourBars(int windows) {
  std::string text = "title = \"" + std::to_string(windows) +
                     " four-bar windows (IFToMM A02)\"\n"
                     "source = \"M. Gonzalez, D. Dopico, U. Lugris, J. Cuadrado, A benchmarking "
                     "system for MBS simulation software, Multibody Syst. Dyn. 16 (2006) 179-190; "
                     "problem A02 of lim.ii.udc.es/mbsbenchmark\"\n"
                     "gravity = [0, \"-g\", 0]\n\n[parameters]\ng = 9.81\nm = 1\nl = 1\n\n"
                     "[[link]]\nname = \"ground\"\n";
  std::string q, qd, closures;
  const auto rod = [&](const std::string& name, const std::string& parent, const std::string& x) {
    text += "\n[[link]]\nname = \"" + name + "\"\nparent = \"" + parent +
            "\"\nmass = \"m\"\ncom = [\"l/2\", 0, 0]\n"
            "inertia = { yy = \"m*l^2/12\", zz = \"m*l^2/12\" }\n"
            "joint = { kind = \"revolute\", xyz = [\"" +
            x + "\", 0, 0] }\n";
  };
  for (int k = 0; k <= windows; ++k) {
    const std::string number = std::to_string(k), next = std::to_string(k + 1);
    rod("upright" + number, "ground", number + "*l");
    q += std::string(k == 0 ? "" : ", ") + "\"pi/2\"";
    qd += std::string(k == 0 ? "" : ", ") + "\"-1/l\"";  // B0 starts at 1 m/s
    if (k == windows) break;
    rod("bar" + number, "upright" + number, "l");
    q += ", \"-pi/2\"";
    qd += ", \"1/l\"";
    closures += "\n[[closure]]\nname = \"B" + next +
                "\"\nkind = \"planar_point\"\na = { link = \"bar" + number +
                "\", xyz = [\"l\", 0, 0] }\nb = { link = \"upright" + next +
                "\", xyz = [\"l\", 0, 0] }\n";
  }
  const std::string name = "four_bars_" + std::to_string(windows);
  return readSceneToml(text + closures + "\n[start]\nq = [" + q + "]\nqd = [" + qd + "]\n", name);
}

namespace {

/// Beside an installed program: bin/ and share/dynwitness/ have one parent. Empty: there is none.
fs::path installedData() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path data = program.parent_path().parent_path() / "share" / "dynwitness";
  return !error && fs::is_directory(data / "scenes", error) ? data : fs::path();
}

}  // namespace

fs::path dataFolder() {
  const char* set = std::getenv("DYNWITNESS_DATA");
  if (!set || !*set) {
    static const fs::path installed = installedData();
    return installed.empty() ? fs::path(DYNWITNESS_DATA_DIR) : installed;
  }
  std::error_code error;
  if (!fs::is_directory(set, error))
    throw InputError(
        {}, "DYNWITNESS_DATA: '" + std::string(set) +
                "' is no folder, allowed: one with the folders audit, scenes and reference");
  return set;
}

Scene readScene(const fs::path& file) {
  return readScene(file, InertiaNeed::kOfEachJoint);
}

Scene readScene(const fs::path& file, InertiaNeed need) {
  const std::string text = readTextFile(file, "a TOML, URDF or MJCF file");
  if (!looksLikeXml(text)) return readSceneToml(text, file, need);
  return isMjcf(text) ? readSceneMjcf(text, file, need) : readSceneUrdf(text, file, need);
}

std::vector<fs::path> bundledScenes() {
  std::vector<fs::path> files;
  std::error_code error;  // a folder that does not exist has no scenes
  for (const auto& entry : fs::directory_iterator(dataFolder() / "scenes", error)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".toml" || extension == ".urdf") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Scene findScene(const std::string& name_or_path) {
  return findScene(name_or_path, InertiaNeed::kOfEachJoint);
}

Scene findScene(const std::string& name_or_path, InertiaNeed need) {
  std::vector<std::string> names;
  for (const fs::path& file : bundledScenes()) {
    names.push_back(file.stem().string());
    if (normalized(names.back()) == normalized(name_or_path)) return readScene(file);
  }
  std::error_code error;
  if (fs::exists(name_or_path, error)) return readScene(name_or_path, need);
  // the small scenes of published tables are crosschecked by name as well
  for (const auto& entry : fs::directory_iterator(dataFolder() / "reference", error))
    if (entry.path().extension() == ".toml" &&
        normalized(entry.path().stem().string()) == normalized(name_or_path))
      return readScene(entry.path());
  int windows = 0;
  if (isFourBars(normalized(name_or_path), &windows)) return fourBars(windows);
  if (Scene family; findFamily(normalized(name_or_path), &family)) return family;
  throw InputError(
      {},
      "no scene and no file is called \"" + name_or_path + "\"" +
          didYouMean(normalized(name_or_path), names) + ", allowed: " +
          (names.empty() ? ""
                         : "one of the " + std::to_string(names.size()) +
                               " that `dynwitness scenes` lists, four_bars_N with N from 1 to " +
                               std::to_string(kMostWindows) +
                               ", chain_N, flat_chain_N or tree_N with N from 1 to " +
                               std::to_string(kMostFamilyLinks) + ", or ") +
          "the path of a file");
}

}  // namespace dynwitness::scene
