/// Floats of 16 bits.
#pragma once

namespace meniscus::io {

/// A number of 16 bits (1 sign, 5 exponent, 10 fraction; IEEE 754) as a float.
float float_of_half(unsigned half);

}  // namespace meniscus::io
