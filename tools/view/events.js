// ---------------------------------------------------------------------------------------------
// The list of what should not have happened, and the strips of clearance and events over time.

const MOST_EVENTS = 400;  // in the list at once
const CLEARANCE_SHOWN = 4;  // [m], height of the strip
const GRAVE = new Set(['overlap', 'person touched']);

/// The events of all replays in the order of time; `app` is told where to go.
class EventList {
  constructor(app) {
    this.app = app;
    this.all = app.replays.flatMap((replay, side) => replay.events.map((event) => ({...event, side})))
        .sort((a, b) => a.time - b.time);
    this.current = null;
    const counts = new Map();
    for (const {kind} of this.all) counts.set(kind, (counts.get(kind) || 0) + 1);
    this.shownKinds = new Set(counts.keys());
    byId('events-section').hidden = this.all.length === 0;
    for (const [kind, count] of counts) {
      const box = element('input', {type: 'checkbox', checked: true});
      box.addEventListener('change', () => {
        if (box.checked) this.shownKinds.add(kind); else this.shownKinds.delete(kind);
        this.list();
        app.changed();
      });
      byId('event-kinds').append(element('label', {}, box, `${count} ${kind}`));
    }
    this.list();
  }

  list() {
    const list = byId('events');
    list.replaceChildren();
    this.listed = this.all.filter((event) => this.shownKinds.has(event.kind));
    for (const event of this.listed.slice(0, MOST_EVENTS)) {
      const button = element('button', {className: GRAVE.has(event.kind) ? 'grave' : '',
                                        onclick: () => this.app.goToEvent(event)},
                             element('span', {}, `${event.time.toFixed(1)} s`),
                             element('span', {}, element('b', {}, event.kind), ' ',
                                     this.describe(event)));
      event.button = button;
      list.append(element('li', {}, button));
    }
    const more = this.listed.length - MOST_EVENTS;
    if (more > 0) list.append(element('li', {className: 'more'}, `and ${more} more (keys N and P)`));
  }

  describe(event) {
    const {app} = this, vehicles = app.replays[event.side].vehicles;
    const names = event.vehicles.map((index) => vehicles[index]?.id ?? '?');
    const depth = GRAVE.has(event.kind) && event.value < 0 ? `${(-event.value).toFixed(3)} m deep` : '';
    const span = event.end - event.time > 0.05 ? `for ${(event.end - event.time).toFixed(1)} s` : '';
    const side = app.replays.length > 1 ? app.nameOf(event.side) : '';
    return [side, names.join(' × '), depth, span, event.text].filter(Boolean).join(' · ');
  }

  /// The next one in a direction, from the current one or from a time.
  next(direction, time) {
    const from = this.current ? this.listed.indexOf(this.current) : -1;
    let k = from + direction;
    if (from < 0) {
      const later = this.listed.findIndex((event) => event.time > time + 1e-6);
      k = direction > 0 ? later : (later < 0 ? this.listed.length : later) - 1;
    }
    return this.listed[k];
  }

  mark(event) {
    if (event === this.current) return;
    this.current?.button?.removeAttribute('aria-current');
    this.current = event;
    event?.button?.setAttribute('aria-current', 'true');
    event?.button?.scrollIntoView({block: 'nearest'});
  }
}

/// Clearance over time (red below half a metre, full height for an overlap), events as ticks, and
/// the moment, of one replay.
class Strip {
  constructor(app, replay, side) {
    Object.assign(this, {app, replay, side, canvas: element('canvas'), still: element('canvas')});
    this.events = app.events.all.filter((event) => event.side === side);
    this.canvas.hidden = !replay.clearance && !this.events.length;
    this.canvas.setAttribute('aria-hidden', 'true');
    byId('strips').append(this.canvas);
    const jump = (event) => {
      const box = this.canvas.getBoundingClientRect();
      app.goTo(app.begin + (event.clientX - box.left) / box.width * (app.end - app.begin));
    };
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      jump(event);
    });
    this.canvas.addEventListener('pointermove', (event) => { if (event.buttons) jump(event); });
  }

  draw() {
    const {app, replay, canvas} = this;
    canvas.hidden = !replay.clearance && !this.events.length;
    if (canvas.hidden || !canvas.clientWidth) return;
    const {context, width, height} = prepareCanvas(canvas);
    const xOf = (t) => (t - app.begin) / Math.max(app.end - app.begin, 1e-3) * width;
    const key = [canvas.width, canvas.height, app.theme.ground, !!replay.clearance,
                 ...app.events.shownKinds].join();
    if (key !== this.key) {  // all but the moment changes seldom
      this.key = key;
      this.still.width = canvas.width;
      this.still.height = canvas.height;
      const still = this.still.getContext('2d');
      still.setTransform(context.getTransform());
      this.drawStill(still, width, height, xOf);
    }
    context.drawImage(this.still, 0, 0, width, height);
    context.fillStyle = app.theme.text;
    context.fillRect(xOf(app.time) - 0.75, 0, 1.5, height);
  }

  drawStill(context, width, height, xOf) {
    const {app, replay} = this, {theme} = app, bottom = height - 2, top = 4;
    const least = this.leastPerPixel(width, xOf);
    for (let x = 0; x < width && least; ++x) {
      if (!(least[x] < Infinity)) continue;
      const share = least[x] < -0.02 ? 1 : Math.min(Math.max(least[x] / CLEARANCE_SHOWN, 0), 1);
      const y = bottom - share * (bottom - top);
      context.fillStyle = least[x] < 0.5 ? theme.alarm : theme.grid;
      context.fillRect(x, y, 1, Math.max(bottom - y, 1));
    }
    context.strokeStyle = theme.grid;
    context.strokeRect(0.5, bottom + 0.5, width - 1, 0.5);
    for (const event of this.events) {
      if (!app.events.shownKinds.has(event.kind)) continue;
      const grave = GRAVE.has(event.kind);
      context.fillStyle = grave ? theme.alarm : theme.zone;
      context.fillRect(xOf(event.time) - 1, top - 4, 2, grave ? height : 9);
    }
    const name = app.replays.length > 1 ? `${app.nameOf(this.side)}: ` : '';
    const text = replay.clearance ? `${name}clearance, 0 to ${CLEARANCE_SHOWN} m` : `${name}events`;
    context.textBaseline = 'top';
    outlinedText(context, theme, text, 4, 2, theme.faint);
  }

  leastPerPixel(width, xOf) {
    const {replay} = this;
    if (!replay.clearance) return null;
    const least = new Float32Array(Math.ceil(width)).fill(Infinity);
    replay.times.forEach((t, frame) => {
      const next = frame + 1 < replay.times.length ? replay.times[frame + 1] : t;
      const c = replay.clearance[frame];
      if (Number.isNaN(c)) return;
      const first = Math.max(0, Math.floor(xOf(t)));
      const last = Math.max(Math.min(Math.ceil(xOf(next)), least.length), first + 1);
      for (let x = first; x < last; ++x) if (c < least[x]) least[x] = c;
    });
    return least;
  }
}
