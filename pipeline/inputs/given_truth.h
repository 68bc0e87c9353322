// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth of an item: values per point and picks from its files, or read together with its shape.
#pragma once

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

// Saliency and picks, or the item's file in the HDF5 form. For an item that the front reads, one without
// content, since the files of its shape also hold its ground truth. Empty without ground truth.
std::vector<File> truth_files_of(const Item& item);

// Ground truth from an item's files, or read with its shape. Picks alone suffice: saliency is then computed
// from them over the mesh, or over the partial mesh of a point cloud, as the study's authors did. [chen2012]
// Throws InputError, one line that names file and line.
GroundTruth given_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files);

// Published values per face, for the faces of the form that remain in `mesh`; NaN if unseen; no picks.
// Throws InputError, one line with a remedy, if there are none.
GroundTruth given_face_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files);

// Content of files with values and picks. For a cloud these count the points of its file, including points
// without a position.
GroundTruth measured_truth(const Mesh& mesh, const Files& files);
GroundTruth measured_cloud_truth(const PointCloud& cloud, const Files& files);

// Number of participants with own files; a file may also hold several who are not told apart.
std::size_t participants_of(const Item& item);

// True if the files tell at least two participants apart.
bool has_participants(const Item& item);

}  // namespace salbench
