// SPDX-License-Identifier: GPL-3.0-or-later
// Files appear whole or not at all, and what others have put into the folder stays.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "crosscheck/system/leaving.hpp"

namespace dynwitness::crosscheck {

/// The name of no file: what is written under it goes to standard output.
inline constexpr const char* kStandardOutput = "-";

/// Writes one file: first beside it under another name, then renamed into place.
/// @throws std::runtime_error  naming the file and the system's reason; nothing is left behind, and
/// what a
///                             KILL left behind goes with the next writing of that file
void writeWholeFile(const std::filesystem::path& file, std::string_view text);

/** Looks whether writeWholeFile() can write this file, without leaving anything there: for calling
    before a long computation. An empty path is none, and passes. From kStandardOutput on, what the
    program prints otherwise goes to standard error, so that the file is alone there.

    @throws scene::InputError  its folder does not exist or cannot be written to, or something that
    is no file (a folder, a device) has this name */
void requireWritableFile(const std::filesystem::path& file);

/** Looks whether files can be written to `folder`, without leaving anything there: for calling
    before a long computation.

    @throws scene::InputError  the folder (or where it would be made) cannot be written to, or is a
                               file */
void requireWritableFolder(const std::filesystem::path& folder);

/** Looks whether a report can be written to `folder`, without leaving anything there: for calling
    before a long computation.

    @throws scene::InputError  the folder (or where it would be made) cannot be written to, is a
    file, or holds an index.html etc. that dynwitness did not write */
void requireWritable(const std::filesystem::path& folder);

/** A folder in the making, beside (or inside) the place where it will appear.

    Everything is written here first; moveIntoPlace() then renames it into place. Destroyed without
    that, it vanishes; after a KILL, with the next report. A folder that exists keeps all files that
    an earlier report did not list in its contents.txt.

    Where a folder holds nothing but an earlier report, the two are exchanged in one step, so that
    even a KILL finds one of them whole. Where other files are in it, where it is the working
    directory, somebody else's, or on another disk than the folder around it, its files are
    exchanged one by one, and INT, TERM and HUP wait for that. */
class UnfinishedFolder {
 public:
  explicit UnfinishedFolder(const std::filesystem::path& folder);
  ~UnfinishedFolder();
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  /// Where to write, for programs that write their files themselves.
  const std::filesystem::path& path() const { return draft_->path(); }
  /// Writes a file, making its parent folders. @throws std::runtime_error
  void write(const std::filesystem::path& relative, std::string_view text) const;
  /// `last` (the page that the user opens) is renamed after all others.
  /// @throws scene::InputError    a file of somebody else is in the way; nothing was changed
  /// @throws std::runtime_error   the system refused
  void moveIntoPlace(const std::filesystem::path& last);

 private:
  bool exchange();  ///< @return false: not possible, and nothing was changed

  std::filesystem::path folder_, first_created_;
  std::optional<DraftFolder> draft_;
  bool existed_ = false, moved_ = false;
};

}  // namespace dynwitness::crosscheck
