#include "tools/view/video.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/view/base64.hpp"
#include "tools/view/webm.hpp"

namespace mvtp {
namespace {

constexpr int kPicturesPerSecond = 30;
constexpr int kPicturesPerBatch = 30;

/// Makes film(times in the run [s], number of the first), which resolves to the compressed
/// pictures.
constexpr const char* kFilm = R"js(
(async () => {
  document.documentElement.classList.add('film');
  const {mvtp} = window, chunks = [];
  mvtp.draw();
  const {width, height} = mvtp.picture();
  const toText = (chunk) => {
    const bytes = new Uint8Array(chunk.byteLength);
    chunk.copyTo(bytes);
    let text = '';
    for (const byte of bytes) text += String.fromCharCode(byte);
    return btoa(text);
  };
  let failure = null;
  const encoder = new VideoEncoder({
    output: (chunk) => chunks.push([chunk.timestamp / 1000, chunk.type === 'key', toText(chunk)]),
    error: (error) => { failure = error; },
  });
  // VP9: Chromium takes some 40 times as long for VP8.
  encoder.configure({codec: 'vp09.00.62.08', width, height, bitrate: 4 * width * height,
                     framerate: RATE, latencyMode: 'quality'});
  window.film = async (times, first) => {
    for (const [i, time] of times.entries()) {
      mvtp.time = time;
      mvtp.draw();
      const timestamp = Math.round((first + i) * 1e6 / RATE);
      const frame = new VideoFrame(mvtp.picture(), {timestamp});
      encoder.encode(frame, {keyFrame: (first + i) % (2 * RATE) === 0});
      frame.close();
    }
    await encoder.flush();
    if (failure) throw failure;
    return chunks.splice(0);
  };
  return [width, height];
})()
)js";

std::string with_rate(std::string_view script) {
  constexpr std::string_view kName = "RATE";
  std::string text;
  for (std::size_t at; (at = script.find(kName)) != std::string_view::npos;) {
    text += script.substr(0, at);
    text += std::to_string(kPicturesPerSecond);
    script.remove_prefix(at + kName.size());
  }
  return text += script;
}

/// From when to when, checked.
std::pair<double, double> span_of(Browser& browser, const VideoRequest& request) {
  const nlohmann::json run =
      browser.evaluate("[window.mvtp.begin, window.mvtp.time, window.mvtp.end]");
  const double begin = run.at(0);
  const double end = run.at(2);
  const double from = request.from.value_or(run.at(1).get<double>());
  const double to = request.to.value_or(end);
  if (from < begin || to > end || from >= to) {
    throw InputError(
        request.to ? "--to" : "--from",
        fmt::format("the video would go from {:g} to {:g} s; the run goes from {:g} to "
                    "{:g} s",
                    from, to, begin, end));
  }
  return {from, to};
}

void choose_colour(Browser& browser, const std::string& colour) {
  if (colour.empty()) return;
  const nlohmann::json known = browser.evaluate(
      "[...document.getElementById('colour').options].map((option) => option.value)");
  if (std::ranges::find(known, nlohmann::json(colour)) == known.end()) {
    std::string names;
    for (const auto& name : known) names += (names.empty() ? "" : ", ") + name.get<std::string>();
    throw InputError("--colour " + colour, "this run has no such colours; choose one of " + names);
  }
  (void)browser.evaluate("document.getElementById('colour').value = " +
                         nlohmann::json(colour).dump());
}

}  // namespace

std::string to_video(Browser& browser, const std::string& page, const VideoRequest& request,
                     const std::function<void(double)>& progress, const std::atomic<bool>& stop) {
  browser.open(page);
  (void)browser.evaluate(
      "new Promise((done) => { const look = () => (window.mvtp ? done(true) : setTimeout(look, "
      "20)); look(); })");
  const auto [from, to] = span_of(browser, request);
  choose_colour(browser, request.colour);
  const nlohmann::json size = browser.evaluate(with_rate(kFilm));

  const int count = std::max(1, int(std::ceil((to - from) / request.speed * kPicturesPerSecond)));
  std::vector<EncodedFrame> frames;
  for (int first = 0; first < count; first += kPicturesPerBatch) {
    if (stop) return {};
    nlohmann::json times = nlohmann::json::array();
    for (int i = first; i < std::min(first + kPicturesPerBatch, count); ++i) {
      times.push_back(std::min(from + i * request.speed / kPicturesPerSecond, to));
    }
    for (const auto& chunk :
         browser.evaluate("window.film(" + times.dump() + ", " + std::to_string(first) + ")")) {
      frames.push_back({.ms = std::llround(chunk.at(0).get<double>()),
                        .key = chunk.at(1).get<bool>(),
                        .data = from_base64(chunk.at(2).get<std::string>()).value_or("")});
    }
    progress(double(first) / count);
  }
  return to_webm(frames, size.at(0), size.at(1), 1000LL * count / kPicturesPerSecond);
}

}  // namespace mvtp
