// ---------------------------------------------------------------------------------------------
// The camera, and what does not move. World: metres, y up; screen: CSS pixels, y down.

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
    this.lanes = new Map();  // 'width kind' -> {width, kind, path of all its lanes}
    this.inner = new Map();
    this.stops = new Path2D();
    for (const lane of scene.lanes) {
      this.addTo(lane.internal ? this.inner : this.lanes, lane);
      if (lane.stop) this.addStopLine(lane);
    }
    this.crossings = new Map();
    for (const crossing of scene.crossings) this.addTo(this.crossings, crossing);
    this.corridors = new Map();
    for (const {zone, shape} of scene.corridors) this.addTo(this.corridors, {width: 2.4, kind: zone, shape});
    this.junctions = scene.junctions.map((shape) => pathOf(shape, true));
    this.zones = scene.zones.map((shape) => pathOf(shape, true));
    this.slots = new Path2D();
    for (const shape of scene.slots) this.slots.addPath(pathOf(shape, false));
    this.solids = scene.polygons.map((shape) => pathOf(shape, true));
    for (const [x, y, radius] of scene.circles) {
      const circle = new Path2D();
      circle.arc(x, y, radius, 0, TURN);
      this.solids.push(circle);
    }
    this.views = this.boundsOf(replay);
  }

  addTo(layer, {width, kind = '', shape}) {
    const key = `${width} ${kind}`;
    if (!layer.has(key)) layer.set(key, {width, kind, path: new Path2D()});
    layer.get(key).path.addPath(pathOf(shape, false));
  }

  addStopLine(lane) {
    const n = lane.shape.length;
    const [x0, y0, x1, y1] = lane.shape.slice(n - 4);
    const length = Math.hypot(x1 - x0, y1 - y0) || 1;
    const dx = (x1 - x0) / length, dy = (y1 - y0) / length, half = lane.width / 2 - 0.15;
    this.stops.moveTo(x1 - 0.3 * dx - half * dy, y1 - 0.3 * dy + half * dx);
    this.stops.lineTo(x1 - 0.3 * dx + half * dy, y1 - 0.3 * dy - half * dx);
  }

  /// What a view may be fitted to: the zones or the parking lot, if there are any, then everything.
  boundsOf(replay) {
    const none = [Infinity, Infinity, -Infinity, -Infinity], zones = [...none], all = [...none];
    const {scene} = replay;
    for (const key of ['zones', 'slots']) for (const shape of scene[key]) boxOfFlat(zones, shape);
    if (this.border) boxOfFlat(all, [0, 0, ...this.border]);
    for (const lane of scene.lanes) boxOfFlat(all, lane.shape);
    for (const key of ['junctions', 'polygons', 'zones', 'slots']) {
      for (const shape of scene[key]) boxOfFlat(all, shape);
    }
    for (const [x, y, r] of scene.circles) boxOfFlat(all, [x - r, y - r, x + r, y + r]);
    if (this.border || !(all[0] <= all[2])) {
      this.addBodies(replay, all);  // which may stick out of a map
    }
    const views = [this.surroundings(zones, all), all].filter((box) => box[0] <= box[2]);
    return views.length ? views : [[-20, -20, 20, 20]];
  }

  addBodies(replay, box) {
    for (const track of replay.tracks) {
      const {length, width, front} = replay.vehicles[track.vehicle];
      const reach = Math.hypot(Math.max(front, length - front), width / 2);
      for (let k = 0; k < track.count; ++k) {
        const x = track.x[k] / 100, y = track.y[k] / 100;
        boxOfFlat(box, [x - reach, y - reach, x + reach, y + reach]);
      }
    }
  }

  /// A box with what comes and goes around it: at least 150 m wide and high, but not beyond `limits`.
  surroundings(box, limits) {
    const wider = (low, high) => Math.max(0, (150 - (high - low)) / 2);
    const x = wider(box[0], box[2]), y = wider(box[1], box[3]);
    return [Math.max(box[0] - x, limits[0]), Math.max(box[1] - y, limits[1]),
            Math.min(box[2] + x, limits[2]), Math.min(box[3] + y, limits[3])];
  }

  draw(context, theme, pixel, withCorridors) {
    if (this.border) {
      context.fillStyle = theme.ground;
      context.fillRect(0, 0, ...this.border);
    }
    context.lineJoin = 'round';
    const stroke = (layer, styleOf, wider) => {
      for (const {width, kind, path} of layer.values()) {
        context.strokeStyle = styleOf(kind);
        context.lineWidth = Math.max(width + wider, pixel);
        context.stroke(path);
      }
    };
    const surface = (kind) => theme.lanes[kind] || theme.road;
    stroke(this.lanes, () => theme.marking, Math.max(0.1, pixel));
    stroke(this.lanes, surface, -Math.max(0.1, pixel));
    context.fillStyle = theme.road;
    for (const junction of this.junctions) context.fill(junction);
    stroke(this.inner, (kind) => (kind === 'foot' ? surface(kind) : theme.road), 0);
    context.setLineDash([0.5, 0.5]);
    stroke(this.crossings, () => theme.marking, 0);
    context.setLineDash([]);
    context.strokeStyle = theme.marking;
    context.lineWidth = 0.4;
    context.stroke(this.stops);
    context.lineWidth = Math.max(0.12, pixel);
    context.stroke(this.slots);
    context.fillStyle = theme.solid;
    for (const solid of this.solids) context.fill(solid);
    context.strokeStyle = theme.solid;
    if (this.border) {
      context.lineWidth = 1.5 * pixel;
      context.strokeRect(0, 0, ...this.border);
    }
    if (withCorridors) this.drawCorridors(context, theme, stroke);
    context.strokeStyle = theme.zone;
    context.lineWidth = 1.5 * pixel;
    context.setLineDash([6 * pixel, 5 * pixel]);
    for (const zone of this.zones) context.stroke(zone);
    context.setLineDash([]);
  }

  /// The corridors as the ground that a control zone takes, one colour each.
  drawCorridors(context, theme, stroke) {
    context.globalAlpha = 0.22;
    context.lineCap = 'butt';
    stroke(this.corridors, (zone) => theme.zones[zone % theme.zones.length], 0);
    context.globalAlpha = 1;
  }
}

/// The lights of the traffic signals at the stop lines, as they are at a time.
function drawLights(context, replay, time, theme, pixel) {
  const {lights} = replay.scene;
  if (!lights.length) return;
  const shown = replay.signals.map((signal) => lightsAt(signal, time));
  const paths = new Map();  // colour -> path
  for (const {signal, index, line} of lights) {
    const colour = lightColour(shown[signal][index], theme);
    if (!paths.has(colour)) paths.set(colour, new Path2D());
    paths.get(colour).moveTo(line[0], line[1]);
    paths.get(colour).lineTo(line[2], line[3]);
  }
  context.lineWidth = Math.max(1.2, 4 * pixel);
  context.lineCap = 'butt';
  for (const [colour, path] of paths) {
    context.strokeStyle = colour;
    context.stroke(path);
  }
}
