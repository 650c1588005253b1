// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/compiled.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "crosscheck/system/children.hpp"
#include "crosscheck/system/hash.hpp"
#include "crosscheck/system/leaving.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// The file of a command: as given when it has a slash, else the first in PATH.
fs::path inPath(const std::string& command) {
  const auto runs = [](const fs::path& file) {
    std::error_code unreadable;  // somebody else's folder may be in the PATH
    return fs::is_regular_file(file, unreadable) && access(file.c_str(), X_OK) == 0;
  };
  if (command.find('/') != std::string::npos) return runs(command) ? fs::path(command) : fs::path();
  std::istringstream folders(environment("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && runs(fs::path(folder) / command)) return fs::path(folder) / command;
  return {};
}

/// More than any kernel has.
constexpr off_t kLargestObject = 64 << 20;

/// What is in a plain file of this user's own (or of root's) that nobody else may write to; nothing
/// is waited for, and no link is followed. Nothing: there is no such file, or it is larger than
/// expected
std::optional<std::string> contents(const fs::path& file, off_t most) {
  const int in = open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (in < 0) return {};
  struct stat about;
  std::string text;
  bool good = fstat(in, &about) == 0 && S_ISREG(about.st_mode) && about.st_size <= most &&
              (about.st_uid == geteuid() || about.st_uid == 0) &&
              !(about.st_mode & (S_IWGRP | S_IWOTH));
  if (good) {
    text.resize(static_cast<std::size_t>(about.st_size));
    std::size_t at = 0;
    for (ssize_t got; at < text.size() && (got = read(in, &text[at], text.size() - at)) > 0;)
      at += static_cast<std::size_t>(got);
    good = at == text.size();
  }
  close(in);
  if (!good) return {};
  return text;
}

/// Writes a file that nobody else may change. @throws CannotCompile
void write(const fs::path& file, const std::string& text) {
  const int out = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);
  std::size_t at = 0;
  for (ssize_t done;
       out >= 0 && at < text.size() && (done = ::write(out, &text[at], text.size() - at)) > 0;)
    at += static_cast<std::size_t>(done);
  const int error = errno;
  if (out < 0 || close(out) != 0 || at < text.size())
    throw CannotCompile(
        fmt::format("{}: cannot be written: {}", file.string(), std::strerror(error)));
}

std::string inWords(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// One source on its way.
struct Job {
  std::string source;
  fs::path name;      ///< in the folder, without extension
  std::string draft;  ///< name of its files in the temporary folder, without extension
  std::optional<Child> compiler;
  std::shared_ptr<SharedObject> result;

  fs::path with(const char* extension) const { return fs::path(name) += extension; }
  /// The source as it is kept.
  std::string record(const std::string& object) const {
    return fmt::format("{}/* {} bytes, {} */\n", source, object.size(), hashOf(object));
  }

  bool fromFolder() {
    const std::optional<std::string> kept =
        contents(with(".c"), static_cast<off_t>(source.size()) + 100);
    if (!kept || kept->compare(0, source.size(), source) != 0) return false;
    const std::optional<std::string> object = contents(with(".so"), kLargestObject);
    if (!object || *kept != record(*object)) return false;
    try {
      result = std::make_shared<SharedObject>(*object);
      return true;
    } catch (const std::runtime_error&) {
      return false;  // made by another machine's compiler
    }
  }
};

void start(Job& job, const CompileOptions& options, const fs::path& drafts) {
  write(drafts / (job.draft + ".c"), job.source);
  std::vector<std::string> words = options.compiler;
  words.insert(words.end(), options.flags.begin(), options.flags.end());
  for (const std::string& word :
       {std::string("-o"), job.draft + ".so", job.draft + ".c", std::string("-lm")})
    words.push_back(word);
  ChildOptions how;
  how.folder = drafts;
  how.seconds = kMostCompileSeconds;
  how.environment = {{"TMPDIR", drafts.string()}, {"LC_ALL", "C"}};  // its drafts go with ours
  job.compiler.emplace(words, how);
}

/// The object that the compiler has made, loaded. @throws CannotCompile
std::string finish(Job& job, const CompileOptions& options, const fs::path& drafts,
                   const Trial& trial, std::size_t index) {
  const Ending ending = job.compiler->wait();
  if (!ending.problem.empty()) throw CannotCompile(ending.problem);
  const fs::path file = drafts / (job.draft + ".so");
  chmod(file.c_str(), 0700);
  const std::optional<std::string> object = contents(file, kLargestObject);
  const auto refuse = [&](const std::string& why) {
    throw CannotCompile(fmt::format("{}: {}", inWords(options.compiler), why));
  };
  if (!object) refuse("it wrote no shared object");
  const std::string problem = triedInCopy(
      [&] {
        const SharedObject loaded(*object);
        return trial ? trial(loaded, index) : std::string();
      },
      kMostCompileSeconds);
  if (!problem.empty()) refuse("what it wrote is of no use: " + problem);
  job.result = std::make_shared<SharedObject>(*object);
  return *object;
}

/// Keeps an object for the next time. Where that is not possible, it is made again the next time.
void keep(const Job& job, const std::string& object, const fs::path& drafts) {
  try {
    const fs::path record = drafts / (job.draft + ".txt");
    write(record, job.record(object));
    // the object first: a source whose object is another's is made again
    fs::rename(drafts / (job.draft + ".so"), job.with(".so"));
    fs::rename(record, job.with(".c"));
  } catch (const std::exception&) {
  }
}

}  // namespace

std::vector<std::string> findCompiler() {
  std::istringstream chosen(environment("DYNWITNESS_CC"));
  std::vector<std::string> words;
  for (std::string word; chosen >> word;) words.push_back(word);
  if (!words.empty()) {
    const fs::path file = inPath(words[0]);
    if (file.empty())
      throw CannotCompile(
          fmt::format("DYNWITNESS_CC: '{}' is no program that can be run", words[0]));
    words[0] = file.string();
    return words;
  }
  for (const char* command : {"cc", "gcc", "clang"})
    if (const fs::path file = inPath(command); !file.empty()) return {file.string()};
  throw CannotCompile(
      "no C compiler: looked for cc, gcc and clang in PATH (install gcc, or name one in DYNWITNESS_CC)");
}

fs::path cacheFolder() {
  fs::path folder = environment("DYNWITNESS_CACHE");
  if (folder.empty() && !environment("XDG_CACHE_HOME").empty())
    folder = fs::path(environment("XDG_CACHE_HOME")) / "dynwitness";
  if (folder.empty() && !environment("HOME").empty())
    folder = fs::path(environment("HOME")) / ".cache" / "dynwitness";
  if (folder.empty())
    throw CannotCompile(
        "no cache folder: none of DYNWITNESS_CACHE, XDG_CACHE_HOME and HOME is set");
  std::error_code error;
  const bool is_new = fs::create_directories(folder, error);
  if (is_new) fs::permissions(folder, fs::perms::owner_all, error);
  struct stat about;
  if (stat(folder.c_str(), &about) != 0 || !S_ISDIR(about.st_mode) ||
      access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    throw CannotCompile(fmt::format("{}: not a folder that can be written", folder.string()));
  // what lies there is loaded and run
  if ((about.st_uid != geteuid() && about.st_uid != 0) || (about.st_mode & S_IWOTH))
    throw CannotCompile(fmt::format(
        "{}: others can write there, expected a folder of the user's own", folder.string()));
  return folder;
}

SharedObject::SharedObject(const std::string& bytes)
    : file_(memfd_create("dynwitness-kernel", MFD_CLOEXEC)) {
  if (file_ < 0) throw std::runtime_error(fmt::format("memfd_create: {}", std::strerror(errno)));
  std::size_t at = 0;
  for (ssize_t done;
       at < bytes.size() && (done = ::write(file_, &bytes[at], bytes.size() - at)) > 0;)
    at += static_cast<std::size_t>(done);
  // open for as long as it is loaded: the loader knows it by this name
  handle_ = at == bytes.size()
                ? dlopen(fmt::format("/proc/self/fd/{}", file_).c_str(), RTLD_NOW | RTLD_LOCAL)
                : nullptr;
  if (!handle_) {
    const std::string error = at == bytes.size() ? dlerror() : std::strerror(errno);
    close(file_);
    throw std::runtime_error(error);
  }
}
SharedObject::~SharedObject() {
  dlclose(handle_);
  close(file_);
}

void* SharedObject::symbol(const std::string& name) const {
  void* address = dlsym(handle_, name.c_str());
  if (!address) throw std::runtime_error(fmt::format("shared object: no function {}", name));
  return address;
}

std::vector<std::shared_ptr<SharedObject>> compileAndLoad(const std::vector<std::string>& sources,
                                                          const CompileOptions& options,
                                                          const Trial& trial) {
  const std::string how = inWords(options.compiler) + " " + inWords(options.flags);
  // one that has failed is not asked again: it may be one that hangs, whoever wants its code
  static std::map<std::string, std::string> failures;
  std::optional<DraftFolder> drafts;  // goes after the compilers that write there
  std::vector<Job> jobs(sources.size());
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    // the first line says how, so that the kept source tells other flags apart
    jobs[i].source = fmt::format("/* {} */\n{}", how, sources[i]);
    jobs[i].name = options.folder / hashOf(jobs[i].source);
    jobs[i].draft = fmt::format("kernel{}", i);
    if (!jobs[i].fromFolder()) missing.push_back(i);
  }
  if (!missing.empty()) {
    for (const std::size_t i : missing)
      if (const auto it = failures.find(jobs[i].source); it != failures.end())
        throw CannotCompile(it->second);
    std::size_t at = 0;
    try {
      drafts.emplace(options.folder, "draft");
      for (const std::size_t i : missing) start(jobs[i], options, drafts->path());
      for (; at < missing.size(); ++at) {
        Job& job = jobs[missing[at]];
        keep(job, finish(job, options, drafts->path(), trial, missing[at]), drafts->path());
      }
    } catch (const std::exception& error) {
      if (at < missing.size()) failures[jobs[missing[at]].source] = error.what();
      throw CannotCompile(error.what());
    }
  }
  std::vector<std::shared_ptr<SharedObject>> results;
  for (Job& job : jobs) results.push_back(job.result);
  return results;
}

}  // namespace dynwitness::crosscheck::kernel
