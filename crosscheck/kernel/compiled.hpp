// SPDX-License-Identifier: GPL-3.0-or-later
// C source to a loaded shared object, by the system's compiler, kept in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace dynwitness::crosscheck::kernel {

/// There is no C compiler, or no folder to keep its results in; the message says what was looked
/// for.
struct CannotCompile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The C compiler: the environment variable DYNWITNESS_CC, which may have options after the
/// command, or the first of cc, gcc, clang in PATH. A command and its options. @throws
/// CannotCompile
std::vector<std::string> findCompiler();

/// Where shared objects are kept: $DYNWITNESS_CACHE, or $XDG_CACHE_HOME/dynwitness, or
/// ~/.cache/dynwitness. Created when it is not there. @throws CannotCompile
std::filesystem::path cacheFolder();

/// A loaded shared object.
class SharedObject {
 public:
  /// Of the bytes of a file: what happens to the file afterwards does not matter. @throws
  /// std::runtime_error
  explicit SharedObject(const std::string& bytes);
  ~SharedObject();
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;
  /// The address of a function. @throws std::runtime_error when there is none of that name
  void* symbol(const std::string& name) const;

 private:
  int file_;
  void* handle_;
};

/// How a source is compiled.
struct CompileOptions {
  std::vector<std::string> compiler;  ///< as from findCompiler()
  std::vector<std::string> flags;
  std::filesystem::path folder;  ///< as from cacheFolder()
};

/// Tries a loaded object. @return what is wrong with it, or nothing
using Trial = std::function<std::string(const SharedObject& object, std::size_t source)>;

/// The longest that a compiler, and a trial, may take [s]: ten times what ours takes for the
/// largest kernel.
inline constexpr double kMostCompileSeconds = 20;

/** Compiles each source, all at the same time, and loads what comes out.

    A source that was compiled before with the same compiler and flags is taken from the folder:
    files are named by a hash of all three. The source is kept beside the object, with the size and
    a hash of the object at its end, and written last; only when both are plain files of this user
    (or of root), which nobody else may write to, the source is the same and the object has that
    hash, it is loaded. Everything else (cut off, changed, exchanged, a folder, a link, a pipe) is
    made again; what cannot be kept is loaded all the same. Two processes may share a folder.

    What has just been compiled is tried in a copy of this process before it is loaded or kept: it
    may be rubbish.
    @throws CannotCompile  the compiler cannot be run, refuses the source, does not end, or writes
                           what cannot be loaded or fails the trial; with its first lines */
std::vector<std::shared_ptr<SharedObject>> compileAndLoad(const std::vector<std::string>& sources,
                                                          const CompileOptions& options,
                                                          const Trial& trial = {});

}  // namespace dynwitness::crosscheck::kernel
