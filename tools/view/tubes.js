// ---------------------------------------------------------------------------------------------
// Tubes: where the selected human driver may be some seconds later, as the last decision expects it.

/// The tube of a track at its k-th frame, or null: {k: its frame when it was kept, passes, paths,
/// reaches: [{later [s], least, most [m]}]}.
function tubeAt(replay, track, k) {
  const tube = track.tubes?.findLast((kept) => kept.k <= k);
  if (!tube?.code) return null;
  const {later, units, paths, forks} = replay.tubes;
  return {
    k: tube.k,
    passes: tube.code % 2 === 0,
    paths: forks[(tube.code - 1) >> 1].map((path) => paths[path]),
    reaches: tube.reaches.map(([least, most], h) => (
      {later: later[h], least: least * units[h], most: most * units[h]})),
  };
}

/// The station on a path that is nearest to a place [m].
function stationOn(path, x, y) {
  let best = 0, least = Infinity, station = 0;
  for (let i = 0; i + 3 < path.length; i += 2) {
    const dx = path[i + 2] - path[i], dy = path[i + 3] - path[i + 1], length = Math.hypot(dx, dy) || 1e-9;
    const along = Math.min(Math.max(((x - path[i]) * dx + (y - path[i + 1]) * dy) / length, 0), length);
    const distance = Math.hypot(path[i] + dx * along / length - x, path[i + 1] + dy * along / length - y);
    if (distance < least) [least, best] = [distance, station + along];
    station += length;
  }
  return best;
}

/// Adds the part of a path between two stations to what is drawn; beyond its ends it goes on straight.
function tracePath(context, path, from, to) {
  let station = 0, begun = false;
  for (let i = 0; i + 3 < path.length; i += 2) {
    const dx = path[i + 2] - path[i], dy = path[i + 3] - path[i + 1], length = Math.hypot(dx, dy) || 1e-9;
    const isFirst = i === 0, isLast = i + 5 >= path.length;
    const a = isFirst ? from - station : Math.max(from - station, 0);
    const b = isLast ? to - station : Math.min(to - station, length);
    if (a < b) {
      if (!begun) context.moveTo(path[i] + dx * a / length, path[i + 1] + dy * a / length);
      context.lineTo(path[i] + dx * b / length, path[i + 1] + dy * b / length);
      begun = true;
    }
    station += length;
  }
}

/// The pose of the path at a station.
function placeOn(path, station) {
  let rest = station;
  for (let i = 0;; i += 2) {
    const dx = path[i + 2] - path[i], dy = path[i + 3] - path[i + 1], length = Math.hypot(dx, dy) || 1e-9;
    if (rest <= length || i + 5 >= path.length) {
      return {x: path[i] + dx * rest / length, y: path[i + 1] + dy * rest / length,
              heading: Math.atan2(dy, dx)};
    }
    rest -= length;
  }
}

/// The tube of the selected vehicle. If it passes: for each moment a band from the rear bumper of the
/// slowest to the front bumper of the quickest motion. If it waits: the ground up to its line.
function drawTube(painter, view) {
  const now = painter.present.find((box) => box.vehicle === view.selected);
  const tube = painter.tube = now ? tubeAt(painter.replay, now.track, now.k) : null;
  if (!tube) return;
  const {context, pixel, replay} = painter, {front, length, width} = replay.vehicles[now.vehicle];
  const pose = poseOf(now.track, tube.k);  // since then it has gone on
  for (const path of tube.paths) {
    const here = stationOn(path, pose.x, pose.y);
    painter.useWorld(context);
    context.strokeStyle = view.theme.tube;
    context.lineCap = 'butt';
    context.lineWidth = Math.max(width, 3 * pixel);
    const band = (from, to) => {
      context.beginPath();
      tracePath(context, path, from + front - length, to + front);
      context.stroke();
    };
    context.globalAlpha = tube.passes ? 0.3 : 0.5;
    band(tube.passes ? here : stationOn(path, now.x, now.y), here + tube.reaches.at(-1).most);
    if (tube.passes) for (const {least, most} of tube.reaches) band(here + least, here + most);  // on top
    context.globalAlpha = 1;
    if (tube.passes) drawTubeEnds(painter, view, tube, (most) => placeOn(path, here + most + front));
  }
}

/// A bar with its time across the path where the quickest motion ends.
function drawTubeEnds(painter, view, tube, placeOf) {
  const {context, camera, size, pixel} = painter, half = 1.6;
  for (const {later, most} of tube.reaches) {
    const {x, y, heading} = placeOf(most), dx = -half * Math.sin(heading), dy = half * Math.cos(heading);
    painter.useWorld(context);
    context.strokeStyle = view.theme.text;
    context.lineWidth = Math.max(0.15, 1.5 * pixel);
    context.beginPath();
    context.moveTo(x - dx, y - dy);
    context.lineTo(x + dx, y + dy);
    context.stroke();
    painter.useScreen(context);
    const [sx, sy] = camera.toScreen(size, x + 1.8 * dx, y + 1.8 * dy);
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    outlinedText(context, view.theme, `${later} s`, sx, sy, view.theme.text);
  }
}

/// What a tube means, in one line.
function describeTube({passes, paths, reaches}) {
  const times = reaches.map(({later}) => later).join(' and '), turns = paths.length;
  const where = turns > 1 ? `, on any of ${turns} turns` : '';
  return passes ? `where it may be in ${times} s, from the slowest to the quickest${where}`
    : `anywhere up to its stop line until it has green${where}`;
}
