// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of rows that read the files of an item: its shape, and what people picked on it. All throw
// InputError, and warn of what they leave out.
#pragma once

#include "pipeline/catalog/row.h"
#include "stages/core/point_cloud.h"
#include "stages/core/types.h"

namespace salbench {

Mesh load_mesh(const FilesOf<Source::shape_file>& file);
PointCloud load_cloud(const FilesOf<Source::shape_file>& file);

// Picks alone are enough: the saliency is then made from them, as the study's authors did. [chen2012]
GroundTruth load_ground_truth(const Mesh& mesh, const FilesOf<Source::truth_files>& files);

// The same over the partial mesh. The files count the points of the cloud's file, those without a position
// included.
GroundTruth load_cloud_ground_truth(const PointCloud& cloud, Surface surface,
                                    const FilesOf<Source::truth_files>& files);

Mesh mesh_of(const PointCloud& cloud, Surface surface);

}  // namespace salbench
