// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of a mechanism: places its links, draws them, and lets a reader move them.
'use strict';

// ------------------------------------------------------------------------------------------ kinematics
// A frame is the upper three rows of its 4 x 4 matrix, row by row: R and the origin p beside it.

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

/// a b: first b's motion, then a's.
function compose(a, b) {
  const c = new Array(12);
  for (let i = 0; i < 12; i += 4) {
    for (let j = 0; j < 4; ++j)
      c[i + j] = a[i] * b[j] + a[i + 1] * b[4 + j] + a[i + 2] * b[8 + j] + (j === 3 ? a[i + 3] : 0);
  }
  return c;
}

/// A point of a frame, seen from where the frame is.
const pointOf = (frame, x) =>
  [0, 4, 8].map(i => frame[i] * x[0] + frame[i + 1] * x[1] + frame[i + 2] * x[2] + frame[i + 3]);
/// A direction, likewise.
const turned = (frame, x) => [0, 4, 8].map(i => frame[i] * x[0] + frame[i + 1] * x[1] + frame[i + 2] * x[2]);
const originOf = frame => [frame[3], frame[7], frame[11]];
const axisOf = (frame, k) => [frame[k], frame[4 + k], frame[8 + k]];

const shift = (x, y, z) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z];
/// A turn about axis 0, 1 or 2.
function turn(axis, angle) {
  const frame = identity.slice(), j = (axis + 1) % 3, k = (axis + 2) % 3;
  frame[5 * j] = frame[5 * k] = Math.cos(angle);
  frame[4 * k + j] = Math.sin(angle);
  frame[4 * j + k] = -Math.sin(angle);
  return frame;
}
/// R = 1 + 2 (w [v]x + [v]x [v]x) / (q'q), of any length but 0.
function quaternion(w, x, y, z) {
  const s = 2 / (w * w + x * x + y * y + z * z);
  return [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), 0,
          s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x), 0,
          s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y), 0];
}

/// The page's data as the rest of this script has it: rows of tables with the names of their columns, frames for
/// their numbers, and what was left out.
function unpacked(data) {
  const rows = ({columns, rows}) => rows.map(row => Object.fromEntries(
    columns.map((column, k) => [column, row[k]]).filter(([, value]) => value !== undefined && value !== null)));
  const frames = data.frames.map(x => x.length === 12 ? x
    : compose(shift(...(x.length === 7 ? x.slice(4) : [0, 0, 0])), quaternion(...x.slice(0, 4))));
  const placed = thing => ({...thing, frame: frames[thing.frame]});
  const pairs = all => all.map(pair => ({...pair, a: placed(pair.a), b: placed(pair.b)}));
  const units = {angle: 'rad', length: 'm', quaternion: '1'};
  return {...data, closures: pairs(data.closures), springs: pairs(data.springs), bodies: rows(data.bodies).map(placed),
          links: rows(data.links).map(link => ({...link, before: frames[link.before], after: frames[link.after]})),
          slots: rows(data.slots).map(slot => ({start: 0, rest: 0, unit: units[slot.kind], ...slot}))};
}

/// What a joint does at its positions; those with one axis move about and along z.
const motions = {
  fixed: () => identity,
  revolute: q => turn(2, q[0]),
  prismatic: q => shift(0, 0, q[0]),
  helical: (q, link) => compose(shift(0, 0, link.pitch * q[0]), turn(2, q[0])),
  cylindrical: q => compose(shift(0, 0, q[0]), turn(2, q[1])),
  universal: q => compose(turn(0, q[0]), turn(1, q[1])),
  planar: q => compose(shift(q[0], q[1], 0), turn(2, q[2])),
  spherical: q => quaternion(q[0], q[1], q[2], q[3]),
  floating: q => compose(shift(q[0], q[1], q[2]), quaternion(q[3], q[4], q[5], q[6])),
};

/// All positions: followers where their leaders put them.
function followed(scene, q) {
  const all = q.slice();
  for (const link of scene.links)
    if (link.follows) all[link.slot] = link.follows.multiplier * q[link.follows.slot] + link.follows.offset;
  return all;
}

/// Frames in the world, one a link: of the joint before its motion and after it, and of the link.
function place(scene, positions) {
  const q = followed(scene, positions), placed = {before: [], moved: [], link: []};
  scene.links.forEach((link, i) => {
    const parent = link.parent < 0 ? identity : placed.link[link.parent];
    placed.before.push(link.before ? compose(parent, link.before) : parent);
    const motion = motions[link.kind](q.slice(link.slot, link.slot + link.slots), link);
    placed.moved.push(compose(placed.before[i], motion));
    placed.link.push(link.after ? compose(placed.moved[i], link.after) : placed.moved[i]);
  });
  return placed;
}

/// Centres of mass in the world, one a body.
const centres = (scene, placed) => scene.bodies.map(body => pointOf(placed.link[body.link], originOf(body.frame)));

/// How far a closure is from being closed [m].
function gapOf(closure, placed) {
  const a = compose(placed.link[closure.a.link], closure.a.frame);
  const b = compose(placed.link[closure.b.link], closure.b.frame);
  const d = originOf(b).map((x, k) => x - originOf(a)[k]);
  const along = k => d[0] * a[k] + d[1] * a[4 + k] + d[2] * a[8 + k];
  switch (closure.kind) {
    case 'distance': return Math.abs(Math.hypot(...d) - closure.length);
    case 'plane': return Math.abs(along(2));
    case 'planar_point': return Math.hypot(along(0), along(1));
    default: return Math.hypot(...d);
  }
}

// --------------------------------------------------------------------------------------------- drawing
// Orthographic, as SVG: what is farther away is drawn first.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, factor = 1) => a.map((x, k) => x + factor * b[k]);
const escaped = text => text.replace(/[&<>"']/g, c => `&#${c.charCodeAt(0)};`);
const px = x => (Math.round(x * 100) / 100).toString();

/// A camera: {azimuth, elevation} [rad] about `up`, {x, y} pan [px], zoom. Maps points to [x, y, depth].
function projector(scene, camera, width, height) {
  const up = scene.up, ahead = scene.ahead, side = cross(up, ahead);
  const c = Math.cos(camera.azimuth), s = Math.sin(camera.azimuth);
  const C = Math.cos(camera.elevation), S = Math.sin(camera.elevation);
  const right = plus(side.map(x => c * x), ahead, -s);
  const toward = plus(plus(ahead.map(x => C * c * x), side, C * s), up, S);
  const above = cross(toward, right);
  const scale = 0.46 * Math.min(width, height) / scene.radius * camera.zoom;
  const direction = v => [scale * dot(right, v), -scale * dot(above, v)];
  const point = x => {
    const d = plus(x, scene.center, -1);
    return [scale * dot(right, d) + camera.x, camera.y - scale * dot(above, d), dot(toward, d)];
  };
  return {point, direction, toward, scale};
}

/// What is to be drawn, collected and then put in painter's order.
class Drawing {
  constructor(view) {
    this.view = view;
    this.items = [];
  }
  put(depth, svg) { this.items.push([depth, svg]); }
  line(a, b, type, before = 0) {
    const p = this.view.point(a), q = this.view.point(b);
    this.put((p[2] + q[2]) / 2 + before,
             `<path class="${type}" d="M${px(p[0])} ${px(p[1])}L${px(q[0])} ${px(q[1])}"/>`);
  }
  spot(x, radius, type, title) {
    const p = this.view.point(x);
    const body = title ? `><title>${escaped(title)}</title></circle>` : '/>';
    this.put(p[2], `<circle class="${type}" cx="${px(p[0])}" cy="${px(p[1])}" r="${radius}"${body}`);
  }
  text(x, words, type) {
    const p = this.view.point(x);  // in front of everything
    this.put(1e300, `<text class="${type}" x="${px(p[0] + 5)}" y="${px(p[1] - 5)}">${escaped(words)}</text>`);
  }
  /// The unit circle under x = center + u a + v b.
  ring(center, a, b, type, before = 0) {
    const p = this.view.point(center), u = this.view.direction(a), v = this.view.direction(b);
    this.put(p[2] + before, `<circle class="${type}" r="1" transform="matrix(${
      [...u, ...v, p[0], p[1]].map(x => x.toPrecision(6)).join(' ')})"/>`);
  }
  /// Half axes [m] as vectors in the world: the outline, and the ellipses through two of them.
  ellipsoid(center, halves, type, title) {
    const p = this.view.point(center), P = halves.map(a => this.view.direction(a));
    // the outline is the unit circle under L, L L' = sum of P P'; half a pixel keeps it visible
    const sum = (j, k) => P.reduce((total, a) => total + a[j] * a[k], 0);
    const a = Math.sqrt(sum(0, 0) + 0.25), b = sum(0, 1) / a, d = Math.sqrt(Math.max(sum(1, 1) + 0.25 - b * b, 0.01));
    this.put(p[2], `<g class="${type}"><title>${escaped(title)}</title><circle class="outline" r="1" transform="matrix(${
      [a, b, 0, d, p[0], p[1]].map(x => x.toPrecision(6)).join(' ')})"/></g>`);
    for (let k = 0; k < 3; ++k) this.ring(center, halves[k], halves[(k + 1) % 3], type + ' section', 1e-9);
  }
  svg() { return this.items.sort((a, b) => a[0] - b[0]).map(item => item[1]).join(''); }
}

/// The mechanism at a placement. `show` says which parts.
function draw(scene, placed, view, show) {
  const drawing = new Drawing(view), size = scene.glyph;
  const com = centres(scene, placed);
  drawing.ring(scene.ground, plus([0, 0, 0], scene.ahead, 0.6 * scene.radius),
               plus([0, 0, 0], cross(scene.up, scene.ahead), 0.6 * scene.radius), 'floor', -1e9);
  const frame = (f, length) => ['x', 'y', 'z'].forEach((name, k) => {
    const tip = plus(originOf(f), axisOf(f, k), length);
    drawing.line(originOf(f), tip, `axis ${name}`);
    if (show.letters) drawing.text(tip, name, `letter ${name}`);
  });
  frame(identity, 1.6 * size);
  if (show.ellipsoids)
    scene.bodies.forEach((body, i) => {
      if (!body.half || show.hidden.has(body.who)) return;
      const f = placed.link[body.link];
      const halves = [0, 1, 2].map(k => turned(f, axisOf(body.frame, k)).map(x => x * body.half[k]));
      drawing.ellipsoid(com[i], halves, `body${body.who ? ' read' : ''}${body.impossible ? ' impossible' : ''}`,
                        `${scene.links[body.link].name}: ${body.mass} kg${body.who ? `, as ${body.who} reads it` : ''}${
                          body.impossible ? '; an inertia that no body has' : ''}`);
    });
  scene.links.forEach((link, i) => {
    const here = originOf(placed.before[i]), moved = originOf(placed.moved[i]), end = originOf(placed.link[i]);
    if (link.parent >= 0 && show.links) {
      drawing.line(originOf(placed.link[link.parent]), here, 'link');
      if (here.some((x, k) => x !== moved[k])) drawing.line(here, moved, 'slide');
      drawing.line(moved, end, 'link');
    }
    if (link.kind !== 'fixed' && show.joints) {
      const f = placed.before[i], z = axisOf(f, 2), at = moved;
      if (link.kind === 'spherical' || link.kind === 'floating') drawing.spot(at, 6, 'joint round', link.joint);
      else if (link.kind === 'universal') {
        drawing.line(plus(at, axisOf(f, 0), -size), plus(at, axisOf(f, 0), size), 'joint');
        drawing.line(plus(at, axisOf(placed.moved[i], 1), -size), plus(at, axisOf(placed.moved[i], 1), size), 'joint');
      } else {
        drawing.line(plus(at, z, -size), plus(at, z, size), link.kind === 'prismatic' ? 'joint slides' : 'joint');
        const arms = [0, 1].map(k => axisOf(f, k).map(x => 0.4 * size * x));
        if (link.kind !== 'prismatic') drawing.ring(plus(at, z, 0.6 * size), ...arms, 'joint');
        drawing.spot(plus(at, z, size), 2.5, 'joint tip', link.joint);
      }
      if (show.names) {
        const where = ['spherical', 'floating', 'universal'].includes(link.kind) ? at : plus(at, z, size);
        drawing.text(where, show.words ? `${link.label} ${link.joint}` : link.label, 'name');
      }
    }
    if (show.frames && link.parent >= 0) frame(placed.link[i], size);
  });
  if (show.centres)
    scene.bodies.forEach((body, i) => {
      if (body.mass === 0 || show.hidden.has(body.who)) return;
      if (!body.who) drawing.line(originOf(placed.link[body.link]), com[i], 'lever');
      drawing.spot(com[i], 3.5, body.who ? 'com read' : 'com',
                   `centre of mass of ${scene.links[body.link].name}${body.who ? `, as ${body.who} reads it` : ''}`);
    });
  if (show.links)
    for (const pair of [...scene.closures, ...scene.springs])
      for (const end of [pair.a, pair.b]) {
        const f = placed.link[end.link];
        if (scene.links[end.link].parent >= 0) drawing.line(originOf(f), pointOf(f, originOf(end.frame)), 'link');
      }
  for (const closure of scene.closures)
    drawing.line(pointOf(placed.link[closure.a.link], originOf(closure.a.frame)),
                 pointOf(placed.link[closure.b.link], originOf(closure.b.frame)),
                 closure.kind === 'distance' ? 'rod' : 'gap');
  for (const spring of scene.springs)
    drawing.line(pointOf(placed.link[spring.a.link], originOf(spring.a.frame)),
                 pointOf(placed.link[spring.b.link], originOf(spring.b.frame)), 'spring');
  return drawing.svg();
}

// ---------------------------------------------------------------------------------------------- the page

function start(scene) {
  const svg = document.getElementById('picture'), page = document.documentElement;
  const byId = id => document.getElementById(id);
  const q = scene.slots.map(slot => slot.start);
  const first = {azimuth: scene.azimuth, elevation: scene.elevation, x: 0, y: 0, zoom: 1};
  const camera = {...first};
  const many = scene.links.length > 60;
  const show = {links: true, joints: true, names: !many, words: false, frames: false, letters: !many,
                centres: true, ellipsoids: true, hidden: new Set()};  // engines whose reading is not shown
  page.classList.add('alive');
  svg.setAttribute('role', 'application');
  svg.setAttribute('tabindex', '0');
  svg.removeAttribute('preserveAspectRatio');
  const make = (tag, attributes, ...children) => {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.append(...children);
    return element;
  };

  // drawing, once a frame of the screen at most
  let asked = false, ready = false;
  function drawNow() {
    asked = false;
    const box = svg.getBoundingClientRect();
    const width = Math.max(box.width, 100), height = Math.max(box.height, 100);
    svg.setAttribute('viewBox', `${px(-width / 2)} ${px(-height / 2)} ${px(width)} ${px(height)}`);
    const placed = place(scene, q);
    svg.innerHTML = draw(scene, placed, projector(scene, camera, width, height), show);
    if (scene.closures.length) {
      const gap = Math.max(...scene.closures.map(closure => gapOf(closure, placed)));
      byId('gap').textContent = `The picture moves joints alone; closures are open by ${gap.toPrecision(2)} m.`;
    }
  }
  function ask() {
    if (asked || !ready) return;
    asked = true;
    requestAnimationFrame(drawNow);
  }

  // camera
  const limit = Math.PI / 2;
  function orbit(dx, dy) {
    camera.azimuth -= dx;
    camera.elevation = Math.max(-limit, Math.min(limit, camera.elevation + dy));
    ask();
  }
  function pan(dx, dy) {
    camera.x += dx;
    camera.y += dy;
    ask();
  }
  /// About a point of the screen, measured from its centre.
  function zoom(factor, x = 0, y = 0) {
    const next = Math.max(0.05, Math.min(200, camera.zoom * factor)), f = next / camera.zoom;
    camera.zoom = next;
    camera.x = x + f * (camera.x - x);
    camera.y = y + f * (camera.y - y);
    ask();
  }
  function reset() {
    Object.assign(camera, first);
    ask();
  }
  const fromCentre = event => {
    const box = svg.getBoundingClientRect();
    return [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
  };
  const pointers = new Map();
  svg.addEventListener('pointerdown', event => {
    svg.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, fromCentre(event));
  });
  svg.addEventListener('pointermove', event => {
    const was = pointers.get(event.pointerId);
    if (!was) return;
    const now = fromCentre(event), dx = now[0] - was[0], dy = now[1] - was[1];
    if (pointers.size === 2) {
      const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
      const reach = p => Math.max(Math.hypot(p[0] - other[0], p[1] - other[1]), 1);
      zoom(reach(now) / reach(was), other[0], other[1]);
      pan(dx / 2, dy / 2);
    } else if (pointers.size === 1) {
      if (event.shiftKey || event.buttons & 6) pan(dx, dy);
      else orbit(0.01 * dx, 0.01 * dy);
    }
    pointers.set(event.pointerId, now);
  });
  for (const end of ['pointerup', 'pointercancel'])
    svg.addEventListener(end, event => pointers.delete(event.pointerId));
  svg.addEventListener('contextmenu', event => event.preventDefault());
  svg.addEventListener('wheel', event => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY), ...fromCentre(event));
  }, {passive: false});
  const keys = {
    ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
  };
  svg.addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const arrow = keys[event.key];
    if (arrow && event.shiftKey) pan(20 * arrow[0], 20 * arrow[1]);
    else if (arrow) orbit(0.1 * arrow[0], 0.1 * arrow[1]);
    else if (event.key === '+' || event.key === '=') zoom(1.2);
    else if (event.key === '-') zoom(1 / 1.2);
    else if (event.key === '0') reset();
    else return;
    event.preventDefault();
  });
  const button = (words, label, act) => {
    const made = make('button', {type: 'button', 'aria-label': label, title: label}, words);
    made.addEventListener('click', act);
    return made;
  };
  byId('tools').append(button('+', 'nearer', () => zoom(1.25)), button('\u2212', 'farther', () => zoom(0.8)),
                       button('Reset view', 'reset view', reset));

  // what is shown
  const has = test => scene.bodies.some(test);
  const parts = [['links', 'links'], ['joints', 'joint axes'], ['names', 'q'], ['words', 'joint names'],
                 ['frames', 'frames'], ['letters', 'x y z'], ['centres', 'centres of mass'],
                 ...(has(body => body.half) ? [['ellipsoids', 'inertia']] : [])];
  const addBox = (words, checked, act) => {
    const box = make('input', {type: 'checkbox'});
    box.checked = checked;
    box.addEventListener('change', () => {
      act(box.checked);
      ask();
    });
    byId('parts').append(make('label', {}, box, ` ${words}`));
  };
  for (const [part, words] of parts) addBox(words, show[part], on => { show[part] = on; });
  for (const who of new Set(scene.bodies.map(body => body.who)))
    if (who) addBox(`as ${who} reads it`, true, on => { on ? show.hidden.delete(who) : show.hidden.add(who); });

  // joints
  const rows = [];
  const spoken = (slot, x) => slot.kind === 'angle' ? `${x.toFixed(3)} rad, ${(x * 180 / Math.PI).toFixed(1)}\u00b0`
    : `${x.toFixed(3)}${slot.unit === '1' ? '' : ` ${slot.unit}`}`;
  function showValues() {
    for (const [slot, input, output, k] of rows) {
      if (document.activeElement !== input || +input.value !== q[k]) input.value = q[k];
      output.textContent = spoken(slot, q[k]);
      input.setAttribute('aria-valuetext', spoken(slot, q[k]));
    }
  }
  scene.slots.forEach((slot, k) => {
    if (slot.follows) return;
    const input = make('input', {type: 'range', min: slot.lower, max: slot.upper, step: 'any', id: `slot${k}`});
    const output = make('output', {for: `slot${k}`});
    const limits = slot.limited ? make('small', {}, `${+slot.lower.toPrecision(4)} to ${+slot.upper.toPrecision(4)} ${slot.unit}`)
      : '';
    byId('sliders').append(make('div', {class: 'slider'},
      make('label', {for: `slot${k}`}, make('b', {}, slot.name), ` ${slot.label}`), output, input, limits));
    rows.push([slot, input, output, k]);
    input.addEventListener('input', () => {
      stop();
      const before = q[k];
      q[k] = +input.value;
      const four = slot.quaternion;  // its first slot: four zeros are no orientation
      if (four !== undefined && !q.slice(four, four + 4).some(x => x !== 0)) q[k] = before || 1;
      showValues();
      ask();
    });
  });
  function pose(values) {
    stop();
    values.forEach((x, k) => { q[k] = x; });
    showValues();
    ask();
  }
  byId('poses').append(button('Start', 'joints where the scene starts', () => pose(scene.slots.map(s => s.start))),
                       button('Zero', 'all joints zero', () => pose(scene.slots.map(s => s.rest))));
  showValues();

  // motion
  let playing = 0;
  let stop = () => {};
  if (scene.motion) {
    const {time, q: states, energy} = scene.motion, last = time.length - 1;
    const input = byId('time'), play = byId('play'), said = byId('now');
    let at = 0;
    const width = 300, height = 110, span = Math.max(time[last] - time[0], Number.MIN_VALUE);
    const all = energy.flatMap(line => line.values), low = Math.min(...all), high = Math.max(...all);
    const x = t => 4 + (width - 8) * (t - time[0]) / span;
    const y = e => high > low ? 6 + (height - 12) * (high - e) / (high - low) : height / 2;
    const chart = byId('energy');
    if (energy.length) {
      chart.setAttribute('viewBox', `0 0 ${width} ${height}`);
      chart.innerHTML = energy.map((line, k) => `<path class="line${k}" d="M${
        line.values.map((e, i) => `${px(x(time[i]))} ${px(y(e))}`).join('L')}"/>`).join('') +
        `<path id="cursor" class="cursor" d="M0 0V${height}"/>`;
    }
    const show_at = index => {
      at = index;
      input.value = at;
      states[at].forEach((value, k) => { q[k] = value; });
      const words = energy.map(line => `${line.name} ${line.values[at].toPrecision(4)} J`).join(', ');
      said.textContent = `t = ${time[at].toPrecision(4)} s${words ? `; ${words}` : ''}`;
      input.setAttribute('aria-valuetext', `${time[at].toPrecision(4)} s`);
      const cursor = byId('cursor');
      if (cursor) cursor.setAttribute('d', `M${px(x(time[at]))} 0V${height}`);
      showValues();
      ask();
    };
    stop = () => {
      cancelAnimationFrame(playing);
      playing = 0;
      play.textContent = 'Play';
    };
    play.addEventListener('click', () => {
      if (playing) return stop();
      let from = at === last ? 0 : at;
      const begun = performance.now() - 1000 * (time[from] - time[0]);
      play.textContent = 'Pause';
      const step = now => {
        while (from < last && time[from + 1] - time[0] <= (now - begun) / 1000) ++from;
        show_at(from);
        if (from === last) return stop();
        playing = requestAnimationFrame(step);
      };
      playing = requestAnimationFrame(step);
    });
    input.max = last;
    input.addEventListener('input', () => {
      stop();
      show_at(+input.value);
    });
    show_at(0);
  }

  ready = true;
  new ResizeObserver(ask).observe(svg);
  addEventListener('beforeprint', drawNow);
  drawNow();
  // for tests, and for those who like to look inside
  window.dynwitness = {scene, q, camera, show, place: () => place(scene, q), pose, drawNow};
}

if (typeof module !== 'undefined') module.exports = {unpacked, place, centres, gapOf};
if (typeof document !== 'undefined') start(unpacked(JSON.parse(document.getElementById('scene').textContent)));
