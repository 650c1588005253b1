// SPDX-License-Identifier: GPL-3.0-or-later
// Text files that a user names, read whole: what else a path can be is refused, not waited for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace dynwitness::scene {

/// A scene's text and what is made of it take some 20 times the memory: 64 MiB are half a million
/// links.
constexpr std::uintmax_t kMostTextBytes = std::uintmax_t{64} << 20;

/** The text of a regular file.
    @param allowed  what the file should have been, for messages: "a TOML or URDF file"
    @throws InputError  it is a folder, a FIFO, a device or a socket, cannot be read, is longer than
    kMostTextBytes, or has a zero byte in it, which no text has */
std::string readTextFile(const std::filesystem::path& file, const std::string& allowed);

/// XML starts with '<', and TOML cannot.
bool looksLikeXml(const std::string& text);

/// Opens a regular file for reading, without waiting for a FIFO's other end. The caller closes the
/// descriptor.
/// @throws InputError  as readTextFile() does when it cannot be opened
int openRegularFile(const std::filesystem::path& file, const std::string& allowed);

}  // namespace dynwitness::scene
