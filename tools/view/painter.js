// ---------------------------------------------------------------------------------------------
// Drawing one replay on one canvas.

/// Draws one replay. The caller gives {time, selected, mode (of COLOUR_MODES), scale, tails, ids,
/// ghosts, corridors, nearest, footprints, event, theme} and sets `camera`.
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
    const {context, camera, size, replay} = this;
    this.drawStill(view);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.still, 0, 0);
    this.present = snapshot(replay, view.time);
    this.pixel = 1 / camera.scale;
    this.useWorld(context);
    drawLights(context, replay, view.time, view.theme, this.pixel);
    if (view.ghosts) drawGhosts(this, view);
    if (view.tails > 0) drawTails(this, view);
    drawTube(this, view);
    drawSelectedPath(this, view);
    for (const now of this.present) {
      if (this.isInView(now)) this.drawVehicle(now, view);
    }
    this.pair = closestPair(this.present);
    if (view.nearest && this.pair) drawPair(this, view.theme);
    if (view.event) drawEvent(this, view.event, view.theme);
    this.useScreen(context);
    if (view.ids || view.selected !== null) drawNames(this, view);
    drawScaleBar(this, view.theme);
    return size;
  }

  isInView({cx, cy, radius}) {
    const {camera, size} = this, reach = radius + 5 / camera.scale;
    return Math.abs(cx - camera.x) - reach < size.width / 2 / camera.scale &&
        Math.abs(cy - camera.y) - reach < size.height / 2 / camera.scale;
  }

  drawStill({theme, corridors}) {
    const {camera, size} = this;
    const key = [camera.x, camera.y, camera.scale, size.width, size.height, theme.ground,
                 corridors].join();
    if (key === this.stillKey) return;
    this.stillKey = key;
    const context = this.still.getContext('2d');
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = this.scene.border ? theme.outside : theme.ground;
    context.fillRect(0, 0, this.still.width, this.still.height);
    this.useWorld(context);
    this.scene.draw(context, theme, 1 / camera.scale, corridors);
  }

  colourOf(now, view) {
    if (now.person) return view.theme.state[now.state];
    return COLOUR_MODES[view.mode].of(now, this.replay.vehicles[now.vehicle], view.theme, view.scale);
  }

  useVehicle(pose) {
    const {context, size, camera} = this, s = camera.scale * size.ratio;
    const [sx, sy] = camera.toScreen(size, pose.x, pose.y);
    const c = Math.cos(pose.heading) * s, d = Math.sin(pose.heading) * s;
    context.setTransform(c, -d, -d, -c, sx * size.ratio, sy * size.ratio);
  }

  drawPerson(now, view) {
    const {context, pixel} = this, {front} = this.replay.vehicles[now.vehicle];
    context.beginPath();
    context.arc(0, 0, Math.max(front, 2 * pixel), 0, TURN);
    context.fillStyle = this.colourOf(now, view);
    context.fill();
    context.strokeStyle = now.vehicle === view.selected ? view.theme.alarm : view.theme.outline;
    context.lineWidth = (now.vehicle === view.selected ? 2.5 : 0.8) * pixel;
    context.stroke();
  }

  drawVehicle(now, view) {
    const {context, camera, pixel} = this;
    const {length, width, front} = this.replay.vehicles[now.vehicle];
    const rear = front - length, half = width / 2;
    const big = length * camera.scale;
    this.useVehicle(now);
    if (now.person) return this.drawPerson(now, view);
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
