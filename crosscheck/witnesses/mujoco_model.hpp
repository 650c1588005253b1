// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo's objects with owners, for those that are built with MuJoCo.
#pragma once

#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

namespace dynwitness::crosscheck {

/// MuJoCo's own rule for principal axes (eigEPS of mju_eig3): Jacobi turns stop when the cosine of
/// the next one exceeds 1 - this, that is with up to sqrt(2 kMujocoTurnStop) rad still to turn.
inline constexpr double kMujocoTurnStop = 1e-12;

struct MujocoDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};
template <typename T>
using MujocoOwned = std::unique_ptr<T, MujocoDeleter>;

/// MuJoCo's own answers are to write MUJOCO_LOG.TXT, and on errors to wait for a key and exit.
inline void installMujocoHandlers() {
  mju_user_warning = [](const char*) {};  // counted in mjData::warning
  mju_user_error = [](const char* text) { throw std::runtime_error(text); };
}

/** What its compiler makes of a file that exists in memory only.
    @param file   a name for it
    @param error  why there is none, where null is returned */
inline MujocoOwned<mjModel> mujocoModelOf(const std::string& text, const char* file,
                                          std::string* error) {
  const MujocoOwned<mjVFS> files(new mjVFS);
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), file, static_cast<int>(text.size())) != 0) {
    *error = "the file is too large for its virtual folder";
    return nullptr;
  }
  std::memcpy(files->filedata[0], text.data(), text.size());
  char said[1000] = "";
  MujocoOwned<mjModel> model(mj_loadXML(file, files.get(), said, sizeof said));
  if (!model) *error = said;
  return model;
}

}  // namespace dynwitness::crosscheck
