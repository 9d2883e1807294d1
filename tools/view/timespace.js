// ---------------------------------------------------------------------------------------------
// The time-space diagram of a movement: how far its vehicles are along it, over time, and what the
// signals on its path show.

const WINDOW = 120;  // [s] shown at once

/// A path with its length up to each point. Coordinates in metres.
class MeasuredPath {
  constructor(points) {
    this.points = points;
    this.lengths = [0];
    for (let i = 1; i < points.length; ++i) {
      this.lengths.push(this.lengths[i - 1] +
          Math.hypot(points[i][0] - points[i - 1][0], points[i][1] - points[i - 1][1]));
    }
  }

  get length() { return this.lengths.at(-1); }

  /// {station, distance, piece} of the place nearest to a point, among the pieces within two stations.
  nearest([x, y], from = 0, to = Infinity) {
    let best = {station: from, distance: Infinity, piece: 0};
    for (let i = 1; i < this.points.length; ++i) {
      if (this.lengths[i] < from) continue;
      if (this.lengths[i - 1] > to) break;
      const [ax, ay] = this.points[i - 1], [bx, by] = this.points[i];
      const dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy || 1e-9;
      const u = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / square, 0), 1);
      const distance = Math.hypot(ax + u * dx - x, ay + u * dy - y);
      if (distance >= best.distance) continue;
      best = {station: this.lengths[i - 1] + u * Math.sqrt(square), distance, piece: i};
    }
    return best;
  }
}

/// What the diagram of one replay shows: the lines of its vehicles, and its lights with stations.
function timeSpaceOf(replay, movement) {
  const tracks = replay.tracks.filter(({vehicle}) => (
    !replay.vehicles[vehicle].person && replay.vehicles[vehicle].movement === movement));
  if (!tracks.length) return {lines: [], lights: [], length: 1};
  const pathOfTrack = (track) => {
    const points = [];
    for (let k = 0; k < track.count; ++k) {
      const point = [track.x[k] / 100, track.y[k] / 100], last = points.at(-1);
      if (!last || Math.hypot(point[0] - last[0], point[1] - last[1]) > 0.5) points.push(point);
    }
    return new MeasuredPath(points);
  };
  const path = tracks.map(pathOfTrack).reduce((a, b) => (b.length > a.length ? b : a));
  const lines = tracks.map((track) => {
    const line = new Path2D();
    let station = path.nearest([track.x[0] / 100, track.y[0] / 100]).station;
    for (let k = 0; k < track.count; ++k) {
      const place = [track.x[k] / 100, track.y[k] / 100];
      station = path.nearest(place, station - 5, station + 60).station;
      line.lineTo(replay.times[track.first + k], station);
    }
    return {track, line, t0: replay.times[track.first], t1: replay.times[track.first + track.count - 1]};
  });
  return {lines, lights: lightsOnPath(replay, path), length: Math.max(path.length, 1)};
}

/// Of each stop line on the path the light for those who go on along the path.
function lightsOnPath(replay, path) {
  const lights = [];
  for (const {signal, index, line, target} of replay.scene.lights) {
    if (!target) continue;
    const at = path.nearest([(line[0] + line[2]) / 2, (line[1] + line[3]) / 2]);
    const behind = path.nearest(target).distance;
    if (at.distance > 2.5 || behind > 2.5) continue;
    const same = lights.findIndex((light) => Math.abs(light.station - at.station) < 1);
    if (same < 0) lights.push({signal, index, station: at.station, behind});
    else if (behind < lights[same].behind) lights[same] = {signal, index, station: at.station, behind};
  }
  return lights;
}

class TimeSpace {
  constructor(app) {
    this.app = app;
    this.known = new Map();
    const counts = new Map();
    for (const {movement, person} of app.replays.flatMap((replay) => replay.vehicles)) {
      if (movement && !person) counts.set(movement, (counts.get(movement) || 0) + 1);
    }
    const select = byId('movement');
    byId('movements').hidden = counts.size === 0;
    for (const [movement, count] of [...counts].sort((a, b) => b[1] - a[1]).slice(0, 500)) {
      const text = `${movement.replace('>', ' → ')} (${count})`;
      select.append(element('option', {value: movement}, text));
    }
    select.addEventListener('change', () => {
      app.writeAddress();
      app.changed();
    });
    byId('timespace').style.setProperty('--count', app.replays.length);
    this.canvases = app.replays.map(() => {
      const canvas = element('canvas');
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-label', 'Time-space diagram of the movement');
      canvas.addEventListener('pointerdown', (event) => {
        const x = event.clientX - canvas.getBoundingClientRect().left;
        app.goTo(this.from + (x - this.left) / (this.right - this.left) * (this.to - this.from));
      });
      byId('timespace').append(canvas);
      return canvas;
    });
  }

  get movement() { return byId('movement').value; }

  draw() {
    byId('timespace').hidden = !this.movement;
    if (!this.movement) return;
    const {app} = this;
    this.from = Math.max(Math.min(app.time - WINDOW / 2, app.end - WINDOW), app.begin);
    this.to = Math.max(Math.min(this.from + WINDOW, app.end), this.from + 1);
    app.replays.forEach((replay, side) => this.drawSide(replay, side));
  }

  drawSide(replay, side) {
    const key = `${side} ${this.movement}`;
    if (!this.known.has(key)) this.known.set(key, timeSpaceOf(replay, this.movement));
    const {lines, lights, length} = this.known.get(key);
    const {app, from, to} = this, {theme} = app;
    const {context, width, height} = prepareCanvas(this.canvases[side]);
    const [left, right, top, bottom] = [40, width - 8, 8, height - 18];
    Object.assign(this, {left, right});
    const xOf = (t) => left + (t - from) / (to - from) * (right - left);
    const yOf = (s) => bottom - s / length * (bottom - top);
    const name = app.replays.length > 1 ? `${app.nameOf(side)}: ` : '';
    drawPlotFrame(context, theme, {left, right, height, t0: from, t1: to, least: 0, most: length, yOf,
                                   title: `${name}distance [m] over time`});
    context.save();
    context.beginPath();
    context.rect(left, top, right - left, bottom - top);
    context.clip();
    for (const light of lights) this.drawLight(context, replay.signals[light.signal], light, xOf, yOf);
    const scale = new DOMMatrix([xOf(1) - xOf(0), 0, 0, yOf(1) - yOf(0), xOf(0), yOf(0)]);
    context.lineJoin = 'round';
    for (const {track, line, t0, t1} of lines) {
      if (t1 < from || t0 > to) continue;
      const selected = track.vehicle === app.selectedIn(side);
      context.strokeStyle = selected ? theme.alarm : this.colourOf(replay, track);
      context.lineWidth = selected ? 2.5 : 1.3;
      const path = new Path2D();
      path.addPath(line, scale);
      context.stroke(path);
    }
    context.restore();
    context.fillStyle = theme.text;
    context.fillRect(xOf(app.time) - 0.75, top, 1.5, bottom - top);
  }

  /// In modes that do not change over time as on the map.
  colourOf(replay, track) {
    const {theme, scale} = this.app, mode = byId('colour').value, {vehicle} = track;
    if (!['penetration', 'type', 'vehicle'].includes(mode)) return theme.lines[0];
    return COLOUR_MODES[mode].of({vehicle}, replay.vehicles[vehicle], theme, scale);
  }

  drawLight(context, signal, {index, station}, xOf, yOf) {
    const {from, to, app} = this;
    signal.shown.forEach(([t, letters], i) => {
      const end = i + 1 < signal.shown.length ? signal.shown[i + 1][0] : app.end;
      if (end < from || t > to) return;
      context.fillStyle = lightColour(letters[index], app.theme);
      context.fillRect(xOf(t), yOf(station) - 2, xOf(end) - xOf(t), 4);
    });
  }
}
