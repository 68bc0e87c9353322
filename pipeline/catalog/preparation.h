// SPDX-License-Identifier: GPL-3.0-or-later
// Work on a value that the jobs of one row and family share: of a mesh, what all of its scans need.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <variant>

#include "io/value.h"

namespace salbench {

using ValuePtr = std::shared_ptr<const Value>;

// Holds one object, which the first job that asks for it makes. Its owner decides how long it is kept.
class Preparation {
 public:
  // T(const Source&), made of the Source in the value. The value lives as long as the object. Always asked
  // for the same T and value; several jobs may ask at once.
  template <class T, class Source>
  std::shared_ptr<const T> of(const ValuePtr& value) {
    if (const std::shared_ptr<const void> known = kept({})) return std::static_pointer_cast<const T>(known);
    struct Made {
      ValuePtr source;
      T object;
      explicit Made(const ValuePtr& from) : source(from), object(std::get<Source>(*source)) {}
    };
    // Not under the lock: a thread that waits within may take up another job, which may ask for the same. Of
    // two that were made at once, the first is kept.
    const auto made = std::make_shared<const Made>(value);
    return std::static_pointer_cast<const T>(kept(std::shared_ptr<const T>(made, &made->object)));
  }

 private:
  std::shared_ptr<const void> kept(std::shared_ptr<const void> made) {
    const std::lock_guard lock(mutex_);
    if (kept_ == nullptr) kept_ = std::move(made);
    return kept_;
  }

  std::mutex mutex_;
  std::shared_ptr<const void> kept_;
};

}  // namespace salbench
