// SPDX-License-Identifier: GPL-3.0-or-later
// yaml-cpp's emitter: YAML in flow style with JSON's escapes is JSON, as long as no key has more than 1024
// bytes: before such a one it writes a question mark.
#include "pipeline/config/json.h"

#include <yaml-cpp/yaml.h>

namespace salbench {

template <class Emitter>
void Json::write(Emitter& emitter) const {
  if (const auto* list = std::get_if<List>(&value_)) {
    emitter << YAML::BeginSeq;
    for (const Json& element : *list) element.write(emitter);
    emitter << YAML::EndSeq;
  } else if (const auto* members = std::get_if<Object>(&value_)) {
    emitter << YAML::BeginMap;
    for (const auto& [key, value] : *members) {
      emitter << key;
      value.write(emitter);
    }
    emitter << YAML::EndMap;
  } else if (const auto* text = std::get_if<std::string>(&value_)) {
    emitter << *text;
  } else if (const auto* number = std::get_if<std::int64_t>(&value_)) {
    emitter << *number;
  } else if (const auto* truth = std::get_if<bool>(&value_)) {
    emitter << *truth;
  } else {
    emitter << YAML::Null;
  }
}

std::string Json::text() const {
  YAML::Emitter emitter;
  emitter.SetOutputCharset(YAML::EscapeAsJson);
  emitter.SetStringFormat(YAML::DoubleQuoted);
  emitter.SetNullFormat(YAML::LowerNull);
  emitter.SetSeqFormat(YAML::Flow);
  emitter.SetMapFormat(YAML::Flow);
  write(emitter);
  return {emitter.c_str(), emitter.size()};
}

}  // namespace salbench
