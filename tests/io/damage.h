/// What is done to the bytes of small files, and what may come of it: read, or refused with an error that names it.
#pragma once

#include "small_frames.h"

namespace meniscus {

enum class Outcome { read, refused };

/// Reads a file; anything else than particles of one length or an error about this file fails the test.
inline Outcome outcome_of(const std::string& path, const ReadOptions& options = {}) {
  try {
    const Particles particles = read_particles(path, options);
    EXPECT_EQ(particles.y.size(), particles.size());
    EXPECT_EQ(particles.z.size(), particles.size());
    for (const Attribute& attribute : particles.attributes)
      EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components));
    return Outcome::read;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return Outcome::refused;
  }
}

/// Reads every `step`th prefix. Those shorter than `least_whole` bytes must be refused.
inline void check_prefixes(const std::string& name, const std::string& bytes, std::size_t least_whole,
                           std::size_t step = 1) {
  const Scratch scratch;
  ASSERT_EQ(outcome_of(scratch.write(name, bytes)), Outcome::read);
  for (std::size_t size = 0; size < bytes.size(); size += step) {
    const Outcome outcome = outcome_of(scratch.write(name, std::string_view(bytes).substr(0, size)));
    if (size < least_whole) {
      ASSERT_EQ(outcome, Outcome::refused) << name << ": " << size << " of " << bytes.size() << " bytes";
    }
  }
}

/// Reads copies with one byte changed.
inline void check_changed_bytes(const std::string& name, const std::string& bytes, std::size_t step = 1) {
  const Scratch scratch;
  for (std::size_t at = 0; at < bytes.size(); at += step)
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      outcome_of(scratch.write(name, damaged));
    }
}

/// Reads a file that must be refused without the process growing by more than `mebibytes`.
inline Error refused_within(const std::string& path, std::uint64_t mebibytes) {
  const std::uint64_t before = peak_rss_bytes();
  Error error = refused(path);
  EXPECT_LT(peak_rss_bytes() - before, mebibytes << 20) << path;
  return error;
}

/// `bytes` with `now` in place of the first `was`, of the same length where both have one.
inline std::string replaced(std::string bytes, std::string_view was, std::string_view now) {
  const std::size_t at = bytes.find(was);
  EXPECT_NE(at, std::string::npos) << was;
  if (at != std::string::npos) bytes.replace(at, was.size(), now);
  return bytes;
}

}  // namespace meniscus
