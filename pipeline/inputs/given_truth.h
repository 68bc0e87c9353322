// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth from the files of an item, as the description of its data set says that they are written.
#pragma once

#include <vector>

#include "io/dataset.h"
#include "io/one_form.h"
#include "pipeline/engine/binding.h"
#include "stages/core/point_cloud.h"

namespace salbench {

// The mesh file, if values are per face in its order; then saliency, masks and picks; or a cloud's file with
// its ground truth in columns. How they are read, and from where the shape was seen, is part of their names,
// and so of a key; the names of files in the Schelling study's form say nothing about it.
FilesOfUnit truth_files_of(const DatasetItem& item);

File mesh_file_of(const DatasetItem& item);  // not read yet

bool has_columns(const DatasetItem& item);               // a point cloud in columns of a text
std::string column_cloud_name(const DatasetItem& item);  // of its file, in keys

// From what these files hold. Values per face or per point of another sampling are carried over to the
// vertices; several files of saliency are averaged where they have a vertex seen, and kept if they are of
// viewers; what the camera of the item does not see is hidden. Picks alone are enough: the saliency is then
// made from them, as the study's authors did. [chen2012] Throws InputError, one line that names file and
// line.
GroundTruth given_truth(const Mesh& mesh, const Files& files);

// The same of a point cloud, picks being smoothed over its partial mesh. The files count the points of the
// cloud's file, those without a position included; values per face are refused.
GroundTruth given_cloud_truth(const PointCloud& cloud, Surface surface, const Files& files);

// The ground truth as its files have it: no saliency is made from picks. Without a surface, cameras see all
// of a cloud. `as_read`, where it is given, takes the files whose values are not those of the result: of
// faces or other points, masked, or averaged.
GroundTruth measured_truth(const Mesh& mesh, const Files& files,
                           std::vector<ValuesAsRead>* as_read = nullptr);
GroundTruth measured_cloud_truth(const PointCloud& cloud, Surface surface, const Files& files,
                                 std::vector<ValuesAsRead>* as_read = nullptr);

// How the files of an item are written.
const TruthFormat& format_of(const DatasetItem& item);

// People whose picks or maps are in files of their own; one file may be of several who are not told apart.
std::size_t participants_of(const DatasetItem& item);

// True if the files tell participants apart, at least two.
bool has_participants(const DatasetItem& item);

}  // namespace salbench
