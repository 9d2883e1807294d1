// ---------------------------------------------------------------------------------------------
// What surrounds the maps: the header with the figures, the legend, the transport; and pictures of
// all maps.

function buildHeader(app) {
  const {replays} = app, several = replays.length > 1;
  byId('title').textContent = document.title.replace(/\S*\//g, '');  // without folders
  byId('title').title = document.title;
  replays.forEach((replay, side) => {
    const people = replay.vehicles.filter((vehicle) => vehicle.person).length;
    const facts = [several ? app.nameOf(side) : '', replay.version,
                   replay.seed !== '' ? `seed ${replay.seed}` : '',
                   `${replay.vehicles.length - people} vehicles`, people ? `${people} on foot` : '',
                   `${replay.times.length} frames`];
    byId('about-text').append(element('p', {}, facts.filter(Boolean).join(' · ')));
    if (replay.command) {
      byId('about-text').append(element('p', {}, element('code', {}, replay.command)));
    }
  });
  const labels = [...new Set(replays.flatMap((replay) => replay.figures.map((f) => f[0])))];
  const list = byId('figures');
  list.hidden = labels.length === 0;
  if (several) list.append(figureBlock('', replays.map((_, side) => element('dd', {}, app.nameOf(side)))));
  list.append(...labels.map((label) => figureBlock(label, replays.map((replay) => (
    figureCell(replay.figures.find((f) => f[0] === label)))))));
}

/// A figure with its values in all replays, one below the other.
function figureBlock(label, cells) {
  return element('div', {}, element('dt', {}, label || '\u00a0'), ...cells);
}

const GOOD_STATUS = new Set(['finished', 'end reached', 'solved']);
const BAD_IF_ANY = new Set(['overlaps', 'people touched', 'violations']);

function figureCell(figure) {
  if (!figure) return element('dd', {}, '–');
  const [label, value, unit] = figure;
  const bad = label === 'status' ? !GOOD_STATUS.has(value) : BAD_IF_ANY.has(label) && Number(value) > 0;
  const cell = element('dd', {className: bad ? 'bad' : ''}, value);
  if (unit) cell.append(element('span', {className: 'unit'}, ` ${unit}`));
  return cell;
}

function drawLegend(app, mode) {
  const {theme, scale} = app, key = `${mode} ${theme === THEMES.dark}`;
  if (key === app.legendKey) return;
  app.legendKey = key;
  const samples = COLOUR_MODES[mode].legend(theme, scale);
  if (scale.people && mode !== 'state') samples.push([theme.state[5], STATES[5]]);
  byId('legend').replaceChildren(...samples.map(([background, text, isRamp]) => {
    const sample = element('i', {className: isRamp ? 'ramp' : ''});
    sample.style.background = background;
    return element('span', {}, ...(background ? [sample] : []), text);
  }));
}

function buildTransport(app) {
  const rate = byId('rate');
  rate.append(...RATES.map((r) => element('option', {value: r}, `${r}×`)));
  rate.value = '1';
  rate.addEventListener('change', () => { app.rate = Number(rate.value); });
  byId('play').addEventListener('click', () => app.toggle());
  byId('to-start').addEventListener('click', () => app.goTo(app.begin));
  byId('step-back').addEventListener('click', () => app.step(-1));
  byId('step-on').addEventListener('click', () => app.step(1));
  byId('fit').addEventListener('click', () => app.fit());
  byId('picture').addEventListener('click', () => app.savePicture());
  byId('show-help').addEventListener('click', () => byId('help').showModal());
  byId('show-side').addEventListener('click', () => {
    const open = byId('side').parentElement.classList.toggle('side-open');
    byId('show-side').setAttribute('aria-expanded', String(open));
  });
  const scrub = byId('scrub');
  scrub.min = app.begin;
  scrub.max = Math.max(app.end, app.begin + 1e-3);
  scrub.addEventListener('input', () => app.goTo(Number(scrub.value)));
}

function drawTransport(app) {
  byId('clock').textContent = `${app.time.toFixed(2)} / ${app.end.toFixed(1)} s`;
  byId('scrub').value = app.time;
  byId('scrub').setAttribute('aria-valuetext', `${app.time.toFixed(1)} seconds`);
  const play = byId('play');
  const label = app.playing ? 'Pause' : 'Play';
  if (play.getAttribute('aria-label') !== label) {
    play.setAttribute('aria-label', label);
    play.textContent = app.playing ? '❚❚' : '▶';
  }
  document.documentElement.dataset.playing = app.playing;
}

/// Beside each map: who is there, and how near they come to each other.
function drawCaption(app, {painter, status}) {
  const {present, pair, replay} = painter;
  const people = present.filter((now) => now.person).length, vehicles = present.length - people;
  const counts = [`${vehicles} vehicle${vehicles === 1 ? '' : 's'}`];
  if (people) counts.push(`${people} on foot`);
  const name = (box) => replay.vehicles[box.vehicle].id;
  if (app.time > replay.end + 1e-6) {
    counts.push(`ended at ${replay.end.toFixed(1)} s`);
  } else if (pair) {
    const distance = pair.distance <= -0.02 ? `overlap by ${(-pair.distance).toFixed(2)} m`
      : `closest ${Math.max(pair.distance, 0).toFixed(2)} m`;
    const isNarrow = painter.size.width < 300;
    counts.push(isNarrow ? distance : `${distance}: ${name(pair.a)}, ${name(pair.b)}`);
  }
  status.textContent = counts.join(' · ');
}

/// Do two maps show the same place, so that their views move together?
function alike(a, b) {
  const width = Math.min(a[2], b[2]) - Math.max(a[0], b[0]);
  const height = Math.min(a[3], b[3]) - Math.max(a[1], b[1]);
  const area = (box) => Math.max(box[2] - box[0], 1) * Math.max(box[3] - box[1], 1);
  return width > 0 && height > 0 && width * height > 0.6 * Math.max(area(a), area(b));
}

/// All maps as they are drawn now on one canvas, each with its name and the time.
function pictureOf(app) {
  const panes = byId('panes').getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
  const even = (length) => 2 * Math.floor(length * ratio / 2);  // as videos must be
  const picture = element('canvas', {width: even(panes.width), height: even(panes.height)});
  const context = picture.getContext('2d');
  context.fillStyle = app.theme.grid;
  context.fillRect(0, 0, picture.width, picture.height);
  for (const {canvas, side} of app.panes) {
    const box = canvas.getBoundingClientRect();
    context.setTransform(ratio, 0, 0, ratio, (box.left - panes.left) * ratio, (box.top - panes.top) * ratio);
    context.drawImage(canvas, 0, 0, box.width, box.height);
    context.textBaseline = 'top';
    const name = app.replays.length > 1 ? `${app.nameOf(side)}, ` : '';
    outlinedText(context, app.theme, `${name}${app.time.toFixed(1)} s`, 10, 10, app.theme.text);
  }
  return picture;
}
