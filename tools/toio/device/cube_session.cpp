#include "tools/toio/device/cube_session.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace mvtp {
namespace {

constexpr int kLeastBattery = 20;                    // [%]
constexpr std::string_view kLeastVersion = "2.2.0";  // the first that can notify all the time

constexpr double kAskAgain = 0.3;  // if no answer has come [s]
constexpr double kAskTime = 5.0;   // for all times together [s]
constexpr double kSilence = 0.3;   // after which a place does not count any more [s]

// A cube stands if what it reports varies by no more than this, for so long after the first stop:
// longer than a command and the report of what it did are under way.
constexpr double kRestDots = 1.5;
constexpr double kRestDegrees = 2.5;
constexpr double kRestTime = 0.25;    // [s]
constexpr double kStopTime = 1.0;     // for stopping in all: by then every command has ended [s]
constexpr double kStopPeriod = 0.05;  // cubes may miss commands that come closer [s]

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char p, char q) {
    return std::tolower(static_cast<unsigned char>(p)) ==
           std::tolower(static_cast<unsigned char>(q));
  });
}

double seconds_between(std::chrono::steady_clock::time_point a,
                       std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

CubeSession::CubeSession(Bluetooth& bluetooth) : bluetooth_(bluetooth) {
  bluetooth_.on_notification([this](const std::string& path, const Notification& notification) {
    hear(path, notification);
    if (handler_) handler_(path, notification);
  });
}

CubeSession::~CubeSession() {
  handler_ = nullptr;  // who listened may have ended already
  bluetooth_.finish();
  stop_all();
  bluetooth_.on_notification(nullptr);
  for (const FoundCube& cube : cubes_) {
    try {
      bluetooth_.disconnect(cube.path);  // ends attempts to connect it, too
    } catch (const BluetoothError&) {
      // Its link is lost already, or it will notice that nobody talks to it.
    }
  }
}

void CubeSession::hear(const std::string& path, const Notification& notification) {
  const auto event = decode_event(notification.from, notification.bytes);
  if (!event) return;
  Told& told = told_[path];
  if (const auto* version = std::get_if<Version>(&*event)) {
    told.version = version->text;
  } else if (const auto* done = std::get_if<SettingDone>(&*event)) {
    told.settings[done->setting] = done->result;
  } else if (const auto* position = std::get_if<PositionId>(&*event)) {
    hear_place(told, {double(position->x), double(position->y), double(position->degrees)});
  } else if (std::holds_alternative<PositionMissed>(*event)) {
    told.place.reset();
    told.saw_or_missed = true;
  }
}

void CubeSession::hear_place(Told& told, const MatPose& place) {
  told.place = place;
  told.heard = Clock::now();
  told.saw_or_missed = true;
  const double turn = std::remainder(place.degrees - told.rest.degrees, 360.0);
  if (std::hypot(place.x - told.rest.x, place.y - told.rest.y) <= kRestDots &&
      std::abs(turn) <= kRestDegrees) {
    return;
  }
  told.rest = place;
  told.moved = told.heard;
}

bool CubeSession::ask(const FoundCube& cube, const CubeCommand& question,
                      const std::function<bool(const Told&)>& answered) {
  const Clock::time_point begin = Clock::now();
  while (seconds_between(begin, Clock::now()) < kAskTime) {
    bluetooth_.write(cube.path, encode(question));
    if (bluetooth_.wait_until(kAskAgain, [&] { return answered(told_[cube.path]); })) return true;
  }
  return false;
}

void CubeSession::require_setting(const FoundCube& cube, const CubeCommand& setting,
                                  std::uint8_t answer) {
  if (!ask(cube, setting, [&](const Told& told) { return told.settings.contains(answer); })) {
    throw BluetoothError(fmt::format(
        "{} does not confirm its settings; switch it off and on, and bring it nearer", cube.name));
  }
  const int result = told_[cube.path].settings[answer];
  if (result == 0) return;
  throw BluetoothError(fmt::format(
      "{} refuses to report its position all the time (result {}); update its firmware with "
      "toio's update page",
      cube.name, result));
}

void CubeSession::refuse_unfit(const FoundCube& cube) {
  if (!ask(cube, AskVersion{}, [](const Told& told) { return !told.version.empty(); })) {
    throw BluetoothError(fmt::format(
        "{} does not tell its protocol; switch it off and on, and bring it nearer", cube.name));
  }
  const std::string& version = told_[cube.path].version;
  if (version < kLeastVersion) {  // digits and points of equal length
    throw BluetoothError(
        fmt::format("{} has protocol {}, at least {} is needed; update its firmware "
                    "with toio's update page",
                    cube.name, version, kLeastVersion));
  }
  const Bytes battery = bluetooth_.read(cube.path, Characteristic::kBattery);
  const auto event = decode_event(Characteristic::kBattery, battery);
  if (const auto* level = event ? std::get_if<Battery>(&*event) : nullptr) {
    if (level->percent < kLeastBattery) {
      throw BluetoothError(
          fmt::format("the battery of {} is at {} %, at least {} % is needed; "
                      "charge it",
                      cube.name, level->percent, kLeastBattery));
    }
  }
}

void CubeSession::add(const FoundCube& cube) {
  bluetooth_.connect(cube.path);
  cubes_.push_back(cube);
  listen_to(cube);
  refuse_unfit(cube);
  set_up(cube);
}

bool CubeSession::regain(const FoundCube& cube) {
  try {
    if (!bluetooth_.connect_meanwhile(cube.path)) return false;
    listen_to(cube);
    set_up(cube);
    return true;
  } catch (const BluetoothError&) {
    return false;  // its link is lost again, or it does not answer yet
  }
}

void CubeSession::listen_to(const FoundCube& cube) {
  told_[cube.path] = {};
  for (const Characteristic c :
       {Characteristic::kId, Characteristic::kMotor, Characteristic::kSensor,
        Characteristic::kButton, Characteristic::kConfiguration}) {
    bluetooth_.subscribe(cube.path, c);
  }
}

void CubeSession::set_up(const FoundCube& cube) {
  require_setting(cube, NotifyId{1, NotifyWhen::kAlways}, 0x98);
  require_setting(cube, NotifyIdMissed{10}, 0x99);
}

std::optional<MatPose> CubeSession::place(const std::string& path) const {
  const auto told = told_.find(path);
  if (told == told_.end() || !told->second.place) return std::nullopt;
  if (seconds_between(told->second.heard, Clock::now()) > kSilence) return std::nullopt;
  return told->second.place;
}

void CubeSession::await_places(double seconds) {
  (void)bluetooth_.wait_until(seconds, [this] {
    return std::ranges::all_of(cubes_, [this](const FoundCube& cube) {
      return told_[cube.path].saw_or_missed || !bluetooth_.connected(cube.path);
    });
  });
}

bool CubeSession::stands_since(const FoundCube& cube, Clock::time_point begin) const {
  const auto told = told_.find(cube.path);
  return told != told_.end() && told->second.place.has_value() &&
         seconds_between(std::max(begin, told->second.moved), told->second.heard) > kRestTime;
}

void CubeSession::stop_all() {
  const Write stop = encode(DriveOn{});
  const Clock::time_point begin = Clock::now();
  try {
    while (seconds_between(begin, Clock::now()) < kStopTime) {
      bool all_stand = true;
      for (const FoundCube& cube : cubes_) {
        if (!bluetooth_.connected(cube.path) || stands_since(cube, begin)) continue;
        all_stand = false;
        bluetooth_.write_now(cube.path, stop);
      }
      if (all_stand) return;
      bluetooth_.wait(kStopPeriod);
    }
  } catch (const BluetoothError&) {
    // The bus is lost: the cubes stop by themselves when their last command ends.
  }
}

bool is_called(const FoundCube& cube, const std::string& name) {
  if (equal_ignoring_case(cube.address, name) || cube.name == name) return true;
  return name.size() == 3 && cube.name.size() > 3 && cube.name.ends_with("-" + name);
}

std::vector<FoundCube> find_cubes(Bluetooth& bluetooth, std::size_t count,
                                  const std::vector<std::string>& named, double seconds) {
  const auto missing = [&](const std::vector<FoundCube>& cubes) {
    std::vector<std::string> names;
    for (const std::string& name : named) {
      const auto called = [&](const FoundCube& cube) { return is_called(cube, name); };
      if (std::ranges::none_of(cubes, called)) names.push_back(name);
    }
    return names;
  };
  const std::vector<FoundCube> cubes =
      bluetooth.scan(seconds, [&](const std::vector<FoundCube>& found) {
        return found.size() >= count && missing(found).empty();
      });
  const std::vector<std::string> names = missing(cubes);
  if (!names.empty()) {
    throw BluetoothError(
        fmt::format("no cube called {} within {:.0f} s; switch it on, or see mvtp "
                    "toio scan",
                    fmt::join(names, ", "), seconds));
  }
  if (cubes.size() < count) {
    throw BluetoothError(
        fmt::format("{} of {} cubes found within {:.0f} s; switch the others on "
                    "near the computer",
                    cubes.size(), count, seconds));
  }
  return cubes;
}

}  // namespace mvtp
