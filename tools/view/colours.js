// ---------------------------------------------------------------------------------------------
// Colours: of the page in light and dark, and of vehicles in the modes that one can choose from.

// Okabe and Ito's colours, told apart by the colour-blind; in grey they differ in lightness too.
const THEMES = {
  light: {
    ground: '#eceee8', road: '#c3c8cf', marking: '#ffffff', outside: '#dcdfe3', solid: '#6a7078',
    text: '#1a1d21', halo: 'rgba(255,255,255,.85)', outline: '#23272d', glass: 'rgba(20,24,30,.62)',
    grid: '#c9cdd3', zone: '#0063a0', alarm: '#c43c00', reverse: '#cc3d93', faint: '#59616c',
    state: ['#ffffff', '#0072b2', '#f0a500', '#5fb89b', '#8f979f', '#b3446c'],
    lines: ['#0072b2', '#d55e00', '#009e73', '#cc79a7'], automated: '#0072b2', human: '#f0a500', tube: '#b3446c',
    lanes: {bus: '#c2a68c', bicycle: '#b7c9a3', rail: '#a9a3b5', foot: '#dcdcd4'},
    lights: {green: '#009e73', yellow: '#f0c000', red: '#d5201f', off: '#59616c'},
    zones: ['#0063a0', '#d55e00', '#009e73', '#8c5ca8'],
  },
  dark: {
    ground: '#181c21', road: '#3a414b', marking: '#808a97', outside: '#101317', solid: '#8b939e',
    text: '#e6e9ed', halo: 'rgba(20,23,27,.85)', outline: '#07090b', glass: 'rgba(5,8,12,.7)',
    grid: '#39404a', zone: '#56b4e9', alarm: '#ff7a33', reverse: '#e58fc4', faint: '#a0a8b3',
    state: ['#d3d8de', '#3fa2e0', '#f0a500', '#4fae8f', '#6f7781', '#e07a9f'],
    lines: ['#56b4e9', '#ff9150', '#2fbf93', '#e58fc4'], automated: '#3fa2e0', human: '#f0a500', tube: '#e07a9f',
    lanes: {bus: '#5b4a3b', bicycle: '#46553a', rail: '#4b4558', foot: '#2a2f33'},
    lights: {green: '#2fbf93', yellow: '#ffd84a', red: '#ff5a50', off: '#59616c'},
    zones: ['#56b4e9', '#ff9150', '#2fbf93', '#c79be0'],
  },
};

// Cividis (Nunez et al. 2018), made for the colour-blind: dark is little, bright is much.
const RAMP = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];

// Asked for every vehicle in every frame: a text for each of so many steps is made once.
const RAMP_STEPS = 64;
const RAMP_TEXTS = Array.from({length: RAMP_STEPS + 1}, (_, i) => {
  const place = i / RAMP_STEPS * (RAMP.length - 1), k = Math.min(Math.floor(place), RAMP.length - 2);
  const mix = RAMP[k].map((c, j) => Math.round(c + (RAMP[k + 1][j] - c) * (place - k)));
  return `rgb(${mix.join(',')})`;
});

function rampColour(fraction) {
  return RAMP_TEXTS[Math.round(Math.min(Math.max(fraction, 0), 1) * RAMP_STEPS)];
}

const manyColours = [];

/// Colours of many vehicles: neighbours in index are far apart in hue, and lightness alternates.
function indexColour(index) {
  return manyColours[index] ??=
      `hsl(${(index * 137.508 + 205) % 360} ${62 + 12 * (index % 2)}% ${[46, 62, 54][index % 3]}%)`;
}

/// The colour of a traffic light by SUMO's letter for it.
function lightColour(letter, theme) {
  if (letter === 'G' || letter === 'g') return theme.lights.green;
  if (letter === 'y' || letter === 'Y') return theme.lights.yellow;
  return letter === 'r' || letter === 's' || letter === 'u' ? theme.lights.red : theme.lights.off;
}

/// What the colours of vehicles mean over all replays: ranges, and the types there are.
function colourScale(replays) {
  const scale = {topSpeed: 0.1, topCo2: 0, types: [], states: new Set(), reverses: false,
                 groups: false, humans: false, automated: false, people: false};
  for (const replay of replays) {
    for (const track of replay.tracks) {
      for (let k = 0; k < track.count; ++k) {
        const speed = track.speed[k] * SPEED_UNIT;
        scale.topSpeed = Math.max(scale.topSpeed, Math.abs(speed));
        scale.reverses ||= speed < -0.02;
        if (track.co2) scale.topCo2 = Math.max(scale.topCo2, track.co2[k] * CO2_UNIT);
        scale.states.add(track.state[k]);
      }
    }
    scale.groups ||= replay.groups;
    for (const vehicle of replay.vehicles) {
      scale.people ||= vehicle.person;
      if (vehicle.person) continue;
      scale[vehicle.automated ? 'automated' : 'humans'] = true;
      if (vehicle.kind && !scale.types.includes(vehicle.kind)) scale.types.push(vehicle.kind);
    }
  }
  return scale;
}

/// The ways to colour vehicles: {name, has(scale, steps), of(now, vehicle, theme, scale),
/// legend(theme, scale)}; a legend is a list of [background, text, is it a ramp?]. `steps`: are all
/// replays plans?
const RAMP_BACKGROUND = `linear-gradient(90deg, ${[0, 0.2, 0.4, 0.6, 0.8, 1].map(rampColour).join(',')})`;
const COLOUR_MODES = {
  state: {
    name: 'by state',
    has: () => true,
    of: (now, _, theme) => (now.speed < -0.02 ? theme.reverse : theme.state[now.state] || theme.faint),
    legend: (theme, scale) => STATES.map((name, s) => [theme.state[s], name])
        .filter((_, s) => scale.states.has(s))
        .concat(scale.reverses ? [[theme.reverse, 'in reverse']] : []),
  },
  speed: {
    name: 'by speed',
    has: () => true,
    of: (now, _, theme, scale) => rampColour(Math.abs(now.speed) / scale.topSpeed),
    legend: (theme, scale) => [[RAMP_BACKGROUND, `0 to ${scale.topSpeed.toFixed(1)} m/s`, true]],
  },
  co2: {
    name: 'by emissions',
    has: (scale) => scale.topCo2 > 0,
    of: (now, _, theme, scale) => (now.track.co2
      ? rampColour(now.track.co2[now.k] * CO2_UNIT / scale.topCo2) : theme.faint),
    legend: (theme, scale) => [[RAMP_BACKGROUND, `0 to ${scale.topCo2.toFixed(1)} g CO₂ per s`, true]],
  },
  penetration: {
    name: 'controlled, human',
    has: (scale, steps) => !steps && (scale.automated || scale.humans),
    of: (now, vehicle, theme) => (vehicle.automated ? theme.automated : theme.human),
    legend: (theme) => [[theme.automated, 'may be taken over'], [theme.human, 'human driver']],
  },
  type: {
    name: 'by type',
    has: (scale, steps) => !steps && scale.types.length > 0,
    of: (now, vehicle, theme, scale) => indexColour(scale.types.indexOf(vehicle.kind)),
    legend: (theme, scale) => scale.types.slice(0, 8).map((type, i) => [indexColour(i), type]),
  },
  group: {
    name: 'by group of ESCoT',
    has: (scale) => scale.groups,
    of: (now, _, theme) => (now.track.group?.[now.k] ? indexColour(now.track.group[now.k] - 1)
      : theme.state[4]),
    legend: (theme) => [[theme.state[4], 'planned alone, or not'], ['', 'one colour for each group']],
  },
  priority: {
    name: 'by priority in the group',
    has: (scale) => scale.groups,
    of: (now, _, theme) => (now.track.rank?.[now.k] ? rampColour(1 - (now.track.rank[now.k] - 1) / 9)
      : theme.state[4]),
    legend: (theme) => [[theme.state[4], 'in no group'], [RAMP_BACKGROUND, 'tenth or later, to first', true]],
  },
  vehicle: {
    name: 'by vehicle',
    has: () => true,
    of: (now) => indexColour(now.vehicle),
    legend: () => [['', 'one colour each']],
  },
};
