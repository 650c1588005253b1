// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/compiled.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

extern char** environ;

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
    return fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0;
  };
  if (command.find('/') != std::string::npos) return runs(command) ? fs::path(command) : fs::path();
  std::istringstream folders(environment("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && runs(fs::path(folder) / command)) return fs::path(folder) / command;
  return {};
}

/// 128 bits of FNV-1a from two starts. Files are compared besides, so a collision costs time alone.
std::string hashOf(const std::string& text) {
  std::uint64_t a = 0xcbf29ce484222325u, b = 0x84222325cbf29ce4u;
  for (const unsigned char c : text) {
    a = (a ^ c) * 0x100000001b3u;
    b = (b ^ c ^ (b >> 29)) * 0x100000001b3u;
  }
  return fmt::format("{:016x}{:016x}", a, b);
}

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw CannotCompile(fmt::format("{}: cannot be written", file.string()));
}

/// One source on its way.
struct Job {
  std::string source;
  fs::path name;                           ///< in the folder, without extension
  fs::path draft, c, object, messages;     ///< drafts, unique to this process
  pid_t process = -1;
  std::shared_ptr<SharedObject> result;

  fs::path with(const char* extension) const { return fs::path(name) += extension; }

  bool fromFolder() {
    if (contents(with(".c")) != source) return false;
    try {
      result = std::make_shared<SharedObject>(with(".so"));
      return true;
    } catch (const std::runtime_error&) {
      return false;  // cut off, or of another machine: made again
    }
  }
};

void start(Job& job, const CompileOptions& options) {
  static int counter = 0;
  job.draft = fs::path(job.name) += fmt::format(".{}.{}", getpid(), ++counter);
  job.c = fs::path(job.draft) += ".c";
  job.object = fs::path(job.draft) += ".so";
  job.messages = fs::path(job.draft) += ".txt";
  write(job.c, job.source);
  std::vector<std::string> words = {options.compiler};
  words.insert(words.end(), options.flags.begin(), options.flags.end());
  for (const std::string& word : {std::string("-o"), job.object.string(), job.c.string(), std::string("-lm")})
    words.push_back(word);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, job.messages.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int failed =
      posix_spawn(&job.process, options.compiler.c_str(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed) {
    job.process = -1;
    throw CannotCompile(fmt::format("{}: cannot be run: {}", options.compiler, std::strerror(failed)));
  }
}

/// Waits for the compiler. @return what it said when it failed, else ""
std::string finish(Job& job) {
  if (job.process < 0) return "";
  int status = 0;
  while (waitpid(job.process, &status, 0) < 0 && errno == EINTR) {
  }
  job.process = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  const std::string said = contents(job.messages).substr(0, 600);
  return said.empty() ? "it failed without a word" : said;
}

void removeDrafts(const Job& job) {
  std::error_code ignored;
  for (const fs::path& file : {job.c, job.object, job.messages})
    if (!file.empty()) fs::remove(file, ignored);
}

}  // namespace

std::string findCompiler() {
  const std::string chosen = environment("DYNWITNESS_CC");
  if (!chosen.empty()) {
    const fs::path file = inPath(chosen);
    if (file.empty())
      throw CannotCompile(fmt::format("DYNWITNESS_CC: '{}' is no program that can be run", chosen));
    return file.string();
  }
  for (const char* command : {"cc", "gcc", "clang"})
    if (const fs::path file = inPath(command); !file.empty()) return file.string();
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
    throw CannotCompile("no cache folder: none of DYNWITNESS_CACHE, XDG_CACHE_HOME and HOME is set");
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

SharedObject::SharedObject(const fs::path& file) : handle_(dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) throw std::runtime_error(dlerror());
}
SharedObject::~SharedObject() { dlclose(handle_); }

void* SharedObject::symbol(const std::string& name) const {
  void* address = dlsym(handle_, name.c_str());
  if (!address) throw std::runtime_error(fmt::format("shared object: no function {}", name));
  return address;
}

std::vector<std::shared_ptr<SharedObject>> compileAndLoad(const std::vector<std::string>& sources,
                                                          const CompileOptions& options) {
  std::string how = options.compiler;
  for (const std::string& flag : options.flags) how += " " + flag;
  std::vector<Job> jobs(sources.size());
  std::string failure;
  try {
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      // the first line says how, so that the kept source tells other flags apart
      jobs[i].source = fmt::format("/* {} */\n{}", how, sources[i]);
      jobs[i].name = options.folder / hashOf(jobs[i].source);
      if (!jobs[i].fromFolder()) start(jobs[i], options);
    }
  } catch (const CannotCompile& error) {
    failure = error.what();
  }
  for (Job& job : jobs) {
    const std::string said = finish(job);
    if (!said.empty() && failure.empty()) failure = options.compiler + ": " + said;
  }
  if (failure.empty()) {
    for (Job& job : jobs) {
      if (job.result) continue;
      // the object first: who finds the source finds the object that belongs to it
      std::error_code error;
      fs::rename(job.object, job.with(".so"), error);
      if (!error) fs::rename(job.c, job.with(".c"), error);
      if (error) {
        failure = fmt::format("{}: {}", job.with(".so").string(), error.message());
        break;
      }
      job.result = std::make_shared<SharedObject>(job.with(".so"));
    }
  }
  std::vector<std::shared_ptr<SharedObject>> results;
  for (Job& job : jobs) {
    removeDrafts(job);
    results.push_back(job.result);
  }
  if (!failure.empty()) throw CannotCompile(failure);
  return results;
}

}  // namespace dynwitness::crosscheck::kernel
