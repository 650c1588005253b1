// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/shard_ledger.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <regex>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/system/hash.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using scene::InputError;

constexpr std::string_view kSeal = "{\"seal\":\"",
                           kAfterSeal = "\",\"record\":", kBesides = ",\"besides\":";
constexpr std::size_t kDigits = 32;

LedgerHead headFrom(const Json& json) {
  LedgerHead head;
  head.version = json.at("version").get<std::string>();
  head.plan = json.at("plan").get<std::string>();
  head.cases = json.at("cases").get<long>();
  head.shard = json.at("shard").get<int>();
  head.shards = json.at("shards").get<int>();
  return head;
}

}  // namespace

std::string sealedLine(std::string_view record, std::string_view besides) {
  const std::string sealed = fmt::format("{}{}{}}}", record, kBesides, besides);
  return fmt::format("{}{}{}{}\n", kSeal, hashOf(sealed), kAfterSeal, sealed);
}

bool opened(std::string_view line, SealedLine* out) {
  const std::size_t begin = kSeal.size() + kDigits + kAfterSeal.size();
  if (line.size() <= begin || line.substr(0, kSeal.size()) != kSeal ||
      line.substr(kSeal.size() + kDigits, kAfterSeal.size()) != kAfterSeal)
    return false;
  const std::string_view sealed = line.substr(begin);
  if (line.substr(kSeal.size(), kDigits) != hashOf(sealed)) return false;
  const std::size_t end = sealed.rfind(kBesides);
  if (end == std::string_view::npos) return false;
  out->record = sealed.substr(0, end);
  out->besides = sealed.substr(end + kBesides.size(), sealed.size() - end - kBesides.size() - 1);
  return true;
}

std::string LedgerHead::text() const {
  return Json{
      {"version", version}, {"plan", plan}, {"cases", cases}, {"shard", shard}, {"shards", shards}}
      .dump();
}

std::optional<LedgerHead> headOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line);) {
    SealedLine parts;
    if (!opened(line, &parts)) continue;
    const Json record = Json::parse(parts.record);
    if (record.contains("plan")) return headFrom(record);
  }
  return std::nullopt;
}

ShardLedger readShardLedger(
    const fs::path& file, int index,
    const std::function<void(const LedgerEntry&, std::string_view record)>& entry) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError({file.string(), 0}, fmt::format("cannot be read: {}", std::strerror(errno)));
  ShardLedger ledger;
  ledger.file = file;
  std::uint64_t offset = 0;
  std::string line;
  for (long number = 1; std::getline(stream, line); ++number) {
    const std::uint64_t begin = offset;
    offset += line.size() + 1;
    ledger.ends_in_a_line = !stream.eof();
    if (line.empty()) continue;  // where a line without its end was left behind
    SealedLine parts;
    if (!ledger.ends_in_a_line || !opened(line, &parts)) {
      ledger.damaged.push_back(number);
      continue;
    }
    const Json record = Json::parse(parts.record);
    if (record.contains("plan")) {
      if (!ledger.has_head) ledger.head = headFrom(record);
      ledger.has_head = true;
      continue;
    }
    if (!ledger.has_head) {  // nobody knows what it is a case of
      ledger.damaged.push_back(number);
      continue;
    }
    const double seconds = Json::parse(parts.besides).at("seconds").get<double>();
    ++ledger.entries;
    ledger.seconds += seconds;
    entry({record.at("case").get<long>(), index,
           begin + static_cast<std::uint64_t>(parts.record.data() - line.data()),
           static_cast<std::uint32_t>(parts.record.size()), seconds,
           std::hash<std::string_view>()(parts.record), record.at("verdict") == "failed"},
          parts.record);
  }
  return ledger;
}

std::vector<fs::path> ledgersIn(const fs::path& folder) {
  static const std::regex name("shard-[0-9]+-of-[0-9]+\\.jsonl");
  std::vector<fs::path> files;
  for (const auto& one : fs::directory_iterator(folder))
    if (std::regex_match(one.path().filename().string(), name)) files.push_back(one.path());
  std::sort(files.begin(), files.end());
  return files;
}

GrowingLedger::GrowingLedger(const fs::path& folder, const LedgerHead& head)
    : file_(folder / fmt::format("shard-{}-of-{}.jsonl", head.shard, head.shards)) {
  std::error_code error;
  fs::create_directories(folder, error);
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw InputError({file_.string(), 0},
                     fmt::format("cannot be written: {}", std::strerror(errno)));
  struct flock whole = {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  // of the open file and not of the process, so that copies of it that end do not give it up; those
  // of a process that was killed live on for a moment
  int refused = fcntl(descriptor_, F_OFD_SETLK, &whole);
  for (int k = 0; refused != 0 && k < 20; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    refused = fcntl(descriptor_, F_OFD_SETLK, &whole);
  }
  if (refused != 0) {
    const int why = errno;
    close(descriptor_);
    throw InputError({file_.string(), 0},
                     why == EAGAIN || why == EACCES
                         ? "another process is adding to it; this shard is being done"
                         : fmt::format("cannot be locked: {}", std::strerror(why)));
  }
  char last = '\n';
  const off_t size = lseek(descriptor_, 0, SEEK_END);
  if (size > 0 && pread(descriptor_, &last, 1, size - 1) == 1 && last != '\n') add("\n");
  if (!headOf(file_)) add(sealedLine(head.text(), "{}"));
}

GrowingLedger::~GrowingLedger() {
  close(descriptor_);
}

void GrowingLedger::add(std::string_view lines) {
  const ssize_t written = write(descriptor_, lines.data(), lines.size());
  if (written == static_cast<ssize_t>(lines.size())) return;
  throw std::runtime_error(fmt::format(
      "{}: cannot be added to: {}; what it has stays, and the same command goes on from there",
      file_.string(), written < 0 ? std::strerror(errno) : "the disk is full"));
}

void GrowingLedger::settle() {
  if (fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    throw std::runtime_error(
        fmt::format("{}: is not safe on the disk: {}", file_.string(), std::strerror(errno)));
}

}  // namespace dynwitness::crosscheck
