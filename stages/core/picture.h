// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of a shape without colours: the visible part of the shape per pixel, so that any map over the
// shape's points can be painted later by look-up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace salbench {

// Square, row by row from the top. "pixel" means size x size values.
struct Picture {
  std::int32_t size = 0;                // pixels on each side
  std::vector<std::int32_t> primitive;  // pixel: face of a mesh, or point of a scan; -1: background
  std::vector<float> weights;           // pixel x 3: of the face's corners, sum 1; for a scan's point 1, 0, 0
  std::vector<float> depth;             // pixel: along the viewing direction, mesh unit; infinity: background
  std::vector<std::uint8_t> shade;      // pixel: brightness of a white surface; 255 for background
  std::vector<std::uint8_t> coverage;   // pixel: covered fraction, 255: all of it
  // World to clip space, for column vectors, row by row. With clip = view_projection * (x, y, z, 1), the
  // fourth component is the depth above; x / w and y / w are -1 at the left and bottom edge of the picture, 1
  // at the right and top edge.
  std::array<double, 16> view_projection = {};

  std::size_t pixels() const { return static_cast<std::size_t>(size) * static_cast<std::size_t>(size); }
};

}  // namespace salbench
