// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/suspects.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Entries of an inertia, as its six numbers are listed.
constexpr std::array<std::array<int, 2>, 6> kEntries = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

using Values = Eigen::VectorXd;

double sizeOr1(double x) {
  return x == 0 ? 1.0 : std::abs(x);
}

/// Collects suspects of one link, or of the joint that carries it.
class LinkNumbers {
 public:
  LinkNumbers(const TextbookModel& model, std::size_t i, std::vector<Suspect>& out)
      : link_(model.links[i]), i_(i), out_(out) {}

  /// One that is added to.
  /// @param edit  what an addition does to the link
  void add(const std::string& rule, const std::string& what, const std::string& unit,
           const std::string& name, double value, double scale,
           const std::function<void(TextbookLink&, double)>& edit, bool at_joint = false) {
    const std::string of = at_joint ? fmt::format(" of joint '{}'", link_.joint)
                                    : fmt::format(" of link '{}'", link_.name);
    out_.push_back({rule,
                    static_cast<int>(i_),
                    at_joint,
                    what + of,
                    unit,
                    {name},
                    {value},
                    {scale},
                    [edit, i = i_](Belief& b, const Values& s) { edit(b.model.links[i], s(0)); }});
  }
  const TextbookLink& link() const { return link_; }
  double reach() const {
    return sizeOr1(std::max({link_.before.p.norm(), link_.after.p.norm(), link_.com.norm()}));
  }

 private:
  const TextbookLink& link_;
  std::size_t i_;
  std::vector<Suspect>& out_;
};

void suspectMass(LinkNumbers& of) {
  const double mass = of.link().mass;
  of.add("mass_wrong", "mass", "kg", "mass", mass, sizeOr1(mass),
         [](TextbookLink& l, double s) { l.mass += s; });
  if (mass != 0)
    of.add("mass_wrong", "density (mass, and inertia with it)", "kg", "mass", mass, mass,
           [](TextbookLink& l, double s) {
             const double factor = 1 + s / l.mass;
             l.mass *= factor;
             l.inertia *= factor;
           });
}

void suspectLengths(LinkNumbers& of) {
  const TextbookLink& link = of.link();
  for (const bool after : {false, true}) {
    const Vector3d p = after ? link.after.p : link.before.p;
    const auto move = [&](const std::string& name, const Vector3d& direction, double value) {
      of.add("length_wrong", "length", "m", name, value, of.reach(),
             [after, direction](TextbookLink& l, double s) {
               (after ? l.after : l.before).p += s * direction;
             });
    };
    int along = 0;
    for (int k = 0; k < 3; ++k) along += p(k) != 0;
    if (along > 1) move("|p|", p.normalized(), p.norm());
    for (int k = 0; k < 3; ++k)
      if (p(k) != 0) move(fmt::format("p{}", "xyz"[k]), Vector3d::Unit(k), p(k));
    for (int k = 0; k < 3; ++k)
      if (p(k) == 0 && (!after || !isTrivial(link.after)))
        move(fmt::format("p{}", "xyz"[k]), Vector3d::Unit(k), 0);
  }
}

void suspectInertia(LinkNumbers& of) {
  const TextbookLink& link = of.link();
  if (link.inertia != Matrix3d::Zero())
    of.add("inertia_wrong", "inertia, by one factor,", "", "factor", 1, 1,
           [](TextbookLink& l, double s) { l.inertia *= 1 + s; });
  for (const auto& [a, b] : kEntries)
    of.add("inertia_wrong", "inertia", "kg m^2", fmt::format("I{}{}", "xyz"[a], "xyz"[b]),
           link.inertia(a, b), sizeOr1(link.inertia.trace()),
           [a = a, b = b](TextbookLink& l, double s) {
             l.inertia(a, b) += s;
             if (a != b) l.inertia(b, a) += s;
           });
}

void suspectCentreOfMass(LinkNumbers& of) {
  for (int k = 0; k < 3; ++k)
    of.add("com_wrong", "centre of mass", "m", fmt::format("c{}", "xyz"[k]), of.link().com(k),
           of.reach(), [k](TextbookLink& l, double s) { l.com(k) += s; });
}

void suspectJoint(LinkNumbers& of) {
  if (!hasOneRate(of.link())) return;
  const auto number = [&](const std::string& rule, const std::string& what, const std::string& unit,
                          double TextbookLink::*member) {
    const double value = of.link().*member;
    if (value == 0) return;
    of.add(
        rule, what, unit, what, value, std::abs(value),
        [member](TextbookLink& l, double s) { l.*member += s; }, true);
  };
  number("rotor_wrong", "inertia of the rotor at the joint", "kg m^2", &TextbookLink::added);
  number("damping_wrong", "damping", "N m s/rad", &TextbookLink::viscous);
  number("spring_wrong", "stiffness", "N m/rad", &TextbookLink::stiffness);
}

/// All six of an inertia.
Suspect wholeInertia(const TextbookModel& model, std::size_t i) {
  const TextbookLink& link = model.links[i];
  const Matrix3d& I = link.inertia;
  const double size = sizeOr1(I.trace());
  return {"inertia_wrong",
          static_cast<int>(i),
          false,
          fmt::format("inertia of link '{}'", link.name),
          "kg m^2",
          {"Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"},
          {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)},
          {size, size, size, size, size, size},
          [i](Belief& b, const Values& s) {
            Matrix3d d;
            d << s(0), s(3), s(4), s(3), s(1), s(5), s(4), s(5), s(2);
            b.model.links[i].inertia += d;
          }};
}

}  // namespace

std::vector<Suspect> suspects(const TextbookModel& model) {
  std::vector<Suspect> out;
  if (model.gravity != Vector3d::Zero()) {
    const double g = model.gravity.norm();
    out.push_back({"gravity_wrong",
                   -1,
                   false,
                   "gravity",
                   "m/s^2",
                   {"g"},
                   {g},
                   {g},
                   [g](Belief& b, const Values& s) { b.model.gravity *= 1 + s(0) / g; }});
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    LinkNumbers of(model, i, out);
    suspectMass(of);
    suspectLengths(of);
    suspectInertia(of);
    suspectCentreOfMass(of);
    suspectJoint(of);
  }
  for (std::size_t i = 1; i < model.links.size(); ++i) out.push_back(wholeInertia(model, i));
  return out;
}

}  // namespace dynwitness::crosscheck
