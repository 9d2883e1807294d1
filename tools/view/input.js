// ---------------------------------------------------------------------------------------------
// Keys, mouse and touch.

function bindKeys(app) {
  const flip = (id) => byId(id).click();
  const cycle = (id) => {
    const select = byId(id);
    select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
    app.changed();
  };
  const pan = (dx, dy) => app.pan(app.panes[0], dx * 60, dy * 60);
  const actions = {
    ' ': () => app.toggle(),
    ArrowLeft: (event) => app.step(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => app.step(event.shiftKey ? 10 : 1),
    Home: () => app.goTo(app.begin), End: () => app.goTo(app.end),
    '+': () => app.changeRate(1), '=': () => app.changeRate(1), '-': () => app.changeRate(-1),
    n: () => app.nextEvent(1), p: () => app.nextEvent(-1),
    f: () => app.fit(), c: () => cycle('colour'), t: () => cycle('tails'),
    i: () => flip('ids'), g: () => flip('ghosts'), l: () => flip('follow'),
    k: () => flip('corridors'),
    z: () => app.zoom(app.panes[0], 1.5), x: () => app.zoom(app.panes[0], 1 / 1.5),
    w: () => pan(0, 1), s: () => pan(0, -1), a: () => pan(1, 0), d: () => pan(-1, 0),
    Escape: () => app.select(null), '?': () => byId('help').showModal(),
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

function bindPointers(app, pane) {
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
      if (moved > 4) app.pan(pane, now.x - before.x, now.y - before.y);
    } else if (pointers.size === 2) {
      const old = spread();
      pointers.set(event.pointerId, now);
      const next = spread();
      app.pan(pane, next.x - old.x, next.y - old.y);
      app.zoom(pane, next.size / Math.max(old.size, 1), next);
    }
  });
  const release = (event) => {
    const at = pointers.get(event.pointerId);
    if (at && pointers.size === 1 && moved <= 4 && event.type === 'pointerup') {
      const index = pane.painter.pick(at.x, at.y, event.pointerType === 'mouse' ? 6 : 18);
      app.select(index === null ? null : pane.painter.replay.vehicles[index].id);
    }
    pointers.delete(event.pointerId);
    if (!pointers.size) canvas.classList.remove('moving');
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('dblclick', (event) => app.zoom(pane, 2, place(event)));
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    app.zoom(pane, Math.exp(-Math.max(-200, Math.min(200, pixels)) * 0.002), place(event));
  }, {passive: false});
}
