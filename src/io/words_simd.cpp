#include "io/words.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "io/words_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus::io {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
constexpr std::size_t kWord = sizeof(float);

template <bool kSwap>
HWY_INLINE float word_at(const char* bytes) {
  std::uint32_t bits = 0;
  hwy::CopyBytes<kWord>(bytes, &bits);
  if (kSwap) bits = __builtin_bswap32(bits);
  float word = 0;
  hwy::CopyBytes<kWord>(&bits, &word);
  return word;
}

#if HWY_TARGET != HWY_SCALAR
using Tag = HWY_CAPPED(float, 4);
using Words = hn::Vec<Tag>;
constexpr std::size_t kLanes = 4;

template <bool kSwap>
HWY_INLINE Words words_at(const char* bytes) {
  const Words words = hn::LoadU(Tag(), reinterpret_cast<const float*>(bytes));
  if (!kSwap) return words;
  alignas(16) static constexpr std::uint8_t kReversed[16] = {3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12};
  const hn::Repartition<std::uint8_t, Tag> d;
  return hn::BitCast(Tag(), hn::TableLookupBytes(hn::BitCast(d, words), hn::Load(d, kReversed)));
}
#endif

void SwapWords(const char* HWY_RESTRICT bytes, std::size_t count, float* HWY_RESTRICT target) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  for (; i + kLanes <= count; i += kLanes) hn::StoreU(words_at<true>(bytes + kWord * i), Tag(), target + i);
#endif
  for (; i < count; ++i) target[i] = word_at<true>(bytes + kWord * i);
}

template <bool kSwap>
void SplitTriples(const char* HWY_RESTRICT bytes, std::size_t stride, std::size_t rows, float* HWY_RESTRICT x,
                  float* HWY_RESTRICT y, float* HWY_RESTRICT z) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const Tag d;
  const hn::Repartition<std::uint64_t, Tag> pairs;
  const auto as_pairs = [=](Words words) HWY_ATTR { return hn::BitCast(pairs, words); };
  // Four rows are four columns of a matrix. A row's fourth word is of whatever follows: not so in the last one.
  for (; i + kLanes < rows; i += kLanes) {
    const char* from = bytes + i * stride;
    const Words a = words_at<kSwap>(from), b = words_at<kSwap>(from + stride);
    const Words c = words_at<kSwap>(from + 2 * stride), e = words_at<kSwap>(from + 3 * stride);
    const auto low_ab = as_pairs(hn::InterleaveLower(d, a, b)), low_ce = as_pairs(hn::InterleaveLower(d, c, e));
    const auto high_ab = as_pairs(hn::InterleaveUpper(d, a, b)), high_ce = as_pairs(hn::InterleaveUpper(d, c, e));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, low_ab, low_ce)), d, x + i);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, low_ab, low_ce)), d, y + i);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, high_ab, high_ce)), d, z + i);
  }
#endif
  for (; i < rows; ++i) {
    x[i] = word_at<kSwap>(bytes + i * stride);
    y[i] = word_at<kSwap>(bytes + i * stride + kWord);
    z[i] = word_at<kSwap>(bytes + i * stride + 2 * kWord);
  }
}

template <bool kSwap>
void CopyTriples(const char* HWY_RESTRICT bytes, std::size_t stride, std::size_t rows, float* HWY_RESTRICT target) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  // The fourth word goes where the next row's first one comes.
  for (; i + 1 < rows; ++i) hn::StoreU(words_at<kSwap>(bytes + i * stride), Tag(), target + 3 * i);
#endif
  for (; i < rows; ++i)
    for (std::size_t c = 0; c < 3; ++c) target[3 * i + c] = word_at<kSwap>(bytes + i * stride + c * kWord);
}

void SplitSwapped(const char* bytes, std::size_t stride, std::size_t rows, float* x, float* y, float* z) {
  SplitTriples<true>(bytes, stride, rows, x, y, z);
}
void SplitPlain(const char* bytes, std::size_t stride, std::size_t rows, float* x, float* y, float* z) {
  SplitTriples<false>(bytes, stride, rows, x, y, z);
}
void CopySwapped(const char* bytes, std::size_t stride, std::size_t rows, float* target) {
  CopyTriples<true>(bytes, stride, rows, target);
}
void CopyPlain(const char* bytes, std::size_t stride, std::size_t rows, float* target) {
  CopyTriples<false>(bytes, stride, rows, target);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus::io
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus::io {

HWY_EXPORT(SwapWords);
HWY_EXPORT(SplitSwapped);
HWY_EXPORT(SplitPlain);
HWY_EXPORT(CopySwapped);
HWY_EXPORT(CopyPlain);

void swap_words(const char* bytes, std::size_t count, float* target) {
  HWY_DYNAMIC_DISPATCH(SwapWords)(bytes, count, target);
}

void split_triples(const char* bytes, std::size_t stride, bool swap, std::size_t rows, float* x, float* y, float* z) {
  const auto split = swap ? HWY_DYNAMIC_DISPATCH(SplitSwapped) : HWY_DYNAMIC_DISPATCH(SplitPlain);
  split(bytes, stride, rows, x, y, z);
}

void copy_triples(const char* bytes, std::size_t stride, bool swap, std::size_t rows, float* target) {
  const auto copy = swap ? HWY_DYNAMIC_DISPATCH(CopySwapped) : HWY_DYNAMIC_DISPATCH(CopyPlain);
  copy(bytes, stride, rows, target);
}

}  // namespace meniscus::io
#endif
