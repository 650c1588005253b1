// SPDX-License-Identifier: GPL-3.0-or-later
// How --help is laid out.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

/** CLI11's layout in 80 columns. Texts are paragraphs, broken at words; a line that begins with a
    space is an example, or a table, and stays as it is. An example may be copied as it stands:
    "  dynwitness COMMAND ...  # a remark"; where that is too long the remark comes first. */
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* app) const override;
  std::string make_expanded(const CLI::App* command) const override;
};

}  // namespace dynwitness::cli
