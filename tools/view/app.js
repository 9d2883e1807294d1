// ---------------------------------------------------------------------------------------------
// The page: state, controls, what is drawn when. Text of the replays is set as textContent only.

const RATES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20];

class App {
  constructor(replays) {
    this.replays = replays;
    const played = replays.filter((replay) => replay.times.length);
    this.begin = Math.min(...played.map((replay) => replay.begin), Infinity);
    this.end = Math.max(...played.map((replay) => replay.end), -Infinity);
    if (!(this.begin <= this.end)) this.begin = this.end = 0;
    this.time = Math.max(this.begin, Math.min(...played.map((replay) => replay.firstSeen), this.end));
    this.steps = replays.every((replay) => replay.steps);
    this.scale = colourScale(replays);
    this.playing = false;
    this.rate = 1;
    this.selectedId = null;
    this.following = false;
    this.viewNumber = -1;
    this.darkness = matchMedia('(prefers-color-scheme: dark)');
    buildHeader(this);
    this.buildPanes();
    this.events = new EventList(this);
    this.buildSide();
    this.vehiclePanel = new VehiclePanel(this);
    this.timeSpace = new TimeSpace(this);
    this.strips = replays.map((replay, side) => new Strip(this, replay, side));
    buildTransport(this);
    bindKeys(this);
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

  buildPanes() {
    this.panes = this.replays.map((replay, side) => {
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
      bindPointers(this, pane);
      return pane;
    });
    const [first, ...others] = this.panes.map((pane) => pane.painter.scene.views.at(-1));
    this.linked = others.every((box) => alike(first, box));
    // Panes that move together show the same view: the zones of the one that has them.
    const most = this.panes.reduce((all, {painter: {scene: {views}}}) => (
      views.length > all.length ? views : all), []);
    if (this.linked) for (const {painter} of this.panes) painter.scene.views = most;
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
    const before = this.panes.map(({painter}) => painter.size);
    for (const {painter} of this.panes) painter.resize();
    const resized = this.panes.some(({painter}, i) => painter.size !== before[i]);
    if (!resized || !(this.panes[0]?.painter.size.width > 0)) return;
    if (this.viewNumber < 0) this.fit(); else if (this.fitted) this.fitAgain();
  }

  buildSide() {
    const colour = byId('colour');
    for (const [mode, {name, has}] of Object.entries(COLOUR_MODES)) {
      if (has(this.scale, this.steps)) colour.append(element('option', {value: mode}, name));
    }
    colour.value = this.steps ? 'vehicle' : 'state';
    byId('tails').value = this.steps ? '10' : '3';
    byId('ghosts').checked = this.steps;
    byId('ghosts-label').hidden = !this.replays.some(({vehicles}) => vehicles.some((v) => v.goal));
    byId('corridors-label').hidden = !this.replays.some(({scene}) => scene.corridors.length);
    for (const id of ['colour', 'tails', 'ids', 'ghosts', 'nearest', 'footprints', 'corridors']) {
      byId(id).addEventListener('change', () => {
        this.writeAddress();
        this.changed();
      });
    }
    byId('follow').addEventListener('change', () => this.setFollowing(byId('follow').checked));
    const ids = new Set(this.replays.flatMap((replay) => replay.vehicles.map((v) => v.id)));
    byId('vehicle-ids').append(...[...ids].slice(0, 5000).map((id) => element('option', {value: id})));
    byId('find').addEventListener('input', () => {
      const id = byId('find').value;
      if (ids.has(id)) this.select(id, true);
    });
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
    this.fitted = false;
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
    this.fitted = false;
    this.changed();
  }

  /// The next of the views that there are.
  fit() {
    ++this.viewNumber;
    this.setFollowing(false);
    this.fitAgain();
    this.changed();
  }

  fitAgain() {
    this.fitted = true;
    for (const {painter} of this.panes) {
      const views = painter.scene.views;
      painter.camera.fit(views[this.viewNumber % views.length], painter.size);
    }
  }

  setFollowing(on) {
    this.following = on && this.selectedId !== null;
    byId('follow').checked = this.following;
    if (this.following) {
      this.fitted = false;
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

  // ----- time -------------------------------------------------------------------------------

  toggle() {
    this.playing = !this.playing && this.end > this.begin;
    if (this.playing && this.time >= this.end - 1e-6) this.time = this.begin;
    this.events.mark(null);
    this.lastTick = null;
    if (!this.playing) this.writeAddress();
    this.changed();
  }

  goTo(time, event = null) {
    this.playing = false;
    this.events.mark(event);
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
    this.fitted = false;
    for (const {painter: {camera}} of this.together(this.panes[event.side])) {
      camera.x = event.x;
      camera.y = event.y;
      camera.scale = Math.max(camera.scale, 9);
    }
    this.goTo(event.time, event);
  }

  nextEvent(direction) {
    const event = this.events.next(direction, this.time);
    if (event) this.goToEvent(event);
  }

  // ----- the address keeps the moment, the vehicle, the colours and the movement ---------------

  readAddress() {
    const address = new URLSearchParams(location.hash.slice(1));
    const time = parseFloat(address.get('t'));
    const id = address.get('sel');
    if (id !== null && this.replays.some((replay) => replay.indexOf.has(id))) this.selectedId = id;
    byId('find').value = this.selectedId ?? '';
    for (const name of ['colour', 'movement']) {
      const value = address.get(name);
      if ([...byId(name).options].some((option) => option.value === value)) byId(name).value = value;
    }
    if (Number.isFinite(time)) this.time = Math.min(Math.max(time, this.begin), this.end);
    this.changed();
  }

  writeAddress() {
    clearTimeout(this.addressTimer);
    this.addressTimer = setTimeout(() => {
      const address = new URLSearchParams({t: Number(this.time.toFixed(3))});
      if (this.selectedId !== null) address.set('sel', this.selectedId);
      address.set('colour', byId('colour').value);
      if (this.timeSpace.movement) address.set('movement', this.timeSpace.movement);
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
    this.timeSpace.draw();  // takes room from the maps
    this.layOut();
    if (this.following) this.centreOnSelected();
    const shared = {
      time: this.time, theme: this.theme, scale: this.scale, mode: byId('colour').value,
      tails: Number(byId('tails').value), ids: byId('ids').checked, ghosts: byId('ghosts').checked,
      corridors: byId('corridors').checked, nearest: byId('nearest').checked,
      footprints: byId('footprints').checked,
    };
    for (const pane of this.panes) {
      const event = this.events.current?.side === pane.side ? this.events.current : null;
      pane.painter.draw({...shared, event, selected: this.selectedIn(pane.side)});
      drawCaption(this, pane);
    }
    for (const strip of this.strips) strip.draw();
    drawTransport(this);
    drawLegend(this, shared.mode);
    this.vehiclePanel.draw();
  }

  /// All maps as they are drawn now, on one canvas; for videos too.
  picture() {
    return pictureOf(this);
  }

  savePicture() {
    this.draw();
    this.picture().toBlob((blob) => {
      const link = element('a', {href: URL.createObjectURL(blob),
                                 download: `replay-${this.time.toFixed(1)}s.png`});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
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
