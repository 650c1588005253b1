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
  return {
    M: s => {
      bias(heavy, s);
      const dense = new mujoco.DoubleBuffer(n * n);
      mujoco.mj_fullM(heavy.model, dense, Array.from(heavy.data.qM));
      const rows = Array.from(dense.GetView());
      dense.delete();
      return Array.from({length: n}, (_, i) => rows.slice(i * n, (i + 1) * n));
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
  };
}

let known = {};
const say = message => process.stdout.write(JSON.stringify(message) + '\n');
for await (const line of createInterface({input: process.stdin})) {
  const asked = JSON.parse(line);
  if (asked.scene) {
    const said = {protocol: 1, name: 'mujoco_npm', version: mujoco.mj_versionString()};
    try {
      known = engine(asked.scene);
      say({...said, quantities: Object.keys(known)});
    } catch (reason) {
      if (!(reason instanceof Refused)) throw reason;
      say({...said, refuses: reason.message});
    }
    continue;
  }
  const answers = asked.states.map(state => Object.fromEntries(asked.quantities.map(quantity => {
    const value = known[quantity](state);
    return [quantity, [value].flat(2).every(Number.isFinite) ? value : 'not finite'];
  })));
  say({batch: asked.batch, answers});
}
