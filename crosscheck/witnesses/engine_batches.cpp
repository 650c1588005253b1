// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_batches.hpp"

#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/witnesses/engine_words.hpp"

namespace dynwitness::crosscheck::engine {
namespace {

/// The shortest decimals that are this double again, with what shows that it is no integer.
void append(double x, std::string* to) {
  char digits[32];
  const std::string_view shortest(
      digits,
      static_cast<std::size_t>(std::to_chars(digits, digits + sizeof digits, x).ptr - digits));
  *to += shortest;
  if (shortest.find_first_of(".e") == std::string_view::npos) *to += ".0";
}

/// One part of a state, with places in the engine's own arrays.
/// @param label  what stands in front of its numbers
template <typename Numbers>
void append(std::string_view label, const Numbers& ours, const std::vector<int>& order,
            std::string* to) {
  *to += label;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0) *to += ',';
    append(ours.empty() ? 0.0 : ours[static_cast<std::size_t>(order[k])], to);
  }
  *to += ']';
}

/// Reads what is as short and plain as it can be; false for anything else, which JSON may be.
class PlainJson {
 public:
  explicit PlainJson(const std::string& line) : at_(line.data()), end_(at_ + line.size()) {}
  bool take(char expected) {
    skip();
    if (at_ == end_ || *at_ != expected) return false;
    ++at_;
    return true;
  }
  bool key(const char* name) {
    if (!take('"')) return false;
    for (; *name != '\0'; ++name, ++at_)
      if (at_ == end_ || *at_ != *name) return false;
    return at_ != end_ && *at_++ == '"' && take(':');
  }
  bool number(double* x) {
    skip();
    const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
    const char* const first = at_ != end_ && *at_ == '-' ? at_ + 1 : at_;
    if (first == end_ || !isDigit(*first)) return false;  // from_chars knows inf and nan
    const auto [after, error] = std::from_chars(at_, end_, *x);
    if (error != std::errc() || !isDigit(after[-1])) return false;
    at_ = after;
    return true;
  }
  bool isAtEnd() {
    skip();
    return at_ == end_;
  }

 private:
  void skip() {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r')) ++at_;
  }
  const char *at_, *end_;
};

/// @return  false: it has to be read as any JSON
bool readPlain(const std::string& line, long asked, std::size_t states,
               const std::vector<Form>& forms, std::vector<Said>* answers) {
  PlainJson text(line);
  double batch = 0;
  if (!text.take('{') || !text.key("batch") || !text.number(&batch) ||
      batch != static_cast<double>(asked) || !text.take(',') || !text.key("answers") ||
      !text.take('['))
    return false;
  answers->clear();
  answers->reserve(states * forms.size());
  for (std::size_t k = 0; k < states; ++k) {
    if ((k > 0 && !text.take(',')) || !text.take('{')) return false;
    for (std::size_t m = 0; m < forms.size(); ++m) {
      const Form& form = forms[m];
      if ((m > 0 && !text.take(',')) || !text.key(form.name.c_str())) return false;
      const bool is_list = form.written != Form::Written::kNumber;
      Eigen::MatrixXd value(form.rows, form.columns);
      if (is_list && !text.take('[')) return false;
      for (Eigen::Index i = 0; i < value.rows(); ++i) {
        if ((i > 0 && !text.take(',')) || (form.hasRows() && !text.take('['))) return false;
        for (Eigen::Index j = 0; j < value.cols(); ++j)
          if ((j > 0 && !text.take(',')) || !text.number(&form.entry(value, i, j))) return false;
        if (form.hasRows() && !text.take(']')) return false;
      }
      if (is_list && !text.take(']')) return false;
      answers->push_back({form.ours(std::move(value)), ""});
    }
    if (!text.take('}')) return false;
  }
  return text.take(']') && text.take('}') && text.isAtEnd();
}

void requireShape(const Form& form, const std::string& where, const Json& said) {
  if (said.is_string()) return;  // why there is no value
  const auto rows = static_cast<std::size_t>(form.rows),
             columns = static_cast<std::size_t>(form.columns);
  if (form.written == Form::Written::kNumber) {
    if (!said.is_number()) expected(where, "a number", said);
    return;
  }
  const std::string shape =
      fmt::format("{} {}{}", rows, form.hasRows() ? "row" : "number", rows == 1 ? "" : "s");
  if (!said.is_array() || said.size() != rows)
    expected(where, shape, said.is_array() ? Json(fmt::format("{} of them", said.size())) : said);
  for (const Json& row : said) {
    if (!form.hasRows()) {
      if (!row.is_number()) expected(where, shape, said);
      continue;
    }
    if (!row.is_array() || row.size() != columns)
      expected(where, fmt::format("rows of {} numbers", columns), row);
    for (const Json& x : row)
      if (!x.is_number()) expected(where, fmt::format("rows of {} numbers", columns), row);
  }
}

/// Of the right shape.
Said read(const Form& form, const Json& said) {
  if (said.is_string()) {
    const std::string reason = plain(said.get<std::string>());
    return {{}, reason.empty() ? "it does not say why" : reason};
  }
  Eigen::MatrixXd out(form.rows, form.columns);
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index j = 0; j < out.cols(); ++j) {
      const Json& row = said.is_array() ? said.at(static_cast<std::size_t>(i)) : said;
      const Json& x = row.is_array() ? row.at(static_cast<std::size_t>(j)) : row;
      form.entry(out, i, j) = x.get<double>();
    }
  return {form.ours(std::move(out)), ""};
}

/// @throws std::runtime_error  what was expected, and what came
std::vector<Said> readAny(const Json& said, long asked, std::size_t states,
                          const std::vector<Form>& forms) {
  std::vector<Said> answers;
  if (!said.contains("batch") || said.at("batch") != asked)
    expected("batch", fmt::format("{}", asked),
             said.contains("batch") ? said.at("batch") : Json("none"));
  if (!said.contains("answers") || !said.at("answers").is_array() ||
      said.at("answers").size() != states)
    expected("answers", fmt::format("a list of {}, one a state", states),
             said.contains("answers") ? said.at("answers") : Json("none"));
  for (std::size_t k = 0; k < states; ++k) {
    const Json& one = said.at("answers").at(k);
    for (const Form& form : forms) {
      const std::string where = fmt::format("{} of state {}", form.name, k + 1);
      if (!one.is_object() || !one.contains(form.name))
        expected(where, "numbers, or a text with the reason why there are none", one);
      const Json& value = one.at(form.name);
      requireShape(form, where, value);
      answers.push_back(read(form, value));
    }
  }
  return answers;
}

}  // namespace

std::string question(long batch, const Batch& states, const std::vector<Form>& forms,
                     const Order& order, const FramePoint* frame) {
  std::string text = fmt::format("{{\"batch\":{},\"quantities\":[", batch);
  for (const Form& form : forms)
    text += fmt::format("{}\"{}\"", text.back() == '[' ? "" : ",", form.name);
  text += "],";
  if (frame != nullptr) {
    text += fmt::format("\"frame\":{{\"link\":{},\"at\":[", frame->link);
    for (int k = 0; k < 3; ++k) {
      if (k > 0) text += ',';
      append(frame->at(k), &text);
    }
    text += "]},";
  }
  text += "\"states\":[";
  std::vector<double> q;
  for (const State& state : states) {
    q.clear();
    for (const auto& x : state.x) q.push_back(x.q);
    if (text.back() != '[') text += ',';
    append("{\"q\":[", q, order.positions, &text);
    append(",\"qd\":[", state.qd, order.rates, &text);
    append(",\"qdd\":[", state.qdd, order.rates, &text);
    append(",\"tau\":[", state.tau, order.rates, &text);
    text += '}';
  }
  return text + "]}";
}

std::vector<Said> answersIn(const std::string& line, long batch, std::size_t states,
                            const std::vector<Form>& forms) {
  std::vector<Said> answers;
  if (!readPlain(line, batch, states, forms, &answers))
    answers = readAny(parsed(line), batch, states, forms);
  return answers;
}

}  // namespace dynwitness::crosscheck::engine
