// SPDX-License-Identifier: Apache-2.0
// MuJoCo's own JavaScript package as a witness. Run with mujoco 3.1.16 from npm and Node 20
// (README.md).
//
//     npm install mujoco
//     ./dynwitness crosscheck puma_560 --engine-memory 100000 \
//       --engine "node data/engines/mujoco_engine.mjs node_modules/mujoco/mujoco.js"
//
// (Node and WebAssembly reserve more address space than they use: --engine-memory.)
// The scene is given as MJCF, each joint at its body's origin. Rotors are `armature`, springs
// `stiffness` and `springref`, viscous friction `damping`; contacts and constraints are off.
//
// As a reader (dynwitness readers FILE --engine "...") it is told a file, URDF or MJCF: that is given
// to MuJoCo as it stands, with no option set, and what its compiler made of it is shown. Package mujoco-js 0.0.7
// (MuJoCo 3.3.8) serves as well here.
import {readFileSync, statSync} from 'node:fs';
import {dirname, resolve} from 'node:path';
import {createInterface} from 'node:readline';
import {pathToFileURL} from 'node:url';

const {default: load} = await import(pathToFileURL(process.argv[2] ?? 'node_modules/mujoco/mujoco.js'));
const mujoco = await load();

class Refused extends Error {}
const kJoints = {revolute: 'hinge', prismatic: 'slide', spherical: 'ball'};

const times = (A, v) => A.map(row => row.reduce((sum, x, k) => sum + x * v[k], 0));
const transposed = A => A[0].map((_, k) => A.map(row => row[k]));
const product = (A, B) => A.map(row => times(transposed(B), row));
const plus = (a, b) => a.map((x, k) => x + b[k]);
const kIdentity = {R: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], p: [0, 0, 0]};
const after = (X, Y) => ({R: product(X.R, Y.R), p: plus(X.p, times(X.R, Y.p))});
const inverse = X => ({R: transposed(X.R), p: times(transposed(X.R), X.p).map(x => -x)});
const column = (x, k, n) => Array.from(x.slice(n * k, n * k + n));
/** What fill(buffers...) leaves in buffers of these sizes. */
function filled(sizes, fill) {
  const buffers = sizes.map(size => new mujoco.DoubleBuffer(size));
  fill(...buffers);
  const out = buffers.map(buffer => Array.from(buffer.GetView()));
  buffers.forEach(buffer => buffer.delete());
  return out;
}
const rowsOf = (x, n) => Array.from({length: n > 0 ? x.length / n : 0}, (_, i) => x.slice(i * n, (i + 1) * n));

/** Rotation matrix of (w, x, y, z). */
function turn([w, x, y, z]) {
  const n = Math.hypot(w, x, y, z);
  [w, x, y, z] = [w / n, x / n, y / n, z / n];
  return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
          [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
          [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
}
/** A body's inertia about its centre of mass, in its axes: it keeps principal ones. */
function inertiaOf(m, body) {
  const R = turn(column(m.body_iquat, body, 4)), moments = column(m.body_inertia, body, 3);
  return product(R.map(row => row.map((x, k) => x * moments[k])), transposed(R));
}

/** MJCF of the scene, and where each body is that a link is welded into. */
function mjcf(scene, gravity) {
  const children = scene.links.map(() => []);
  scene.links.forEach((link, k) => link.parent >= 0 && children[link.parent].push(k));
  const text = x => x.join(' ');
  // frame: of the link's parent in the body that is written around this one
  const body = (k, frame) => {
    const link = scene.links[k], joint = link.joint;
    const X = after(frame, joint.before), inner = joint.after;
    let out = `<body name="b${k}" pos="${text(X.p)}" xyaxes="${text(transposed(X.R)[0])} ${
        text(transposed(X.R)[1])}">`;
    if (joint.kind !== 'fixed') {
      if (!kJoints[joint.kind] || joint.gyroscopic || joint.coulomb.some(x => x !== 0))
        throw new Refused(`joint '${joint.name}': it knows ${Object.keys(kJoints).join(', ')}, ` +
                          'and neither gyroscopic rotors nor Coulomb friction');
      out += `<joint type="${kJoints[joint.kind]}" axis="${text(joint.axis ?? [0, 0, 1])}" armature="${
          joint.gear_ratio ** 2 * joint.rotor_inertia}" damping="${joint.viscous}" stiffness="${
          joint.stiffness}" springref="${joint.rest}"/>`;
    }
    const com = plus(inner.p, times(inner.R, link.com));
    const I = product(product(inner.R, link.inertia), transposed(inner.R));
    // a full one is taken apart into principal axes, which loses digits
    const diagonal = [I[0][0], I[1][1], I[2][2]], products = [I[0][1], I[0][2], I[1][2]];
    if (link.mass > 0)
      out += `<inertial pos="${text(com)}" mass="${link.mass}" ${
          products.every(x => x === 0) ? `diaginertia="${text(diagonal)}"`
                                       : `fullinertia="${text([...diagonal, ...products])}"`}/>`;
    return out + children[k].map(child => body(child, inner)).join('') + '</body>';
  };
  return `<mujoco><compiler angle="radian" autolimits="false"/><option gravity="${text(gravity)}">` +
      '<flag contact="disable" constraint="disable" energy="enable"/></option><worldbody>' +
      children[0].map(child => body(child, kIdentity)).join('') + '</worldbody></mujoco>';
}

function compiled(xml) {
  let model;
  try {
    model = mujoco.mj_compile(mujoco.parseXMLString(xml), new mujoco.MjVFS());
  } catch (error) {
    throw new Refused(String(error.message).split('\n')[0]);
  }
  return {model, data: new mujoco.MjData(model)};
}

function engine(scene) {
  if (scene.wrenches.length > 0) throw new Refused('constant wrenches');
  const n = scene.dof;
  const heavy = compiled(mjcf(scene, scene.gravity)), weightless = compiled(mjcf(scene, [0, 0, 0]));
  const set = ({data}, s, still) => {
    data.qpos.set(s.q);
    data.qvel.set(still ? s.qd.map(() => 0) : s.qd);
    data.qacc.set(s.qdd);
    data.qfrc_applied.set(s.tau);
  };
  const springs = s => scene.links.slice(1).reduce((g, {joint}) => {
    if (joint.stiffness !== 0) g[joint.qd] += joint.stiffness * (s.q[joint.q] - joint.rest);
    return g;
  }, new Array(n).fill(0));
  const bias = (which, s, still) => {
    set(which, s, still);
    mujoco.mj_forward(which.model, which.data);
    return Array.from(which.data.qfrc_bias);
  };
  const root = scene.links[0];
  const bodyOf = k => k > 0 ? mujoco.mj_name2id(heavy.model, mujoco.mjtObj.mjOBJ_BODY.value, `b${k}`) : 0;
  return {
    M: s => {
      bias(heavy, s);
      const [M] = filled([n * n], out => mujoco.mj_fullM(heavy.model, out, Array.from(heavy.data.qM)));
      return rowsOf(M, n);
    },
    c: s => bias(weightless, s),
    g: s => plus(bias(heavy, s, true), springs(s)),
    tau: s => {
      set(heavy, s);
      mujoco.mj_inverse(heavy.model, heavy.data);
      return Array.from(heavy.data.qfrc_inverse);
    },
    qdd: s => {
      set(heavy, s);
      mujoco.mj_forward(heavy.model, heavy.data);
      return Array.from(heavy.data.qacc);
    },
    potential: s => {
      bias(heavy, s);  // the world has no mass in MuJoCo
      return heavy.data.energy[0] -
          root.mass * root.com.reduce((sum, x, k) => sum + x * scene.gravity[k], 0);
    },
    kinetic: s => (bias(heavy, s), heavy.data.energy[1]),
    jacobian: (s, frame) => {
      bias(heavy, s);
      const body = bodyOf(frame.link), inner = scene.links[frame.link].joint?.after ?? kIdentity;
      const R = rowsOf(column(heavy.data.xmat, body, 9), 3);
      const point = plus(column(heavy.data.xpos, body, 3), times(R, after(inner, {R, p: frame.at}).p));
      const [v, w] = filled([3 * n, 3 * n], (v, w) => mujoco.mj_jac(heavy.model, heavy.data, v, w, point, body));
      return [...rowsOf(v, n), ...rowsOf(w, n)];
    },
    // its bodies, seen from the links' own frames
    model: scene.links.slice(1).map((link, k) => {
      const body = bodyOf(k + 1), out = inverse(link.joint.after), m = heavy.model;
      return {
        link: link.name,
        mass: m.body_mass[body],
        com: after(out, {R: out.R, p: column(m.body_ipos, body, 3)}).p,
        inertia: product(product(out.R, inertiaOf(m, body)), transposed(out.R)),
      };
    }),
  };
}

// ---- as a reader

const kWorld = 0;

const kKinds = ['floating', 'spherical', 'prismatic', 'revolute'];  // by MuJoCo's numbers
// of what has no name it would read the start of its memory
const nameOf = (m, type, id) => m.names[m[type === 'mjOBJ_BODY' ? 'name_bodyadr' : 'name_jntadr'][id]] === 0 ? '' :
    mujoco.mj_id2name(m, mujoco.mjtObj[type].value, id);

/** A joint, but for its place. */
function shownJoint(m, joint, kind) {
  const said = {name: nameOf(m, 'mjOBJ_JOINT', joint), kind};
  if (kind !== 'revolute' && kind !== 'prismatic') return said;
  const dof = m.jnt_dofadr[joint], slot = m.jnt_qposadr[joint];
  Object.assign(said, {
    axis: column(m.jnt_axis, joint, 3),
    viscous: m.dof_damping[dof],
    coulomb: m.dof_frictionloss[dof],
    armature: m.dof_armature[dof],
    stiffness: m.jnt_stiffness[joint],
    rest: m.qpos_spring[slot] - m.qpos0[slot],
  });
  if (m.jnt_limited[joint]) [said.lower, said.upper] = column(m.jnt_range, joint, 2);
  const numbers = m.neq > 0 ? m.eq_data.length / m.neq : 0;
  for (let e = 0; e < m.neq; ++e)
    if (m.eq_type[e] === mujoco.mjtEq.mjEQ_JOINT.value && m.eq_obj1id[e] === joint && m.eq_obj2id[e] >= 0 &&
        (m.eq_active0 ?? m.eq_active)[e])
      said.mimic = {
        joint: nameOf(m, 'mjOBJ_JOINT', m.eq_obj2id[e]),
        offset: m.eq_data[e * numbers],
        multiplier: m.eq_data[e * numbers + 1],
      };
  return said;
}

/** Bodies, parents first. A joint's frame is the body's, at the joint's anchor.
    @param apart  several joints of a body are a row of links, of which the last has the name and the mass (MJCF);
                  otherwise they are one joint of a URDF */
function shownLinks(m, apart) {
  const nothing = {mass: 0, com: [0, 0, 0], inertia: kIdentity.R.map(row => row.map(() => 0))};
  const links = [{name: 'world', parent: -1, ...nothing}], placeOf = [0];
  for (let body = kWorld + 1; body < m.nbody; ++body) {
    let before = {R: turn(column(m.body_quat, body, 4)), p: column(m.body_pos, body, 3)};
    let parent = placeOf[m.body_parentid[body]], anchor = [0, 0, 0], joint = {name: '', kind: 'fixed', before};
    const first = m.body_jntadr[body], count = m.body_jntnum[body], rows = apart ? count : Math.min(count, 1);
    for (let k = 0; k < rows; ++k) {
      const kind = kKinds[m.jnt_type[first + k]], was = anchor;
      if (kind === 'revolute' || kind === 'spherical') anchor = column(m.jnt_pos, first + k, 3);  // a slide may have any
      before = after(before, {R: kIdentity.R, p: anchor.map((x, i) => x - was[i])});
      const all = apart || count === 1 ? kind : count === 3 ? 'planar' : 'floating';
      joint = {...shownJoint(m, first + k, all), before};
      if (k + 1 === rows) break;
      links.push({name: '', parent, joint, ...nothing});
      parent = links.length - 1;
      before = kIdentity;
    }
    if (rows > 0) joint.after = {R: kIdentity.R, p: anchor.map(x => -x)};
    placeOf.push(links.length);
    links.push({
      name: nameOf(m, 'mjOBJ_BODY', body),
      parent,
      joint,
      mass: m.body_mass[body],
      com: column(m.body_ipos, body, 3),
      inertia: inertiaOf(m, body),
    });
  }
  return links;
}

/** The name of the first element: "mujoco", "robot". */
function outermost(text) {
  let at = text.indexOf('<');
  for (; at >= 0; at = text.indexOf('<', at)) {
    const end = text.startsWith('<!--', at) ? '-->' : text.startsWith('<?', at) ? '?>' : text.startsWith('<!', at) ? '>' : '';
    if (!end) break;
    const after = text.indexOf(end, at);
    if (after < 0) return '';
    at = after + end.length;
  }
  return /^[^\s/>]*/.exec(text.slice(at + 1, at + 100))[0];
}

const isFile = path => statSync(path, {throwIfNoEntry: false})?.isFile() ?? false;

/** Puts an MJCF file where MuJoCo finds it, with the files that it names. */
function bring(file) {
  const folders = new Set([dirname(file)]), names = new Set(), brought = new Set();
  const put = path => {
    if (brought.has(path) || !isFile(path)) return;
    brought.add(path);
    const bytes = readFileSync(path);
    mujoco.FS.mkdirTree(dirname(path));
    mujoco.FS.writeFile(path, bytes);
    if (path !== file && !path.endsWith('.xml')) return;
    const text = bytes.toString('utf8');
    for (const [, folder] of text.matchAll(/\b(?:meshdir|texturedir|assetdir)\s*=\s*["']([^"']*)["']/g))
      folders.add(resolve(dirname(file), folder));
    for (const [, name] of text.matchAll(/\bfile\w*\s*=\s*["']([^"']+)["']/g)) {
      names.add(name);
      put(resolve(dirname(file), name));  // another part of the model, which may name more
    }
  };
  put(file);
  for (const folder of folders)
    for (const name of names) put(resolve(folder, name));
}

/** What its compiler makes of the bytes of a file. */
function reader(scene) {
  const bytes = readFileSync(scene.file);
  const apart = outermost(bytes.toString('utf8')) === 'mujoco';
  const file = apart ? scene.file : '/' + (scene.file.split('/').pop() || 'robot.urdf');
  let m;
  try {
    if (apart) bring(file);
    else mujoco.FS.writeFile(file, bytes);
    m = mujoco.MjModel.loadFromXML(file);
  } catch (error) {
    throw new Refused(String(error.message ?? error).split('\n').join(' '));
  }
  if (!m) throw new Refused('it gives no reason');
  const data = new mujoco.MjData(m);
  const at = s => {
    s.q.forEach((x, k) => data.qpos[m.jnt_qposadr[k]] = m.qpos0[m.jnt_qposadr[k]] + x);
    data.qvel.fill(0);
    mujoco.mj_kinematics(m, data);
    mujoco.mj_comPos(m, data);
    (mujoco.mj_makeM ?? mujoco.mj_crb)(m, data);  // the first since 3.3, where the second fills another M
    mujoco.mj_comVel(m, data);
  };
  // in the order of the bodies, which may not be that of the joints
  const dofs = Array.from({length: m.nbody}, (_, body) => body)
                   .flatMap(body => Array.from({length: m.body_jntnum[body]}, (_, k) => m.body_jntadr[body] + k))
                   .map(joint => m.jnt_dofadr[joint]);
  return {
    shows: {
      gravity: m.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY.value ? [0, 0, 0] : Array.from(m.opt.gravity),
      links: shownLinks(m, apart),
      // mju_eig3 stops with a cosine of 1 - 1e-12
      principal_axes: Math.sqrt(2e-12),
    },
    M: s => {
      at(s);
      const [full] = filled([m.nv * m.nv], out => mujoco.mj_fullM(m, out, Array.from(data.qM)));
      return dofs.map(i => dofs.map(j => full[i * m.nv + j]));
    },
    g: s => {
      at(s);
      const [g] = filled([m.nv], out => mujoco.mj_rne(m, data, 0, out));
      return dofs.map(i => g[i]);
    },
  };
}

let known = {};
const say = message => process.stdout.write(JSON.stringify(message) + '\n');
for await (const line of createInterface({input: process.stdin})) {
  const asked = JSON.parse(line);
  if (asked.scene) {
    const said = {protocol: 1, name: 'mujoco_npm', version: mujoco.mj_versionString()};
    try {
      const {shows, model, ...functions} = asked.scene.file ? reader(asked.scene) : engine(asked.scene);
      known = functions;
      const quantities = Object.keys(known).filter(name => asked.asks?.includes(name) ?? true);
      say({...said, ...(shows ? {shows} : {}), ...(model ? {model} : {}), quantities});
    } catch (reason) {
      if (!(reason instanceof Refused)) throw reason;
      say({...said, refuses: reason.message});
    }
    continue;
  }
  const answers = asked.states.map(state => Object.fromEntries(asked.quantities.map(quantity => {
    const value = known[quantity](state, asked.frame);
    return [quantity, [value].flat(2).every(Number.isFinite) ? value : 'not finite'];
  })));
  say({batch: asked.batch, answers});
}
