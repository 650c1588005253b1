// SPDX-License-Identifier: GPL-3.0-or-later
// Files appear whole or not at all, and what others have put into the folder stays.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dynwitness::crosscheck {

/// Writes one file: first beside it under another name, then renamed into place.
/// @throws std::runtime_error  naming the file and the system's reason; nothing is left behind
void writeWholeFile(const std::filesystem::path& file, std::string_view text);

/** Looks whether writeWholeFile() can write this file, without leaving anything there: for calling
    before a long computation. An empty path is none, and passes.

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
    that, it vanishes. A folder that exists keeps all files that an earlier report did not list in
    its contents.txt. */
class UnfinishedFolder {
 public:
  explicit UnfinishedFolder(const std::filesystem::path& folder);
  ~UnfinishedFolder();
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  /// Where to write, for programs that write their files themselves.
  const std::filesystem::path& path() const { return unfinished_; }
  /// Writes a file, making its parent folders. @throws std::runtime_error
  void write(const std::filesystem::path& relative, std::string_view text) const;
  /// `last` (the page that the user opens) is renamed after all others.
  /// @throws scene::InputError    a file of somebody else is in the way; nothing was changed
  /// @throws std::runtime_error   the system refused
  void moveIntoPlace(const std::filesystem::path& last);

 private:
  std::filesystem::path folder_, unfinished_, first_created_;
  bool existed_ = false, moved_ = false;
};

}  // namespace dynwitness::crosscheck
