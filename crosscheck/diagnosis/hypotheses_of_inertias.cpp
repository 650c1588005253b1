// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "crosscheck/diagnosis/hypothesis_list.hpp"
#include "crosscheck/diagnosis/textbook_links.hpp"

namespace dynwitness::crosscheck {
namespace {

using Applies = HypothesisList::Applies;

/// The same to the moved joint's origin, in link axes.
Matrix3d toJoint(const TextbookLink& link) {
  return pointMass(link.mass, link.com + link.after.R.transpose() * link.after.p);
}
Matrix3d withProducts(Matrix3d I, double factor) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != j) I(i, j) *= factor;
  return I;
}
/// The inertia about the centre of mass, from numbers as they were written.
Matrix3d fromWritten(const TextbookLink& link, const Matrix3d& written, const Matrix3d& axes) {
  Matrix3d I = axes * written * axes.transpose();
  if (link.about_origin) I -= toOrigin(link);
  return I;
}

/// The link and what fixed joints carry on it, made one body without the theorem of parallel axes.
void lumpWithoutParallelAxes(TextbookModel& model, std::size_t first) {
  std::vector<Frame> frames(model.links.size());
  std::vector<std::size_t> body = {first};
  for (std::size_t i = first + 1; i < model.links.size(); ++i) {
    const TextbookLink& link = model.links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    if (link.kind != scene::JointKind::kFixed || std::count(body.begin(), body.end(), parent) == 0)
      continue;
    frames[i] = frames[parent] * link.before * link.after;
    body.push_back(i);
  }
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
  for (const std::size_t i : body) {
    TextbookLink& link = model.links[i];
    mass += link.mass;
    moment += link.mass * (frames[i].p + frames[i].R * link.com);
    inertia += frames[i].R * link.inertia * frames[i].R.transpose();
    link.mass = 0;
    link.com = Vector3d::Zero();
    link.inertia = Matrix3d::Zero();
  }
  TextbookLink& whole = model.links[first];
  whole.mass = mass;
  if (mass != 0) whole.com = moment / mass;
  whole.inertia = inertia;
}

void addLumped(HypothesisList& list) {
  const TextbookModel& model = list.model();
  std::vector<std::size_t> carriers;  // moving links with something on a fixed joint
  for (std::size_t i = 0; i < model.links.size(); ++i)
    if (moves(model.links[i]) &&
        std::any_of(model.links.begin(), model.links.end(), [&](const TextbookLink& link) {
          return link.kind == scene::JointKind::kFixed && link.parent == static_cast<int>(i);
        }))
      carriers.push_back(i);
  const std::string what =
      "parallel axis terms missing where {} and what it carries on fixed joints are made one body";
  for (const std::size_t i : carriers)
    list.at("parallel_axis_missing", i, false, what,
            [i](Belief& b) { lumpWithoutParallelAxes(b.model, i); });
  if (carriers.size() > 1)
    list.add("parallel_axis_missing", fmt::format(what, "every link"), [carriers](Belief& b) {
      for (const std::size_t i : carriers) lumpWithoutParallelAxes(b.model, i);
    });
}

}  // namespace

void addInertias(HypothesisList& list) {
  const Applies any = [](const TextbookLink& link) { return hasParent(link); };
  const Applies off_origin = [](const TextbookLink& link) {
    return hasParent(link) && link.after.p != Vector3d::Zero();
  };
  const auto both = [&](const std::string& rule, const std::string& sentence, double factor) {
    list.each(rule, false, any, sentence,
              [factor](TextbookLink& link) { link.inertia += factor * toOrigin(link); });
    list.each(rule, false, off_origin, sentence + ", as far as the joint's axis",
              [factor](TextbookLink& link) { link.inertia += factor * toJoint(link); });
  };
  both("inertia_about_joint",
       "inertia of {} taken about the joint instead of the centre of mass (parallel axis twice)",
       1);
  both("parallel_axis_missing", "parallel axis term of {} missing", -1);
  both("parallel_axis_sign", "parallel axis term of {} with the opposite sign", -2);
  list.each("parallel_axis_sign", false, any,
            "parallel axis term of {} with the opposite sign, from the joint to the centre of mass",
            [](TextbookLink& link) { link.inertia += 2 * toOrigin(link); });
  for (const double factor : {-1.0, 0.0}) {
    const std::string rule = factor < 0 ? "product_sign" : "products_dropped";
    const std::string what = factor < 0 ? "products of inertia of {} with the opposite sign"
                                        : "products of inertia of {} dropped";
    list.each(rule, false, any, what,
              [factor](TextbookLink& link) { link.inertia = withProducts(link.inertia, factor); });
    list.each(rule, false, any, what + ", in the axes in which they are given",
              [factor](TextbookLink& link) {
                link.inertia = fromWritten(link, withProducts(link.written, factor), link.axes);
              });
    list.each(rule, false, any, what + ", about the link's origin", [factor](TextbookLink& link) {
      link.inertia = withProducts(Matrix3d(link.inertia + toOrigin(link)), factor) - toOrigin(link);
    });
  }
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} taken in link axes although it is given in axes of its own",
            [](TextbookLink& link) {
              link.inertia = fromWritten(link, link.written, Matrix3d::Identity());
            });
  list.each("rotation_transposed", false, any,
            "inertia of {} turned the wrong way from axes of its own", [](TextbookLink& link) {
              link.inertia = fromWritten(link, link.written, link.axes.transpose());
            });
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} taken in link axes as it is in those of its parent at rest",
            [](TextbookLink& link) {
              const Matrix3d R = atRest(link).R;
              link.inertia = (R.transpose() * link.inertia * R).eval();
            });
  list.each("principal_axes_not_rotated", false, any,
            "inertia of {} turned by its placement once more", [](TextbookLink& link) {
              const Matrix3d R = atRest(link).R;
              link.inertia = (R * link.inertia * R.transpose()).eval();
            });
  const Applies has_axes = [](const TextbookLink& link) {
    return hasParent(link) && link.axes != Matrix3d::Identity();
  };
  for (const Formulas::Triangle kept :
       {Formulas::Triangle::kBoth, Formulas::Triangle::kUpper, Formulas::Triangle::kLower})
    for (const bool left : {true, false})
      list.each(
          "principal_axes_not_rotated", false, has_axes,
          fmt::format("inertia of {{}} turned from axes of its own on the {} alone ({}){}",
                      left ? "left" : "right", left ? "R I" : "I R'",
                      kept == Formulas::Triangle::kBoth    ? ""
                      : kept == Formulas::Triangle::kUpper ? ", M from its upper triangle"
                                                           : ", M from its lower triangle"),
          [left](TextbookLink& link) {
            Matrix3d I = left ? Matrix3d(link.axes * link.written)
                              : Matrix3d(link.written * link.axes.transpose());
            if (link.about_origin) I -= toOrigin(link);
            link.inertia = I;
          },
          [kept](Formulas& f) { f.mirrored = kept; });
  list.each("inertia_dropped", false, any, "inertia of {} about its centre of mass left out",
            [](TextbookLink& link) { link.inertia = Matrix3d::Zero(); });
  addLumped(list);
  std::array<int, 3> order = {0, 1, 2};
  do
    list.each("principal_axes_not_rotated", false, any,
              "principal moments of {} taken as moments about the link's axes",
              [order](TextbookLink& link) {
                const Eigen::SelfAdjointEigenSolver<Matrix3d> solved(link.inertia);
                for (int k = 0; k < 3; ++k)
                  link.inertia.row(k) = Vector3d::Unit(k).transpose() *
                                        solved.eigenvalues()(order[static_cast<std::size_t>(k)]);
              });
  while (std::next_permutation(order.begin(), order.end()));
  list.each("half_inertia", false, any, "half of the inertia of {}",
            [](TextbookLink& link) { link.inertia *= 0.5; });
  list.each("double_inertia", false, any, "inertia of {} twice as large",
            [](TextbookLink& link) { link.inertia *= 2; });
  list.each("com_dropped", false, any, "centre of mass of {} taken at the link's origin",
            [](TextbookLink& link) { link.com = Vector3d::Zero(); });
  list.each("com_dropped", false, off_origin, "centre of mass of {} taken at the joint",
            [](TextbookLink& link) { link.com = -link.after.R.transpose() * link.after.p; });
}

void addCentresOfMass(HypothesisList& list) {
  const std::string rule = "com_wrong_frame";
  for (std::size_t i = 1; i < list.model().links.size(); ++i) {
    for (const Formulas::Com com : {Formulas::Com::kParentFrame, Formulas::Com::kParentAxes})
      list.at(rule, i, false,
              com == Formulas::Com::kParentFrame
                  ? "centre of mass of {} taken in the frame of its parent"
                  : "centre of mass of {} taken in the axes of its parent",
              [i, com](Belief& b) {
                b.formulas.com_elsewhere = static_cast<int>(i);
                b.formulas.com = com;
              });
  }
  const Applies any = [](const TextbookLink& link) { return hasParent(link); };
  list.each(rule, false, any, "centre of mass of {} taken in the moved joint frame",
            [](TextbookLink& link) {
              link.com = (link.after.R.transpose() * (link.com - link.after.p)).eval();
            });
  list.each(rule, false, any, "centre of mass of {} taken in the axes of the moved joint frame",
            [](TextbookLink& link) { link.com = (link.after.R.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} turned with its inertia's axes",
            [](TextbookLink& link) { link.com = (link.axes * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {}, in link axes, taken in its inertia's axes",
            [](TextbookLink& link) { link.com = (link.axes.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} turned by its placement once more",
            [](TextbookLink& link) { link.com = (atRest(link).R * link.com).eval(); });
  list.each(rule, false, any,
            "centre of mass of {} in the axes of its parent at rest taken as if in its own",
            [](TextbookLink& link) { link.com = (atRest(link).R.transpose() * link.com).eval(); });
  list.each(rule, false, any, "centre of mass of {} moved by its placement once more",
            [](TextbookLink& link) {
              const Frame rest = atRest(link);
              link.com = rest.R * link.com + rest.p;
            });
  list.each(rule, false, any,
            "centre of mass of {} taken in the frame of its parent, as it is at rest",
            [](TextbookLink& link) {
              const Frame rest = atRest(link);
              link.com = (rest.R.transpose() * (link.com - rest.p)).eval();
            });
}

}  // namespace dynwitness::crosscheck
