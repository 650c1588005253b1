// SPDX-License-Identifier: GPL-3.0-or-later
// The Python module dynwitness._core: scenes and their quantities, NumPy in and out.
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "crosscheck/python/arrays.hpp"
#include "crosscheck/python/quantities.hpp"
#include "scene/mjcf.hpp"
#include "scene/text_file.hpp"
#include "symbolic/derivation.hpp"

namespace dynwitness::python {
namespace {

/// From so many states on a batch is swept in the processor's lanes, for which a scene is made
/// ready anew: as long as some ten states of it take.
constexpr long kStatesForLanes = 16;
/// From so many states on a batch is given to the kernel, whose compilation takes a second or so
/// where it is not kept on disk yet: as long as some 10^5 states take by the sweeps.
constexpr long kStatesForKernel = 4096;

class PyScene {
 public:
  explicit PyScene(scene::Scene scene) : quantities_(std::move(scene)), room_(quantities_) {}

  const Quantities& quantities() const { return quantities_; }
  int n() const { return quantities_.dof(); }
  int nq() const { return quantities_.positions(); }
  void requireTree() const {
    const std::string why = quantities_.notOfTheTree();
    if (!why.empty()) throw py::value_error(why);
  }

  /// Calls of each state: of one with Python's lock held, of many without it and with a room of
  /// their own, so that other threads may compute meanwhile.
  template <typename Call>
  void forEach(const States& states, const Call& call) {
    if (!states.isBatch()) {
      call(0, room_);
      return;
    }
    const py::gil_scoped_release others_may_run;
    Quantities::Room room(quantities_);
    for (long k = 0; k < states.count(); ++k) call(k, room);
  }

  /// The same of what is swept in lanes where there are enough: `call` of each state, or `many`
  /// once.
  template <typename Call, typename Many>
  void forEach(const States& states, const Call& call, const Many& many) {
    if (!states.isBatch() || states.count() < kStatesForLanes) return forEach(states, call);
    const py::gil_scoped_release others_may_run;
    many();
  }

 private:
  Quantities quantities_;
  Quantities::Room room_;
};

/// All states' rows of an argument: of one state beside a batch, the same for each.
Quantities::Rows rowsOf(const Argument& argument, int width) {
  return {argument.at(0), argument.isBatch() ? width : 0};
}

using O = py::object;

Array massMatrix(PyScene& s, const O& q) {
  const Argument a("q", q, s.nq());
  const States states({&a});
  Array out = states.answers({s.n(), s.n()});
  double* to = out.mutable_data();
  s.forEach(
      states,
      [&](long k, Quantities::Room& room) {
        s.quantities().massMatrix(a.at(k), to + k * s.n() * s.n(), room);
      },
      [&] { s.quantities().massMatrices(rowsOf(a, s.nq()), to, states.count()); });
  return out;
}

Array coriolis(PyScene& s, const O& q, const O& qd) {
  const Argument a("q", q, s.nq()), b("qd", qd, s.n());
  const States states({&a, &b});
  Array out = states.answers({s.n()});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().coriolis(a.at(k), b.at(k), to + k * s.n(), room);
  });
  return out;
}

Array gravity(PyScene& s, const O& q) {
  const Argument a("q", q, s.nq());
  const States states({&a});
  Array out = states.answers({s.n()});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().gravity(a.at(k), to + k * s.n(), room);
  });
  return out;
}

bool takesKernel(const PyScene& s, const States& states, const std::array<const Argument*, 3>& all,
                 std::optional<bool> kernel, bool forward) {
  for (const Argument* a : all)  // one state beside a batch is not laid out for the kernel
    if (!a->isBatch()) return false;
  if (kernel.has_value() ? !*kernel : states.count() < kStatesForKernel) return false;
  const bool has = s.quantities().hasKernel(forward);
  if (!has && kernel.value_or(false))
    throw py::value_error(
        "kernel: True, and there is none for this scene on this machine (no C "
        "compiler, or no straight line worth having), allowed: None, False");
  return has;
}

Array inverseDynamics(PyScene& s, const O& q, const O& qd, const O& qdd,
                      std::optional<bool> kernel) {
  s.requireTree();
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("qdd", qdd, s.n());
  const States states({&a, &b, &c});
  Array out = states.answers({s.n()});
  double* to = out.mutable_data();
  if (takesKernel(s, states, {&a, &b, &c}, kernel, false)) {
    const py::gil_scoped_release others_may_run;
    s.quantities().inverseDynamicsInLanes(a.at(0), b.at(0), c.at(0), to, states.count());
    return out;
  }
  s.forEach(
      states,
      [&](long k, Quantities::Room& room) {
        s.quantities().inverseDynamics(a.at(k), b.at(k), c.at(k), to + k * s.n(), room);
      },
      [&] {
        s.quantities().inverseDynamicsOfMany(rowsOf(a, s.nq()), rowsOf(b, s.n()), rowsOf(c, s.n()),
                                             to, states.count());
      });
  return out;
}

Array forwardDynamics(PyScene& s, const O& q, const O& qd, const O& tau,
                      std::optional<bool> kernel) {
  s.requireTree();
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("tau", tau, s.n());
  const States states({&a, &b, &c});
  Array out = states.answers({s.n()});
  double* to = out.mutable_data();
  if (takesKernel(s, states, {&a, &b, &c}, kernel, true)) {
    const py::gil_scoped_release others_may_run;
    s.quantities().forwardDynamicsInLanes(a.at(0), b.at(0), c.at(0), to, states.count());
    return out;
  }
  s.forEach(
      states,
      [&](long k, Quantities::Room& room) {
        s.quantities().forwardDynamics(a.at(k), b.at(k), c.at(k), to + k * s.n(), room);
      },
      [&] {
        s.quantities().forwardDynamicsOfMany(rowsOf(a, s.nq()), rowsOf(b, s.n()), rowsOf(c, s.n()),
                                             to, states.count());
      });
  return out;
}

O scalarOrArray(const States& states, const Array& out) {
  return states.isBatch() ? O(out) : O(py::float_(*out.data()));
}

O kinetic(PyScene& s, const O& q, const O& qd) {
  const Argument a("q", q, s.nq()), b("qd", qd, s.n());
  const States states({&a, &b});
  Array out = states.answers({});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    to[k] = s.quantities().kinetic(a.at(k), b.at(k), room);
  });
  return scalarOrArray(states, out);
}

O potential(PyScene& s, const O& q) {
  const Argument a("q", q, s.nq());
  const States states({&a});
  Array out = states.answers({});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    to[k] = s.quantities().potential(a.at(k), room);
  });
  return scalarOrArray(states, out);
}

Array momentum(PyScene& s, const O& q, const O& qd) {
  const Argument a("q", q, s.nq()), b("qd", qd, s.n());
  const States states({&a, &b});
  Array out = states.answers({6});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().momentum(a.at(k), b.at(k), to + 6 * k, room);
  });
  return out;
}

Array reactions(PyScene& s, const O& q, const O& qd, const O& qdd) {
  s.requireTree();
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("qdd", qdd, s.n());
  const States states({&a, &b, &c});
  const auto joints = static_cast<py::ssize_t>(s.quantities().scene().mechanism.links.size()) - 1;
  Array out = states.answers({joints, 6});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().reactions(a.at(k), b.at(k), c.at(k), to + 6 * joints * k, room);
  });
  return out;
}

Array regressor(PyScene& s, const O& q, const O& qd, const O& qdd) {
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("qdd", qdd, s.n());
  const States states({&a, &b, &c});
  const int p = s.quantities().parameters();
  Array out = states.answers({s.n(), p});
  double* to = out.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().regressor(a.at(k), b.at(k), c.at(k), to + k * s.n() * p, room);
  });
  return out;
}

py::tuple inverseDerivatives(PyScene& s, const O& q, const O& qd, const O& qdd) {
  s.requireTree();
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("qdd", qdd, s.n());
  const States states({&a, &b, &c});
  const long size = static_cast<long>(s.n()) * s.n();
  Array by_q = states.answers({s.n(), s.n()}), by_qd = states.answers({s.n(), s.n()});
  double *to_q = by_q.mutable_data(), *to_qd = by_qd.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().inverseDerivatives(a.at(k), b.at(k), c.at(k), to_q + k * size, to_qd + k * size,
                                      room);
  });
  return py::make_tuple(by_q, by_qd, massMatrix(s, q));
}

py::tuple forwardDerivatives(PyScene& s, const O& q, const O& qd, const O& tau) {
  s.requireTree();
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), c("tau", tau, s.n());
  const States states({&a, &b, &c});
  const long size = static_cast<long>(s.n()) * s.n();
  Array by_q = states.answers({s.n(), s.n()}), by_qd = states.answers({s.n(), s.n()}),
        by_tau = states.answers({s.n(), s.n()});
  double *to_q = by_q.mutable_data(), *to_qd = by_qd.mutable_data(),
         *to_tau = by_tau.mutable_data();
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().forwardDerivatives(a.at(k), b.at(k), c.at(k), to_q + k * size, to_qd + k * size,
                                      to_tau + k * size, room);
  });
  return py::make_tuple(by_q, by_qd, by_tau);
}

/// Place, turn, J and dJ/dt of a point. Whoever takes one of them returns an O: what pybind11's []
/// gives refers to the tuple.
py::tuple point(PyScene& s, const std::string& link, const O& q, const O& qd, const O& at) {
  const std::size_t index = s.quantities().link(link);
  const Argument a("q", q, s.nq()), b("qd", qd, s.n()), place("at", at, 3);
  if (place.isBatch())
    throw py::value_error("at: expected shape (3,), got " + shapeText(place.array));
  const States states({&a, &b});
  Array p = states.answers({3}), R = states.answers({3, 3}), J = states.answers({6, s.n()}),
        J_rate = states.answers({6, s.n()});
  const Quantities::OfPoint to{p.mutable_data(), R.mutable_data(), J.mutable_data(),
                               J_rate.mutable_data()};
  const long size = 6L * s.n();
  const std::array<double, 3> xyz{place.at(0)[0], place.at(0)[1], place.at(0)[2]};
  s.forEach(states, [&](long k, Quantities::Room& room) {
    s.quantities().point(index, xyz, a.at(k), b.at(k),
                         {to.position + 3 * k, to.rotation + 9 * k, to.jacobian + size * k,
                          to.jacobian_rate + size * k},
                         room);
  });
  return py::make_tuple(p, R, J, J_rate);
}

/// qd of what does not depend on it.
O noRates(const PyScene& s) {
  Array zeros({static_cast<py::ssize_t>(s.n())});
  std::fill_n(zeros.mutable_data(), s.n(), 0.0);
  return O(zeros);
}

std::string derive(const PyScene& s, const std::string& format) {
  const auto style = format == "text"    ? symbolic::Style::kText
                     : format == "latex" ? symbolic::Style::kLatex
                     : format == "mathml"
                         ? symbolic::Style::kMathml
                         : throw py::value_error(fmt::format(
                               "format: read '{}', allowed: text, latex, mathml", format));
  const symbolic::Derivation d = symbolic::derivation(s.quantities().scene().mechanism);
  if (!d.holds()) throw std::runtime_error("a step of the derivation does not hold");
  return symbolic::print(d, style);  // GiNaC is not thread safe: Python's lock stays
}

std::unique_ptr<PyScene> load(const std::string& name) {
  return std::make_unique<PyScene>(scene::findScene(name));
}
std::unique_ptr<PyScene> fromText(const std::string& text, const std::string& name) {
  if (!scene::looksLikeXml(text))
    return std::make_unique<PyScene>(scene::readSceneToml(text, name));
  return std::make_unique<PyScene>(text.find("<mujoco") == std::string::npos
                                       ? scene::readSceneUrdf(text, name)
                                       : scene::readSceneMjcf(text, name));
}
std::vector<std::string> links(const PyScene& s) {
  std::vector<std::string> names;
  for (const scene::Link& link : s.quantities().scene().mechanism.links) names.push_back(link.name);
  return names;
}

void bindDynamics(py::class_<PyScene>& scene) {
  using py::arg;
  scene
      .def("M", &massMatrix, arg("q"),
           "Mass matrix of the tree.\n\nq: (nq,) or (N, nq) [rad, m].\nReturns (n, n) or (N, n, n) "
           "[kg m^2, kg m, kg], symmetric; rotors included.")
      .def("c", &coriolis, arg("q"), arg("qd"),
           "Coriolis and centrifugal forces, without gravity, springs, friction.\n\nq: (nq,), qd: "
           "(n,) [rad/s, m/s], or batches (N, ..).\nReturns (n,) or (N, n) [N m, N].")
      .def("g", &gravity, arg("q"),
           "Gravity and springs, dV/dq.\n\nq: (nq,) or (N, nq).\nReturns (n,) or (N, n) [N m, N].")
      .def(
          "id", &inverseDynamics, arg("q"), arg("qd"), arg("qdd"), py::kw_only(),
          arg("kernel") = py::none(),
          "Inverse dynamics, tau = M qdd + c + g - Q, with friction and constant wrenches in Q.\n\n"
          "q: (nq,), qd, qdd: (n,) [rad, rad/s, rad/s^2; m, ...], or batches (N, ..); one state "
          "beside a batch is\nthe same for all.\nkernel: None takes the scene's compiled code for "
          "batches of 4096 states and more where there is a C\ncompiler, True always, False never "
          "(last digits may differ).\nReturns (n,) or (N, n) [N m, N].")
      .def("fd", &forwardDynamics, arg("q"), arg("qd"), arg("tau"), py::kw_only(),
           arg("kernel") = py::none(),
           "Forward dynamics, qdd of M qdd + c + g = tau + Q.\n\nArguments as id(), tau: (n,) or "
           "(N, n) [N m, N].\nReturns (n,) or (N, n) [rad/s^2, m/s^2].")
      .def("reactions", &reactions, arg("q"), arg("qd"), arg("qdd"),
           "Wrenches that parents exert through the joints of links[1], links[2], ..., fixed ones "
           "too, about the\njoint's origin in its axes: force [N], then moment [N m].\n\nReturns "
           "(links - 1, 6) or (N, links - 1, 6).")
      .def(
          "regressor", &regressor, arg("q"), arg("qd"), arg("qdd"),
          "Y of tau = Y pi + springs, friction and loads, pi as parameter_names lists it.\n\nReturns "
          "(n, p) or (N, n, p).")
      .def("id_derivatives", &inverseDerivatives, arg("q"), arg("qd"), arg("qdd"),
           "(dtau/dq, dtau/dqd, dtau/dqdd), each (n, n) or (N, n, n), row i of tau_i.")
      .def("fd_derivatives", &forwardDerivatives, arg("q"), arg("qd"), arg("tau"),
           "(dqdd/dq, dqdd/dqd, dqdd/dtau), each (n, n) or (N, n, n), row i of qdd_i.");
}

void bindMotion(py::class_<PyScene>& scene) {
  using py::arg;
  scene
      .def("kinetic", &kinetic, arg("q"), arg("qd"),
           "Kinetic energy T [J], rotors included: a float, or (N,).")
      .def("potential", &potential, arg("q"),
           "Potential energy V [J], springs included, 0 for masses at the world's origin: a float, "
           "or (N,).")
      .def(
          "momentum", &momentum, arg("q"), arg("qd"),
          "Momentum of all links in world axes: linear [N s], then angular about the world's origin "
          "[N m s].\n\nReturns (6,) or (N, 6).")
      .def(
          "position",
          [](PyScene& s, const std::string& link, const O& q, const O& at) -> O {
            return point(s, link, q, noRates(s), at)[0];
          },
          arg("link"), arg("q"), arg("at") = py::make_tuple(0.0, 0.0, 0.0),
          "Place of a link's point in world axes.\n\nat: (3,) in the link's axes [m], without: its "
          "origin.\nReturns (3,) or (N, 3) [m].")
      .def(
          "rotation",
          [](PyScene& s, const std::string& link, const O& q) -> O {
            return point(s, link, q, noRates(s), py::make_tuple(0.0, 0.0, 0.0))[1];
          },
          arg("link"), arg("q"),
          "Turn of a link: the columns are its axes in world axes.\n\nReturns (3, 3) or (N, 3, 3).")
      .def(
          "jacobian",
          [](PyScene& s, const std::string& link, const O& q, const O& at) -> O {
            return point(s, link, q, noRates(s), at)[2];
          },
          arg("link"), arg("q"), arg("at") = py::make_tuple(0.0, 0.0, 0.0),
          "J of (velocity of the point [m/s], angular velocity of the link [rad/s]) = J qd, in world "
          "axes.\n\nReturns (6, n) or (N, 6, n).")
      .def(
          "jacobian_rate",
          [](PyScene& s, const std::string& link, const O& q, const O& qd, const O& at) -> O {
            return point(s, link, q, qd, at)[3];
          },
          arg("link"), arg("q"), arg("qd"), arg("at") = py::make_tuple(0.0, 0.0, 0.0),
          "dJ/dt at rates qd: the acceleration is J qdd + dJ/dt qd.\n\nReturns (6, n) or (N, 6, n).");
}

}  // namespace
}  // namespace dynwitness::python

PYBIND11_MODULE(_core, m) {
  using namespace dynwitness;
  using python::PyScene;
  namespace py = pybind11;
  m.doc() = "Scenes and their quantities in process. Import dynwitness, which adds to it.";
  m.attr("__version__") = DYNWITNESS_VERSION;
  py::register_exception<scene::InputError>(m, "InputError", PyExc_ValueError).doc() =
      "A scene cannot be read: file, line, what was read, what is allowed.";
  m.def("load", &python::load, py::arg("name"),
        "A scene by the name of a bundled one, or by the path of a TOML, URDF or MJCF file.");
  m.def("from_text", &python::fromText, py::arg("text"), py::arg("name") = "scene",
        "A scene from the text of a TOML, URDF or MJCF file; name stands in messages.");
  py::class_<PyScene> scene(
      m, "Scene",
      "A scene, read and checked. It does not change; methods may be called from several threads,\n"
      "and batches compute with Python's lock released. Made by load() or from_text().");
  scene.def_property_readonly("name", [](const PyScene& s) { return s.quantities().scene().name; })
      .def_property_readonly("title", [](const PyScene& s) { return s.quantities().scene().title; })
      .def_property_readonly("n", &PyScene::n, "Degrees of freedom: length of qd, qdd, tau.")
      .def_property_readonly("nq", &PyScene::nq, "Positions: length of q.")
      .def_property_readonly("links", &python::links, "Names of the links, the root first.")
      .def_property_readonly(
          "joints", [](const PyScene& s) { return s.quantities().scene().mechanism.rateLabels(); },
          "Names of the rates, in the order of qd.")
      .def_property_readonly(
          "parameter_names", [](const PyScene& s) { return s.quantities().parameterNames(); },
          "Columns of the regressor, with units.")
      .def(
          "toml", [](const PyScene& s) { return writeSceneToml(s.quantities().scene()); },
          "The scene as the text of a TOML file.")
      .def(
          "derive", &python::derive, py::arg("format") = "text",
          "The derivation of M, c and g from T and V, each step checked: text, latex (the body of a\n"
          "document) or mathml.")
      .def("__repr__", [](const PyScene& s) {
        return fmt::format("<dynwitness.Scene {}: {} degrees of freedom, {} links>",
                           s.quantities().scene().name, s.n(),
                           s.quantities().scene().mechanism.links.size());
      });
  python::bindDynamics(scene);
  python::bindMotion(scene);
}
