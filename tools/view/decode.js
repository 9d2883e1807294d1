// ---------------------------------------------------------------------------------------------
// From the packed data in the page to replays.
//
// A replay is {title, label, command, version, seed, steps, scene, figures, events, vehicles, signals,
//   times: Float64Array [s], clearance: Float32Array [m] or null (NaN where there is none), tracks}.
// A signal is {id, shown: [[from when on, a letter for each light], ...]}.
// A track is one vehicle in an unbroken row of frames:
//   {vehicle: index, first: frame, count, x, y [cm], heading [0.1 deg], speed [2 cm/s], state,
//   and, if the replay has `groups`: group (0, or 1 + index of its first vehicle), rank (1 first);
//   if it has `emissions`: co2 [0.2 g/s];
//   if it has `tubes` ({later [s], units [m], every [ms], paths, forks}): tubes, those that are kept, as
//   {k: from its k-th frame on, code (0 for none, else 1 + 2 * fork + does it pass?), reaches: [[least, most]
//   for each of the times, in units]}}.

const FORMAT = 2;
const SPEED_UNIT = 0.02;
const CO2_UNIT = 0.2;
const NO_CLEARANCE = 9999;
const STATES = ['SUMO’s driver', 'coordinated', 'waiting', 'arrived', 'parked', 'on foot'];

async function inflate(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// Reads columns of integers: zigzag varints of second differences (ReplayColumn in replay.cpp).
class ColumnReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.position = 0;
  }

  varint() {
    let value = 0;
    for (let factor = 1;; factor *= 128) {
      if (this.position >= this.bytes.length) throw new Error('the data ends too early');
      const byte = this.bytes[this.position++];
      value += (byte & 127) * factor;
      if (byte < 128) return value % 2 ? -(value + 1) / 2 : value / 2;
    }
  }

  into(target, count) {
    let value = 0;
    let difference = 0;
    for (let i = 0; i < count; ++i) {
      const second = this.varint();
      difference = i === 1 ? second : difference + second;
      value += difference;
      target[i] = value;
    }
    return target;
  }
}

/// Values that seldom change: pairs (how often, value) in one column, summed up as they come.
function decodeRuns(reader, values) {
  let i = 0, filled = 0, value = 0, difference = 0, length = 0;
  while (filled < values.length) {
    const second = reader.varint();
    difference = i === 1 ? second : difference + second;
    value += difference;
    if (i % 2 === 0) {
      length = value;
    } else {
      if (!(length > 0)) throw new Error('a run of values is empty');
      values.fill(value, filled, filled + length);
      filled += length;
    }
    ++i;
  }
  return values;
}

function decodeTrack(reader, header, [vehicle, first, count]) {
  const track = {
    vehicle, first, count,
    x: reader.into(new Int32Array(count), count),
    y: reader.into(new Int32Array(count), count),
    heading: reader.into(new Int32Array(count), count),
    speed: reader.into(new Int16Array(count), count),
    state: decodeRuns(reader, new Uint8Array(count)),
  };
  if (header.groups) {
    track.group = decodeRuns(reader, new Uint32Array(count));
    track.rank = decodeRuns(reader, new Uint16Array(count));
  }
  if (header.emissions) track.co2 = reader.into(new Int16Array(count), count);
  return track;
}

/// The tubes of all tracks (ReplayTubes in replay_tubes.cpp): one is kept where the code changes, and of
/// one who passes again after `every` ms.
function decodeTubes(reader, {every, later}, tracks, times) {
  const column = (count) => reader.into(new Int32Array(count), count);
  const counts = column(tracks.length), runs = counts.reduce((sum, count) => sum + count, 0);
  const lengths = column(runs), codes = column(runs), kept = [];
  let run = 0;
  tracks.forEach((track, i) => {
    track.tubes = [];
    for (let k = 0, r = 0; r < counts[i]; ++r, ++run) {
      for (const end = k + lengths[run], begin = k; k < end; ++k) {
        const ms = Math.round(1000 * times[track.first + k]), last = track.tubes.at(-1);
        if (k > begin && (codes[run] % 2 || !codes[run] || ms - last.ms < every)) continue;
        track.tubes.push({k, ms, code: codes[run], reaches: []});
        if (codes[run]) kept.push(track.tubes.at(-1));
      }
    }
  });
  for (const _ of later) {
    const least = column(kept.length), most = column(kept.length);
    kept.forEach((tube, i) => tube.reaches.push([least[i], most[i]]));
  }
}

function decode(bytes) {
  const view = new DataView(bytes.buffer);
  const length = view.getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  if (header.format !== FORMAT) throw new Error(`unknown format ${header.format}`);
  const reader = new ColumnReader(bytes.subarray(4 + length));

  const times = reader.into(new Float64Array(header.frames), header.frames).map((ms) => ms / 1000);
  let clearance = null;
  if (header.clearance) {
    const cm = reader.into(new Int16Array(header.frames), header.frames);
    clearance = Float32Array.from(cm, (c) => (c >= NO_CLEARANCE ? NaN : c / 100));
  }
  const tracks = header.tracks.map((track) => decodeTrack(reader, header, track));
  if (header.tubes) decodeTubes(reader, header.tubes, tracks, times);
  const replay = {...header, times, clearance, tracks};
  replay.tracksOf = header.vehicles.map(() => []);
  for (const track of tracks) replay.tracksOf[track.vehicle].push(track);
  replay.indexOf = new Map(header.vehicles.map((vehicle, index) => [vehicle.id, index]));
  replay.begin = times.length ? times[0] : 0;
  replay.end = times.length ? times[times.length - 1] : 0;
  // When somebody is there first.
  replay.firstSeen = tracks.length ? times[tracks.reduce((least, track) => Math.min(least, track.first), times.length - 1)] : replay.begin;
  return replay;
}

async function decodePage() {
  const blocks = document.querySelectorAll('script[type="application/x-mvtp-replay"]');
  const replays = [];
  for (const block of blocks) {
    replays.push(decode(await inflate(block.textContent)));
    block.remove();  // frees the text
  }
  return replays;
}
