// SPDX-License-Identifier: GPL-3.0-or-later
// A JSON value, to be written: null, true or false, a whole number, a text, a list or an object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace salbench {

class Json {
 public:
  struct Member;
  using List = std::vector<Json>;
  using Object = std::vector<Member>;  // in the order in which it is written

  Json(std::initializer_list<Member> members) : value_(Object(members)) {}
  Json(List list) : value_(std::move(list)) {}
  Json(Object members) : value_(std::move(members)) {}

  template <class Value>
  requires(!std::is_same_v<Value, Json>) Json(const Value& value) {  // an empty optional is null
    if constexpr (std::is_same_v<Value, bool>) {
      value_ = value;
    } else if constexpr (std::is_integral_v<Value>) {
      value_ = static_cast<std::int64_t>(value);
    } else if constexpr (std::is_same_v<Value, std::filesystem::path>) {
      value_ = value.string();
    } else if constexpr (requires { value.has_value(); }) {
      if (value) *this = Json(*value);
    } else {
      value_ = std::string(value);
    }
  }

  // A list of what `convert` makes of each element.
  template <class Range, class Convert>
  static Json list(const Range& range, const Convert& convert) {
    List list;
    for (const auto& element : range) list.emplace_back(convert(element));
    return list;
  }

  // One line of UTF-8; U+FFFD in place of bytes that are not.
  std::string text() const;

 private:
  template <class Emitter>
  void write(Emitter& emitter) const;

  std::variant<std::monostate, bool, std::int64_t, std::string, List, Object> value_;
};

struct Json::Member {
  std::string key;  // of at most 1024 bytes
  Json value;
};

}  // namespace salbench
