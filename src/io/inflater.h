/// What unpacks whole blocks of deflated bytes: libdeflate, which takes half the time of zlib but all bytes at once.
#pragma once

#include <libdeflate.h>

#include <memory>
#include <new>

namespace meniscus::io {

using Inflater = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;

/// For one thread.
/// @throws std::bad_alloc
inline Inflater make_inflater() {
  Inflater inflater(libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!inflater) throw std::bad_alloc();
  return inflater;
}

}  // namespace meniscus::io
