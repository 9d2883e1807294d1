#pragma once

#include <cstdint>
#include <vector>

namespace mvtp {

/// A set of 64-bit keys by open addressing: what a closed list needs, and no more.
class CellSet {
 public:
  CellSet() : slots_(256, kEmpty) {}

  /// Adds a key other than 2^64 - 1; false if it was there.
  bool insert(std::uint64_t key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    std::uint64_t& slot = slots_[slot_of(key)];
    if (slot == key) return false;
    slot = key;
    ++size_;
    return true;
  }

  [[nodiscard]] bool contains(std::uint64_t key) const { return slots_[slot_of(key)] == key; }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  /// Where the key is, or may be put.
  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;  // the size is a power of two
    std::size_t i = (key * 0x9e3779b97f4a7c15U) >> 20U & mask;
    while (slots_[i] != kEmpty && slots_[i] != key) i = (i + 1) & mask;
    return i;
  }

  void grow() {
    std::vector<std::uint64_t> old(slots_.size() * 4, kEmpty);
    old.swap(slots_);
    for (const std::uint64_t key : old) {
      if (key != kEmpty) slots_[slot_of(key)] = key;
    }
  }

  std::vector<std::uint64_t> slots_;
  std::size_t size_ = 0;
};

}  // namespace mvtp
