// ---------------------------------------------------------------------------------------------
// Drawing one replay on one canvas. World: metres, y up; screen: CSS pixels, y down.

// Okabe and Ito's colours, told apart by the colour-blind; in grey they differ in lightness too.
const THEMES = {
  light: {
    ground: '#eceee8', road: '#c3c8cf', marking: '#ffffff', outside: '#dcdfe3', solid: '#6a7078',
    text: '#1a1d21', halo: 'rgba(255,255,255,.85)', outline: '#23272d', glass: 'rgba(20,24,30,.62)',
    grid: '#c9cdd3', zone: '#0063a0', alarm: '#c43c00', state: ['#ffffff', '#0072b2', '#f0a500', '#5fb89b'],
    reverse: '#cc3d93', faint: '#59616c', lines: ['#0072b2', '#d55e00', '#009e73', '#cc79a7'],
  },
  dark: {
    ground: '#181c21', road: '#3a414b', marking: '#808a97', outside: '#101317', solid: '#8b939e',
    text: '#e6e9ed', halo: 'rgba(20,23,27,.85)', outline: '#07090b', glass: 'rgba(5,8,12,.7)',
    grid: '#39404a', zone: '#56b4e9', alarm: '#ff7a33', state: ['#d3d8de', '#3fa2e0', '#f0a500', '#4fae8f'],
    reverse: '#e58fc4', faint: '#a0a8b3', lines: ['#56b4e9', '#ff9150', '#2fbf93', '#e58fc4'],
  },
};

// Cividis (Nunez et al. 2018), made for the colour-blind: dark is slow, bright is fast.
const RAMP = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];

function rampColour(fraction) {
  const place = Math.min(Math.max(fraction, 0), 1) * (RAMP.length - 1);
  const k = Math.min(Math.floor(place), RAMP.length - 2);
  const mix = RAMP[k].map((c, i) => Math.round(c + (RAMP[k + 1][i] - c) * (place - k)));
  return `rgb(${mix.join(',')})`;
}

/// Colours of many vehicles: neighbours in index are far apart in hue, and lightness alternates.
function vehicleColour(index) {
  return `hsl(${(index * 137.508 + 205) % 360} ${62 + 12 * (index % 2)}% ${[46, 62, 54][index % 3]}%)`;
}

class Camera {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 1;  // pixels per metre
  }
  toScreen(size, x, y) {
    return [(x - this.x) * this.scale + size.width / 2, size.height / 2 - (y - this.y) * this.scale];
  }
  toWorld(size, sx, sy) {
    return [this.x + (sx - size.width / 2) / this.scale, this.y - (sy - size.height / 2) / this.scale];
  }
  fit(box, size) {
    const margin = Math.min(30, size.width * 0.06);
    this.x = (box[0] + box[2]) / 2;
    this.y = (box[1] + box[3]) / 2;
    this.scale = Math.min((size.width - 2 * margin) / Math.max(box[2] - box[0], 1),
                          (size.height - 2 * margin) / Math.max(box[3] - box[1], 1));
    this.scale = Math.min(Math.max(this.scale, 1e-3), 60);
  }
}

function pathOf(flat, closed) {
  const path = new Path2D();
  for (let i = 0; i + 1 < flat.length; i += 2) path.lineTo(flat[i], flat[i + 1]);
  if (closed) path.closePath();
  return path;
}

function boxOfFlat(box, flat) {
  for (let i = 0; i + 1 < flat.length; i += 2) {
    box[0] = Math.min(box[0], flat[i]);
    box[1] = Math.min(box[1], flat[i + 1]);
    box[2] = Math.max(box[2], flat[i]);
    box[3] = Math.max(box[3], flat[i + 1]);
  }
  return box;
}

/// What does not move, as paths that are built once.
class Scene {
  constructor(replay) {
    const scene = replay.scene;
    this.border = scene.border;
    this.lanes = new Map();   // width -> path of all its lanes
    this.inner = new Map();
    this.stops = new Path2D();
    for (const lane of scene.lanes) {
      const layer = lane.internal ? this.inner : this.lanes;
      if (!layer.has(lane.width)) layer.set(lane.width, new Path2D());
      layer.get(lane.width).addPath(pathOf(lane.shape, false));
      if (lane.stop) this.addStopLine(lane);
    }
    this.junctions = scene.junctions.map((shape) => pathOf(shape, true));
    this.zones = scene.zones.map((shape) => pathOf(shape, true));
    this.solids = scene.polygons.map((shape) => pathOf(shape, true));
    for (const [x, y, radius] of scene.circles) {
      const circle = new Path2D();
      circle.arc(x, y, radius, 0, TURN);
      this.solids.push(circle);
    }
    this.views = this.boundsOf(replay);
  }

  addStopLine(lane) {
    const n = lane.shape.length;
    const [x0, y0, x1, y1] = lane.shape.slice(n - 4);
    const length = Math.hypot(x1 - x0, y1 - y0) || 1;
    const dx = (x1 - x0) / length, dy = (y1 - y0) / length, half = lane.width / 2 - 0.15;
    this.stops.moveTo(x1 - 0.3 * dx - half * dy, y1 - 0.3 * dy + half * dx);
    this.stops.lineTo(x1 - 0.3 * dx + half * dy, y1 - 0.3 * dy - half * dx);
  }

  /// What a view may be fitted to: the zones, if there are any, then everything.
  boundsOf(replay) {
    const none = [Infinity, Infinity, -Infinity, -Infinity], zones = [...none], all = [...none];
    for (const zone of replay.scene.zones) boxOfFlat(zones, zone);
    if (this.border) boxOfFlat(all, [0, 0, ...this.border]);
    for (const lane of replay.scene.lanes) boxOfFlat(all, lane.shape);
    for (const key of ['junctions', 'polygons', 'zones']) {
      for (const shape of replay.scene[key]) boxOfFlat(all, shape);
    }
    for (const [x, y, r] of replay.scene.circles) boxOfFlat(all, [x - r, y - r, x + r, y + r]);
    if (!(all[0] <= all[2])) {
      for (const track of replay.tracks) {
        for (let k = 0; k < track.count; ++k) boxOfFlat(all, [track.x[k] / 100, track.y[k] / 100]);
      }
    }
    const views = [this.surroundings(zones, all), all].filter((box) => box[0] <= box[2]);
    return views.length ? views : [[-20, -20, 20, 20]];
  }

  /// A box with what comes and goes around it: at least 150 m wide and high, but not beyond `limits`.
  surroundings(box, limits) {
    const wider = (low, high) => Math.max(0, (150 - (high - low)) / 2);
    const x = wider(box[0], box[2]), y = wider(box[1], box[3]);
    return [Math.max(box[0] - x, limits[0]), Math.max(box[1] - y, limits[1]),
            Math.min(box[2] + x, limits[2]), Math.min(box[3] + y, limits[3])];
  }

  draw(context, theme, pixel) {
    if (this.border) {
      context.fillStyle = theme.ground;
      context.fillRect(0, 0, ...this.border);
    }
    context.lineJoin = 'round';
    const stroke = (paths, style, wider) => {
      context.strokeStyle = style;
      for (const [width, path] of paths) {
        context.lineWidth = width + wider;
        context.stroke(path);
      }
    };
    stroke(this.lanes, theme.marking, Math.max(0.1, pixel));
    stroke(this.lanes, theme.road, -Math.max(0.1, pixel));
    context.fillStyle = theme.road;
    for (const junction of this.junctions) context.fill(junction);
    stroke(this.inner, theme.road, 0);
    context.strokeStyle = theme.marking;
    context.lineWidth = 0.4;
    context.stroke(this.stops);
    context.fillStyle = theme.solid;
    for (const solid of this.solids) context.fill(solid);
    context.strokeStyle = theme.solid;
    if (this.border) {
      context.lineWidth = 1.5 * pixel;
      context.strokeRect(0, 0, ...this.border);
    }
    context.strokeStyle = theme.zone;
    context.lineWidth = 1.5 * pixel;
    context.setLineDash([6 * pixel, 5 * pixel]);
    for (const zone of this.zones) context.stroke(zone);
    context.setLineDash([]);
  }
}

/// Draws one replay. The caller gives {time, selected, colour, tails, ids, ghosts, nearest,
/// footprints, event, theme} and sets `camera`.
class Painter {
  constructor(replay, canvas) {
    this.replay = replay;
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.scene = new Scene(replay);
    this.camera = new Camera();
    this.still = document.createElement('canvas');
    this.stillKey = '';
    this.size = {width: 0, height: 0, ratio: 1};
    this.topSpeed = this.findTopSpeed();
  }

  findTopSpeed() {
    let top = 0;
    for (const track of this.replay.tracks) {
      for (let k = 0; k < track.count; ++k) top = Math.max(top, Math.abs(track.speed[k]));
    }
    return Math.max(top * SPEED_UNIT, 0.1);
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (width === this.size.width && height === this.size.height && ratio === this.size.ratio) return;
    this.size = {width, height, ratio};
    for (const canvas of [this.canvas, this.still]) {
      canvas.width = Math.max(1, Math.round(width * ratio));
      canvas.height = Math.max(1, Math.round(height * ratio));
    }
    this.stillKey = '';
  }

  useWorld(context) {
    const {width, height, ratio} = this.size, {x, y, scale} = this.camera, s = scale * ratio;
    context.setTransform(s, 0, 0, -s, (width / 2 - x * scale) * ratio, (height / 2 + y * scale) * ratio);
  }

  useScreen(context) {
    const {ratio} = this.size;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  draw(view) {
    const {context, camera, size} = this;
    this.drawStill(view.theme);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.still, 0, 0);
    this.present = snapshot(this.replay, view.time);
    this.pixel = 1 / camera.scale;
    if (view.ghosts) this.drawGhosts(view);
    if (view.tails > 0) this.drawTails(view);
    this.drawSelectedPath(view);
    for (const now of this.present) this.drawVehicle(now, view);
    this.pair = closestPair(this.present);
    if (view.nearest && this.pair) this.drawPair(view.theme);
    if (view.event) this.drawEvent(view.event, view.theme);
    this.useScreen(context);
    if (view.ids || view.selected !== null) this.drawNames(view);
    this.drawScaleBar(view.theme);
    return size;
  }

  drawStill(theme) {
    const {camera, size} = this;
    const key = [camera.x, camera.y, camera.scale, size.width, size.height, theme.ground].join();
    if (key === this.stillKey) return;
    this.stillKey = key;
    const context = this.still.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.scene.border ? theme.outside : theme.ground;
    context.fillRect(0, 0, this.still.width, this.still.height);
    this.useWorld(context);
    this.scene.draw(context, theme, 1 / camera.scale);
  }

  colourOf(now, view) {
    if (view.colour === 'vehicle') return vehicleColour(now.vehicle);
    if (view.colour === 'speed') return rampColour(Math.abs(now.speed) / view.topSpeed);
    return now.speed < -0.02 ? view.theme.reverse : view.theme.state[now.state] || view.theme.faint;
  }

  useVehicle(pose) {
    const {context, size, camera} = this, s = camera.scale * size.ratio;
    const [sx, sy] = camera.toScreen(size, pose.x, pose.y);
    const c = Math.cos(pose.heading) * s, d = Math.sin(pose.heading) * s;
    context.setTransform(c, -d, -d, -c, sx * size.ratio, sy * size.ratio);
  }

  drawVehicle(now, view) {
    const {context, camera, pixel} = this;
    const {length, width, front} = this.replay.vehicles[now.vehicle];
    const rear = front - length, half = width / 2;
    const big = length * camera.scale;
    this.useVehicle(now);
    context.fillStyle = this.colourOf(now, view);
    context.fillRect(rear, -half, length, width);
    if (big > 7) {  // windshield: the narrow end of the trapezoid looks forward
      const cab = Math.min(length * 0.26, 1.6), at = front - Math.min(length * 0.2, 1.4);
      context.fillStyle = view.theme.glass;
      context.beginPath();
      context.moveTo(at - cab * 0.45, half * 0.82);
      context.lineTo(at, half * 0.62);
      context.lineTo(at, -half * 0.62);
      context.lineTo(at - cab * 0.45, -half * 0.82);
      context.fill();
      if (big > 16) context.fillRect(rear + length * 0.06, -half * 0.7, length * 0.05, width * 0.7);
    }
    if (now.speed < -0.02 && big > 7) {
      context.fillStyle = view.theme.reverse;
      context.fillRect(rear - 0.05 * length, -half, 0.1 * length, width);
    }
    context.strokeStyle = view.theme.outline;
    context.lineWidth = big > 7 ? pixel : 0.6 * pixel;
    context.strokeRect(rear, -half, length, width);
    if (now.vehicle === view.selected) {
      context.strokeStyle = view.theme.alarm;
      context.lineWidth = 2.5 * pixel;
      const gap = 3 * pixel;
      context.strokeRect(rear - gap, -half - gap, length + 2 * gap, width + 2 * gap);
    }
  }

  outline(pose, vehicle) {
    this.useVehicle(pose);
    this.context.strokeRect(vehicle.front - vehicle.length, -vehicle.width / 2, vehicle.length,
                            vehicle.width);
  }

  /// Start: dashed; goal: solid with a bar at the front.
  drawGhosts(view) {
    const {context, pixel} = this;
    this.replay.vehicles.forEach((vehicle, index) => {
      if (view.selected !== null && index !== view.selected && this.replay.vehicles.length > 40) return;
      context.strokeStyle = view.colour === 'vehicle' ? vehicleColour(index) : view.theme.faint;
      context.lineWidth = 1.5 * pixel;
      const at = ([x, y, heading]) => this.outline({x, y, heading}, vehicle);
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

  /// Adds the way of the rear axle from time `from` to time `to` to the path, along the arcs.
  trace(track, from, to) {
    const {replay, context} = this;
    const parts = replay.steps ? 6 : this.camera.scale > 4 ? 4 : 1;  // between two frames
    const first = Math.max(frameAt(replay, from) - track.first, 0);
    const fine = 200 * this.pixel;  // [cm]: two pixels
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

  drawTails(view) {
    const {context, pixel} = this, {theme} = view;
    const groups = new Map();  // colour -> vehicles: one stroke each
    for (const now of this.present) {
      const colour = this.colourOf(now, view), visible = colour === theme.state[0] ? theme.faint : colour;
      if (!groups.has(visible)) groups.set(visible, []);
      groups.get(visible).push(now);
    }
    this.useWorld(context);
    context.lineWidth = Math.max(2 * pixel, 0.18);
    context.globalAlpha = 0.55;
    for (const [colour, group] of groups) {
      context.strokeStyle = colour;
      context.beginPath();
      for (const now of group) this.trace(now.track, view.time - view.tails, view.time);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  /// What the selected vehicle has driven, and, dashed, what it will.
  drawSelectedPath(view) {
    if (view.selected === null) return;
    const {context, pixel, replay} = this, tracks = replay.tracksOf[view.selected];
    this.useWorld(context);
    context.strokeStyle = view.theme.alarm;
    context.lineWidth = 1.5 * pixel;
    for (const [from, to, dash] of [[replay.begin, view.time, []],
                                    [view.time, replay.end, [5 * pixel, 4 * pixel]]]) {
      context.setLineDash(dash);
      context.beginPath();
      for (const track of tracks) this.trace(track, from, to);
      context.stroke();
    }
    context.setLineDash([]);
    if (view.footprints) for (const track of tracks) this.drawFootprints(track);
  }

  /// The footprints of the frames, but those hardly moved from the one drawn before.
  drawFootprints(track) {
    const {context, pixel, replay} = this, apart = 100 * Math.max(0.5, 4 * pixel);  // [cm]
    context.globalAlpha = 0.5;
    let last = -1;
    for (let k = 0; k < track.count; ++k) {
      const moved = last < 0 ? Infinity : Math.hypot(track.x[k] - track.x[last], track.y[k] - track.y[last]);
      if (moved < apart) continue;
      last = k;
      context.lineWidth = pixel;
      this.outline(poseOf(track, k), replay.vehicles[track.vehicle]);
    }
    context.globalAlpha = 1;
  }

  drawPair(theme) {
    const {context, pixel, pair} = this;
    this.useWorld(context);
    context.strokeStyle = theme.alarm;
    context.lineWidth = 2 * pixel;
    context.setLineDash([3 * pixel, 3 * pixel]);
    context.beginPath();
    context.moveTo(pair.a.cx, pair.a.cy);
    context.lineTo(pair.b.cx, pair.b.cy);
    context.stroke();
    context.setLineDash([]);
  }

  drawEvent(event, theme) {
    const {context, pixel} = this;
    this.useWorld(context);
    context.strokeStyle = theme.alarm;
    context.lineWidth = 2.5 * pixel;
    context.beginPath();
    context.arc(event.x, event.y, Math.max(4, 18 * pixel), 0, TURN);
    context.stroke();
  }

  drawNames(view) {
    const {context, camera, size} = this;
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.lineWidth = 3;
    context.lineJoin = 'round';
    for (const now of this.present) {
      if (!view.ids && now.vehicle !== view.selected) continue;
      const [x, y] = camera.toScreen(size, now.cx, now.cy);
      if (x < -50 || y < -20 || x > size.width + 50 || y > size.height + 20) continue;
      const id = this.replay.vehicles[now.vehicle].id;
      const text = id.length > 24 ? id.slice(0, 23) + '…' : id;
      const above = y - now.radius * camera.scale - 9;
      context.strokeStyle = view.theme.halo;
      context.strokeText(text, x, above);
      context.fillStyle = view.theme.text;
      context.fillText(text, x, above);
    }
  }

  drawScaleBar(theme) {
    const {context, camera, size} = this;
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

  /// Index of the vehicle at a place on the screen, or null. Fingers get a margin.
  pick(sx, sy, margin) {
    const [x, y] = this.camera.toWorld(this.size, sx, sy);
    let best = null, least = margin / this.camera.scale;
    for (const now of this.present || []) {
      const distance = distanceToBox(now, [x, y]);
      if (distance < least || (distance === 0 && least === 0)) {
        least = distance;
        best = now.vehicle;
      }
    }
    return best;
  }
}
