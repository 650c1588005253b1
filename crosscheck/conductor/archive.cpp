// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/archive.hpp"

#include <nlohmann/json.hpp>

namespace nlohmann {

template <typename T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& to, const std::optional<T>& from) {
    if (from)
      to = *from;
    else
      to = nullptr;
  }
  static void from_json(const json& from, std::optional<T>& to) {
    if (from.is_null())
      to.reset();
    else
      to = from.get<T>();
  }
};

}  // namespace nlohmann

namespace dynwitness::crosscheck {

// one line a structure, all members
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckResult::Exact, prime, points, discarded, degree,
                                   error_probability, residual_zero, parameters)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckResult::Off, entry, joint, unit, state, said, right)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckResult, kind, law, statement, quantity, left, right,
                                   left_is_control, right_is_control, unit, states, voided, excused,
                                   is_idle, first_voided, voided_reason, worst, limit, ratio, seen,
                                   loosest, largest, worst_state, worst_entry, seed, verdict,
                                   reason, off, wrong_joints, exact, no_exact, digits, condition,
                                   known_loss)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DigitsResult, witness, quantity, scalar, states, worst, median,
                                   worst_single, worst_state, worst_entry, is_control)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Control, quantity, size, found, missed, blind, nothing)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Finding, kind, scene, quantity, witness, text, digits)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Drift::Path, step, worst, time, error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Drift, method, method_order, duration, scale, observed_order,
                                   paths)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedMotion::Entry, of, time, published, ours, difference,
                                   limit, digits)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedMotion, title, source, own, note, moved, method,
                                   duration, step_error, steps, values, ratio, entries, failure)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Equations, summary, kinetic, potential, lines)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Ledger::Zeros::Group, reason, entries)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Ledger::Zeros, quantity, entries, zero, groups, not_examined)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Ledger, links, joints, rates, parameters, base_parameters,
                                   no_base_parameters, zeros, error_probability, general_operations,
                                   operations, no_operations, disputes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SceneResult, name, title, source, file, dof, links, link_names,
                                   joint_labels, parents, not_modelled, ledger, equations, checks,
                                   digits, findings, controls, drift, motions)

namespace {

/// CBOR keeps every double, infinities too.
template <typename T>
std::string bytesOf(const T& value) {
  std::string bytes;
  nlohmann::json::to_cbor(nlohmann::json(value), bytes);
  return bytes;
}

}  // namespace

void to_json(nlohmann::json& to, const RandomCampaign::Failure& from) {
  to = {{"file", from.scene.file.string()},
        {"scene", scene::writeSceneToml(from.scene)},
        {"checks", from.checks},
        {"findings", from.findings}};
}
void from_json(const nlohmann::json& from, RandomCampaign::Failure& to) {
  to.scene = scene::readSceneToml(from.at("scene"), from.at("file").get<std::string>());
  from.at("checks").get_to(to.checks);
  from.at("findings").get_to(to.findings);
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RandomCampaign, mechanisms, joints, checks, not_answerable,
                                   by_law, error_probability, plain, comparisons, asked, unanswered,
                                   failures)

std::string archived(const SceneResult& result) {
  return bytesOf(result);
}
std::string archived(const RandomCampaign& campaign) {
  return bytesOf(campaign);
}
SceneResult sceneResultOf(const std::string& bytes) {
  return nlohmann::json::from_cbor(bytes);
}
RandomCampaign randomCampaignOf(const std::string& bytes) {
  return nlohmann::json::from_cbor(bytes);
}

}  // namespace dynwitness::crosscheck
