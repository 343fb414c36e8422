#pragma once
#include <hdf5.h>

namespace quicksand {

/// Makes HDF5 write files through a driver that orders what it writes, so that the file can be read whenever
/// the process dies: what lies behind the end of the last flush, to which nothing on disk refers yet, is
/// written at once; what lies before it is held back until the flush ends and only then written, the heading
/// first. A new node of an index is thus on disk before its parent names it. HDF5 by itself writes by rising
/// address. False when HDF5 refuses.
bool use_ordered_driver(hid_t file_access);

}  // namespace quicksand
