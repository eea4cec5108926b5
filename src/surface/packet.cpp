#include "surface/packet.h"

#include <cstring>
#include <new>

namespace meniscus {
namespace {

constexpr std::align_val_t kAlignment{64};

}  // namespace

void AlignedFloats::Free::operator()(float* values) const { ::operator delete[](values, kAlignment); }

void AlignedFloats::reserve(std::size_t count, std::size_t keep) {
  if (count <= capacity_) return;
  const std::size_t wanted = std::max<std::size_t>(count, 2 * capacity_);
  std::unique_ptr<float[], Free> larger(new (kAlignment) float[wanted]);
  if (keep > 0) std::memcpy(larger.get(), data_.get(), keep * sizeof(float));
  data_ = std::move(larger);
  capacity_ = wanted;
}

void PacketList::reserve(std::size_t wanted, bool colours) {
  if (wanted <= mass.capacity() && (!colours || wanted <= blue.capacity())) return;
  for (AlignedFloats* values : {&x, &y, &z, &mass}) values->reserve(wanted, count);
  if (colours)
    for (AlignedFloats* values : {&red, &green, &blue}) values->reserve(wanted, count);
}

}  // namespace meniscus
