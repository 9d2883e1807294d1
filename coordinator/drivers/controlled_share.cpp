#include "coordinator/drivers/controlled_share.hpp"

namespace mvtp {

double share_of_id(const std::string& id, std::uint64_t seed) {
  std::uint64_t hash = 0xcbf29ce484222325U;  // FNV-1a, 64 bits
  for (const char c : id) hash = (hash ^ std::uint8_t(c)) * 0x100000001b3U;
  // The last steps of SplitMix64 spread ids that differ in one letter, and the seed, over all bits.
  hash += (seed + 1) * 0x9e3779b97f4a7c15U;
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9U;
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebU;
  hash ^= hash >> 31U;
  return double(hash >> 11U) * 0x1p-53;
}

bool ControlledShare::contains(const std::string& id, const std::string& type) const {
  if (human_types.contains(type)) return false;
  if (!coordinate_types.empty() && !coordinate_types.contains(type)) return false;
  return share_of_id(id, seed) < penetration;
}

}  // namespace mvtp
