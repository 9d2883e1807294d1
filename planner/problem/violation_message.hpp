#pragma once

#include "planner/problem/instance.hpp"
#include "planner/problem/plan.hpp"
#include "planner/problem/referee_protocol.hpp"
#include "planner/problem/validate.hpp"

namespace mvtp::referee {

/// An entry of the protocol for people: who broke the rule, when, by how much, and what is allowed.
[[nodiscard]] Violation to_violation(const Protocol::Entry& entry, const Instance& instance,
                                     const Plan& plan);

}  // namespace mvtp::referee
