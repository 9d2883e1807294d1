#include "planner/problem/check_instance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two cars of 3 x 2 m far from each other and from everything.
Instance free_instance() {
  Instance instance;
  instance.agents = {{"a", {}, {10, 10, 0}, {20, 10, 0}}, {"b", {}, {10, 30, 0}, {20, 30, 0}}};
  instance.map = {.width = 50, .height = 40, .circles = {{40, 20, 0.8}}, .polygons = {}};
  return instance;
}

std::vector<std::string> problems(const Instance& instance) {
  std::vector<std::string> result;
  for (const InputError& error : check_instance(instance, "cross.yaml")) {
    result.emplace_back(error.what());
  }
  return result;
}

TEST(CheckInstance, FindsNothingWrongWithAFreeInstance) {
  EXPECT_THAT(problems(free_instance()), IsEmpty());
}

TEST(CheckInstance, TellsHowDeepAGoalOverlapsACircle) {
  Instance instance = free_instance();
  instance.map.circles.push_back({23.1, 10, 0.8});  // the front is at 22.5
  EXPECT_THAT(problems(instance),
              ElementsAre("cross.yaml: agents[0].goal: the footprint at (20.00, 10.00) overlaps "
                          "obstacles[1] by 0.20 m; move the goal or the obstacle"));
}

TEST(CheckInstance, TellsHowDeepAStartOverlapsAPolygon) {
  Instance instance = free_instance();
  instance.map.polygons = {{{12.25, 25}, {15, 25}, {15, 35}, {12.25, 35}}};
  EXPECT_THAT(problems(instance),
              ElementsAre("cross.yaml: agents[1].start: the footprint at (10.00, 30.00) overlaps "
                          "polygons[0] by 0.25 m; move the start or the obstacle"));
}

TEST(CheckInstance, FindsAFootprintInsideAPolygon) {
  Instance instance = free_instance();
  instance.map.polygons = {{{0, 0}, {15, 0}, {15, 20}, {0, 20}}};
  EXPECT_EQ(problems(instance).size(), 1u);
}

TEST(CheckInstance, TellsWhichFootprintsOverlapEachOther) {
  Instance instance = free_instance();
  instance.agents[1].start = {10, 11.9, 0};
  instance.agents[1].goal = {20, 10, std::numbers::pi};
  EXPECT_THAT(problems(instance),
              ElementsAre("cross.yaml: agents[1].start: the footprint at (10.00, 11.90) overlaps "
                          "that of agents[0].start by 0.10 m; move one of them",
                          "cross.yaml: agents[1].goal: the footprint at (20.00, 10.00) overlaps "
                          "that of agents[0].goal by 1.00 m; move one of them"));
}

TEST(CheckInstance, AStartMayLieOnTheGoalOfAnother) {
  Instance instance = free_instance();
  instance.agents[1].start = instance.agents[0].goal;
  EXPECT_THAT(problems(instance), IsEmpty());
}

TEST(CheckInstance, TellsWhatSticksOutOfTheMap) {
  Instance instance = free_instance();
  instance.agents[0].start = {48, 10, 0};
  EXPECT_THAT(problems(instance),
              ElementsAre("cross.yaml: agents[0].start: the footprint at (48.00, 10.00) is 0.50 m "
                          "outside the map of 50 x 40 m; move it, or choose --bounds axle"));
  instance.map.bounds = Bounds::kAxle;
  EXPECT_THAT(problems(instance), IsEmpty());
  instance.agents[0].start = {50.25, 10, std::numbers::pi};
  EXPECT_THAT(problems(instance),
              ElementsAre("cross.yaml: agents[0].start: the rear axle at (50.25, 10.00) is 0.25 m "
                          "outside the map of 50 x 40 m; move it"));
}

TEST(CheckInstance, ATouchUpToAMillimetreIsFine) {
  Instance instance = free_instance();
  instance.agents[1].start = {10, 11.9991, 0};
  EXPECT_THAT(problems(instance), IsEmpty());
  instance.agents[1].start = {10, 11.9989, 0};
  EXPECT_THAT(problems(instance), ElementsAre(testing::HasSubstr("by 0.0011 m")));
}

}  // namespace
}  // namespace mvtp
