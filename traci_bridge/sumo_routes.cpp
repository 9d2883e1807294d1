#include "traci_bridge/sumo_routes.hpp"

#include <algorithm>
#include <optional>
#include <set>

namespace mvtp::MVTP_SUMO_NAMESPACE {
namespace {

constexpr int kAllStops = 0;           // of getStops(): those to come
constexpr double kNearEnd = 20.0;      // [m] before the end of an edge: SUMO must know the next,
constexpr double kNearEndTime = 40.0;  // [m/s] and as far as a vehicle may come in a step

/// How many edges of the rest of a route lie between its begin and the end of a piece of it;
/// 0 if it has no such piece. Edges of the piece that the vehicle has left already do not count.
std::size_t piece_length(std::span<const std::string> rest, std::span<const std::string> piece) {
  for (; !piece.empty(); piece = piece.subspan(1)) {
    const auto found = std::ranges::search(rest, piece);
    if (!found.empty()) return std::size_t(found.end() - rest.begin());
  }
  return 0;
}

void add_stop(const std::string& id, const libsumo::TraCINextStopData& stop) {
  const bool named = !stop.stoppingPlaceID.empty();
  const std::size_t index = stop.lane.rfind('_');
  api::Vehicle::setStop(
      id, named ? stop.stoppingPlaceID : stop.lane.substr(0, index), named ? 1.0 : stop.endPos,
      named ? 0 : std::stoi(stop.lane.substr(index + 1)), stop.duration, stop.stopFlags,
      named ? libsumo::INVALID_DOUBLE_VALUE : stop.startPos, stop.until);
}

}  // namespace

SumoRoutes::SumoRoutes(const RoadNetwork& network, SumoLog& log) : network_(network), log_(log) {
  for (const auto& [edge, lanes] : network.edges) ends_[edge];
  for (const auto& [id, junction] : network.junctions) {
    for (const std::string& lane : junction.incoming_lanes) {
      ends_[network.lanes.at(lane).edge].second = id;
    }
    for (const Connection& c : junction.connections) {
      ends_[network.lanes.at(c.to_lane).edge].first = id;
    }
  }
}

std::span<const std::string> SumoRoutes::rest(const std::string& id, double time) const {
  Route& route = routes_[id];
  if (route.seen != time) {
    look(id, route);
    route.seen = time;
  }
  return std::span(route.edges).subspan(route.done);
}

void SumoRoutes::look(const std::string& id, Route& route) const {
  std::string name = api::Vehicle::getRouteID(id);
  const auto found = cuts_.find(id);
  Cut* const cut = found == cuts_.end() ? nullptr : &found->second;
  if (cut != nullptr && cut->name != name) take_over_detour(id, name, *cut);
  if (name != route.name) {
    route.edges = cut != nullptr ? cut->rest : api::Vehicle::getRoute(id);
    route.name = std::move(name);
  }
  const int base = cut != nullptr ? int(cut->base) : 0;
  const int done = api::Vehicle::getRouteIndex(id) - base;  // negative before the departure
  const std::size_t last = std::max<std::size_t>(route.edges.size(), 1) - 1;
  route.done = std::min(std::size_t(std::max(done, 0)), last);
}

/// SUMO has found another path to the end of the piece that it knows, or to another end.
void SumoRoutes::take_over_detour(const std::string& id, const std::string& name, Cut& cut) const {
  const std::vector<std::string> all = api::Vehicle::getRoute(id);
  const auto base = std::size_t(std::max(api::Vehicle::getRouteIndex(id), 0));
  std::vector<std::string> rest(all.begin() + std::ptrdiff_t(base), all.end());
  const std::size_t known = rest.size();
  if (rest.back() == cut.rest[cut.known - 1]) {
    rest.insert(rest.end(), cut.rest.begin() + std::ptrdiff_t(cut.known), cut.rest.end());
  }
  cut = {.name = name,
         .rest = std::move(rest),
         .known = known,
         .base = base,
         .length = known,
         .stops = std::move(cut.stops)};
}

std::size_t SumoRoutes::length_to_cut(const std::string& id, std::span<const std::string> edges,
                                      double time) const {
  const std::span<const std::string> left = rest(id, time);
  if (!is_cut(id) && !meets_itself(routes_.at(id))) return 0;
  return piece_length(left, edges);
}

std::size_t SumoRoutes::next_cut(const std::string& id, double time) const {
  const auto found = cuts_.find(id);
  if (found == cuts_.end() || found->second.known >= found->second.length) return 0;
  (void)rest(id, time);
  const Cut& cut = found->second;
  const std::size_t done = routes_.at(id).done;
  const bool further = done > 0 && done < cut.length;
  return further || (cut.known == 1 && is_near_end(id)) ? cut.length - done : 0;
}

void SumoRoutes::cut(const std::string& id, std::size_t length, double time) {
  const std::span<const std::string> left = rest(id, time);
  Cut cut{.rest = {left.begin(), left.end()}, .length = length};
  cut.known = std::max<std::size_t>(clear_length(left.first(length)), is_near_end(id) ? 2 : 1);
  cut.known = std::min(cut.known, length);
  cut.name = name_of({left.begin(), left.begin() + std::ptrdiff_t(cut.known)});
  const auto before = cuts_.find(id);
  if (before != cuts_.end() && before->second.name == cut.name) {
    before->second.length = length;
    return;
  }
  std::vector<libsumo::TraCINextStopData> stops = api::Vehicle::getStops(id, kAllStops);
  if (before != cuts_.end()) {
    stops.insert(stops.end(), before->second.stops.begin(), before->second.stops.end());
  }
  if (!give(id, cut.name)) return;
  const std::size_t kept = api::Vehicle::getStops(id, kAllStops).size();
  cut.stops.assign(stops.begin() + std::ptrdiff_t(std::min(kept, stops.size())), stops.end());
  cuts_[id] = std::move(cut);
  routes_.erase(id);
}

bool SumoRoutes::restore(const std::string& id, double time) {
  if (!is_cut(id)) return true;
  const std::span<const std::string> left = rest(id, time);
  if (!give(id, name_of({left.begin(), left.end()}))) return false;
  const Cut cut = std::move(cuts_.at(id));
  forget(id);
  for (const libsumo::TraCINextStopData& stop : cut.stops) add_stop(id, stop);
  return true;
}

/// SUMO refuses a route while it believes the vehicle to be inside a junction on its way elsewhere.
bool SumoRoutes::give(const std::string& id, const std::string& name) {
  try {
    api::Vehicle::setRouteID(id, name);
    return true;
  } catch (const libsumo::TraCIException&) {
    static_cast<void>(log_.take_errors());
    return false;
  }
}

bool SumoRoutes::detour(const std::string& id) {
  if (is_cut(id) || !api::Vehicle::getStops(id, kAllStops).empty()) return false;
  const std::string lane = api::Vehicle::getLaneID(id);
  const std::string type = api::Vehicle::getTypeID(id);
  const std::string destination = api::Vehicle::getRoute(id).back();
  std::optional<libsumo::TraCIStage> best;
  for (const std::string& next : edges_after(lane)) {
    libsumo::TraCIStage path = api::Simulation::findRoute(next, destination, type);
    if (path.edges.empty() || (best && best->travelTime <= path.travelTime)) continue;
    best = std::move(path);
  }
  if (!best) return false;
  best->edges.insert(best->edges.begin(), network_.lanes.at(lane).edge);
  return give(id, name_of(best->edges));
}

/// Where the connections of a lane lead.
std::vector<std::string> SumoRoutes::edges_after(const std::string& lane) const {
  std::vector<std::string> edges;
  const auto junction = network_.junctions.find(ends_.at(network_.lanes.at(lane).edge).second);
  if (junction == network_.junctions.end()) return edges;
  for (const Connection& c : junction->second.connections) {
    if (c.from_lane == lane) edges.push_back(network_.lanes.at(c.to_lane).edge);
  }
  return edges;
}

std::vector<libsumo::TraCINextStopData> SumoRoutes::stops_behind(const std::string& id) const {
  const auto found = cuts_.find(id);
  return found == cuts_.end() ? std::vector<libsumo::TraCINextStopData>() : found->second.stops;
}

void SumoRoutes::forget(const std::string& id) {
  routes_.erase(id);
  cuts_.erase(id);
}

bool SumoRoutes::meets_itself(const Route& route) const {
  const auto known = meeting_.find(route.name);
  if (known != meeting_.end()) return known->second;
  return meeting_[route.name] = clear_length(route.edges) < route.edges.size();
}

/// How many of the edges, one at least, come to no junction twice, nor back to where they begin.
std::size_t SumoRoutes::clear_length(std::span<const std::string> edges) const {
  std::set<std::string> seen = {ends_.at(edges.front()).first};
  std::size_t clear = 0;
  for (; clear < edges.size(); ++clear) {
    const std::string& end = ends_.at(edges[clear]).second;
    if (!end.empty() && !seen.insert(end).second) break;
  }
  return std::max<std::size_t>(clear, 1);
}

/// Is it inside a junction, off the road, or about to leave its edge?
bool SumoRoutes::is_near_end(const std::string& id) const {
  const auto lane = network_.lanes.find(api::Vehicle::getLaneID(id));
  if (lane == network_.lanes.end() || lane->second.internal) return true;
  const double left = lane->second.length - api::Vehicle::getLanePosition(id);
  return left < std::max(kNearEnd, kNearEndTime * api::Simulation::getDeltaT());
}

/// SUMO's id of a route made here with these edges.
const std::string& SumoRoutes::name_of(const std::vector<std::string>& edges) {
  std::string& name = names_[edges];
  if (name.empty()) {
    name = "mvtp:" + std::to_string(names_.size());
    api::Route::add(name, edges);
  }
  return name;
}

}  // namespace mvtp::MVTP_SUMO_NAMESPACE
