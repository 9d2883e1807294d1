// The page as a reader sees it: in a headless Chromium, on a large screen and on a phone.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"
#include "tools/view/base64.hpp"
#include "tools/view/browser.hpp"
#include "tools/view/page.hpp"
#include "tools/view/replay.hpp"
#include "tools/view/webm.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;

const Browser::Size kScreen{1280, 720, 1.0};
const Browser::Size kPhone{390, 844, 1.0};

ReplayRecorder recorder_with(const ReplayScene& scene) {
  ReplayRecorder recorder({.title = "a street"}, scene, 0.0);
  recorder.add_vehicle({.id = "a", .kind = "car", .length = 4.5, .width = 1.8, .front = 3.6});
  recorder.add_vehicle({.id = "b", .kind = "bus", .length = 9.0, .width = 2.5, .front = 7.0});
  recorder.vehicle(0).movement = recorder.vehicle(1).movement = "W>E";
  recorder.vehicle(1).automated = false;
  ReplayVehicle person{.id = "p", .kind = "person", .length = 0.5, .width = 0.5, .front = 0.25};
  person.person = true;
  recorder.add_vehicle(person);
  return recorder;
}

/// A street from x = 0 to 200 with a light at x = 100 that turns green at t = 10 s. Nobody is there
/// before t = 5 s; then `a` drives along it at 10 m/s, `b` stands, and somebody walks beside them.
Replay street() {
  ReplayScene scene;
  scene.lanes = {{.shape = {{0, 0}, {100, 0}}, .stop_line = true}, {.shape = {{100, 0}, {200, 0}}}};
  scene.lights = {{.signal = 0, .index = 0, .from = {99.7, -1.6}, .to = {99.7, 1.6}}};
  scene.lights[0].target = Point{100, 0};
  scene.corridors = {{.zone = 0, .shape = {{40, 0}, {160, 0}}}};
  ReplayRecorder recorder = recorder_with(scene);
  const std::size_t signal = recorder.add_signal("s");
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.5 * i;
    recorder.add_lights(t, signal, t < 10.0 ? "r" : "G");
    if (t < 5.0) {
      recorder.add_frame(t, {});
      continue;
    }
    ReplayVehicleState a{0, {10.0 * (t - 5.0), 0.0, 0.0}, 10.0, ReplayState::kCoordinated};
    ReplayVehicleState b{1, {150, 0, 0}, 0.0, ReplayState::kParked};
    a.group = b.group = 0;
    a.rank = 1;
    b.rank = 2;
    a.co2 = 3.0;
    b.co2 = 0.0;
    recorder.add_frame(t, std::vector{a, b, {2, {20, 5, 0}, 1.0, ReplayState::kWalking}});
  }
  recorder.add_event({.kind = ReplayEventKind::kOffRoad, .time = 6.0, .vehicles = {0}});
  recorder.add_event(
      {.kind = ReplayEventKind::kPersonTouched, .time = 7.0, .vehicles = {0, 2}, .value = -0.012});
  recorder.add_figure({"status", "stuck", ""});
  recorder.add_figure({"people touched", "1", ""});
  return recorder.finish();
}

class Page : public testing::Test {
 protected:
  void SetUp() override {
    const auto program = Browser::find();
    if (!program) {
      GTEST_SKIP() << "no Chromium here to show the page; install chromium-headless-shell";
    }
    browser_ = std::make_unique<Browser>(*program, kScreen);
  }

  void show(const std::vector<Replay>& replays, const std::string& fragment = "") const {
    browser_->open(directory_.file("page.html", to_html(replays)), fragment);
    (void)see(
        "new Promise((done) => { const look = () => (window.mvtp ? done(1) : "
        "setTimeout(look, 10)); look(); })");
    draw();
  }

  [[nodiscard]] Json see(const std::string& expression) const {
    return browser_->evaluate(expression);
  }
  void draw() const { (void)see("window.mvtp?.draw()"); }
  void resize(const Browser::Size& size) const {
    browser_->resize(size);
    (void)see("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
    draw();
  }

  /// The colour on the map of the first pane at a place in the world, as red, green, blue.
  [[nodiscard]] Json colour_at(double x, double y) const {
    return see(
        "(() => { const {painter, canvas} = mvtp.panes[0];"
        "const [x, y] = painter.camera.toScreen(painter.size, " +
        std::to_string(x) + "," + std::to_string(y) +
        "); return [...canvas.getContext('2d').getImageData(Math.round(x), Math.round(y), "
        "1, 1).data].slice(0, 3); })()");
  }

  /// What can be pressed, read or looked at, and reaches beyond the screen.
  [[nodiscard]] Json cut_off() const {
    return see(R"js([...document.querySelectorAll(
          'header h1, header dd, main button, main canvas, footer *, #side select, #side input')]
        .filter((e) => e.checkVisibility() && !e.closest('option'))
        .filter((e) => {
          const b = e.getBoundingClientRect();
          const list = e.closest('#events');
          return !list && b.width > 0 && (b.left < -0.5 || b.right > innerWidth + 0.5 ||
              b.top < -0.5 || b.bottom > innerHeight + 0.5);
        }).map((e) => e.id || e.className || e.tagName))js");
  }

  /// Whatever is seen and reaches beyond the page to its left or right.
  [[nodiscard]] Json wider_than_the_page() const {
    return see(R"js([...document.querySelectorAll('body *')].filter((e) => e.checkVisibility())
        .filter((e) => {
          const b = e.getBoundingClientRect();
          return b.width > 0 && (b.left < -0.5 || b.right > innerWidth + 0.5);
        }).map((e) => e.id || e.className || e.tagName))js");
  }
  [[nodiscard]] double edge(const std::string& id, const std::string& which) const {
    return see("document.getElementById('" + id + "').getBoundingClientRect()." + which)
        .get<double>();
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Browser> browser_;
};

TEST_F(Page, OpensWhenSomebodyIsThereFirst) {
  show({street()});
  EXPECT_EQ(see("mvtp.time"), 5.0);
  EXPECT_EQ(see("document.getElementById('clock').textContent"), "5.00 / 25.0 s");
  EXPECT_EQ(see("document.querySelector('.caption span').textContent"),
            "2 vehicles · 1 on foot · closest 144.40 m: a, b");
  show({street()}, "t=12");
  EXPECT_EQ(see("mvtp.time"), 12.0);
}

TEST_F(Page, CallsEventsWhatTheyAre) {
  show({street()});
  EXPECT_THAT(see("[...document.querySelectorAll('#events li')].map((e) => e.innerText.replace("
                  "/\\s+/g, ' '))"),
              ElementsAre("6.0 s off the road a", "7.0 s person touched a × p · 0.012 m deep"));
  EXPECT_THAT(see("[...document.querySelectorAll('#event-kinds label')].map((e) => e.innerText)"),
              ElementsAre("1 off the road", "1 person touched"));
}

TEST_F(Page, TheHeaderShowsHowItEndedAndWhoWasTouched) {
  show({street()});
  EXPECT_THAT(see("[...document.querySelectorAll('#figures .bad')].map((e) => e.textContent)"),
              ElementsAre("stuck", "1"));
}

TEST_F(Page, LightsShowTheirColoursAtTheStopLine) {
  show({street()}, "t=9.9");
  EXPECT_THAT(colour_at(99.7, 0.8), ElementsAre(0xd5, 0x20, 0x1f));
  (void)see("mvtp.goTo(10)");
  draw();
  EXPECT_THAT(colour_at(99.7, 0.8), ElementsAre(0x00, 0x9e, 0x73));
}

TEST_F(Page, ColoursSayWhoDrivesHowFastAndWithWhom) {
  show({street()}, "t=15.2");  // the rear axle of a is at 102 m
  EXPECT_THAT(
      see("[...document.getElementById('colour').options].map((o) => o.value)"),
      ElementsAre("state", "speed", "co2", "penetration", "type", "group", "priority", "vehicle"));
  const auto colours = [&](const std::string& mode) {
    (void)see("document.getElementById('colour').value = '" + mode + "'");
    draw();
    return std::pair{colour_at(103.5, 0.0), colour_at(152.5, 0.0)};
  };
  EXPECT_THAT(colours("state").first, ElementsAre(0x00, 0x72, 0xb2));
  EXPECT_THAT(colours("state").second, ElementsAre(0x8f, 0x97, 0x9f)) << "parked, not waiting";
  EXPECT_THAT(colours("speed").first, ElementsAre(254, 232, 56));
  EXPECT_THAT(colours("speed").second, ElementsAre(0, 34, 78));
  EXPECT_THAT(colours("co2").first, ElementsAre(254, 232, 56));
  EXPECT_THAT(colours("penetration").first, ElementsAre(0x00, 0x72, 0xb2));
  EXPECT_THAT(colours("penetration").second, ElementsAre(0xf0, 0xa5, 0x00));
  EXPECT_NE(colours("type").first, colours("type").second);
  EXPECT_EQ(colours("group").first, colours("group").second);
  EXPECT_NE(colours("priority").first, colours("priority").second);
}

/// `b` waits for its green at x = 160 until t = 6 s, and then passes. Its path bends to the north
/// at x = 180, and another one goes on to the east.
Replay waiting_and_passing() {
  ReplayScene scene;
  scene.lanes = {{.shape = {{0, 0}, {300, 0}}}};
  ReplayRecorder recorder = recorder_with(scene);
  ReplayTubes& tubes = recorder.tubes();
  const std::size_t north = tubes.add_path({{100, 0}, {180, 0}, {180, 100}});
  const std::size_t east = tubes.add_path({{100, 0}, {300, 0}});
  const std::size_t known = tubes.add_fork({north});
  const std::size_t open = tubes.add_fork({north, east});
  for (int i = 0; i <= 20; ++i) {
    const double t = 5.0 + 0.1 * i;
    const bool passes = t >= 6.0;
    ReplayVehicleState b{1, {153 + i * 0.1, 0, 0}, 1.0, ReplayState::kCarFollowing};
    b.tube = ReplayTube{.fork = passes ? known : open, .passes = passes, .reaches = {}};
    b.tube->reaches = {{{0, 8}, {0, 8}}};
    if (passes) b.tube->reaches = {{{2, 10}, {14, 40}}};
    recorder.add_frame(t, std::vector{b});
  }
  return recorder.finish();
}

TEST_F(Page, TheTubeOfTheSelectedDriverIsTheGroundAhead) {
  show({waiting_and_passing()}, "t=6.5");
  const Json road = colour_at(200.0, 0.9);
  const auto facts = [&] { return see("document.getElementById('vehicle-facts').innerText"); };
  EXPECT_EQ(colour_at(175.0, 0.7), road) << "nobody is selected";
  show({waiting_and_passing()}, "t=6.5&sel=b");
  EXPECT_THAT(facts(), HasSubstr("where it may be in 2 and 4 s, from the slowest to the quickest"));
  EXPECT_NE(colour_at(175.0, 0.7), road);
  EXPECT_NE(colour_at(180.7, 18.0), road) << "round the bend, until 194 + 7 m";
  EXPECT_EQ(colour_at(175.0, 0.7), colour_at(164.0, 0.7)) << "in 4 s; in 2 s";
  EXPECT_NE(colour_at(175.0, 0.7), colour_at(168.5, 0.7)) << "both, from 166 to 171 m";
  const Json ground = colour_at(183.5, 10.0);
  EXPECT_EQ(colour_at(180.7, 24.0), ground);
  EXPECT_EQ(colour_at(200.0, 0.7), road) << "it does not go straight on";
  (void)see("mvtp.select('a')");
  draw();
  EXPECT_EQ(colour_at(175.0, 0.7), road) << "another one is selected";
}

TEST_F(Page, OneWithoutGreenHasTheGroundUpToItsLine) {
  show({waiting_and_passing()}, "t=5.5&sel=b");
  EXPECT_THAT(see("document.getElementById('vehicle-facts').innerText"),
              HasSubstr("anywhere up to its stop line until it has green, on any of 2 turns"));
  const Json road = colour_at(200.0, 0.9);
  EXPECT_NE(colour_at(167.0, 0.7), road) << "153 + 8 + 7 m";
  EXPECT_EQ(colour_at(170.0, 0.7), road);
}

TEST_F(Page, TheTimeSpaceDiagramHasTheVehiclesOfAMovementAndItsLights) {
  show({street()}, "t=12&movement=W%3EE");
  EXPECT_TRUE(see("document.querySelector('#timespace canvas').checkVisibility()"));
  EXPECT_EQ(see("mvtp.timeSpace.known.get('0 W>E').lines.length"), 2);
  EXPECT_EQ(see("mvtp.timeSpace.known.get('0 W>E').lights.length"), 1);
  EXPECT_NEAR(see("mvtp.timeSpace.known.get('0 W>E').lights[0].station").get<double>(), 99.7, 0.1);
  EXPECT_NEAR(see("mvtp.timeSpace.known.get('0 W>E').length").get<double>(), 200.0, 0.1);
  (void)see("document.getElementById('movement').value = ''");
  draw();
  EXPECT_FALSE(see("document.querySelector('#timespace canvas').checkVisibility()"));
}

TEST_F(Page, NothingIsCutOffOnALargeScreenAndOnAPhone) {
  for (const Browser::Size& size : {kScreen, kPhone}) {
    resize(size);
    show({street()}, "t=12&sel=a&movement=W%3EE");
    EXPECT_THAT(cut_off(), IsEmpty()) << size.width;
    EXPECT_EQ(see("document.documentElement.scrollWidth"), size.width);
  }
  (void)see("document.getElementById('show-side').click()");
  draw();
  EXPECT_TRUE(see("document.getElementById('colour').checkVisibility()"));
  EXPECT_THAT(cut_off(), Not(testing::Contains("colour")));
}

//   Two maps, a diagram and the facts on a vehicle are the most that there is to show.
TEST_F(Page, DetailsCoverNoMapOnAPhone) {
  resize(kPhone);
  show({street(), street()}, "t=12&sel=a&movement=W%3EE");
  EXPECT_THAT(wider_than_the_page(), IsEmpty());
  (void)see("document.getElementById('show-side').click()");
  draw();
  EXPECT_THAT(wider_than_the_page(), IsEmpty());
  EXPECT_LE(edge("maps", "bottom"), edge("side", "top"));
  EXPECT_GE(edge("panes", "height"), 80.0);
  EXPECT_GE(edge("side", "height"), 250.0);
  EXPECT_LE(edge("side", "bottom"), edge("strips", "top"));
  (void)see("document.getElementById('show-help').click()");
  EXPECT_THAT(wider_than_the_page(), IsEmpty());
}

TEST_F(Page, AllOfAPlanIsSeenWhateverTheShapeOfTheScreen) {
  ReplayScene map;
  map.border = Point{50, 50};
  ReplayRecorder recorder({.title = "plan", .motion = ReplayMotion::kSteps}, map, 0.0);
  recorder.add_vehicle({.id = "a", .goal = Pose{48, 2, 0}});
  recorder.add_frame(0.0, std::vector<ReplayVehicleState>{{0, {0, 25, 0}, 0.0, {}}});  // sticks out
  const Replay plan = recorder.finish();
  for (const Browser::Size& size : {kScreen, kPhone, kScreen}) {
    resize(size);
    if (size.width == kScreen.width) show({plan});
    const Json corners = see(
        "(() => { const {painter: {camera, size}} = mvtp.panes[0];"
        "return [...camera.toScreen(size, -0.5, 0), ...camera.toScreen(size, 50, 50), size.width, "
        "size.height]; })()");
    EXPECT_GE(corners[0], 0.0) << size.width;
    EXPECT_LE(corners[1], corners[5]) << size.width;
    EXPECT_LE(corners[2], corners[4]) << size.width;
    EXPECT_GE(corners[3], 0.0) << size.width;
  }
}

TEST_F(Page, AVideoPlaysInABrowser) {
  const std::string page = directory_.file("in.html", to_html(std::vector{street()}));
  const std::string program = std::string("'") + MVTP_PROGRAM + "' view '" + page + "' --video '";
  const std::string video = directory_.path("out.webm");
  ASSERT_EQ(std::system((program + video + "' --from 5 --to 25 --speed 10 --quiet").c_str()), 0);
  browser_->open(directory_.file("play.html", "<video muted src='data:video/webm;base64," +
                                                  to_base64(content_of(video)) + "'></video>"));
  const Json seen = see(R"js(new Promise((done, fail) => {
    const v = document.querySelector('video');
    v.onerror = () => fail(new Error(v.error.message));
    v.onseeked = () => {
      const context = Object.assign(document.createElement('canvas'), {width: 1280, height: 720})
          .getContext('2d');
      context.drawImage(v, 0, 0);
      done([v.videoWidth, v.videoHeight, v.duration, v.seekable.end(0),
            ...context.getImageData(640, 60, 1, 1).data]);
    };
    v.currentTime = 1.5;
  }))js");
  EXPECT_THAT(std::vector<double>(seen.begin(), seen.begin() + 4),
              ElementsAre(1280, 720, 2.0, 2.0));
  EXPECT_NEAR(seen[4].get<double>(), 0xec, 3.0) << "the ground beside the road";
  EXPECT_NEAR(seen[5].get<double>(), 0xee, 3.0);
  EXPECT_NEAR(seen[6].get<double>(), 0xe8, 3.0);
}

using ViewVideo = Program;

TEST_F(ViewVideo, RefusesWhatCannotBe) {
  expect_refused("view p.yaml --video v.webm --at 1 -o m.svg",
                 "view: --at excludes --video; see mvtp view --help");
  (void)directory_.file("in.html", to_html(std::vector{street()}));
  expect_refused("view in.html --video a.mp4", "--video: is a.mp4; give a name .*");
  expect_refused("view in.html --from 3", "view: --from requires --video.*");
  const Outcome bare =
      shell(std::string("PATH= '") + MVTP_PROGRAM + "' view in.html --video a.webm");
  EXPECT_EQ(bare.exit_code, 2);
  EXPECT_THAT(bare.err, HasSubstr("--video: needs a browser; install chromium-headless-shell"));
  if (!Browser::find()) GTEST_SKIP() << "no Chromium here; install chromium-headless-shell";
  expect_refused("view in.html --video a.webm -q --to 99",
                 "--to: the video would go from 5 to 99 s; the run goes from 0 to 25 s");
  expect_refused("view in.html --video a.webm -q --colour red",
                 "--colour red: this run has no such colours; choose one of state, .*");
  EXPECT_EQ(shell("ls").out, "in.html\n");
}

TEST(Base64, GivesBackAllBytes) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes.push_back(static_cast<char>(i));
  for (std::size_t n = 0; n < 5; ++n) {
    EXPECT_EQ(from_base64(to_base64(bytes.substr(n))), bytes.substr(n));
  }
  EXPECT_EQ(to_base64("ab"), "YWI=");
  EXPECT_EQ(from_base64("a b"), std::nullopt);
}

TEST(Webm, EachKeyFrameIsInTheIndex) {
  const std::vector<EncodedFrame> frames = {{0, true, "xx"}, {33, false, "y"}, {66, true, "zz"}};
  const std::string file = to_webm(frames, 4, 2, 99);
  EXPECT_THAT(file, HasSubstr("V_VP9")) << "VP8 takes some 40 times as long";
  EXPECT_THAT(file, StartsWith("\x1A\x45\xDF\xA3"));
  const std::string cluster = "\x1F\x43\xB6\x75";
  const std::size_t segment = file.find("\x18\x53\x80\x67") + 12;
  const std::size_t cues = file.find("\x1C\x53\xBB\x6B");
  std::size_t at = cues;
  for (int key = 0; key < 2; ++key) {
    at = file.find("\xF1\x01", at + 1);  // where the next cluster begins in the segment
    ASSERT_NE(at, std::string::npos);
    std::uint64_t where = 0;
    for (std::size_t k = 0; k < 8; ++k)
      where = where << 8 | static_cast<unsigned char>(file[at + 9 + k]);
    EXPECT_EQ(file.substr(segment + where, 4), cluster);
  }
}

}  // namespace
}  // namespace mvtp
