// SPDX-License-Identifier: GPL-3.0-or-later
// TOML scenes (data/scenes/README.md), read a second time.
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "crosscheck/rereading/description.hpp"

namespace dynwitness::crosscheck::rereading {
namespace {

/// A table, and which of its keys somebody has looked at: the others are told.
class Keys {
 public:
  Keys(const toml::table& table, std::string what, std::vector<std::string>* not_read)
      : table_(table), what_(std::move(what)), not_read_(not_read) {}
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  ~Keys() {
    for (const auto& [key, value] : table_)
      if (seen_.count(std::string(key.str())) == 0)
        not_read_->push_back(fmt::format("{} of {}", key.str(), what_));
  }

  const toml::node* get(const char* key) {
    seen_.insert(key);
    return table_.get(key);
  }
  std::string text(const char* key, const std::string& otherwise = "") {
    const toml::node* node = get(key);
    if (node == nullptr) return otherwise;
    if (!node->is_string()) throw std::runtime_error(fmt::format("{} of {}: no text", key, what_));
    return node->as_string()->get();
  }
  const toml::table* table(const char* key) {
    const toml::node* node = get(key);
    if (node != nullptr && !node->is_table())
      throw std::runtime_error(fmt::format("{} of {}: no table", key, what_));
    return node == nullptr ? nullptr : node->as_table();
  }
  std::vector<const toml::table*> tables(const char* key) {
    std::vector<const toml::table*> out;
    const toml::node* node = get(key);
    if (node == nullptr) return out;
    if (!node->is_array()) throw std::runtime_error(fmt::format("{} of {}: no tables", key, what_));
    for (const toml::node& element : *node->as_array()) {
      if (!element.is_table())
        throw std::runtime_error(fmt::format("{} of {}: no tables", key, what_));
      out.push_back(element.as_table());
    }
    return out;
  }
  const std::string& what() const { return what_; }

 private:
  const toml::table& table_;
  std::string what_;
  std::vector<std::string>* not_read_;
  std::set<std::string> seen_;
};

class TomlText {
 public:
  TomlText(const std::string& text, std::filesystem::path file,
           const std::vector<std::filesystem::path>& bundled)
      : file_(std::move(file)), bundled_(bundled) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
    top_ = toml::parse(std::string_view(text));
  }

  Description read() {
    readAll();
    return std::move(out_);
  }

 private:
  void readAll() {
    Keys top(top_, "the scene", &out_.not_read);
    for (const char* words : {"title", "source", "envelope"}) top.get(words);
    out_.format = "TOML";
    const toml::table* parameters = top.table("parameters");
    if (const std::string other = top.text("like"); !other.empty()) readLike(other, parameters);
    readParameters(parameters);
    if (const toml::table* settings = top.table("set")) readSettings(*settings);
    if (const std::string base = top.text("base"); !base.empty()) readBase(base);
    if (const toml::node* gravity = top.get("gravity")) out_.gravity = vector(*gravity);
    std::vector<Named> links;
    for (const toml::table* table : top.tables("link")) links.push_back(readLink(*table));
    if (!links.empty()) out_.links = inOrder(std::move(links));
    for (const toml::table* table : top.tables("wrench")) readWrench(*table);
    for (const toml::table* table : top.tables("closure")) readClosure(*table);
    for (const toml::table* table : top.tables("spring")) readSpring(*table);
    for (const toml::table* table : top.tables("acceleration_constraint")) readConstraint(*table);
    if (const toml::table* table = top.table("start")) {
      Keys start(*table, "start", &out_.not_read);
      out_.start_q.clear();
      out_.start_qd.clear();
      if (const toml::node* q = start.get("q")) out_.start_q = list(*q);
      if (const toml::node* qd = start.get("qd")) out_.start_qd = list(*qd);
    }
  }

  // ---- numbers ---------------------------------------------------------------------------------

  /// Of a value in its line, as it is spelled; toml++ counts characters, not bytes.
  std::string_view spelled(const toml::node& node) {
    const toml::source_region& region = node.source();
    const std::string& line = lines_.at(region.begin.line - 1);
    if (line_ != region.begin.line) {
      line_ = region.begin.line;
      starts_.clear();
      for (std::size_t i = 0; i < line.size(); ++i)
        if ((static_cast<unsigned char>(line[i]) >> 6) != 2) starts_.push_back(i);
    }
    const std::size_t begin = starts_.at(region.begin.column - 1);
    const std::size_t end = line.find_first_not_of("0123456789+-._eE", begin);
    return std::string_view(line).substr(begin, end == std::string::npos ? end : end - begin);
  }

  Value number(const toml::node& node) { return number(node, parameters_); }
  Value number(const toml::node& node, const Parameters& parameters) {
    if (const auto* text = node.as_string()) return evaluated(text->get(), parameters);
    if (const auto* whole = node.as_integer()) return decimal(std::to_string(whole->get()));
    const auto* real = node.as_floating_point();
    if (real == nullptr) throw std::runtime_error("neither a number nor an expression");
    std::string digits(spelled(node));
    digits.erase(std::remove(digits.begin(), digits.end(), '_'), digits.end());
    const Value x = decimal(digits);
    if (static_cast<double>(x.value) != real->get())
      throw std::runtime_error(fmt::format("'{}' is not where toml++ has {}", digits, real->get()));
    return x;
  }
  std::vector<Value> list(const toml::node& node) {
    if (!node.is_array()) throw std::runtime_error("no list of numbers");
    std::vector<Value> out;
    for (const toml::node& element : *node.as_array()) out.push_back(number(element));
    return out;
  }
  Vector vector(const toml::node& node) {
    const std::vector<Value> three = list(node);
    if (three.size() != 3) throw std::runtime_error("no list of three numbers");
    return {three[0], three[1], three[2]};
  }
  void put(Keys& keys, const char* key, Value* x) {
    if (const toml::node* node = keys.get(key)) *x = number(*node);
  }
  void put(Keys& keys, const char* key, Vector* v) {
    if (const toml::node* node = keys.get(key)) *v = vector(*node);
  }

  void readParameters(const toml::table* table) {
    if (table == nullptr) return;
    std::vector<std::pair<toml::source_position, std::string>> in_file_order;
    for (const auto& [key, value] : *table)
      in_file_order.emplace_back(value.source().begin, std::string(key.str()));
    std::sort(in_file_order.begin(), in_file_order.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    const Parameters of_other = parameters_;  // which have their values already
    for (const auto& [where, name] : in_file_order) {
      if (of_other.count(name) > 0) continue;
      const toml::node* instead = instead_ == nullptr ? nullptr : instead_->get(name);
      parameters_[name] = instead == nullptr ? number(*table->get(name))
                                             : instead_owner_->number(*instead, parameters_);
    }
  }

  // ---- links -----------------------------------------------------------------------------------

  Named readLink(const toml::table& table) {
    Named out;
    out.link.name = table["name"].value_or(std::string());
    Keys keys(table, "link '" + out.link.name + "'", &out_.not_read);
    keys.get("name");
    Solid& solid = out.link.solid;
    put(keys, "mass", &solid.mass);
    put(keys, "com", &solid.com);
    if (const toml::table* inertia = keys.table("inertia")) {
      Keys six(*inertia, "inertia of " + keys.what(), &out_.not_read);
      solid.about_com = six.text("about", "com") == "com";
      put(six, "rpy", &solid.rpy);
      put(six, "xx", &solid.xx);
      put(six, "yy", &solid.yy);
      put(six, "zz", &solid.zz);
      put(six, "xy", &solid.xy);
      put(six, "xz", &solid.xz);
      put(six, "yz", &solid.yz);
    }
    if (keys.get("parent") != nullptr) out.parent = keys.text("parent");
    if (const toml::table* joint = keys.table("joint"))
      out.link.joint = readJoint(*joint, out.link.name);
    return out;
  }

  Joint readJoint(const toml::table& table, const std::string& link) {
    Joint out;
    out.name = table["name"].value_or(link);
    Keys keys(table, "joint '" + out.name + "'", &out_.not_read);
    keys.get("name");
    out.kind = keys.text("kind");
    put(keys, "xyz", &out.xyz);
    put(keys, "rpy", &out.rpy);
    put(keys, "axis", &out.axis);
    for (const auto& [key, form] :
         {std::pair("dh", Joint::Form::kDh), std::pair("mdh", Joint::Form::kMdh)}) {
      const toml::table* row = keys.table(key);
      if (row == nullptr) continue;
      out.form = form;
      Keys cells(*row, fmt::format("{} of {}", key, keys.what()), &out_.not_read);
      put(cells, "a", &out.a);
      put(cells, "alpha", &out.alpha);
      put(cells, "d", &out.d);
      put(cells, "theta", &out.theta);
    }
    put(keys, "pitch", &out.pitch);
    put(keys, "rotor_inertia", &out.rotor_inertia);
    put(keys, "gear_ratio", &out.gear_ratio);
    put(keys, "stiffness", &out.stiffness);
    put(keys, "rest", &out.rest);
    if (const toml::node* gyroscopic = keys.get("gyroscopic"))
      out.gyroscopic = gyroscopic->value_or(false);
    if (const toml::node* rotors = keys.get("rotors")) readRotors(*rotors, keys, &out);
    if (const toml::table* friction = keys.table("friction")) readFriction(*friction, keys, &out);
    if (const toml::table* mimic = keys.table("mimic")) {
      Keys words(*mimic, "mimic of " + keys.what(), &out_.not_read);
      Following follows;
      follows.leader = words.text("joint");
      put(words, "multiplier", &follows.multiplier);
      put(words, "offset", &follows.offset);
      out.follows = follows;
    }
    return out;
  }

  void readRotors(const toml::node& list, const Keys& joint, Joint* out) {
    for (const toml::node& one : *list.as_array()) {
      Keys keys(*one.as_table(), "rotor of " + joint.what(), &out_.not_read);
      GearedRotor rotor;
      put(keys, "inertia", &rotor.inertia);
      for (const toml::node& n : *keys.get("ratio")->as_array()) rotor.ratio.push_back(number(n));
      if (keys.get("axis") != nullptr) put(keys, "axis", &rotor.axis.emplace());
      out->rotors.push_back(rotor);
    }
  }

  void readFriction(const toml::table& table, const Keys& joint, Joint* out) {
    Keys keys(table, "friction of " + joint.what(), &out_.not_read);
    put(keys, "viscous", &out->viscous);
    const toml::node* coulomb = keys.get("coulomb");
    if (coulomb == nullptr) return;
    if (!coulomb->is_table()) {
      out->positive = out->negative = number(*coulomb);
      return;
    }
    Keys sides(*coulomb->as_table(), "coulomb " + keys.what(), &out_.not_read);
    put(sides, "positive", &out->positive);
    put(sides, "negative", &out->negative);
  }

  // ---- what acts on links ----------------------------------------------------------------------

  void readWrench(const toml::table& table) {
    Keys keys(table, "wrench", &out_.not_read);
    Wrench out;
    out.link = keys.text("link");
    out.in_world_axes = keys.text("axes", "link") == "world";
    put(keys, "force", &out.force);
    put(keys, "moment", &out.moment);
    put(keys, "at", &out.at);
    out_.wrenches.push_back(out);
  }
  Anchor anchor(Keys& keys, const char* key) {
    const toml::table* table = keys.table(key);
    if (table == nullptr) throw std::runtime_error(fmt::format("{}: no {}", keys.what(), key));
    Keys words(*table, fmt::format("{} of {}", key, keys.what()), &out_.not_read);
    Anchor out;
    out.link = words.text("link");
    put(words, "xyz", &out.xyz);
    put(words, "rpy", &out.rpy);
    return out;
  }
  void readClosure(const toml::table& table) {
    Keys keys(table, "closure", &out_.not_read);
    keys.get("name");
    Closure out;
    out.kind = keys.text("kind");
    out.a = anchor(keys, "a");
    out.b = anchor(keys, "b");
    put(keys, out.kind == "rolling" ? "radius" : "length", &out.length);
    out_.closures.push_back(out);
  }
  void readSpring(const toml::table& table) {
    Keys keys(table, "spring", &out_.not_read);
    keys.get("name");
    Spring out;
    out.a = anchor(keys, "a");
    out.b = anchor(keys, "b");
    put(keys, "stiffness", &out.stiffness);
    put(keys, "rest", &out.rest);
    put(keys, "damping", &out.damping);
    out_.springs.push_back(out);
  }
  void readConstraint(const toml::table& table) {
    Keys keys(table, "acceleration_constraint", &out_.not_read);
    keys.get("name");
    AccelerationConstraint out;
    out.link = keys.text("link");
    out.in_world_axes = keys.text("axes", "world") == "world";
    put(keys, "at", &out.at);
    put(keys, "direction", &out.direction);
    put(keys, "rotation", &out.rotation);
    put(keys, "value", &out.value);
    put(keys, "compliance", &out.compliance);
    out_.acceleration_constraints.push_back(out);
  }

  /// The scene of another file, some of whose parameters this one gives.
  void readLike(const std::string& other, const toml::table* parameters) {
    std::filesystem::path file = file_.parent_path() / other;
    if (!std::filesystem::is_regular_file(file)) file += ".toml";
    for (const std::filesystem::path& scene : bundled_)
      if (!std::filesystem::is_regular_file(file) && scene.stem() == other) file = scene;
    if (!std::filesystem::is_regular_file(file))
      throw NotReread(
          fmt::format("'{}', which it is like, is neither a file beside it nor bundled", other));
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error(fmt::format("{} cannot be read", file.string()));
    std::ostringstream text;
    text << stream.rdbuf();
    const std::string content = withoutMark(text.str());
    const std::size_t first = content.find_first_not_of(" \t\r\n");
    if (first != std::string::npos && content[first] == '<') {
      out_ = describedUrdf(content);
      return;
    }
    TomlText reader(content, file, bundled_);
    reader.instead_ = parameters;
    reader.instead_owner_ = this;
    reader.readAll();
    out_ = std::move(reader.out_);
    parameters_ = reader.parameters_;
  }

  // ---- what is changed of a scene that this one is like ----------------------------------------

  Link& linkOf(const std::string& name, bool by_joint) {
    for (Link& link : out_.links)
      if ((by_joint ? link.joint.name : link.name) == name) return link;
    throw std::runtime_error(fmt::format("[set]: there is no '{}'", name));
  }
  /// One number, or a list, or a text of several.
  std::vector<Value> valuesOf(const toml::node& node) {
    if (node.is_array()) return list(node);
    const auto* text = node.as_string();
    if (text == nullptr) return {number(node)};
    std::vector<Value> out;
    std::istringstream words(text->get());
    for (std::string word; std::getline(words, word, ',');)
      out.push_back(evaluated(word, parameters_));
    return out;
  }
  void readSettings(const toml::table& table) {
    for (const auto& [key, node] : table) {
      const std::string whole(key.str()),
          what = whole.substr(0, whole.find(':')),
          name = whole.substr(std::min(whole.size(), what.size() + 1));
      if (what == "motion") {
        out_.not_read.push_back(fmt::format("motion of joint '{}'", name));
        continue;
      }
      const std::vector<Value> v = valuesOf(node);
      const auto need = [&](std::size_t count) {
        if (v.size() != count) throw std::runtime_error(fmt::format("[set]: {}", whole));
      };
      if (what == "mass" || what == "com" || what == "inertia") {
        Solid& solid = linkOf(name, false).solid;
        need(what == "mass" ? 1 : what == "com" ? 3 : 6);
        if (what == "mass") solid.mass = v[0];
        if (what == "com") solid.com = {v[0], v[1], v[2]};
        if (what != "inertia") continue;
        solid.about_com = true;
        solid.rpy = {};
        Value* const six[] = {&solid.xx, &solid.yy, &solid.zz, &solid.xy, &solid.xz, &solid.yz};
        for (std::size_t k = 0; k < 6; ++k) *six[k] = v[k];
        continue;
      }
      Joint& joint = linkOf(name, true).joint;
      if (what == "coulomb") {
        joint.positive = v.at(0);
        joint.negative = v.back();
        continue;
      }
      need(1);
      Value* const one = what == "damping"         ? &joint.viscous
                         : what == "stiffness"     ? &joint.stiffness
                         : what == "rest"          ? &joint.rest
                         : what == "rotor_inertia" ? &joint.rotor_inertia
                         : what == "gear_ratio"    ? &joint.gear_ratio
                                                   : nullptr;
      if (one == nullptr) throw std::runtime_error(fmt::format("[set]: {}", whole));
      *one = v[0];
    }
  }
  /// What rested in the world floats in it.
  void readBase(const std::string& base) {
    if (base != "floating") throw NotReread(fmt::format("base = \"{}\"", base));
    const auto unused = [&](const std::string& wanted, bool of_joints) {
      std::string name = wanted;
      const auto isTaken = [&](const Link& link) {
        return (of_joints ? link.joint.name : link.name) == name;
      };
      for (int k = 2; std::any_of(out_.links.begin(), out_.links.end(), isTaken); ++k)
        name = fmt::format("{}.{}", wanted, k);
      return name;
    };
    Link world;
    world.name = unused("world", false);
    Joint floating;
    floating.name = unused("floating_base", true);
    floating.kind = "floating";
    out_.links.at(0).joint = floating;
    for (Link& link : out_.links) ++link.parent;
    out_.links.insert(out_.links.begin(), world);
    if (!out_.start_q.empty()) out_.start_q.insert(out_.start_q.begin(), {0, 0, 0, 1, 0, 0, 0});
    if (!out_.start_qd.empty()) out_.start_qd.insert(out_.start_qd.begin(), 6, 0);
  }

  std::filesystem::path file_;
  const std::vector<std::filesystem::path>& bundled_;
  std::vector<std::string> lines_;
  toml::table top_;
  toml::source_index line_ = 0;      ///< the line of:
  std::vector<std::size_t> starts_;  ///< of its characters
  Parameters parameters_;
  const toml::table* instead_ = nullptr;  ///< parameters that have their values there
  TomlText* instead_owner_ = nullptr;
  Description out_;
};

}  // namespace

Description describedToml(const std::string& text, const std::filesystem::path& file,
                          const std::vector<std::filesystem::path>& bundled) {
  try {
    return TomlText(text, file, bundled).read();
  } catch (const toml::parse_error& error) {
    throw std::runtime_error(std::string(error.description()));
  }
}

}  // namespace dynwitness::crosscheck::rereading
