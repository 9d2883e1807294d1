#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "tools/toio/cube/predictor.hpp"
#include "tools/toio/device/cube_session.hpp"
#include "tools/toio/device/live_run.hpp"

namespace mvtp {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kSpinUnits = 12;
constexpr double kSpinTime = 2.6;  // about one turn [s]
constexpr int kDriveUnits = 25;
constexpr double kDriveTime = 1.0;  // about 70 mm [s]
constexpr int kDrives = 4;
constexpr double kRest = 0.5;  // until the cube stands [s]
constexpr double kKeepAlive = 0.05;
constexpr double kFirstLook = 2.0;  // for the cube to tell where it is [s]

/// One report of the cube and when it came [s].
struct Sample {
  double time = 0.0;
  double x = 0.0;  ///< [dots]
  double y = 0.0;
};

/// Keeps the wheels turning for a time, and records what the cube reports from the first command.
class Recorder {
 public:
  Recorder(CubeSession& session, std::string path)
      : session_(session), bluetooth_(session.bluetooth()), path_(std::move(path)) {
    session_.on_notification([this](const std::string& from, const Notification& notification) {
      const auto event = decode_event(notification.from, notification.bytes);
      if (from != path_ || !event) return;
      missed_ = missed_ || std::holds_alternative<PositionMissed>(*event);
      if (const auto* p = std::get_if<PositionId>(&*event)) {
        samples_.push_back({now(), double(p->x), double(p->y)});
      }
    });
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() { session_.on_notification(nullptr); }

  std::vector<Sample> drive(const WheelUnits& units, double seconds) {
    samples_.clear();
    begin_ = Clock::now();
    while (now() < seconds) {
      bluetooth_.write_now(path_, encode(DriveFor{units, 25}));
      bluetooth_.wait(kKeepAlive);
      if (missed_)
        throw BluetoothError("the cube left the mat; put it in the middle and try again");
    }
    std::vector<Sample> taken = std::move(samples_);
    bluetooth_.write_now(path_, encode(DriveFor{{}, 25}));
    bluetooth_.wait(kRest);
    return taken;
  }

 private:
  [[nodiscard]] double now() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }

  CubeSession& session_;
  Bluetooth& bluetooth_;
  std::string path_;
  Clock::time_point begin_ = Clock::now();
  std::vector<Sample> samples_;
  bool missed_ = false;
};

/// The middle of the values: what one drive that was held up does not change. @pre not empty.
double median(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2.0;
}

/// Radius of the circle that best fits the points [dots]: least squares after I. Kasa, "A circle
/// fitting procedure and its error analysis", IEEE Trans. Instrum. Meas. 25(1), 1976.
double circle_radius(const std::vector<Sample>& samples) {
  double mx = 0.0;
  double my = 0.0;
  for (const Sample& s : samples) {
    mx += s.x / double(samples.size());
    my += s.y / double(samples.size());
  }
  double uu = 0.0;
  double vv = 0.0;
  double uv = 0.0;
  double uq = 0.0;
  double vq = 0.0;
  double q_mean = 0.0;
  for (const Sample& s : samples) {
    const double u = s.x - mx;
    const double v = s.y - my;
    const double q = u * u + v * v;
    uu += u * u;
    vv += v * v;
    uv += u * v;
    uq += u * q;
    vq += v * q;
    q_mean += q / double(samples.size());
  }
  const double determinant = uu * vv - uv * uv;
  if (determinant < 1e-6) return 0.0;  // the centre stood still
  const double a = (uq * vv - vq * uv) / determinant / 2.0;
  const double b = (vq * uu - uq * uv) / determinant / 2.0;
  return std::sqrt(std::max(0.0, q_mean + a * a + b * b));
}

/// The line distance = speed * (time - begin) through the part of a drive at full speed.
struct Line {
  double speed = 0.0;  ///< [dots/s]
  double begin = 0.0;  ///< [s]
};

Line line_of(const std::vector<Sample>& samples) {
  double n = 0.0;
  double st = 0.0;
  double sw = 0.0;
  double stt = 0.0;
  double stw = 0.0;
  for (const Sample& s : samples) {
    if (s.time < 0.5 * kDriveTime) continue;
    const double driven = std::hypot(s.x - samples.front().x, s.y - samples.front().y);
    n += 1.0;
    st += s.time;
    sw += driven;
    stt += s.time * s.time;
    stw += s.time * driven;
  }
  const double determinant = n * stt - st * st;
  if (n < 5.0 || determinant <= 0.0) throw BluetoothError("the cube reports too seldom to measure");
  const double speed = (n * stw - st * sw) / determinant;
  if (speed < 1.0) throw BluetoothError("the cube did not move; is it blocked?");
  return {speed, (st - sw / speed) / n};
}

}  // namespace

Calibration calibrate(Bluetooth& bluetooth, const Mat& mat, const std::string& name,
                      const LiveHooks& hooks) {
  constexpr double kScanTime = 10.0;
  std::vector<std::string> named;
  if (!name.empty()) named.push_back(name);
  const std::vector<FoundCube> found = find_cubes(bluetooth, 1, named, kScanTime);
  const auto wanted = std::ranges::find_if(
      found, [&](const FoundCube& cube) { return name.empty() || is_called(cube, name); });
  CubeSession session(bluetooth);
  hooks.say(fmt::format("measuring {} ({})", wanted->name, wanted->address));
  session.add(*wanted);
  session.await_places(kFirstLook);
  Recorder recorder(session, wanted->path);

  Calibration result;
  result.center_to_axle =
      circle_radius(recorder.drive({kSpinUnits, -kSpinUnits}, kSpinTime)) * mat.metres_per_dot;
  std::vector<double> speeds;
  std::vector<double> lags;
  for (int i = 0; i < kDrives; ++i) {
    const int units = i % 2 == 0 ? kDriveUnits : -kDriveUnits;
    const Line line = line_of(recorder.drive({units, units}, kDriveTime));
    speeds.push_back(line.speed * mat.metres_per_dot / kDriveUnits);
    // The wheels near their speed as exp(-t / kMotorTime): the line begins that much later.
    lags.push_back(line.begin - kMotorTime);
  }
  result.speed_per_unit = median(speeds);
  result.lag = std::max(0.0, median(lags));
  return result;
}

}  // namespace mvtp
