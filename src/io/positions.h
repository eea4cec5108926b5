/// Positions from columns of any type: scaled, and counted from an origin near them where floats would lose digits.
#pragma once

#include <array>

#include "io/rows.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// One column of numbers; need not be aligned.
struct Column {
  Stored first;
  std::size_t stride = 0;  ///< bytes from row to row
};

/// Fills x, y, z and origin of particles from three columns of one type.
/// Floats without a scale are taken over bit by bit. Of doubles the origin is options.origin, else zero, or a round
/// number amidst the positions where they are more than kFar times as far away as they are spread.
/// particles.dropped_non_finite becomes the number of coordinates that are NaN or infinite: finish() leaves their
/// particles out and counts these.
/// @param beside  other values of the same rows, which are converted in the same pass
/// @throws Error  as FileBytes::fetch()
void set_positions(Scalar type, std::endian order, const std::array<Column, 3>& columns, std::size_t rows,
                   const ReadOptions& options, Particles& particles, const RowParts& beside = {});

/// The same from interleaved doubles that a reader has parsed (text): 3 a row.
void set_positions(std::span<const double> values, const ReadOptions& options, Particles& particles);

}  // namespace meniscus::io
