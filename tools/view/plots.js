// ---------------------------------------------------------------------------------------------
// Diagrams beside the map: speed over time of the selected vehicle, and a time-space diagram of a
// movement.

const byId = (id) => document.getElementById(id);
const SMALL_FONT = '11px system-ui, "DejaVu Sans", sans-serif';

function element(name, properties = {}, ...children) {
  const node = Object.assign(document.createElement(name), properties);
  node.append(...children);
  return node;
}

/// Fits a canvas to its box and returns its context in CSS pixels.
function prepareCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const {clientWidth: width, clientHeight: height} = canvas;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return {context, width, height};
}

function outlinedText(context, theme, text, x, y, colour) {
  context.font = SMALL_FONT;
  context.strokeStyle = theme.halo;
  context.lineWidth = 3;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

/// A round step for about four marks over a range.
function markUnit(range) {
  return [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].find((unit) => range / unit <= 4) || 1000;
}

/// The frame of a diagram: horizontal lines with values, the ends of the time axis, and its title.
function drawPlotFrame(context, theme, {left, right, height, t0, t1, least, most, yOf, title}) {
  context.font = SMALL_FONT;
  context.fillStyle = theme.faint;
  context.strokeStyle = theme.grid;
  context.lineWidth = 1;
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  const unit = markUnit(most - least);
  for (let v = Math.ceil(least / unit) * unit; v <= most; v += unit) {
    context.beginPath();
    context.moveTo(left, yOf(v));
    context.lineTo(right, yOf(v));
    context.stroke();
    context.fillText(String(Number(v.toFixed(1))), left - 4, yOf(v));
  }
  context.textBaseline = 'alphabetic';
  for (const [align, x, text] of [['left', left, `${t0.toFixed(1)} s`], ['right', right, `${t1.toFixed(1)} s`],
                                  ['center', (left + right) / 2, title]]) {
    context.textAlign = align;
    context.fillText(text, x, height - 4);
  }
}

/// Facts about the selected vehicle, and its speed over time in all replays, with its limit.
class VehiclePanel {
  constructor(app) {
    this.app = app;
    byId('plot').addEventListener('pointerdown', (event) => {
      const {t0, t1, left, right} = this.plotted;
      const x = event.clientX - byId('plot').getBoundingClientRect().left;
      app.goTo(t0 + Math.min(Math.max((x - left) / (right - left), 0), 1) * (t1 - t0));
    });
  }

  draw() {
    const {app} = this, {selectedId} = app;
    byId('vehicle').hidden = selectedId === null;
    if (selectedId === null) return;
    const rows = [];
    let known = null;
    app.panes.forEach(({painter, side}) => {
      const index = app.selectedIn(side);
      if (index === null) return;
      known = known || painter.replay.vehicles[index];
      const now = painter.present.find((box) => box.vehicle === index);
      rows.push([app.replays.length > 1 ? app.nameOf(side) : 'now', side,
                 now ? this.describe(now, painter.replay) : 'not on the map']);
      if (painter.tube) rows.push(['tube', -1, describeTube(painter.tube)]);
    });
    if (!known) return;
    const size = `${known.length.toFixed(2)} × ${known.width.toFixed(2)} m`;
    rows.unshift(['vehicle', -1, [known.id, known.kind, size].filter(Boolean).join(' · ')]);
    if (known.movement) rows.splice(1, 0, ['movement', -1, known.movement.replace('>', ' → ')]);
    byId('vehicle-facts').replaceChildren(...rows.map(([label, side, text]) => {
      const head = element('th', {scope: 'row'}, label);
      if (side >= 0) head.prepend(this.lineSample(side));
      return element('tr', {}, head, element('td', {}, text));
    }));
    this.drawPlot(known);
  }

  describe(now, replay) {
    const {track, k} = now;
    const facts = [`${now.speed.toFixed(1)} m/s`, STATES[now.state] ?? '?',
                   `at (${now.x.toFixed(2)}, ${now.y.toFixed(2)})`,
                   `${(wrap(now.heading) * 180 / Math.PI).toFixed(0)}°`];
    if (track.co2) facts.push(`${(track.co2[k] * CO2_UNIT).toFixed(1)} g CO₂ per s`);
    if (track.group?.[k]) {
      facts.push(`priority ${track.rank[k]} in the group of ${replay.vehicles[track.group[k] - 1].id}`);
    }
    return facts.join(', ');
  }

  lineSample(side) {
    const {lines} = this.app.theme, sample = element('i');
    sample.style.borderTopColor = lines[side % lines.length];
    sample.style.borderTopStyle = side ? 'dashed' : 'solid';
    return sample;
  }

  /// What the plot shows: the tracks of the vehicle, and the ranges of time and speed.
  plotOf(known) {
    const {app} = this;
    if (this.plotted?.id === app.selectedId) return this.plotted;
    const plot = {id: app.selectedId, tracks: [], t0: Infinity, t1: -Infinity, most: known.maxSpeed,
                  least: 0, limit: known.maxSpeed, paths: null};
    app.replays.forEach((replay, side) => {
      for (const track of replay.tracksOf[app.selectedIn(side)] || []) {
        plot.tracks.push({replay, track, side});
        plot.t0 = Math.min(plot.t0, replay.times[track.first]);
        plot.t1 = Math.max(plot.t1, replay.times[track.first + track.count - 1]);
        for (const speed of track.speed) {
          plot.most = Math.max(plot.most, speed * SPEED_UNIT);
          plot.least = Math.min(plot.least, speed * SPEED_UNIT);
        }
      }
    });
    plot.t1 = Math.max(plot.t1, plot.t0 + 1e-3);
    plot.most = Math.max(plot.most * 1.08, 0.1);
    return this.plotted = plot;
  }

  drawPlot(known) {
    const {context, width, height} = prepareCanvas(byId('plot')), {theme, time} = this.app;
    const plot = this.plotOf(known), {t0, t1, least, most, limit} = plot;
    if (!plot.tracks.length) return;
    const [left, right, top, bottom] = [34, width - 6, 8, height - 18];
    Object.assign(plot, {left, right});
    const xOf = (t) => left + (t - t0) / (t1 - t0) * (right - left);
    const yOf = (v) => bottom - (v - least) / (most - least) * (bottom - top);
    drawPlotFrame(context, theme, {left, right, height, t0, t1, least, most, yOf, title: 'speed [m/s]'});
    context.strokeStyle = theme.alarm;
    context.setLineDash([5, 4]);
    const limits = limit > 0 ? [limit, ...(least < 0 ? [Math.max(-limit, least)] : [])] : [];
    for (const v of limits) context.strokeRect(left, yOf(v), right - left, 0);
    if (plot.width !== width || !plot.paths) {
      plot.paths = plot.tracks.map(({replay, track}) => this.speedPath(replay, track, xOf, yOf));
      plot.width = width;
    }
    context.lineWidth = 1.8;
    plot.tracks.forEach(({side}, i) => {
      context.strokeStyle = theme.lines[side % theme.lines.length];
      context.setLineDash(side ? [6, 2] : []);
      context.stroke(plot.paths[i]);
    });
    context.setLineDash([]);
    context.fillStyle = theme.text;
    if (t0 <= time && time <= t1) context.fillRect(xOf(time) - 0.75, top, 1.5, bottom - top);
  }

  speedPath(replay, track, xOf, yOf) {
    const path = new Path2D();
    for (let k = 0; k < track.count; ++k) {
      const x = xOf(replay.times[track.first + k]), y = yOf(track.speed[k] * SPEED_UNIT);
      if (replay.steps && k) path.lineTo(xOf(replay.times[track.first + k - 1]), y);
      path.lineTo(x, y);
    }
    return path;
  }
}
