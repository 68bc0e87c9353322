// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include "io/hdf5/hdf5_file.h"

namespace salbench {

inline void expect_equal(const Hdf5Content& a, const Hdf5Content& b) {
  ASSERT_EQ(a.arrays.size(), b.arrays.size());
  for (std::size_t i = 0; i < a.arrays.size(); ++i) {
    SCOPED_TRACE(b.arrays[i].name);
    EXPECT_EQ(a.arrays[i].name, b.arrays[i].name);
    EXPECT_EQ(a.arrays[i].shape, b.arrays[i].shape);
    EXPECT_EQ(a.arrays[i].values, b.arrays[i].values);
    EXPECT_EQ(a.arrays[i].unit, b.arrays[i].unit);
    EXPECT_EQ(a.arrays[i].description, b.arrays[i].description);
  }
  EXPECT_EQ(a.attributes, b.attributes);
}

}  // namespace salbench
