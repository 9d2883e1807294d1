// Who is let over junctions is decided for each control zone by itself: which guests are offered,
// in which order, and whether the plans of the control zone allow it.

#include <algorithm>
#include <iterator>
#include <optional>
#include <ranges>

#include "coordinator/drivers/human_drivers.hpp"
#include "coordinator/junctions/coordinator.hpp"
#include "coordinator/network/partition.hpp"

namespace mvtp {

/// The control zone of each junction; LaneGraph::kNone: it is not coordinated.
void Coordinator::find_zones() {
  zone_of_junction_.assign(std::size_t(graph_.junctions()), LaneGraph::kNone);
  const std::vector<ControlZone> zones = partition(graph_, coordinated_, options_.corridors.chain);
  for (std::size_t z = 0; z < zones.size(); ++z) {
    for (const int j : zones[z].junctions) zone_of_junction_[std::size_t(j)] = int(z);
  }
}

/// The control zone through which a corridor leads first.
int Coordinator::zone_of(int corridor) const {
  for (const CorridorPiece& piece : corridors_[corridor].course.pieces) {
    if (graph_.edge_of(piece.lane) != LaneGraph::kNone) continue;
    const int junction = graph_.link(graph_.links_over(piece.lane).front()).junction;
    const int zone = zone_of_junction_[std::size_t(junction)];
    if (zone != LaneGraph::kNone) return zone;
  }
  return LaneGraph::kNone;
}

/// The control zone that somebody is in, or comes to next.
int Coordinator::zone_of(const std::string& guest) const {
  if (people_ && people_->knows(guest)) {
    return zone_of_junction_[std::size_t(people_->junction_of(guest))];
  }
  const VehicleState* v = find_state(guest);
  const int lane = v == nullptr ? LaneGraph::kNone : graph_.find_lane(v->lane);
  if (lane == LaneGraph::kNone) return LaneGraph::kNone;
  std::vector<int> junctions;
  if (graph_.edge_of(lane) == LaneGraph::kNone) {
    const auto links = graph_.links_over(lane);
    if (!links.empty()) junctions.push_back(graph_.link(links.front()).junction);
  }
  for (const int edge : route_of(*v)) junctions.push_back(graph_.junction_behind(edge));
  for (const int j : junctions) {
    const int zone = j == LaneGraph::kNone ? j : zone_of_junction_[std::size_t(j)];
    if (zone != LaneGraph::kNone) return zone;
  }
  return LaneGraph::kNone;
}

/// Crossings that may get green now. A driver who has waited longer goes first; but not one who has
/// to wait for those at the kerb, who may well wait for him.
std::vector<std::string> Coordinator::crossings_to_offer() {
  if (!people_) return {};
  std::vector<std::string> drivers;
  if (humans_) drivers = humans_->first_at_lines();
  std::erase_if(drivers, [this](const std::string& id) { return may_meet_people({id}); });
  return people_->propose([&](int light) {
    double longest = 0.0;
    for (const std::string& id : drivers) {
      if (humans_->is_crossed_by(id, light)) longest = std::max(longest, humans_->waited(id));
    }
    return longest;
  });
}

/// Drivers and people at lights, those who have waited longest first.
std::vector<std::vector<std::string>> Coordinator::groups_at_lights() {
  std::vector<std::pair<double, std::vector<std::string>>> groups;
  for (const std::string& crossing : crossings_to_offer()) {
    groups.push_back({people_->waited(crossing), {crossing}});
  }
  if (humans_) {
    for (std::vector<std::string>& drivers : humans_->propose()) {
      const double waited = humans_->waited(drivers.front());
      groups.emplace_back(waited, std::move(drivers));
    }
  }
  std::ranges::stable_sort(groups, std::ranges::greater{}, [](const auto& g) { return g.first; });
  std::vector<std::vector<std::string>> ordered;
  for (auto& [waited, group] : groups) ordered.push_back(std::move(group));
  return ordered;
}

/// Those who may go over junctions now, in groups that only go together: guests at the gate,
/// and those at lights, in turn.
std::vector<std::vector<std::string>> Coordinator::groups_of_guests() {
  std::vector<std::vector<std::vector<std::string>>> kinds(2);
  for (std::string& guest : guests_at_gate()) kinds[0].push_back({std::move(guest)});
  kinds[1] = groups_at_lights();
  std::vector<std::vector<std::string>> groups;
  for (std::size_t i = 0; std::ranges::any_of(kinds, [i](const auto& k) { return i < k.size(); });
       ++i) {
    for (auto& kind : kinds) {
      if (i < kind.size()) groups.push_back(std::move(kind[i]));
    }
  }
  return groups;
}

/// The order in which groups are tried: all at once, or else each alone.
std::vector<std::vector<std::string>> Coordinator::in_order(
    std::vector<std::vector<std::string>> groups) {
  constexpr std::size_t kMost = 3;  // alone
  std::vector<std::vector<std::string>> offers;
  std::vector<std::string> all;
  for (auto& group : groups) {
    if (may_meet_people(group)) continue;
    std::vector<std::string> with = all;
    with.insert(with.end(), group.begin(), group.end());
    if (!may_meet_people(with) && !exclude_each_other(all, group)) all = std::move(with);
    offers.push_back(std::move(group));
  }
  offers.resize(std::min(offers.size(), kMost));
  for (const std::string& id : std::views::join(offers)) gate_.asked_for(id);
  if (offers.size() < 2) return offers;
  if (std::ranges::count(offers, all) == 0) offers.insert(offers.begin(), std::move(all));
  return offers;
}

/// What may be offered, by control zone. Where somebody has no complete plan, and may come to rest
/// anywhere, only to guests who stand.
/// @param without  a trial without guests.
std::map<int, Coordinator::ZoneOffers> Coordinator::offers_of_zones(
    const std::vector<std::vector<std::string>>& groups, const Trial& without) {
  std::map<int, std::vector<std::vector<std::string>>> by_zone;
  for (const auto& group : groups) by_zone[zone_of(group.front())].push_back(group);
  const auto moves = [this](const std::vector<std::string>& group) {
    return std::ranges::any_of(group, [this](const auto& id) { return gate_.is_under_way(id); });
  };
  std::map<int, ZoneOffers> offers;
  for (auto& [zone, its_own] : by_zone) {
    if (verdict(without, zone).stepped > 0) std::erase_if(its_own, moves);
    if (!its_own.empty()) offers[zone].sets = in_order(std::move(its_own));
  }
  return offers;
}

/// What a trial means for those under control in a control zone.
Coordinator::ZoneVerdict Coordinator::verdict(const Trial& trial, int zone) const {
  ZoneVerdict verdict;
  const auto is_there = [&](std::int64_t key) {
    const auto known = trial.zones.find(key);
    return known != trial.zones.end() && known->second == zone;
  };
  for (const JointPlan::Entry& e : trial.decision.plan.entries) {
    verdict.stepped += int(!e.profile->complete && is_there(e.key));
  }
  for (std::size_t g = 0; g < trial.decision.members.size(); ++g) {
    if (std::ranges::none_of(trial.decision.members[g], is_there)) continue;
    verdict.cost += trial.decision.costs[g];
    verdict.is_refused |= std::ranges::binary_search(trial.refused, g);
  }
  return verdict;
}

/// May these guests of a control zone go, as planned in `with`? Nobody there may lose its complete
/// plan, and nobody may come where the guests may be; and it has to be worth what it costs.
bool Coordinator::allows(const std::vector<std::string>& guests, int zone, const Trial& with,
                         const Trial& without) {
  const ZoneVerdict then = verdict(with, zone);
  const ZoneVerdict before = verdict(without, zone);
  if (then.stepped > before.stepped || then.is_refused) return false;
  const bool looks_inside = people_ || is_at_gate(guests);
  if (looks_inside && waits_inside(with, zone) && !waits_inside(without, zone)) return false;
  if (!is_clear_of(guests, with) || touches_guests(guests, with)) return false;
  const bool comparable = before.stepped == 0;
  return !comparable || then.cost - before.cost <= worth(guests);
}

/// The plan with as many drivers and people getting green as is possible, and worth what it costs
/// the vehicles under control. Junctions of two control zones are apart: each control zone has its
/// own offers and its own verdict, and one trial plans an offer of every control zone.
/// @param groups  of those who may go over junctions now.
/// @param tried  a trial of guests of all control zones, which need not be made again; none: there
/// is none.
Coordinator::Trial Coordinator::best_trial_by_zones(
    const std::map<std::string, Driven>& arrivals, const std::set<std::string>& excluded,
    const std::vector<std::int64_t>& upset, const std::vector<std::vector<std::string>>& groups,
    std::optional<Trial> tried) {
  Trial without =
      without_the_late(plan_trial(arrivals, excluded, upset, {}), arrivals, excluded, upset);
  std::map<int, ZoneOffers> offers = offers_of_zones(groups, without);
  const auto guests_of_all = [&] {
    std::vector<std::string> guests;
    for (const auto& [zone, offer] : offers) {
      if (offer.next < offer.sets.size())
        std::ranges::copy(offer.present(), std::back_inserter(guests));
    }
    return guests;
  };
  while (true) {
    const std::vector<std::string> guests = guests_of_all();
    if (guests.empty()) return without;
    const bool is_known = tried && tried->guests == guests && tried->excluded == without.excluded;
    Trial with =
        is_known ? *std::move(tried) : plan_trial(arrivals, without.excluded, upset, guests);
    if (is_known) tried.reset();
    bool all_go = true;
    for (auto& [zone, offer] : offers) {
      if (offer.next == offer.sets.size() || allows(offer.present(), zone, with, without)) continue;
      ++offer.next;
      all_go = false;
    }
    if (all_go) return with;
  }
}

}  // namespace mvtp
