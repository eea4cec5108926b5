#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include "meniscus/io.h"

namespace meniscus {

FrameFollower::FrameFollower(std::vector<std::string> arguments, ReadOptions reading, Options options)
    : arguments_(std::move(arguments)), reading_(std::move(reading)), options_(std::move(options)) {}

double FrameFollower::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

namespace {

std::vector<std::string> files_of(const FramePath& frame) {
  std::vector<std::string> paths = frame.further;
  paths.push_back(frame.path);
  return paths;
}

/// What a frame is told from others by: its files and its time.
std::string key_of(const FramePath& frame) {
  std::string key;
  for (const std::string& path : files_of(frame)) key += path + '\n';
  if (frame.time) key += fmt::format("{}", *frame.time);
  return key;
}

}  // namespace

bool FrameFollower::settled(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  const auto written = error ? std::filesystem::file_time_type{} : std::filesystem::last_write_time(path, error);
  if (error) return false;  // it is gone, or not there yet
  const std::int64_t changed = written.time_since_epoch().count();
  const auto [at, is_new] = seen_.try_emplace(path);
  Seen& seen = at->second;
  if (is_new || seen.bytes != bytes || seen.changed != changed) {
    seen = {bytes, changed, now()};
    // What was there long before has settled long before.
    if (is_new) {
      const auto age = std::filesystem::file_time_type::clock::now() - written;
      seen.since -= std::max(std::chrono::duration<double>(age).count(), 0.0);
    }
  }
  return now() - seen.since >= options_.settle;
}

std::optional<FrameSequence> FrameFollower::look() {
  FrameSequence found;
  try {
    found = find_frames(arguments_, reading_);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::not_found) throw;
    return std::nullopt;
  }
  for (std::size_t i = 0; i < found.frames.size(); ++i) found.frames[i].place = i;
  // Frames are given in order: one that is not whole yet keeps back those behind it.
  const auto first_open = std::find_if(found.frames.begin(), found.frames.end(), [&](const FramePath& frame) {
    if (given_.contains(key_of(frame))) return false;
    bool whole = true;
    for (const std::string& path : files_of(frame)) whole = settled(path) && whole;
    return !whole;
  });
  found.frames.erase(first_open, found.frames.end());
  std::erase_if(found.frames, [&](const FramePath& frame) { return given_.contains(key_of(frame)); });
  if (found.frames.empty()) return std::nullopt;
  for (const FramePath& frame : found.frames) given_.insert(key_of(frame));
  return found;
}

FrameSequence FrameFollower::first() {
  const double start = now();
  while (true) {
    if (std::optional<FrameSequence> found = look()) return std::move(*found);
    if (stopped() || (options_.end_after && now() - start > *options_.end_after))
      throw Error(ErrorCode::not_found, {"no frame has come", {}, {}, arguments_.front(), {}, {}, {}});
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll));
  }
}

std::vector<FramePath> FrameFollower::further() {
  const double start = now();
  while (!stopped()) {
    if (std::optional<FrameSequence> found = look()) return std::move(found->frames);
    if (options_.end_after && now() - start > *options_.end_after) break;
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll));
  }
  return {};
}

bool FrameFollower::wait_for_change(const FramePath& frame) {
  const std::vector<std::string> paths = files_of(frame);
  std::vector<Seen> before;
  for (const std::string& path : paths) {
    settled(path);
    before.push_back(seen_[path]);
  }
  const double start = now();
  while (!stopped() && now() - start < options_.patience) {
    std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll));
    bool whole = true, changed = false;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      whole = settled(paths[i]) && whole;
      const Seen& seen = seen_[paths[i]];
      changed = changed || seen.bytes != before[i].bytes || seen.changed != before[i].changed;
    }
    if (whole && changed) return true;
  }
  return false;
}

}  // namespace meniscus
