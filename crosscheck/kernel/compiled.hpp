// SPDX-License-Identifier: GPL-3.0-or-later
// C source to a loaded shared object, by the system's compiler, kept in a folder.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace dynwitness::crosscheck::kernel {

/// There is no C compiler, or no folder to keep its results in; the message says what was looked for.
struct CannotCompile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The C compiler: the environment variable DYNWITNESS_CC, or the first of cc, gcc, clang in PATH.
/// @throws CannotCompile
std::string findCompiler();

/// Where shared objects are kept: $DYNWITNESS_CACHE, or $XDG_CACHE_HOME/dynwitness, or
/// ~/.cache/dynwitness. Created when it is not there. @throws CannotCompile
std::filesystem::path cacheFolder();

/// A loaded shared object.
class SharedObject {
 public:
  explicit SharedObject(const std::filesystem::path& file);  ///< @throws std::runtime_error
  ~SharedObject();
  SharedObject(const SharedObject&) = delete;
  SharedObject& operator=(const SharedObject&) = delete;
  /// The address of a function. @throws std::runtime_error when there is none of that name
  void* symbol(const std::string& name) const;

 private:
  void* handle_;
};

/// How a source is compiled.
struct CompileOptions {
  std::string compiler;  ///< as from findCompiler()
  std::vector<std::string> flags;
  std::filesystem::path folder;  ///< as from cacheFolder()
};

/** Compiles each source, all at the same time, and loads what comes out.

    A source that was compiled before with the same compiler and flags is taken from the folder: files
    are named by a hash of all three and compared with the source, which is kept beside them. A file
    that does not load is made again. Files appear whole or not at all, so that two processes may share
    a folder.
    @throws CannotCompile  the compiler cannot be run or refuses the source; with its first lines */
std::vector<std::shared_ptr<SharedObject>> compileAndLoad(const std::vector<std::string>& sources,
                                                          const CompileOptions& options);

}  // namespace dynwitness::crosscheck::kernel
