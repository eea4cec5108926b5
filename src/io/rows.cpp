#include "io/rows.h"

#include "io/file_bytes.h"

namespace meniscus::io {

void convert_rows(const RowParts& rows, std::endian order, const char* bytes, std::size_t begin, std::size_t end) {
  for (const RowPart& part : rows.parts)
    convert_columns(part.type, order, bytes + part.offset, rows.stride, end - begin, part.components,
                    part.target + begin * part.components);
}

void read_rows(const RowParts& rows, std::endian order, std::size_t count) {
  for_each_piece(
      rows.first, rows.stride, rows.stride, count,
      [&](std::size_t begin, std::size_t end, const char* bytes) { convert_rows(rows, order, bytes, begin, end); });
}

}  // namespace meniscus::io
