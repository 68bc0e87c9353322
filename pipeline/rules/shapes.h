// SPDX-License-Identifier: GPL-3.0-or-later
// Rules of the inputs: shapes and ground truth, read from files of the HDF5 form, converted from foreign
// files, or simulated.
#pragma once

#include <memory>
#include <string_view>

#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/item_reader.h"
#include "pipeline/rules/config.h"
#include "pipeline/rules/values.h"

namespace salbench {

// Files of a data set, and their reader.
struct Source {
  const Inputs& inputs;
  std::shared_ptr<const ItemReader> reader;

  bool is_of_front() const { return inputs.read != nullptr; }
  // Files that shape rules read; none if they read imported shapes.
  OfJob<Files> files_read() const { return files_of(is_of_front() ? nullptr : inputs.shape_files); }
};

// Shape with ground truth of a data set that the front reads, for later rules.
Output<ShapeInForm> add_import(RuleTable& table, Level level, const Source& source);

Output<Mesh> add_mesh(RuleTable& table, const Source& source, const Output<ShapeInForm>& form);
Output<GroundTruth> add_mesh_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                          const Output<Mesh>& mesh, const Output<ShapeInForm>& form);

inline constexpr std::string_view kFaceTruth = "face_truth";
// Values per face for meshes; for point clouds it reports that there are none.
Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<Mesh>& mesh,
                                   const Output<ShapeInForm>& form);
Output<GroundTruth> add_face_truth(RuleTable& table, const Source& source, const Output<PointCloud>& cloud);

Output<PointCloud> add_points(RuleTable& table, const Source& source, const Output<ShapeInForm>& form);
Output<GroundTruth> add_cloud_ground_truth(RuleTable& table, const Config& config, const Source& source,
                                           const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                           const Output<ShapeInForm>& form);

}  // namespace salbench
