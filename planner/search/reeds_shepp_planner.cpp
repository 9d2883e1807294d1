// Reeds-Shepp paths by OMPL: the only source that includes it.
#include "planner/search/reeds_shepp_planner.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>
#include <ompl/base/terminationconditions/IterationTerminationCondition.h>
#include <ompl/datastructures/NearestNeighborsSqrtApprox.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "planner/problem/draws.hpp"

namespace mvtp {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Space = ob::ReedsSheppStateSpace;

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kMostVertices = 60;  ///< of the path that is shortened
constexpr double kVertexEvery = 1.0;       ///< [m] on it, if that are no more

Pose pose_of(const ob::State* state) {
  const auto* s = state->as<Space::StateType>();
  return {s->getX(), s->getY(), s->getYaw()};
}

void set(ob::State* state, const Pose& pose) {
  auto* s = state->as<Space::StateType>();
  s->setXY(pose.x, pose.y);
  const double yaw = wrap_to_pi(pose.theta);
  s->setYaw(yaw < kPi ? yaw : -kPi);  // OMPL's headings lie in [-pi, pi)
}

/// The shortest path between two states, in arcs of at most kLongestPiece.
std::vector<Arc> arcs_between(const Space& space, const ob::State* from, const ob::State* to,
                              double radius) {
  const Space::ReedsSheppPath path = space.reedsShepp(from, to);
  std::vector<Arc> arcs;
  for (int k = 0; k < 5 && path.type_[k] != Space::RS_NOP; ++k) {
    const double length = path.length_[k] * radius;
    if (length == 0.0) continue;
    const double turn = path.type_[k] == Space::RS_LEFT    ? 1.0
                        : path.type_[k] == Space::RS_RIGHT ? -1.0
                                                           : 0.0;
    const int pieces = int(std::ceil(std::abs(length) / kLongestPiece));
    arcs.insert(arcs.end(), std::size_t(pieces), Arc{length / pieces, turn / radius});
  }
  return arcs;
}

/// Draws most samples near the start and the goal, where manoeuvres are, and the rest anywhere.
class Sampler final : public ob::StateSampler {
 public:
  Sampler(const ob::StateSpace* space, const Pose& start, const Pose& goal, const Point& ground,
          const SamplingOptions& options)
      : StateSampler(space),
        start_(start),
        goal_(goal),
        ground_(ground),
        around_(options.around),
        draws_(options.seed) {}

  void sampleUniform(ob::State* state) override {
    const int where = draws_.between(0, 3);
    if (where == 0) {
      set(state, {draws_.share() * ground_.x, draws_.share() * ground_.y, heading()});
    } else {
      sample_around(state, where == 1 ? goal_ : start_, around_);
    }
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    sample_around(state, pose_of(near), distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    sample_around(state, pose_of(mean), deviation);
  }

 private:
  double heading() { return (2.0 * draws_.share() - 1.0) * kPi; }

  void sample_around(ob::State* state, const Pose& centre, double reach) {
    const double x = centre.x + (2.0 * draws_.share() - 1.0) * reach;
    const double y = centre.y + (2.0 * draws_.share() - 1.0) * reach;
    set(state, {std::clamp(x, 0.0, ground_.x), std::clamp(y, 0.0, ground_.y), heading()});
  }

  Pose start_;
  Pose goal_;
  Point ground_;
  double around_;
  Draws draws_;
};

class ArcValidator final : public ob::MotionValidator {
 public:
  ArcValidator(const ob::SpaceInformationPtr& space_information, double radius,
               const ArcCheck& is_free)
      : MotionValidator(space_information),
        space_(*space_information->getStateSpace()->as<Space>()),
        radius_(radius),
        is_free_(is_free) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    Pose pose = pose_of(from);
    for (const Arc& arc : arcs_between(space_, from, to, radius_)) {
      if (!is_free_(pose, arc)) return false;
      pose = drive(pose, arc);
    }
    return true;
  }
  /// RRT-Connect does not ask how far it gets.
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>&) const override {
    return checkMotion(from, to);
  }

 private:
  const Space& space_;
  double radius_;
  const ArcCheck& is_free_;
};

/// The shortest path over the vertices of another one, forwards along it (dynamic programming), a
/// change of direction counted as so many metres. A place has two nodes, by how it is arrived at.
class Shortcut {
 public:
  Shortcut(const og::PathGeometric& path, double radius, double cusp)
      : path_(path),
        space_(*path.getSpaceInformation()->getStateSpace()->as<Space>()),
        validator_(*path.getSpaceInformation()->getMotionValidator()),
        radius_(radius),
        cusp_(cusp),
        nodes_(path.getStateCount() * 2) {}

  [[nodiscard]] std::vector<Arc> arcs() {
    const std::size_t count = path_.getStateCount();
    nodes_[0].cost = nodes_[1].cost = 0.0;
    for (std::size_t to = 1; to < count; ++to) {
      for (std::size_t from = 0; from < to; ++from) consider(from, to);
    }
    const std::size_t last = 2 * (count - 1);
    std::vector<Arc> result;
    std::size_t node = nodes_[last].cost <= nodes_[last + 1].cost ? last : last + 1;
    while (node > 1) {
      const std::vector<Arc>& leg = nodes_[node].leg;
      result.insert(result.begin(), leg.begin(), leg.end());
      node = nodes_[node].before;
    }
    return result;
  }

 private:
  struct Node {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t before = 0;
    std::vector<Arc> leg;  ///< from there
  };

  void consider(std::size_t from, std::size_t to) {
    const ob::State* a = path_.getState(unsigned(from));
    const ob::State* b = path_.getState(unsigned(to));
    const double length = space_.distance(a, b);
    const auto cost = [&](std::size_t node) {
      return std::min(nodes_[node].cost, nodes_[node + 1].cost);
    };
    const bool hopeless =
        cost(2 * from) + length >= std::max(nodes_[2 * to].cost, nodes_[2 * to + 1].cost);
    if (hopeless || !validator_.checkMotion(a, b)) return;
    const std::vector<Arc> leg = arcs_between(space_, a, b, radius_);
    double total = length;
    for (std::size_t k = 1; k < leg.size(); ++k) {
      if (leg[k].length * leg[k - 1].length < 0.0) total += cusp_;
    }
    const bool begins_forwards = leg.empty() || leg.front().length > 0.0;
    const bool ends_forwards = leg.empty() || leg.back().length > 0.0;
    Node& node = nodes_[2 * to + (ends_forwards ? 1 : 0)];
    for (std::size_t arrival = 0; arrival < 2; ++arrival) {
      const bool turns = from > 0 && (arrival == 1) != begins_forwards;
      const double sum = nodes_[2 * from + arrival].cost + total + (turns ? cusp_ : 0.0);
      if (sum < node.cost) node = {sum, 2 * from + arrival, leg};
    }
  }

  const og::PathGeometric& path_;
  const Space& space_;
  const ob::MotionValidator& validator_;
  double radius_;
  double cusp_;
  std::vector<Node> nodes_;
};

std::shared_ptr<Space> make_space(double radius, const Point& ground) {
  auto space = std::make_shared<Space>(radius);
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0.0);
  bounds.setHigh(0, ground.x);
  bounds.setHigh(1, ground.y);
  space->setBounds(bounds);
  return space;
}

}  // namespace

double shortest_length(const Pose& from, const Pose& to, double radius) {
  const auto space = std::make_shared<Space>(radius);
  ob::ScopedState<Space> a(space);
  ob::ScopedState<Space> b(space);
  set(a.get(), from);
  set(b.get(), to);
  return space->distance(a.get(), b.get());
}

std::optional<std::vector<Arc>> plan_by_sampling(const Pose& start, const Pose& goal, double radius,
                                                 const Point& ground,
                                                 const SamplingOptions& options,
                                                 const ArcCheck& is_free) {
  ompl::msg::noOutputHandler();  // what it has to say is said by the result
  const std::shared_ptr<Space> space = make_space(radius, ground);
  space->setStateSamplerAllocator([&](const ob::StateSpace* of) {
    return std::make_shared<Sampler>(of, start, goal, ground, options);
  });
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(
      [&](const ob::State* state) { return is_free(pose_of(state), Arc{}); });
  information->setMotionValidator(std::make_shared<ArcValidator>(information, radius, is_free));
  information->setup();

  ob::ScopedState<Space> from(space);
  ob::ScopedState<Space> to(space);
  set(from.get(), start);
  set(to.get(), goal);
  for (const ob::State* end : {from.get(), to.get()}) {  // OMPL would wait for another goal
    if (!information->satisfiesBounds(end) || !information->isValid(end)) return std::nullopt;
  }
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(from, to);

  og::RRTConnect planner(information);
  planner.setRange(options.range);
  planner.setNearestNeighbors<ompl::NearestNeighborsSqrtApprox>();
  planner.setProblemDefinition(problem);
  planner.setup();
  ob::IterationTerminationCondition budget{unsigned(options.iterations)};
  if (planner.solve(budget) != ob::PlannerStatus::EXACT_SOLUTION) return std::nullopt;

  auto path = *problem->getSolutionPath()->as<og::PathGeometric>();
  const auto by_length = std::size_t(path.length() / kVertexEvery) + 2;
  path.interpolate(unsigned(std::max(path.getStateCount(), std::min(kMostVertices, by_length))));
  return Shortcut(path, radius, options.cusp).arcs();
}

}  // namespace mvtp
