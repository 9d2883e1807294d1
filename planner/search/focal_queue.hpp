#pragma once

#include <algorithm>
#include <cassert>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace mvtp {

/// The OPEN and FOCAL lists of focal search in one container of node numbers.
///
/// FOCAL = { n in OPEN : cost(n) <= w * min over OPEN of bound(n) }; pop() takes the node of FOCAL
/// with the least key, so the first goal popped costs at most w times the optimum if bounds are
/// lower bounds. The minimum runs over bounds: over costs, ECBS would only be w^2-suboptimal.
/// It never decreases here (pathmax over the whole search). Ties go to the lower number.
/// Source: Barer et al. 2014. Cost: O(log n) per operation, amortised.
template <class Key>
class FocalQueue {
 public:
  /// @pre w >= 1
  explicit FocalQueue(double w) : w_(w) { assert(w >= 1.0); }

  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// The least bound seen in OPEN at the last pop(): a lower bound on every solution.
  [[nodiscard]] double lower_bound() const { return lower_bound_; }

  /// @param node  a number that was not pushed before; small, for it indexes a table.
  /// @pre bound <= cost <= w * bound
  void push(int node, double bound, double cost, Key key) {
    if (std::size_t(node) >= popped_.size()) popped_.resize(std::size_t(node) + 1, false);
    open_.emplace(bound, node);
    if (cost <= w_ * lower_bound_) {
      focal_.emplace(std::move(key), node);
    } else {
      waiting_.push({cost, node, std::move(key)});
    }
    ++size_;
  }

  /// @pre !empty()
  [[nodiscard]] int pop() {
    assert(!empty());
    while (popped_[std::size_t(open_.top().second)]) open_.pop();
    lower_bound_ = std::max(lower_bound_, open_.top().first);
    while (!waiting_.empty() && waiting_.top().cost <= w_ * lower_bound_) admit();
    // Only rounding, or a cost above w times its bound, can leave FOCAL empty.
    if (focal_.empty()) admit();
    const int node = focal_.top().second;
    focal_.pop();
    popped_[std::size_t(node)] = true;
    --size_;
    return node;
  }

 private:
  struct Waiting {
    double cost;
    int node;
    Key key;
    bool operator>(const Waiting& other) const {
      return std::pair(cost, node) > std::pair(other.cost, other.node);
    }
  };
  template <class T>
  using MinHeap = std::priority_queue<T, std::vector<T>, std::greater<>>;

  void admit() {
    focal_.emplace(waiting_.top().key, waiting_.top().node);
    waiting_.pop();
  }

  double w_;
  double lower_bound_ = 0.0;
  std::size_t size_ = 0;
  MinHeap<std::pair<double, int>> open_;  ///< popped nodes leave it late
  MinHeap<Waiting> waiting_;              ///< OPEN without FOCAL
  MinHeap<std::pair<Key, int>> focal_;
  std::vector<bool> popped_;
};

}  // namespace mvtp
