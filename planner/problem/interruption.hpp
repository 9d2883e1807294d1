#pragma once

#include <functional>

namespace mvtp {

/// Somebody wants the work to end before there is a result. No std::exception: it is no error, and
/// nobody makes a message of it.
struct Interruption {};

/// What long work calls again and again; it throws Interruption where the work is to end.
using InterruptionPoint = std::function<void()>;

/// For work that goes on to its end.
inline void never_interrupted() {}

}  // namespace mvtp
