#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "io/file_bytes.h"
#include "io/formats.h"
#include "io/join_pieces.h"
#include "io/raw.h"
#include "io/readable.h"
#include "io/readers.h"

namespace meniscus {
namespace {

using namespace io;

constexpr std::size_t kStart = std::size_t{1} << 12;  ///< bytes that tell a format

Particles read_compressed(const Source& source, const ReadOptions& options) {
  source.need_all();
  Gunzip stream(source);
  if (!options.raw.empty()) {
    stream.grow_to(believable_size(source.bytes.size()) + 1);
    return read_raw(Source{source.path, stream.bytes()}, options);
  }
  stream.grow_to(kStart);
  const Format& format = format_of(Source{source.path, stream.bytes()});
  if (format.fetching == Format::Fetching::library)
    source.unsupported(fmt::format("is compressed {}", format.title), "decompress it with gunzip");
  if (format.name == "bgeo") return read_bgeo(source.path, stream, options);
  stream.grow_to(believable_size(source.bytes.size()) + 1);
  return format.read(Source{source.path, stream.bytes()}, options);
}

Particles read_any(const std::string& path, const ReadOptions& options) {
  FileBytes bytes(path);
  const Source source = bytes.source();
  source.need(0, kStart);
  const Source start = source.part(0, std::min(kStart, source.bytes.size()));
  if (start.starts_with("\x1f\x8b")) return read_compressed(source, options);
  if (!options.raw.empty()) return read_raw(source, options);
  const Format& format = format_of(start);
  if (format.fetching == Format::Fetching::library) return format.read(start, options);
  if (format.fetching == Format::Fetching::all_before) source.need_all();
  return format.read(source, options);
}

/// A frame in several files. Which particles are kept is decided of all together: one file may hold boundaries alone.
Particles read_parts(const FramePath& frame, const ReadOptions& options) {
  ReadOptions all = options;
  all.boundaries = true;
  all.where.clear();
  Particles particles = join_pieces(1 + frame.further.size(), all, [&](std::size_t part, const ReadOptions& reading) {
    return read_particles(part == 0 ? frame.path : frame.further[part - 1], reading);
  });
  ReadOptions kept = options;
  kept.scale = 1;  // which has been applied
  const std::size_t lost = std::exchange(particles.dropped_non_finite, std::size_t{0});
  finish(kept, particles);
  particles.dropped_non_finite += lost;
  return particles;
}

}  // namespace

Particles read_frame(const FrameSequence& sequence, const FramePath& frame) {
  if (sequence.source) return sequence.source(frame);
  Particles particles =
      frame.further.empty() ? read_particles(frame.path, sequence.reading) : read_parts(frame, sequence.reading);
  if (frame.time && !particles.time) particles.time = frame.time;
  return particles;
}

Particles read_particles(const std::string& path, const ReadOptions& options) {
  try {
    Particles particles = read_any(path, options);
    finish(options, particles);
    return particles;
  } catch (const Error& error) {
    ErrorDetail detail = readable(error).detail();
    if (detail.path.empty()) detail.path = path;  // of an option that does not fit this file
    throw Error(error.code(), std::move(detail));
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit_exceeded,
                {"there is not enough memory for the frame", {}, {}, path, {}, {}, "use fewer particles a frame"});
  }
}

}  // namespace meniscus
