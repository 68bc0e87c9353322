// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth of an item: values per point and picks from its files, or what was read with its shape.
#pragma once

#include "io/hdf5/one_form.h"
#include "io/shapes/dataset.h"
#include "pipeline/engine/binding.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

// Saliency and picks, or the item's file in the HDF5 form. Of an item that the front reads one without
// content, since the files of its shape hold its ground truth, too. None where nothing is known.
std::vector<File> truth_files_of(const Item& item);

// Ground truth from an item's files, or read with its shape. Picks alone are enough: the saliency is then
// made from them over the mesh, of a point cloud its partial one, as the study's authors did. [chen2012]
// Throws InputError, one line that names file and line.
GroundTruth given_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files);

// Values per face as they were published, NaN for what was not seen, of the faces that are left of the
// form's in `mesh`; no picks. Throws InputError, one line that says what to do, where there are none.
GroundTruth given_face_truth(const Mesh& mesh, const ShapeInForm& form, const Files& files);

// What files of values and picks hold; of a cloud they count the points of its file, those without a position
// included.
GroundTruth measured_truth(const Mesh& mesh, const Files& files);
GroundTruth measured_cloud_truth(const PointCloud& cloud, const Files& files);

// People whose picks or maps are in files of their own; one file may be of several who are not told apart.
std::size_t participants_of(const Item& item);

// True if the files tell participants apart, at least two.
bool has_participants(const Item& item);

}  // namespace salbench
