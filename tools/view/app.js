// ---------------------------------------------------------------------------------------------
// The page: state, controls, panels. Text of the replays is set as textContent only.

const RATES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20];
const EVENT_NAMES = {overlap: 'overlap', near: 'near miss', slow: 'slow replan', note: 'note'};
const MOST_EVENTS = 400;  // in the list at once
const CLEARANCE_SHOWN = 4;  // [m], height of the strip
const byId = (id) => document.getElementById(id);

function element(name, properties = {}, ...children) {
  const node = Object.assign(document.createElement(name), properties);
  node.append(...children);
  return node;
}

class App {
  constructor(replays) {
    this.replays = replays;
    const played = replays.filter((replay) => replay.times.length);
    this.begin = Math.min(...played.map((replay) => replay.begin), Infinity);
    this.end = Math.max(...played.map((replay) => replay.end), -Infinity);
    if (!(this.begin <= this.end)) this.begin = this.end = 0;
    this.time = this.begin;
    this.playing = false;
    this.rate = 1;
    this.selectedId = null;
    this.event = null;
    this.following = false;
    this.viewNumber = -1;
    this.darkness = matchMedia('(prefers-color-scheme: dark)');
    this.events = replays.flatMap((replay, side) => replay.events.map((event) => ({...event, side})))
        .sort((a, b) => a.time - b.time);
    this.buildHeader();
    this.buildPanes();
    this.buildSide();
    this.buildTransport();
    this.bindKeys();
    this.readAddress();
    addEventListener('hashchange', () => this.readAddress());
    new ResizeObserver(() => this.changed()).observe(byId('panes'));
    this.darkness.addEventListener('change', () => this.changed());
    for (const event of ['beforeprint', 'afterprint']) {
      addEventListener(event, () => {
        this.printing = event === 'beforeprint';
        this.draw();
      });
    }
    for (const replay of replays) measureClearance(replay, () => this.changed());
  }

  get theme() {
    return this.darkness.matches && !this.printing ? THEMES.dark : THEMES.light;
  }

  nameOf(side) {
    return this.replays[side].label || this.replays[side].title || `run ${side + 1}`;
  }

  /// Index of the selected vehicle in one replay, or null.
  selectedIn(side) {
    const index = this.replays[side].indexOf.get(this.selectedId);
    return index === undefined ? null : index;
  }

  // ----- building ---------------------------------------------------------------------------

  buildHeader() {
    byId('title').textContent = document.title;
    const about = byId('about-text');
    this.replays.forEach((replay, side) => {
      const facts = [this.replays.length > 1 ? this.nameOf(side) : '', replay.version,
                     replay.seed !== '' ? `seed ${replay.seed}` : '',
                     `${replay.vehicles.length} vehicles`, `${replay.times.length} frames`];
      about.append(element('p', {}, facts.filter(Boolean).join(' · ')));
      if (replay.command) about.append(element('p', {}, element('code', {}, replay.command)));
    });
    const labels = [...new Set(this.replays.flatMap((replay) => replay.figures.map((f) => f[0])))];
    const several = this.replays.length > 1;
    const table = byId('figures');
    table.parentElement.hidden = labels.length === 0;
    const head = element('tr', {}, ...labels.map((label) => element('th', {scope: 'col'}, label)));
    if (several) head.prepend(element('th'));
    table.append(element('thead', {}, head));
    const body = element('tbody');
    this.replays.forEach((replay, side) => {
      const row = element('tr');
      if (several) row.append(element('th', {scope: 'row'}, this.nameOf(side)));
      for (const label of labels) {
        const figure = replay.figures.find((f) => f[0] === label);
        const cell = element('td', {}, figure ? figure[1] : '–');
        if (figure && figure[2]) cell.append(element('span', {className: 'unit'}, ` ${figure[2]}`));
        row.append(cell);
      }
      body.append(row);
    });
    table.append(body);
  }

  buildPanes() {
    const {replays} = this;
    this.panes = replays.map((replay, side) => {
      const canvas = element('canvas', {tabIndex: 0});
      canvas.setAttribute('role', 'img');
      canvas.setAttribute('aria-label', `Map of ${this.nameOf(side)}; keys: press ?`);
      const status = element('span');
      const caption = element('div', {className: 'caption'});
      if (this.replays.length > 1) caption.append(element('b', {}, this.nameOf(side)));
      caption.append(status);
      const zoom = element('div', {className: 'zoom'});
      const root = element('div', {className: 'pane'}, canvas, caption, zoom);
      byId('panes').append(root);
      const pane = {canvas, status, painter: new Painter(replay, canvas), side};
      for (const [sign, factor, label] of [['+', 1.5, 'Zoom in'], ['−', 1 / 1.5, 'Zoom out']]) {
        const button = element('button', {title: label, onclick: () => this.zoom(pane, factor)}, sign);
        button.setAttribute('aria-label', label);
        zoom.append(button);
      }
      this.bindPointers(pane);
      return pane;
    });
    this.topSpeed = Math.max(0.1, ...this.panes.map((pane) => pane.painter.topSpeed));
    const [first, ...others] = this.panes.map((pane) => pane.painter.scene.views.at(-1));
    this.linked = others.every((box) => this.alike(first, box));
    // Panes that move together show the same view: the zones of the one that has them.
    const most = this.panes.reduce((all, {painter: {scene: {views}}}) => (
      views.length > all.length ? views : all), []);
    if (this.linked) for (const {painter} of this.panes) painter.scene.views = most;
    this.statesUsed = STATES.map((_, state) => replays.some((replay) => replay.tracks.some(
        (track) => track.state.includes(state))));
    this.reverses = replays.some((replay) => replay.tracks.some(
        (track) => track.speed.some((speed) => speed < -1)));
  }

  /// Do two maps show the same place, so that their views move together?
  alike(a, b) {
    const width = Math.min(a[2], b[2]) - Math.max(a[0], b[0]);
    const height = Math.min(a[3], b[3]) - Math.max(a[1], b[1]);
    const area = (box) => Math.max(box[2] - box[0], 1) * Math.max(box[3] - box[1], 1);
    return width > 0 && height > 0 && width * height > 0.6 * Math.max(area(a), area(b));
  }

  layOut() {
    const panes = byId('panes'), {clientWidth: width, clientHeight: height} = panes;
    const n = this.panes.length;
    let columns = 1, best = 0;
    for (let c = 1; c <= n; ++c) {  // the squarest panes
      const side = Math.min(width / c, height / Math.ceil(n / c));
      if (side > best * 1.02) [best, columns] = [side, c];
    }
    panes.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    panes.style.gridTemplateRows = `repeat(${Math.ceil(n / columns)}, minmax(0, 1fr))`;
    for (const pane of this.panes) pane.painter.resize();
    const size = this.panes.length ? this.panes[0].painter.size : {width: 0};
    if (this.viewNumber < 0 && size.width > 0) this.fit();
  }

  buildSide() {
    const plans = this.replays.every((replay) => replay.steps);
    byId('colour').value = plans ? 'vehicle' : 'state';
    byId('tails').value = plans ? '10' : '3';
    byId('ghosts').checked = plans;
    for (const id of ['colour', 'tails', 'ids', 'ghosts', 'nearest', 'footprints']) {
      byId(id).addEventListener('change', () => this.changed());
    }
    byId('follow').addEventListener('change', () => this.setFollowing(byId('follow').checked));
    const ids = new Set(this.replays.flatMap((replay) => replay.vehicles.map((v) => v.id)));
    byId('vehicle-ids').append(...[...ids].slice(0, 5000).map((id) => element('option', {value: id})));
    byId('find').addEventListener('input', () => {
      const id = byId('find').value;
      if (ids.has(id)) this.select(id, true);
    });
    const plot = byId('plot');
    plot.addEventListener('pointerdown', (event) => {
      const box = plot.getBoundingClientRect();
      this.goTo(this.plotTime(event.clientX - box.left));
    });
    this.buildEvents();
  }

  buildEvents() {
    this.shownKinds = new Set(this.events.map((event) => event.kind));
    byId('events-section').hidden = this.events.length === 0;
    for (const kind of Object.keys(EVENT_NAMES).filter((name) => this.shownKinds.has(name))) {
      const count = this.events.filter((event) => event.kind === kind).length;
      const box = element('input', {type: 'checkbox', checked: true});
      box.addEventListener('change', () => {
        if (box.checked) this.shownKinds.add(kind); else this.shownKinds.delete(kind);
        this.listEvents();
        this.changed();
      });
      byId('event-kinds').append(element('label', {}, box, `${count} ${EVENT_NAMES[kind]}`));
    }
    this.listEvents();
  }

  listEvents() {
    const list = byId('events');
    list.replaceChildren();
    this.listed = this.events.filter((event) => this.shownKinds.has(event.kind));
    for (const event of this.listed.slice(0, MOST_EVENTS)) {
      const button = element('button', {className: event.kind, onclick: () => this.goToEvent(event)},
                             element('span', {}, `${event.time.toFixed(1)} s`),
                             element('span', {}, element('b', {}, EVENT_NAMES[event.kind]), ' ',
                                     this.describe(event)));
      event.button = button;
      list.append(element('li', {}, button));
    }
    const more = this.listed.length - MOST_EVENTS;
    if (more > 0) list.append(element('li', {className: 'more'}, `and ${more} more (keys N and P)`));
  }

  describe(event) {
    const names = event.vehicles.map((index) => this.replays[event.side].vehicles[index]?.id ?? '?');
    const value = {slow: `${event.value.toFixed(1)} ms`, near: `${event.value.toFixed(2)} m`, note: '',
                   overlap: `${Math.abs(event.value).toFixed(3)} m deep`}[event.kind];
    const span = event.end - event.time > 0.05 ? `for ${(event.end - event.time).toFixed(1)} s` : '';
    const side = this.replays.length > 1 ? this.nameOf(event.side) : '';
    return [side, names.join(' × '), value, span, event.text].filter(Boolean).join(' · ');
  }

  buildTransport() {
    const rate = byId('rate');
    rate.append(...RATES.map((r) => element('option', {value: r}, `${r}×`)));
    rate.value = '1';
    rate.addEventListener('change', () => { this.rate = Number(rate.value); });
    byId('play').addEventListener('click', () => this.toggle());
    byId('to-start').addEventListener('click', () => this.goTo(this.begin));
    byId('step-back').addEventListener('click', () => this.step(-1));
    byId('step-on').addEventListener('click', () => this.step(1));
    byId('fit').addEventListener('click', () => this.fit());
    byId('picture').addEventListener('click', () => this.savePicture());
    byId('show-help').addEventListener('click', () => byId('help').showModal());
    byId('show-side').addEventListener('click', () => {
      const open = byId('side').classList.toggle('open');
      byId('show-side').setAttribute('aria-expanded', String(open));
    });
    const scrub = byId('scrub');
    scrub.min = this.begin;
    scrub.max = Math.max(this.end, this.begin + 1e-3);
    scrub.addEventListener('input', () => this.goTo(Number(scrub.value)));
    this.strips = this.replays.map((replay, side) => {
      const canvas = element('canvas');
      canvas.setAttribute('aria-hidden', 'true');
      byId('strips').append(canvas);
      const jump = (event) => {
        const box = canvas.getBoundingClientRect();
        const u = (event.clientX - box.left) / box.width;
        this.goTo(this.begin + u * (this.end - this.begin));
      };
      canvas.addEventListener('pointerdown', (event) => {
        canvas.setPointerCapture(event.pointerId);
        jump(event);
      });
      canvas.addEventListener('pointermove', (event) => { if (event.buttons) jump(event); });
      return {canvas, replay, side};
    });
  }

  // ----- input ------------------------------------------------------------------------------

  bindKeys() {
    const flip = (id) => byId(id).click();
    const cycle = (id) => {
      const select = byId(id);
      select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
      this.changed();
    };
    const pan = (dx, dy) => this.pan(this.panes[0], dx * 60, dy * 60);
    const actions = {
      ' ': () => this.toggle(),
      ArrowLeft: (event) => this.step(event.shiftKey ? -10 : -1),
      ArrowRight: (event) => this.step(event.shiftKey ? 10 : 1),
      Home: () => this.goTo(this.begin), End: () => this.goTo(this.end),
      '+': () => this.changeRate(1), '=': () => this.changeRate(1), '-': () => this.changeRate(-1),
      n: () => this.nextEvent(1), p: () => this.nextEvent(-1),
      f: () => this.fit(), c: () => cycle('colour'), t: () => cycle('tails'),
      i: () => flip('ids'), g: () => flip('ghosts'), l: () => flip('follow'),
      z: () => this.zoom(this.panes[0], 1.5), x: () => this.zoom(this.panes[0], 1 / 1.5),
      w: () => pan(0, 1), s: () => pan(0, -1), a: () => pan(1, 0), d: () => pan(-1, 0),
      Escape: () => this.select(null), '?': () => byId('help').showModal(),
    };
    addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || byId('help').open) return;
      const target = event.target, name = target.tagName;
      const typing = name === 'SELECT' || (name === 'INPUT' && target.type === 'search');
      const pressing = event.key === ' ' && ['BUTTON', 'SUMMARY', 'INPUT'].includes(name) &&
          target.type !== 'range';
      const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
      if (!action || pressing || (typing && event.key !== 'Escape')) return;
      event.preventDefault();
      action(event);
    });
  }

  bindPointers(pane) {
    const {canvas} = pane, pointers = new Map();
    let moved = 0;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      return {x: event.clientX - box.left, y: event.clientY - box.top};
    };
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, size: Math.hypot(a.x - b.x, a.y - b.y)};
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, place(event));
      if (pointers.size === 1) moved = 0;
      canvas.classList.add('moving');
    });
    canvas.addEventListener('pointermove', (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = place(event);
      moved += Math.hypot(now.x - before.x, now.y - before.y);
      if (pointers.size === 1) {
        pointers.set(event.pointerId, now);
        if (moved > 4) this.pan(pane, now.x - before.x, now.y - before.y);
      } else if (pointers.size === 2) {
        const old = spread();
        pointers.set(event.pointerId, now);
        const next = spread();
        this.pan(pane, next.x - old.x, next.y - old.y);
        this.zoom(pane, next.size / Math.max(old.size, 1), next);
      }
    });
    const release = (event) => {
      const at = pointers.get(event.pointerId);
      if (at && pointers.size === 1 && moved <= 4 && event.type === 'pointerup') {
        const index = pane.painter.pick(at.x, at.y, event.pointerType === 'mouse' ? 6 : 18);
        this.select(index === null ? null : pane.painter.replay.vehicles[index].id);
      }
      pointers.delete(event.pointerId);
      if (!pointers.size) canvas.classList.remove('moving');
    };
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('dblclick', (event) => this.zoom(pane, 2, place(event)));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
      this.zoom(pane, Math.exp(-Math.max(-200, Math.min(200, pixels)) * 0.002), place(event));
    }, {passive: false});
  }

  // ----- view -------------------------------------------------------------------------------

  /// All panes that move with this one.
  together(pane) {
    return this.linked ? this.panes : [pane];
  }

  pan(pane, dx, dy) {
    this.setFollowing(false);
    for (const {painter: {camera}} of this.together(pane)) {
      camera.x -= dx / camera.scale;
      camera.y += dy / camera.scale;
    }
    this.changed();
  }

  zoom(pane, factor, at) {
    for (const {painter: {camera, size}} of this.together(pane)) {
      const place = at && !this.following ? at : {x: size.width / 2, y: size.height / 2};
      const [x, y] = camera.toWorld(size, place.x, place.y);
      camera.scale = Math.min(Math.max(camera.scale * factor, 1e-3), 400);
      const [nowX, nowY] = camera.toWorld(size, place.x, place.y);
      camera.x += x - nowX;
      camera.y += y - nowY;
    }
    this.changed();
  }

  fit() {
    ++this.viewNumber;
    this.setFollowing(false);
    for (const {painter} of this.panes) {
      const views = painter.scene.views;
      painter.camera.fit(views[this.viewNumber % views.length], painter.size);
    }
    this.changed();
  }

  setFollowing(on) {
    this.following = on && this.selectedId !== null;
    byId('follow').checked = this.following;
    if (this.following) {
      for (const {painter: {camera}} of this.panes) camera.scale = Math.max(camera.scale, 6);
    }
    this.changed();
  }

  /// @param show move to a moment at which the vehicle is there, and to its place
  select(id, show = false) {
    this.selectedId = id;
    if (id === null) this.setFollowing(false);
    const tracks = this.replays.flatMap((replay, side) => (replay.tracksOf[this.selectedIn(side)] || [])
        .map((track) => [replay.times[track.first], replay.times[track.first + track.count - 1]]));
    if (show && tracks.length && !tracks.some(([t0, t1]) => t0 <= this.time && this.time <= t1)) {
      this.goTo(tracks[0][0]);
    }
    if (show) this.setFollowing(true);
    if (document.activeElement !== byId('find')) byId('find').value = id ?? '';
    this.writeAddress();
    this.changed();
  }

  savePicture() {
    this.draw();
    const sizes = this.panes.map(({canvas}) => canvas);
    const picture = element('canvas', {width: sizes.reduce((sum, c) => sum + c.width, 0),
                                       height: Math.max(...sizes.map((c) => c.height))});
    let x = 0;
    for (const canvas of sizes) {
      picture.getContext('2d').drawImage(canvas, x, 0);
      x += canvas.width;
    }
    picture.toBlob((blob) => {
      const link = element('a', {href: URL.createObjectURL(blob),
                                 download: `replay-${this.time.toFixed(1)}s.png`});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
  }

  // ----- time -------------------------------------------------------------------------------

  toggle() {
    this.playing = !this.playing && this.end > this.begin;
    if (this.playing && this.time >= this.end - 1e-6) this.time = this.begin;
    this.event = null;
    this.lastTick = null;
    if (!this.playing) this.writeAddress();
    this.changed();
  }

  goTo(time, event = null) {
    this.playing = false;
    this.event = event;
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.writeAddress();
    this.changed();
  }

  /// To the next frame of any replay in a direction.
  step(count) {
    let time = this.time;
    for (let i = 0; i < Math.abs(count); ++i) {
      const candidates = this.replays.map((replay) => {
        const k = frameAt(replay, time);
        if (count > 0) return replay.times[k + 1];
        return replay.times[Math.abs(replay.times[k] - time) < 1e-6 ? k - 1 : k];
      }).filter((t) => t !== undefined);
      if (!candidates.length) break;
      time = count > 0 ? Math.min(...candidates) : Math.max(...candidates);
    }
    this.goTo(time);
  }

  changeRate(direction) {
    const k = Math.min(Math.max(RATES.indexOf(this.rate) + direction, 0), RATES.length - 1);
    this.rate = RATES[k];
    byId('rate').value = String(this.rate);
  }

  goToEvent(event) {
    this.viewNumber = Math.max(this.viewNumber, 0);
    const id = this.replays[event.side].vehicles[event.vehicles[0]]?.id;
    if (id !== undefined) this.select(id);
    this.setFollowing(false);
    for (const {painter: {camera}} of this.together(this.panes[event.side])) {
      camera.x = event.x;
      camera.y = event.y;
      camera.scale = Math.max(camera.scale, 9);
    }
    this.goTo(event.time, event);
  }

  nextEvent(direction) {
    const from = this.event ? this.listed.indexOf(this.event) : -1;
    const later = (event) => event.time > this.time + 1e-6;
    let k = from + direction;
    if (from < 0) {
      const next = this.listed.findIndex(later);
      k = direction > 0 ? next : (next < 0 ? this.listed.length : next) - 1;
    }
    if (this.listed[k]) this.goToEvent(this.listed[k]);
  }

  // ----- the address keeps the moment and the vehicle ----------------------------------------

  readAddress() {
    const address = new URLSearchParams(location.hash.slice(1));
    const time = parseFloat(address.get('t'));
    const id = address.get('sel');
    if (id !== null && this.replays.some((replay) => replay.indexOf.has(id))) this.selectedId = id;
    byId('find').value = this.selectedId ?? '';
    if (Number.isFinite(time)) this.time = Math.min(Math.max(time, this.begin), this.end);
    this.changed();
  }

  writeAddress() {
    clearTimeout(this.addressTimer);
    this.addressTimer = setTimeout(() => {
      const address = new URLSearchParams({t: Number(this.time.toFixed(3))});
      if (this.selectedId !== null) address.set('sel', this.selectedId);
      try {
        history.replaceState(null, '', `#${address}`);
      } catch {
        // Some browsers refuse it for files; then the address stays as it is.
      }
    }, 150);
  }

  // ----- drawing ----------------------------------------------------------------------------

  changed() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => {
      this.asked = false;
      if (this.playing) this.advance(now);
      this.draw();
      if (this.playing) this.changed();
    });
  }

  advance(now) {
    const passed = this.lastTick === null ? 0 : Math.min(now - this.lastTick, 250) / 1000;
    this.lastTick = now;
    this.time += passed * this.rate;
    if (this.time < this.end) return;
    this.time = this.end;
    this.playing = false;
    this.writeAddress();
  }

  draw() {
    this.layOut();
    if (this.following) this.centreOnSelected();
    const shared = {
      time: this.time, theme: this.theme, colour: byId('colour').value,
      tails: Number(byId('tails').value), ids: byId('ids').checked, ghosts: byId('ghosts').checked,
      nearest: byId('nearest').checked, footprints: byId('footprints').checked,
      topSpeed: this.topSpeed,
    };
    for (const pane of this.panes) {
      const event = this.event && this.event.side === pane.side ? this.event : null;
      pane.painter.draw({...shared, event, selected: this.selectedIn(pane.side)});
      this.captionOf(pane);
    }
    for (const strip of this.strips) this.drawStrip(strip);
    this.drawTransport();
    this.drawLegend(shared.colour);
    this.drawVehicle();
    for (const event of this.listed.slice(0, MOST_EVENTS)) {
      const current = event === this.event;
      if (current === event.button.hasAttribute('aria-current')) continue;
      if (!current) event.button.removeAttribute('aria-current');
      else event.button.setAttribute('aria-current', 'true');
      if (current) event.button.scrollIntoView({block: 'nearest'});
    }
  }

  captionOf({painter, status}) {
    const {present, pair, replay} = painter;
    const count = `${present.length} vehicle${present.length === 1 ? '' : 's'}`;
    const name = (box) => replay.vehicles[box.vehicle].id;
    const distance = pair && (pair.distance <= -0.02 ? `overlap by ${(-pair.distance).toFixed(2)} m`
        : `closest ${Math.max(pair.distance, 0).toFixed(2)} m`);
    if (this.time > replay.end + 1e-6) {
      status.textContent = `${count} · ended at ${replay.end.toFixed(1)} s`;
      return;
    }
    status.textContent = pair ? `${count} · ${distance}: ${name(pair.a)}, ${name(pair.b)}` : count;
  }

  centreOnSelected() {
    for (const {painter, side} of this.panes) {
      const selected = this.selectedIn(side);
      if (selected === null) continue;
      const frame = frameAt(painter.replay, this.time);
      for (const track of painter.replay.tracksOf[selected]) {
        const now = stateAt(painter.replay, track, frame, this.time);
        if (now) [painter.camera.x, painter.camera.y] = [now.x, now.y];
      }
    }
  }

  drawTransport() {
    byId('clock').textContent = `${this.time.toFixed(2)} / ${this.end.toFixed(1)} s`;
    byId('scrub').value = this.time;
    byId('scrub').setAttribute('aria-valuetext', `${this.time.toFixed(1)} seconds`);
    const play = byId('play');
    const label = this.playing ? 'Pause' : 'Play';
    if (play.getAttribute('aria-label') !== label) {
      play.setAttribute('aria-label', label);
      play.textContent = this.playing ? '❚❚' : '▶';
    }
    document.documentElement.dataset.playing = this.playing;
  }

  drawLegend(colour) {
    const key = `${colour} ${this.theme === THEMES.dark}`;
    if (key === this.legendKey) return;
    this.legendKey = key;
    const legend = byId('legend'), theme = this.theme;
    legend.replaceChildren();
    const add = (background, text, className = '') => {
      const sample = element('i', {className});
      sample.style.background = background;
      legend.append(element('span', {}, sample, text));
    };
    if (colour === 'speed') {
      const stops = [0, 0.2, 0.4, 0.6, 0.8, 1].map(rampColour).join(',');
      add(`linear-gradient(90deg, ${stops})`, `0 to ${this.topSpeed.toFixed(1)} m/s`, 'ramp');
    } else if (colour === 'state') {
      STATES.forEach((name, s) => { if (this.statesUsed[s]) add(theme.state[s], name); });
    } else {
      legend.append(element('span', {}, 'one colour each; start dashed, goal with a bar at its front'));
    }
    if (this.reverses) add(theme.reverse, 'in reverse');
  }

  /// Fits a canvas to its box and returns its context in CSS pixels.
  prepare(canvas) {
    const ratio = window.devicePixelRatio || 1;
    const {clientWidth: width, clientHeight: height} = canvas;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return {context, width, height};
  }

  /// Clearance over time (red below half a metre, full height for an overlap), events as ticks, and the moment.
  drawStrip({canvas, replay, side}) {
    const events = this.events.filter((event) => event.side === side);
    canvas.hidden = !replay.clearance && !events.length;
    if (canvas.hidden) return;
    const {context, width, height} = this.prepare(canvas), {theme} = this;
    const span = Math.max(this.end - this.begin, 1e-3);
    const xOf = (t) => (t - this.begin) / span * width;
    const bottom = height - 2, top = 4;
    const least = this.leastPerPixel(replay, width, xOf);
    for (let x = 0; x < width && least; ++x) {
      if (!(least[x] < Infinity)) continue;
      const share = least[x] < -0.02 ? 1 : Math.min(Math.max(least[x] / CLEARANCE_SHOWN, 0), 1);
      const y = bottom - share * (bottom - top);
      context.fillStyle = least[x] < 0.5 ? theme.alarm : theme.grid;
      context.fillRect(x, y, 1, Math.max(bottom - y, 1));
    }
    context.strokeStyle = theme.grid;
    context.strokeRect(0.5, bottom + 0.5, width - 1, 0.5);
    for (const event of events) {
      if (!this.shownKinds.has(event.kind)) continue;
      context.fillStyle = event.kind === 'overlap' ? theme.alarm : theme.zone;
      context.fillRect(xOf(event.time) - 1, top - 4, 2, event.kind === 'overlap' ? height : 9);
    }
    context.fillStyle = theme.text;
    context.fillRect(xOf(this.time) - 0.75, 0, 1.5, height);
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    context.textBaseline = 'top';
    const name = this.replays.length > 1 ? `${this.nameOf(side)}: ` : '';
    const text = replay.clearance ? `${name}clearance, 0 to ${CLEARANCE_SHOWN} m` : `${name}events`;
    context.strokeStyle = theme.halo;
    context.lineWidth = 3;
    context.strokeText(text, 4, 2);
    context.fillStyle = theme.faint;
    context.fillText(text, 4, 2);
  }

  leastPerPixel(replay, width, xOf) {
    if (!replay.clearance) return null;
    if (replay.leastWidth === width) return replay.least;
    const least = new Float32Array(Math.ceil(width)).fill(Infinity);
    replay.times.forEach((t, frame) => {
      const next = frame + 1 < replay.times.length ? replay.times[frame + 1] : t;
      const c = replay.clearance[frame];
      if (Number.isNaN(c)) return;
      const last = Math.min(Math.ceil(xOf(next)), least.length);
      for (let x = Math.max(0, Math.floor(xOf(t))); x < Math.max(last, Math.floor(xOf(t)) + 1); ++x) {
        if (c < least[x]) least[x] = c;
      }
    });
    [replay.leastWidth, replay.least] = [width, least];
    return least;
  }

  // ----- the selected vehicle ----------------------------------------------------------------

  drawVehicle() {
    byId('vehicle').hidden = this.selectedId === null;
    if (this.selectedId === null) return;
    const rows = [];
    let known = null;
    this.panes.forEach(({painter, side}) => {
      const index = this.selectedIn(side);
      if (index === null) return;
      known = known || painter.replay.vehicles[index];
      const now = painter.present.find((box) => box.vehicle === index);
      const label = this.replays.length > 1 ? this.nameOf(side) : 'now';
      rows.push([label, side, now ? `${now.speed.toFixed(1)} m/s, ${STATES[now.state] ?? '?'}, at (` +
          `${now.x.toFixed(2)}, ${now.y.toFixed(2)}), ${(wrap(now.heading) * 180 / Math.PI).toFixed(0)}°`
        : 'not on the map']);
    });
    if (!known) return;
    const size = `${known.length.toFixed(2)} × ${known.width.toFixed(2)} m`;
    rows.unshift(['vehicle', -1, [known.id, known.kind, size].filter(Boolean).join(' · ')]);
    byId('vehicle-facts').replaceChildren(...rows.map(([label, side, text]) => {
      const head = element('th', {scope: 'row'}, label);
      if (side >= 0) head.prepend(this.lineSample(side));
      return element('tr', {}, head, element('td', {}, text));
    }));
    this.drawPlot(known);
  }

  lineSample(side) {
    const sample = element('i');
    sample.style.borderTopColor = this.theme.lines[side % this.theme.lines.length];
    sample.style.borderTopStyle = side ? 'dashed' : 'solid';
    return sample;
  }

  /// What the plot of the selected vehicle shows: its tracks, and the ranges of time and speed.
  plotOf(known) {
    if (this.plotted?.id === this.selectedId) return this.plotted;
    const plot = {id: this.selectedId, tracks: [], t0: Infinity, t1: -Infinity, most: known.maxSpeed,
                  least: 0, limit: known.maxSpeed, paths: null};
    this.replays.forEach((replay, side) => {
      for (const track of replay.tracksOf[this.selectedIn(side)] || []) {
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

  /// Speed over time of the selected vehicle in all replays, with its limit.
  drawPlot(known) {
    const {context, width, height} = this.prepare(byId('plot')), {theme} = this;
    const plot = this.plotOf(known), {t0, t1} = plot;
    if (!plot.tracks.length) return;
    const [left, right, top, bottom] = [34, width - 6, 8, height - 18];
    Object.assign(plot, {left, right});
    const xOf = (t) => left + (t - t0) / (t1 - t0) * (right - left);
    const yOf = (v) => bottom - (v - plot.least) / (plot.most - plot.least) * (bottom - top);
    this.drawPlotFrame(context, plot, {left, right, height}, yOf);
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
    if (t0 <= this.time && this.time <= t1) context.fillRect(xOf(this.time) - 0.75, top, 1.5, bottom - top);
  }

  drawPlotFrame(context, {t0, t1, most, least, limit}, {left, right, height}, yOf) {
    const {theme} = this;
    const rule = (y, colour, dash) => {
      context.strokeStyle = colour;
      context.setLineDash(dash);
      context.beginPath();
      context.moveTo(left, y);
      context.lineTo(right, y);
      context.stroke();
      context.setLineDash([]);
    };
    context.font = '11px system-ui, "DejaVu Sans", sans-serif';
    context.fillStyle = theme.faint;
    context.lineWidth = 1;
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const unit = [0.5, 1, 2, 5, 10, 20, 50].find((u) => (most - least) / u <= 4) || 100;
    for (let v = Math.ceil(least / unit) * unit; v <= most; v += unit) {
      rule(yOf(v), theme.grid, []);
      context.fillText(String(Number(v.toFixed(1))), left - 4, yOf(v));
    }
    context.textBaseline = 'alphabetic';
    for (const [align, x, text] of [['left', left, `${t0.toFixed(1)} s`], ['right', right, `${t1.toFixed(1)} s`],
                                    ['center', (left + right) / 2, 'speed [m/s]']]) {
      context.textAlign = align;
      context.fillText(text, x, height - 4);
    }
    if (limit > 0) rule(yOf(limit), theme.alarm, [5, 4]);
    if (limit > 0 && least < 0) rule(yOf(Math.max(-limit, least)), theme.alarm, [5, 4]);
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

  plotTime(x) {
    const {t0, t1, left, right} = this.plotted;
    return t0 + Math.min(Math.max((x - left) / (right - left), 0), 1) * (t1 - t0);
  }
}

function showMessage(text) {
  byId('message').textContent = text;
  byId('message').hidden = false;
}

(async () => {
  if (typeof DecompressionStream === 'undefined') {
    showMessage('This browser is too old to unpack the replay; use one of 2023 or later.');
    return;
  }
  try {
    const replays = await decodePage();
    if (!replays.length) showMessage('There is no replay in this page.');
    window.mvtp = new App(replays);
  } catch (error) {
    showMessage(`The replay in this page cannot be read: ${error.message}`);
    throw error;
  }
})();
