#include "tools/coordinate/lot_options.hpp"

#include <gtest/gtest.h>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

TEST(LotOptionsOf, KnowTheControllersOfTheRegistryAndNoOthers) {
  CoordinateOptions options;
  for (const ControllerKind& kind : controller_kinds()) {
    options.controller = kind.name;
    if (kind.on_lots) {
      EXPECT_EQ(lot_options(options).controller, *kind.on_lots) << kind.name;
    } else {
      EXPECT_THROW((void)lot_options(options), InputError) << kind.name;
    }
  }
  options.controller = "magic";
  EXPECT_THROW((void)lot_options(options), InputError);
}

}  // namespace
}  // namespace mvtp
