// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy arrays of one state or of many, checked against what a quantity wants.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace dynwitness::python {

namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::string shapeText(const py::array& array) {
  std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim());
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

/** An argument: what Python gave as doubles, row by row. The caller's array is read, never kept or
    written; where it is no contiguous float64 it is copied. */
struct Argument {
  Argument(const char* argument, const py::object& given, int wanted)
      : name(argument), width(wanted) {
    const py::array raw = py::array::ensure(given);
    if (!raw) {
      PyErr_Clear();
      throw py::type_error(fmt::format("{}: expected numbers, got {}", name,
                                       py::str(py::type::of(given)).cast<std::string>()));
    }
    if (std::string("biuf").find(raw.dtype().kind()) == std::string::npos)
      throw py::type_error(fmt::format("{}: expected real numbers, got an array of {}", name,
                                       py::str(raw.dtype()).cast<std::string>()));
    array = Array::ensure(raw);
    if (array.ndim() < 1 || array.ndim() > 2 || array.shape(array.ndim() - 1) != width)
      throw py::value_error(fmt::format("{}: expected shape ({},) or (N, {}), got {}", name, width,
                                        width, shapeText(array)));
  }

  bool isBatch() const { return array.ndim() == 2; }
  long states() const { return isBatch() ? static_cast<long>(array.shape(0)) : 1; }
  const double* at(long k) const { return array.data() + (isBatch() ? k * width : 0); }

  const char* name;
  int width;
  Array array;
};

/// How many states a call is about: one array of two dimensions makes all of them batches, and one
/// state beside is the same for all.
class States {
 public:
  explicit States(const std::vector<const Argument*>& arguments) {
    const Argument* first = nullptr;
    for (const Argument* a : arguments) {
      if (!a->isBatch()) continue;
      if (first && a->states() != count_)
        throw py::value_error(fmt::format("{}: expected {} states as in {}, got {}", a->name,
                                          count_, first->name, a->states()));
      if (!first) count_ = a->states();
      if (!first) first = a;
    }
    is_batch_ = first != nullptr;
  }
  long count() const { return count_; }
  bool isBatch() const { return is_batch_; }

  /// An array for the answers, (shape) of one state and (N, shape) of a batch.
  Array answers(std::vector<py::ssize_t> shape) const {
    if (is_batch_) shape.insert(shape.begin(), count_);
    return Array(shape);
  }

 private:
  long count_ = 1;
  bool is_batch_ = false;
};

}  // namespace dynwitness::python
