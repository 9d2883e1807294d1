#include "tools/cli/suggest.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mvtp {
namespace {

const std::vector<std::string> kNames = {"north", "south", "east", "west"};

TEST(Suggestion, NamesTheNearestIfItCouldBeASlip) {
  EXPECT_EQ(suggestion("nort", kNames), "did you mean north? there are north, south, east, west");
  EXPECT_EQ(suggestion("Wset", kNames), "did you mean west? there are north, south, east, west");
  EXPECT_EQ(suggestion("up", kNames), "there are north, south, east, west");
  EXPECT_EQ(suggestion("EAST", kNames), "did you mean east? there are north, south, east, west");
}

TEST(DidYouMean, IsEmptyWhereNothingIsNear) {
  EXPECT_EQ(did_you_mean("esat", kNames), "did you mean east? ");
  EXPECT_EQ(did_you_mean("up", kNames), "");
  EXPECT_EQ(did_you_mean("up", {}), "");
  EXPECT_EQ(did_you_mean("-q", std::vector<std::string>{"-h"}), "");
}

TEST(Suggestion, ListsSomeOfMany) {
  std::vector<std::string> many;
  for (int i = 0; i < 20; ++i) many.push_back("junction" + std::to_string(i));
  EXPECT_EQ(suggestion("x", many),
            "there are junction0, junction1, junction2, junction3, junction4, junction5, "
            "junction6, junction7, ... (20 in all)");
  EXPECT_EQ(suggestion("x", {}), "there are none");
  EXPECT_EQ(suggestion("x", std::vector<std::string>{"only"}), "there is only");
}

}  // namespace
}  // namespace mvtp
