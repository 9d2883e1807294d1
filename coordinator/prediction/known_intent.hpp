#pragma once

namespace mvtp {

/// What is known of where human drivers go.
enum class KnownIntent {
  kRoute,  ///< their routes
  kLane,   ///< they may drive any movement of their lane until they are behind its line
  kNone,   ///< and of the lanes beside it as long as they may change to them
};

}  // namespace mvtp
