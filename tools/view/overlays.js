// ---------------------------------------------------------------------------------------------
// What is drawn around the vehicles of one replay: tails, paths, footprints, names, the scale bar.

/// Start: dashed; goal: solid with a bar at the front.
function drawGhosts(painter, view) {
  const {context, pixel} = painter;
  painter.replay.vehicles.forEach((vehicle, index) => {
    if (!vehicle.start && !vehicle.goal) return;
    if (view.selected !== null && index !== view.selected && painter.replay.vehicles.length > 40) return;
    context.strokeStyle = view.mode === 'vehicle' ? indexColour(index) : view.theme.faint;
    context.lineWidth = 1.5 * pixel;
    const at = ([x, y, heading]) => painter.outline({x, y, heading}, vehicle);
    context.setLineDash([4 * pixel, 3 * pixel]);
    if (vehicle.start) at(vehicle.start);
    context.setLineDash([]);
    if (!vehicle.goal) return;
    at(vehicle.goal);
    context.fillStyle = context.strokeStyle;
    context.fillRect(vehicle.front - 0.12 * vehicle.length, -vehicle.width / 2,
                     0.12 * vehicle.length, vehicle.width);
  });
}

/// Adds the path of the rear axle from time `from` to time `to` to what is drawn, along the arcs.
function trace(painter, track, from, to) {
  const {replay, context} = painter;
  const parts = replay.steps ? 6 : painter.camera.scale > 4 ? 4 : 1;  // between two frames
  const first = Math.max(frameAt(replay, from) - track.first, 0);
  const fine = 200 * painter.pixel;  // [cm]: two pixels
  let lastX = Infinity, lastY = Infinity;
  const add = (x, y) => {
    if (lastX === Infinity) context.moveTo(x / 100, y / 100); else context.lineTo(x / 100, y / 100);
    [lastX, lastY] = [x, y];
  };
  for (let k = first; k < track.count; ++k) {
    const frame = track.first + k, t0 = replay.times[frame];
    if (t0 > to) break;
    const x = track.x[k], y = track.y[k];
    if (t0 >= from && (Math.abs(x - lastX) > fine || Math.abs(y - lastY) > fine)) {
      add(x, y);
    }
    for (let i = 1; i < parts && frame + 1 < replay.times.length; ++i) {
      const t = t0 + (replay.times[frame + 1] - t0) * i / parts;
      if (t < from || t > to) continue;
      const at = stateAt(replay, track, frame, t);
      add(100 * at.x, 100 * at.y);
    }
  }
  const frame = frameAt(replay, to);
  const end = stateAt(replay, track, frame, to);
  if (end) add(100 * end.x, 100 * end.y);
}

function drawTails(painter, view) {
  const {context, pixel} = painter, {theme} = view;
  const groups = new Map();  // colour -> vehicles: one stroke each
  for (const now of painter.present) {
    if (!painter.isInView(now)) continue;
    const colour = painter.colourOf(now, view), visible = colour === theme.state[0] ? theme.faint : colour;
    if (!groups.has(visible)) groups.set(visible, []);
    groups.get(visible).push(now);
  }
  painter.useWorld(context);
  context.lineWidth = Math.max(2 * pixel, 0.18);
  context.globalAlpha = 0.55;
  for (const [colour, group] of groups) {
    context.strokeStyle = colour;
    context.beginPath();
    for (const now of group) trace(painter, now.track, view.time - view.tails, view.time);
    context.stroke();
  }
  context.globalAlpha = 1;
}

/// What the selected vehicle has driven, and, dashed, what it will.
function drawSelectedPath(painter, view) {
  if (view.selected === null) return;
  const {context, pixel, replay} = painter, tracks = replay.tracksOf[view.selected];
  painter.useWorld(context);
  context.strokeStyle = view.theme.alarm;
  context.lineWidth = 1.5 * pixel;
  for (const [from, to, dash] of [[replay.begin, view.time, []],
                                  [view.time, replay.end, [5 * pixel, 4 * pixel]]]) {
    context.setLineDash(dash);
    context.beginPath();
    for (const track of tracks) trace(painter, track, from, to);
    context.stroke();
  }
  context.setLineDash([]);
  if (view.footprints) for (const track of tracks) drawFootprints(painter, track);
}

/// The footprints of the frames, but those hardly moved from the one drawn before.
function drawFootprints(painter, track) {
  const {context, pixel, replay} = painter, apart = 100 * Math.max(0.5, 4 * pixel);  // [cm]
  context.globalAlpha = 0.5;
  let last = -1;
  for (let k = 0; k < track.count; ++k) {
    const moved = last < 0 ? Infinity : Math.hypot(track.x[k] - track.x[last], track.y[k] - track.y[last]);
    if (moved < apart) continue;
    last = k;
    context.lineWidth = pixel;
    painter.outline(poseOf(track, k), replay.vehicles[track.vehicle]);
  }
  context.globalAlpha = 1;
}

function drawPair(painter, theme) {
  const {context, pixel, pair} = painter;
  painter.useWorld(context);
  context.strokeStyle = theme.alarm;
  context.lineWidth = 2 * pixel;
  context.setLineDash([3 * pixel, 3 * pixel]);
  context.beginPath();
  context.moveTo(pair.a.cx, pair.a.cy);
  context.lineTo(pair.b.cx, pair.b.cy);
  context.stroke();
  context.setLineDash([]);
}

function drawEvent(painter, event, theme) {
  const {context, pixel} = painter;
  painter.useWorld(context);
  context.strokeStyle = theme.alarm;
  context.lineWidth = 2.5 * pixel;
  context.beginPath();
  context.arc(event.x, event.y, Math.max(4, 18 * pixel), 0, TURN);
  context.stroke();
}

function drawNames(painter, view) {
  const {context, camera, size} = painter;
  context.font = '11px system-ui, "DejaVu Sans", sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineWidth = 3;
  context.lineJoin = 'round';
  for (const now of painter.present) {
    if (!view.ids && now.vehicle !== view.selected) continue;
    const [x, y] = camera.toScreen(size, now.cx, now.cy);
    if (x < -50 || y < -20 || x > size.width + 50 || y > size.height + 20) continue;
    const id = painter.replay.vehicles[now.vehicle].id;
    const text = id.length > 24 ? id.slice(0, 23) + '…' : id;
    const above = y - now.radius * camera.scale - 9;
    context.strokeStyle = view.theme.halo;
    context.strokeText(text, x, above);
    context.fillStyle = view.theme.text;
    context.fillText(text, x, above);
  }
}

function drawScaleBar(painter, theme) {
  const {context, camera, size} = painter;
  const most = Math.min(150, size.width * 0.3) / camera.scale;
  const power = 10 ** Math.floor(Math.log10(most));
  const metres = power * [5, 2, 1].find((factor) => factor * power <= most);
  const length = metres * camera.scale, y = size.height - 14;
  context.lineWidth = 4;
  context.strokeStyle = theme.halo;
  const bar = () => {
    context.beginPath();
    context.moveTo(12, y - 5);
    context.lineTo(12, y);
    context.lineTo(12 + length, y);
    context.lineTo(12 + length, y - 5);
    context.stroke();
  };
  bar();
  context.lineWidth = 1.5;
  context.strokeStyle = theme.text;
  bar();
  context.font = '12px system-ui, "DejaVu Sans", sans-serif';
  context.textAlign = 'left';
  context.textBaseline = 'alphabetic';
  context.lineWidth = 3;
  context.strokeStyle = theme.halo;
  const text = metres >= 1000 ? `${metres / 1000} km` : `${Number(metres.toPrecision(1))} m`;
  context.strokeText(text, 18, y - 7);
  context.fillStyle = theme.text;
  context.fillText(text, 18, y - 7);
}
