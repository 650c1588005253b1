// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace dynwitness::scene {
namespace {

namespace fs = std::filesystem;

std::string readFile(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) {
    throw InputError({file.string(), 0}, "is a folder, allowed: a TOML or URDF file");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw InputError({file.string(), 0},
                     "cannot be read: " + std::string(std::strerror(errno ? errno : ENOENT)));
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// XML starts with '<', and TOML cannot.
bool looksLikeXml(const std::string& text) {
  const std::size_t start = text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;  // byte order mark
  const std::size_t first = text.find_first_not_of(" \t\r\n", start);
  return first != std::string::npos && text[first] == '<';
}

/// "Double pendulum", "double-pendulum" and "double_pendulum" name the same scene.
std::string normalized(std::string name) {
  for (char& c : name) {
    if (c == ' ' || c == '-') c = '_';
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return name;
}

}  // namespace

fs::path dataFolder() {
  const char* set = std::getenv("DYNWITNESS_DATA");
  return set && *set ? fs::path(set) : fs::path(DYNWITNESS_DATA_DIR);
}

Scene readScene(const fs::path& file) {
  const std::string text = readFile(file);
  return looksLikeXml(text) ? readSceneUrdf(text, file) : readSceneToml(text, file);
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
  std::string names;
  for (const fs::path& file : bundledScenes()) {
    const std::string name = file.stem().string();
    if (normalized(name) == normalized(name_or_path)) return readScene(file);
    names += (names.empty() ? "" : ", ") + name;
  }
  std::error_code error;
  if (fs::exists(name_or_path, error)) return readScene(name_or_path);
  throw InputError({}, "no scene and no file is called \"" + name_or_path + "\", allowed: " +
                           (names.empty() ? "" : names + ", or ") + "the path of a file");
}

}  // namespace dynwitness::scene
