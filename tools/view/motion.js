// ---------------------------------------------------------------------------------------------
// Where vehicles are at a moment, and how far apart. Metres, radians, y up, rear axle.

const TURN = 2 * Math.PI;
const wrap = (angle) => angle - TURN * Math.round(angle / TURN);

/// The last frame at or before time t; -1 before the first.
function frameAt(replay, t) {
  let low = -1, high = replay.times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (replay.times[middle] <= t + 1e-9) low = middle; else high = middle;
  }
  return low;
}

function poseOf(track, k) {
  return {x: track.x[k] / 100, y: track.y[k] / 100, heading: track.heading[k] * Math.PI / 1800};
}

/// The pose at a fraction u of the distance from a to b along the arc that joins them: the constant twist of
/// SE(2), which is the very arc if a car drove one.
function alongArc(a, b, u) {
  const turn = wrap(b.heading - a.heading);
  const dx = b.x - a.x, dy = b.y - a.y;
  const phi = u * turn;
  if (Math.abs(turn) < 1e-4) return {x: a.x + u * dx, y: a.y + u * dy, heading: a.heading + phi};
  const c = Math.cos(a.heading), s = Math.sin(a.heading);
  const px = c * dx + s * dy, py = -s * dx + c * dy;
  const half = turn / 2, cot = half / Math.tan(half);
  const vx = (cot * px + half * py) / turn, vy = (cot * py - half * px) / turn;
  const sin = Math.sin(phi), cos = 1 - Math.cos(phi);
  const qx = sin * vx - cos * vy, qy = cos * vx + sin * vy;
  return {x: a.x + c * qx - s * qy, y: a.y + s * qx + c * qy, heading: a.heading + phi};
}

/// Fraction of the distance done after a fraction u of the time, if the speed changes evenly from v0 to v1.
function progress(u, v0, v1) {
  const mean = (v0 + v1) / 2;
  if (v0 * v1 < 0 || Math.abs(mean) < 0.05) return u;
  return (v0 * u + (v1 - v0) * u * u / 2) / mean;
}

/// State of a track at time t in frame `frame` = frameAt(t), or null if it is not there.
function stateAt(replay, track, frame, t) {
  const k = frame - track.first;
  if (k < 0 || k >= track.count) return null;
  const now = {track, k, vehicle: track.vehicle, state: track.state[k]};
  const v0 = track.speed[k] * SPEED_UNIT;
  const t0 = replay.times[frame];
  if (k + 1 >= track.count) return Object.assign(now, poseOf(track, k), {speed: v0});
  const u = (t - t0) / (replay.times[frame + 1] - t0);
  const v1 = track.speed[k + 1] * SPEED_UNIT;
  const share = replay.steps ? u : progress(u, v0, v1);
  Object.assign(now, alongArc(poseOf(track, k), poseOf(track, k + 1), share));
  now.speed = replay.steps ? v1 : v0 + u * (v1 - v0);
  return now;
}

/// The tracks of those who are there in a frame; looked up in lists for blocks of frames, so that it
/// does not matter how many came and went in a long run.
function tracksAt(replay, frame) {
  const BLOCK = 64;
  if (!replay.blocks) {
    replay.blocks = Array.from({length: Math.ceil(replay.times.length / BLOCK)}, () => []);
    for (const track of replay.tracks) {
      const last = Math.floor((track.first + track.count - 1) / BLOCK);
      for (let b = Math.floor(track.first / BLOCK); b <= last; ++b) replay.blocks[b].push(track);
    }
  }
  return replay.blocks[Math.floor(frame / BLOCK)].filter(
      (track) => track.first <= frame && frame < track.first + track.count);
}

/// What a signal shows at time t, a letter for each light; empty before it is known.
function lightsAt(signal, t) {
  let low = -1, high = signal.shown.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (signal.shown[middle][0] <= t + 1e-9) low = middle; else high = middle;
  }
  return low < 0 ? '' : signal.shown[low][1];
}

/// All vehicles at time t, with their boxes: centre cx, cy and half sizes.
function snapshot(replay, t) {
  const frame = frameAt(replay, t);
  const present = [];
  if (frame < 0) return present;
  for (const track of tracksAt(replay, frame)) {
    const now = stateAt(replay, track, frame, t);
    const body = replay.vehicles[track.vehicle];
    addBox(now, body);
    now.person = body.person;
    present.push(now);
  }
  return present;
}

function addBox(pose, vehicle) {
  pose.cos = Math.cos(pose.heading);
  pose.sin = Math.sin(pose.heading);
  const ahead = vehicle.front - vehicle.length / 2;
  pose.cx = pose.x + pose.cos * ahead;
  pose.cy = pose.y + pose.sin * ahead;
  pose.halfLength = vehicle.length / 2;
  pose.halfWidth = vehicle.width / 2;
  pose.radius = Math.hypot(pose.halfLength, pose.halfWidth);
}

function corners(box) {
  const lx = box.cos * box.halfLength, ly = box.sin * box.halfLength;
  const wx = -box.sin * box.halfWidth, wy = box.cos * box.halfWidth;
  return [[lx + wx, ly + wy], [lx - wx, ly - wy], [-lx - wx, -ly - wy], [wx - lx, wy - ly]].map(
      ([x, y]) => [box.cx + x, box.cy + y]);
}

/// How far the boxes are apart along the axes of a, at most; negative: none of them parts the boxes.
function gapAlongAxes(a, b) {
  const dx = b.cx - a.cx, dy = b.cy - a.cy;
  const c = Math.abs(a.cos * b.cos + a.sin * b.sin), s = Math.abs(a.cos * b.sin - a.sin * b.cos);
  return Math.max(
      Math.abs(a.cos * dx + a.sin * dy) - a.halfLength - c * b.halfLength - s * b.halfWidth,
      Math.abs(a.cos * dy - a.sin * dx) - a.halfWidth - s * b.halfLength - c * b.halfWidth);
}

function distanceToBox(box, [x, y]) {
  const dx = x - box.cx, dy = y - box.cy;
  return Math.hypot(Math.max(0, Math.abs(box.cos * dx + box.sin * dy) - box.halfLength),
                    Math.max(0, Math.abs(box.cos * dy - box.sin * dx) - box.halfWidth));
}

/// Distance of two boxes; if they overlap, minus the least shift that parts them.
function boxDistance(a, b) {
  const gap = Math.max(gapAlongAxes(a, b), gapAlongAxes(b, a));
  if (gap <= 0) return gap;
  let least = Infinity;
  for (const corner of corners(a)) least = Math.min(least, distanceToBox(b, corner));
  for (const corner of corners(b)) least = Math.min(least, distanceToBox(a, corner));
  return least;
}

/// The closest pair of vehicles in `present` as {a, b, distance}, or null. A sweep along x.
function closestPair(present) {
  const sorted = present.filter((box) => !box.person).sort((a, b) => a.cx - b.cx);
  const widest = sorted.reduce((most, box) => Math.max(most, box.radius), 0);
  let best = null, least = Infinity;
  for (let i = 0; i < sorted.length; ++i) {
    const a = sorted[i];
    for (let j = i + 1; j < sorted.length; ++j) {
      const b = sorted[j];
      if (b.cx - a.cx > least + a.radius + widest) break;
      const reach = least + a.radius + b.radius;
      if (Math.hypot(b.cx - a.cx, b.cy - a.cy) > reach) continue;
      const distance = boxDistance(a, b);
      if (distance < least) {
        least = distance;
        best = {a, b, distance};
      }
    }
  }
  return best;
}

/// Fills in replay.clearance, the least distance from each frame to the next, a slice at a time.
function measureClearance(replay, whenDone) {
  const SAMPLES = 4, SLICE_MS = 12, MOST_STATES = 400000;
  const states = replay.tracks.reduce((sum, track) => sum + track.count, 0);
  if (replay.clearance || states * SAMPLES > MOST_STATES || replay.vehicles.length < 2) return;
  const clearance = new Float32Array(replay.times.length).fill(NaN);
  let frame = 0;
  const slice = () => {
    const start = performance.now();
    for (; frame < clearance.length; ++frame) {
      if (performance.now() - start > SLICE_MS) return setTimeout(slice, 0);
      const t0 = replay.times[frame];
      const t1 = frame + 1 < clearance.length ? replay.times[frame + 1] : t0;
      for (let i = 0; i < SAMPLES; ++i) {
        const pair = closestPair(snapshot(replay, t0 + (t1 - t0) * i / SAMPLES));
        if (pair && !(pair.distance >= clearance[frame])) clearance[frame] = pair.distance;
      }
    }
    replay.clearance = clearance;
    whenDone();
  };
  setTimeout(slice, 0);
}
