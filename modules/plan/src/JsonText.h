// SPDX-License-Identifier: GPL-3.0-or-later
// JSON text made safe to look at: limits are checked before anything is built, repeated keys are refused, and
// every error knows its path. Throws JsonFault; SceneJson.cpp turns it into an Error.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vernier {

struct JsonFault {
  std::string sentence;
  std::string path;  // RFC 6901 pointer
};

std::string pointerTo(const std::string& parent, const std::string& key);
std::string pointerTo(const std::string& parent, std::size_t index);

nlohmann::json parseJson(std::string_view text);

// The elements of the array `key` of the top object, token by token, without the space between tokens. The
// text has been parsed before.
std::vector<std::string> elementTexts(std::string_view text, std::string_view key);
std::string withoutSpace(std::string_view text);

// The text of the object `text`, which has been parsed before, with `value` under `key`: in the key's place,
// or at the end. All else stays as it was.
std::string withMember(std::string_view text, std::string_view key, std::string_view value);

}  // namespace vernier
