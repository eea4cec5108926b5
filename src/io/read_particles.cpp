#include <fmt/format.h>

#include <new>

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
  Gunzip stream(source);
  if (!options.raw.empty()) {
    stream.grow_to(believable_size(source.bytes.size()) + 1);
    return read_raw(Source{source.path, stream.bytes()}, options);
  }
  stream.grow_to(kStart);
  const Source start{source.path, stream.bytes()};
  const Format& format = format_of(start);
  if (format.reads_file) source.unsupported(fmt::format("is compressed {}", format.title), "decompress it with gunzip");
  if (format.name == "bgeo") return read_bgeo(source.path, stream, options);
  stream.grow_to(believable_size(source.bytes.size()) + 1);
  return format.read(Source{source.path, stream.bytes()}, options);
}

Particles read_any(const std::string& path, const ReadOptions& options) {
  if (options.raw.empty()) {
    // Libraries read their formats by themselves: look at the first bytes before all are fetched.
    const Bytes bytes = read_file(path, kStart);
    const Source start{path, bytes.span()};
    if (!start.starts_with("\x1f\x8b"))
      if (const Format& format = format_of(start); format.reads_file) return format.read(start, options);
  }
  const Bytes bytes = read_file(path);
  const Source source{path, bytes.span()};
  if (source.starts_with("\x1f\x8b")) return read_compressed(source, options);
  return options.raw.empty() ? format_of(source).read(source, options) : read_raw(source, options);
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
  finish(kept, particles);
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
