// SPDX-License-Identifier: GPL-3.0-or-later
// What engines write to our streams, kept from the terminal.
#pragma once

#include <iostream>
#include <sstream>
#include <string>

namespace dynwitness::crosscheck {

/// Keeps what is written to std::cerr and std::cout while it lives.
class Hushed {
 public:
  Hushed() : cerr_(std::cerr.rdbuf(heard_.rdbuf())), cout_(std::cout.rdbuf(heard_.rdbuf())) {}
  ~Hushed() {
    std::cerr.rdbuf(cerr_);
    std::cout.rdbuf(cout_);
  }
  Hushed(const Hushed&) = delete;
  Hushed& operator=(const Hushed&) = delete;
  std::string text() const { return heard_.str(); }

 private:
  std::ostringstream heard_;
  std::streambuf *cerr_, *cout_;
};

}  // namespace dynwitness::crosscheck
