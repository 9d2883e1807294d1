#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace mvtp {

/// A number for each pair of robots, the same both ways round, and zero until it is set.
///
/// Memory that nobody wrote to takes no time and no space: few of the pairs of 10,000 robots meet.
template <class Value>
class PairTable {
 public:
  /// @throws std::bad_alloc
  explicit PairTable(std::size_t robots)
      : robots_(robots),
        values_(static_cast<Value*>(std::calloc(robots * robots + 1, sizeof(Value)))) {
    static_assert(std::is_arithmetic_v<Value>, "all bits zero is to be the number zero");
    if (!values_) throw std::bad_alloc();
  }

  [[nodiscard]] Value at(int i, int j) const { return values_.get()[index(i, j)]; }
  void set(int i, int j, Value value) {
    values_.get()[index(i, j)] = values_.get()[index(j, i)] = value;
  }

 private:
  struct Free {
    void operator()(Value* values) const { std::free(values); }
  };

  [[nodiscard]] std::size_t index(int i, int j) const {
    return std::size_t(i) * robots_ + std::size_t(j);
  }

  std::size_t robots_;
  std::unique_ptr<Value, Free> values_;
};

}  // namespace mvtp
