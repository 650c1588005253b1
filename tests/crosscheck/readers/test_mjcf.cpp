// SPDX-License-Identifier: GPL-3.0-or-later
// Our reader of MJCF, and MuJoCo, whose format it is, on the same bytes: M, c, g, springs, damping
// and friction of each file in tests/scene/mjcf; and of any folder of models that
// DYNWITNESS_MJCF_FOLDER names, as a table.
#define BOOST_TEST_DYN_LINK
#define BOOST_TEST_MODULE mjcf
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include <boost/test/data/monomorphic.hpp>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>

#include <fmt/format.h>
#include <Eigen/Core>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/readers/robot.hpp"
#include "crosscheck/readers/same.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/formats.hpp"
#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/numbers.hpp"
#include "scene/text_file.hpp"
#include "tests/fixtures/program.hpp"

#ifdef DYNWITNESS_HAS_MUJOCO
#include "crosscheck/witnesses/mujoco_model.hpp"
#endif

namespace data = boost::unit_test::data;
namespace fs = std::filesystem;
using namespace dynwitness;
using namespace dynwitness::crosscheck;

#ifdef DYNWITNESS_HAS_MUJOCO
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
const fs::path kModels = fs::path(DYNWITNESS_SOURCE_DIR) / "tests/scene/mjcf";

/// What MuJoCo makes of a file, with nothing set.
class Engine {
 public:
  explicit Engine(const fs::path& file) {
    installMujocoHandlers();
    char said[1000] = "";
    try {
      m_.reset(mj_loadXML(file.c_str(), nullptr, said, sizeof said));
      if (!m_) refusal = said;
    } catch (const std::exception& error) {
      refusal = error.what();
    }
    if (m_) d_.reset(mj_makeData(m_.get()));
  }

  std::string refusal;

  mjModel& model() const { return *m_; }

  /** Our state in MuJoCo's words: qpos = q + ref, quaternions of length 1, linear speeds of free
      joints in the axes of the world; T' turns its forces into ours. */
  void set(const scene::State<double>& state, bool moving) {
    mjModel* m = m_.get();
    mjData* d = d_.get();
    mj_resetData(m, d);
    T_ = MatrixXd::Identity(m->nv, m->nv);
    turned_.clear();
    for (int j = 0, slot = 0; j < m->njnt; ++j) {
      mjtNum* q = d->qpos + m->jnt_qposadr[j];
      const auto x = [&](int k) { return state.x[static_cast<std::size_t>(slot + k)].q; };
      const int dof = m->jnt_dofadr[j], type = m->jnt_type[j];
      if (type == mjJNT_HINGE || type == mjJNT_SLIDE) {
        q[0] = x(0) + m->qpos0[m->jnt_qposadr[j]];
        slot += 1;
        continue;
      }
      const int count = type == mjJNT_FREE ? 7 : 4;
      for (int k = 0; k < count; ++k) q[k] = x(k);
      mju_normalize4(q + count - 4);
      if (type == mjJNT_FREE) {
        RowMajor3 R;
        mju_quat2Mat(R.data(), q + 3);
        T_.block<3, 3>(dof, dof) = R;
        turned_.push_back({dof, R});
      }
      slot += count;
    }
    ours_ = Eigen::Map<const VectorXd>(state.qd.data(), m->nv);
    if (!moving) ours_.setZero();
    Eigen::Map<VectorXd>(d->qvel, m->nv) = T_ * ours_;
    mj_fwdPosition(m, d);
    mj_fwdVelocity(m, d);
  }
  MatrixXd M() const {
    MatrixXd full(m_->nv, m_->nv);
    mj_fullM(m_.get(), full.data(), d_->qM);
    return T_.transpose() * full * T_;
  }
  /// Forces where our accelerations are zero; springs and dampers with the sign of a load.
  VectorXd forces(bool with_gravity, bool with_passive) {
    mjModel* m = m_.get();
    const Eigen::Vector3d gravity(m->opt.gravity);
    if (!with_gravity) mju_zero(m->opt.gravity, 3);
    VectorXd a = VectorXd::Zero(m->nv);
    for (const auto& [dof, R] : turned_) {
      const Eigen::Vector3d v = ours_.segment<3>(dof), w = ours_.segment<3>(dof + 3);
      a.segment<3>(dof) = R * w.cross(v);
    }
    Eigen::Map<VectorXd>(d_->qacc, m->nv) = a;
    VectorXd out(m->nv);
    mj_rne(m, d_.get(), 1, out.data());
    std::copy_n(gravity.data(), 3, m->opt.gravity);
    if (with_passive) out -= Eigen::Map<const VectorXd>(d_->qfrc_passive, m->nv);
    return T_.transpose() * out;
  }

 private:
  struct Turned {
    int dof;
    RowMajor3 R;
  };
  MujocoOwned<mjModel> m_;
  MujocoOwned<mjData> d_;
  MatrixXd T_;
  VectorXd ours_;
  std::vector<Turned> turned_;
};

/// How far two answers are apart, over what they may be.
struct Apart {
  double M = 0, c = 0, g = 0;
  std::string where;  ///< what else differs
  double worst() const { return std::max({M, c, g}); }
  bool agrees() const { return where.empty() && worst() <= 1; }
};

/** MuJoCo keeps inertias as principal moments and axes, which its compiler leaves short of turned
    where there are products (kMujocoTurnStop), and rounds. Both are relative to the largest terms:
    of M its largest entry, of c what Christoffel's symbols of that make, dM/dq being at most 2 M a
    joint, of g all weights at the largest distance, and the springs. */
Apart compared(const scene::Scene& scene, Engine& engine, int states) {
  Apart out;
  scene::Scene tree = scene;
  tree.mechanism = scene::withoutMimics(scene.mechanism);
  const mjModel& m = engine.model();
  const std::vector<int> moving = tree.mechanism.movingLinks();
  if (static_cast<int>(moving.size()) != m.njnt || tree.mechanism.dof() != m.nv) {
    out.where = fmt::format("{} joints, {} dof, and MuJoCo has {}, {}", moving.size(),
                            tree.mechanism.dof(), m.njnt, m.nv);
    return out;
  }
  const scene::RealNumbers<double> number(tree.mechanism);
  double spring = 0;
  for (int j = 0; j < m.njnt; ++j) {
    const scene::Joint& joint =
        tree.mechanism.links[static_cast<std::size_t>(moving[static_cast<std::size_t>(j)])].joint;
    const char* name = mj_id2name(&m, mjOBJ_JOINT, j);
    if (name && *name && joint.name != name) out.where = "order of joints: " + joint.name;
    const int dof = m.jnt_dofadr[j];
    const auto differs = [](double a, double b) {
      return std::abs(a - b) > 4e-16 * std::max(std::abs(a), std::abs(b));  // parsed twice
    };
    if (differs(number(joint.friction.viscous), m.dof_damping[dof])) out.where = "damping";
    if (differs(number(joint.friction.positive), m.dof_frictionloss[dof])) out.where = "friction";
    if (differs(number(joint.rotor_inertia), m.dof_armature[dof])) out.where = "armature";
    if (differs(number(joint.stiffness), m.jnt_stiffness[j])) out.where = "stiffness";
    spring += std::abs(m.jnt_stiffness[j]) * (4 + std::abs(number(joint.rest)));
  }
  const auto witness = newtonEulerKind().make(tree).value();
  // only inertias with products are turned
  const bool is_turned = std::any_of(
      tree.mechanism.links.begin(), tree.mechanism.links.end(), [&](const scene::Link& link) {
        const scene::MassProperties& I = link.inertia;
        return number(I.xy) != 0 || number(I.xz) != 0 || number(I.yz) != 0;
      });
  const double relative = roundingOf(static_cast<int>(tree.mechanism.links.size())) +
                          (is_turned ? std::sqrt(2 * kMujocoTurnStop) : 0);
  for (int k = 0; k < states && out.where.empty(); ++k) {
    const scene::State<double> state =
        drawState(tree.mechanism, scene.name, 1, static_cast<std::uint64_t>(k));
    engine.set(state, false);
    const MatrixXd M = witness->answer(Quantity::kM, state).value;
    const VectorXd g = witness->answer(Quantity::kg, state).value;
    const double largest = M.cwiseAbs().maxCoeff();
    out.M = std::max(out.M, (M - engine.M()).cwiseAbs().maxCoeff() / (relative * largest));
    double mass = 0, reach = m.njnt;  // slides and free joints go up to 1 m
    for (int b = 1; b < m.nbody; ++b) {
      mass += m.body_mass[b];
      reach +=
          Eigen::Vector3d(m.body_pos + 3 * b).norm() + Eigen::Vector3d(m.body_ipos + 3 * b).norm();
    }
    for (int j = 0; j < m.njnt; ++j) reach += 2 * Eigen::Vector3d(m.jnt_pos + 3 * j).norm();
    const double weight = mass * reach * Eigen::Vector3d(m.opt.gravity).norm();
    const double size = weight + spring;
    if (size > 0)
      out.g = std::max(out.g,
                       (g - engine.forces(true, true)).cwiseAbs().maxCoeff() / (relative * size));
    engine.set(state, true);
    const VectorXd c = witness->answer(Quantity::kc, state).value;
    const double speed = Eigen::Map<const VectorXd>(state.qd.data(), m.nv).cwiseAbs().sum();
    out.c = std::max(out.c, (c - engine.forces(false, false)).cwiseAbs().maxCoeff() /
                                (relative * 3 * largest * speed * speed));
  }
  return out;
}

std::string firstLine(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error))
    if (entry.path().extension() == ".xml") {
      const std::string text = scene::readTextFile(entry.path(), "XML");
      if (scene::isMjcf(text) && text.find("<worldbody") != std::string::npos)
        out.push_back(entry.path());
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

BOOST_DATA_TEST_CASE(our_reader_and_mujoco_make_the_same_of_a_file, data::make(filesIn(kModels))) {
  const scene::Scene scene = scene::readScene(sample);
  Engine engine(sample);
  BOOST_REQUIRE(engine.refusal.empty());
  const Apart apart = compared(scene, engine, 10);
  BOOST_TEST(apart.agrees(), sample.filename() << ": " << apart.where << " M " << apart.M << ", c "
                                               << apart.c << ", g " << apart.g);
}

// the comparison sees what a reader may do wrong: each change of a number moves it past its limit
BOOST_AUTO_TEST_CASE(a_reader_with_a_mistake_would_be_found) {
  const fs::path file = kModels / "joints.xml";
  const scene::Scene right = scene::readScene(file);
  const auto found = [&](const auto& change) {
    scene::Scene wrong = right;
    change(&wrong);
    Engine engine(file);
    return !compared(wrong, engine, 2).agrees();
  };
  const auto linkOf = [](scene::Scene* scene, const std::string& name) -> scene::Link& {
    for (scene::Link& link : scene->mechanism.links)
      if (link.name == name) return link;
    throw std::logic_error("no link " + name);
  };
  using scene::Number;
  const auto number = [](const char* text) { return scene::Expression::parse(text); };
  BOOST_TEST(!found([](scene::Scene*) {}));
  BOOST_TEST(found([&](scene::Scene* s) { linkOf(s, "three").inertia.com[0] = number("0.1"); }));
  BOOST_TEST(found([&](scene::Scene* s) { linkOf(s, "three").joint.rest = Number(0); }) == false);
  BOOST_TEST(found([&](scene::Scene* s) { linkOf(s, "three.h1").joint.rest = number("0.1"); }));
  BOOST_TEST(found([&](scene::Scene* s) { linkOf(s, "after").joint.placement.xyz = {}; }));
  BOOST_TEST(found([&](scene::Scene* s) { linkOf(s, "fixed").joint.placement.rpy = {}; }));
  BOOST_TEST(
      found([&](scene::Scene* s) { linkOf(s, "three").joint.friction.viscous = number("0.01"); }));
}

BOOST_AUTO_TEST_CASE(closures_and_keyframes_are_mujocos) {
  const fs::path file = kModels / "closed.xml";
  const scene::Scene scene = scene::readScene(file);
  Engine engine(file);
  const mjModel& m = engine.model();
  const scene::RealNumbers<double> number(scene.mechanism);
  BOOST_REQUIRE(scene.mechanism.closures.size() == 3u);
  // connect: MuJoCo keeps the anchor in both bodies; left's frame is moved to the anchor of j1
  const auto& loop = scene.mechanism.closures[0];
  for (int k = 0; k < 3; ++k) {
    BOOST_TEST(number(loop.a.xyz[static_cast<std::size_t>(k)]) == m.eq_data[k], "a " << k);
    BOOST_TEST(std::abs(number(loop.b.xyz[static_cast<std::size_t>(k)]) - m.eq_data[3 + k]) <
               1e-15 * 4);
  }
  // weld: the anchor in body2, its place in body1, and the quaternion of body2 on body1
  for (const int e : {1, 2}) {
    const scene::Closure& weld = scene.mechanism.closures[static_cast<std::size_t>(e)];
    const mjtNum* at = m.eq_data + mjNEQDATA * e;
    RowMajor3 R;
    mju_quat2Mat(R.data(), at + 6);
    const auto c = [&](int k) { return number.angle(weld.a.rpy[static_cast<std::size_t>(k)]); };
    RowMajor3 X, Y, Z;
    X << 1, 0, 0, 0, c(0).c, -c(0).s, 0, c(0).s, c(0).c;
    Y << c(1).c, 0, c(1).s, 0, 1, 0, -c(1).s, 0, c(1).c;
    Z << c(2).c, -c(2).s, 0, c(2).s, c(2).c, 0, 0, 0, 1;
    BOOST_TEST((Z * Y * X - R).norm() < 1e-14);
    const double shift = e == 2 ? 0.01 : 0;  // of left's link from its body
    for (int k = 0; k < 3; ++k)
      BOOST_TEST(std::abs(number(weld.a.xyz[static_cast<std::size_t>(k)]) + (k == 0 ? shift : 0) -
                          at[3 + k]) < 1e-15 * 4);
  }
  for (int k = 0; k < m.nq; ++k)
    if (k != 6)  // the follower is where its leader puts it
      BOOST_TEST(number(scene.start_q[static_cast<std::size_t>(k)]) == m.key_qpos[k]);
  BOOST_TEST(number(scene.start_q[6]) == 0.06);
  BOOST_TEST(scene.start_qd.size() == 6u);
}

BOOST_AUTO_TEST_CASE(models_of_a_folder_agree_or_are_refused_by_name) {
  const char* folder = std::getenv("DYNWITNESS_MJCF_FOLDER");
  if (!folder) return;
  int agree = 0, refused = 0, engine_refused = 0, both = 0;
  for (const fs::path& file : filesIn(folder)) {
    std::string refusal;
    scene::Scene scene;
    try {
      scene = scene::readScene(file);
    } catch (const scene::InputError& error) {
      refusal = firstLine(error.what());
      BOOST_TEST(refusal.find(".xml") != std::string::npos, refusal);
    }
    Engine engine(file);
    const std::string name = fs::relative(file, folder).string();
    if (!refusal.empty()) {
      ++(engine.refusal.empty() ? refused : both);
      std::cout << fmt::format("{:<70} refused{}: {}\n", name,
                               engine.refusal.empty() ? "" : ", by MuJoCo too",
                               refusal.substr(refusal.find(".xml") + 4));
    } else if (!engine.refusal.empty()) {
      ++engine_refused;
      std::cout << fmt::format("{:<70} MuJoCo refuses: {}\n", name, firstLine(engine.refusal));
    } else if (scene.mechanism.dof() == 0) {
      std::cout << fmt::format("{:<70} nothing moves\n", name);
    } else {
      const Apart apart = compared(scene, engine, 5);
      if (apart.agrees()) ++agree;
      BOOST_TEST(apart.agrees(), name << " " << apart.where);
      std::cout << fmt::format("{:<70} {} {:>3} dof, M {:.1e} c {:.1e} g {:.1e} {}\n", name,
                               apart.agrees() ? "agrees" : "DIFFERS", scene.mechanism.dof(),
                               apart.M, apart.c, apart.g, apart.where);
    }
  }
  std::cout << fmt::format("{} agree, {} refused by name, {} refused by MuJoCo alone, {} by both\n",
                           agree, refused, engine_refused, both);
}
#endif

BOOST_AUTO_TEST_SUITE(written)

// every bundled scene, in every format that holds it
BOOST_AUTO_TEST_CASE(a_scene_in_another_format_is_the_same_robot) {
  using scene::Format;
  int same = 0;
  for (const fs::path& file : scene::bundledScenes())
    for (const Format format : {Format::kToml, Format::kUrdf, Format::kMjcf}) {
      Description a = {scene::readScene(file), {}};
      if (format == Format::kUrdf) {  // which has no start
        a.scene.start_q = a.scene.mechanism.restPosition();
        a.scene.start_qd.assign(a.scene.start_qd.size(), scene::Number());
      }
      BOOST_TEST_CONTEXT(a.scene.name << " as " << scene::name(format)) {
        scene::WrittenScene written;
        try {
          written = scene::writeSceneAs(a.scene, format);
        } catch (const scene::InputError& error) {
          BOOST_TEST(std::string(error.what()).find(", allowed") != std::string::npos);
          continue;
        }
        if (!written.lost.empty()) continue;
        Description b;
        if (format == Format::kUrdf)
          b = scene::readUrdfAsWritten(written.text, "b.urdf");
        else
          b.scene = format == Format::kToml ? scene::readSceneToml(written.text, "b.toml")
                                            : scene::readSceneMjcf(written.text, "b.xml");
        BOOST_TEST(b.scene.mechanism.closures.size() == a.scene.mechanism.closures.size());
        try {
          const SameResult result = compareDescriptions(a, b, 1, 1);
          BOOST_TEST(result.isSame(), sameText(result));
          same += result.isSame() ? 1 : 0;
        } catch (const scene::InputError&) {  // loads, closures: not compared
        }
      }
    }
  BOOST_TEST(same >= 42);  // of 141; the others are refused, or not compared
}

BOOST_AUTO_TEST_CASE(the_command_writes_or_says_what_would_be_lost) {
  const fixtures::Program program;
  BOOST_TEST(program.run("write double_pendulum --format mjcf -o p.xml").status == 0);
  BOOST_TEST(program.run("same p.xml double_pendulum").status == 0);
  BOOST_TEST(program.run("write p.xml --format urdf --lossy", "2>/dev/null").out.find("<robot") ==
             0u);
  fixtures::refuses(program, "write furuta_pendulum --format xyz", "xyz");
  fixtures::refuses(program, "write heavy_top --format urdf -o t.urdf",
                    "spherical, allowed in URDF");
  program.write("s.toml",
                "title = \"x\"\nsource = \"x\"\n[[link]]\nname = \"base\"\n[[link]]\nname = \"a\"\n"
                "parent = \"base\"\nmass = 1\ncom = [1, 0, 0]\n"
                "joint = { kind = \"revolute\", friction = { coulomb = { positive = 1 } } }\n");
  fixtures::refuses(program, "write s.toml --format mjcf -o s.xml",
                    "mjcf cannot hold, allowed: another format, or --lossy");
  BOOST_TEST(!program.exists("s.xml"));
  const fixtures::Outcome lossy = program.run("write s.toml --format mjcf -o s.xml --lossy");
  BOOST_TEST(lossy.status == 0, lossy.out);
  BOOST_TEST(lossy.out.find("lost: Coulomb friction of joint a") != std::string::npos, lossy.out);
  BOOST_TEST(program.read("s.xml").find("<!-- lost: Coulomb friction") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()
