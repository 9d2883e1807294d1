// How fast the replay page draws: 500 vehicles for 10,000 steps, in a headless Chromium.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "planner/problem/text_file.hpp"
#include "tools/runs/temporary_folder.hpp"
#include "tools/view/browser.hpp"
#include "tools/view/page.hpp"
#include "tools/view/replay.hpp"

namespace mvtp {
namespace {

constexpr int kVehicles = 500;
constexpr int kSteps = 10'000;

/// Cars on rings side by side, with waving speeds, groups that change and emissions, and lights.
Replay many_vehicles() {
  ReplayScene scene;
  for (int ring = 0; ring < 25; ++ring) {
    ReplayLane lane;
    for (int i = 0; i <= 60; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 60.0;
      lane.shape.push_back({120.0 * (ring % 5) + 50.0 * std::cos(angle),
                            120.0 * (ring / 5) + 50.0 * std::sin(angle)});
    }
    scene.lanes.push_back(lane);
    const double x = 120.0 * (ring % 5) + 50.0;
    const double y = 120.0 * (ring / 5);
    scene.lights.push_back({.signal = 0, .index = ring, .from = {x - 1.6, y}, .to = {x + 1.6, y}});
  }
  ReplayRecorder recorder({.title = "500 vehicles"}, scene, 0.0);
  const std::size_t signal = recorder.add_signal("s");
  std::vector<ReplayVehicleState> states;
  for (int i = 0; i < kVehicles; ++i) {
    recorder.add_vehicle({.id = std::to_string(i), .kind = i % 7 == 0 ? "bus" : "car"});
    const double angle = 2.0 * std::numbers::pi * (i / 25) / 20.0;
    const int ring = i % 25;
    states.push_back({std::size_t(i),
                      {120.0 * (ring % 5) + 50.0 * std::cos(angle),
                       120.0 * (ring / 5) + 50.0 * std::sin(angle), angle + std::numbers::pi / 2},
                      0.0,
                      ReplayState::kCoordinated});
  }
  for (int k = 0; k < kSteps; ++k) {
    for (ReplayVehicleState& state : states) {
      state.speed = 7.0 + 6.0 * std::sin(0.01 * k + double(state.vehicle));
      state.pose = drive(state.pose, 0.1 * state.speed, 1.0 / 50.0);
      state.group = state.vehicle % 25;
      state.co2 = 2.0 + std::sin(0.05 * k + double(state.vehicle));
    }
    recorder.add_lights(0.1 * k, signal, std::string(25, k / 300 % 2 == 0 ? 'r' : 'G'));
    recorder.add_frame(0.1 * k, states);
  }
  return recorder.finish();
}

/// Draws the page again and again, and has each picture finished.
void draw_page(benchmark::State& state, int width, int height) {
  const auto program = Browser::find();
  if (!program) {
    state.SkipWithError("no Chromium here; install chromium-headless-shell");
    return;
  }
  static const std::string html = to_html(std::vector{many_vehicles()});
  const TemporaryFolder folder;
  const std::string page = (folder.path() / "page.html").string();
  write_text_file(page, html);
  Browser browser(*program, {width, height, 1.0});
  browser.open(page, "t=300");
  (void)browser.evaluate(
      "new Promise((done) => { const look = () => (window.mvtp ? done(1) : setTimeout(look, 50)); "
      "look(); })");
  constexpr int kDraws = 30;
  for (auto _ : state) {
    (void)browser.evaluate("for (let i = 0; i < " + std::to_string(kDraws) +
                           "; ++i) { mvtp.time = 300 + (mvtp.time + 0.037 - 300) % 600; "
                           "mvtp.draw(); mvtp.panes[0].canvas.getContext('2d')"
                           ".getImageData(0, 0, 1, 1); }");
  }
  state.counters["frames/s"] =
      benchmark::Counter(double(state.iterations()) * kDraws, benchmark::Counter::kIsRate);
  state.counters["page MB"] = double(html.size()) / 1e6;
}

BENCHMARK_CAPTURE(draw_page, screen, 1280, 720)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw_page, phone, 390, 844)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mvtp

BENCHMARK_MAIN();
