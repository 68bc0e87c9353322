// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into the program by LD_PRELOAD: reports the HDF5 library as not thread-safe, and ends the program
// with a line on standard error if two threads are inside it at once. A pause ensures that they would meet.
#include <atomic>
#include <cstdio>
#include <cstdlib>

#include <dlfcn.h>
#include <hdf5.h>
#include <unistd.h>

namespace {

std::atomic<int> inside = 0;

class Visit {
 public:
  explicit Visit(const char* function) {
    if (++inside > 1) {
      std::fprintf(stderr, "two threads at once in the HDF5 library, one in %s\n", function);
      std::_Exit(99);
    }
    ::usleep(200);
  }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;
  ~Visit() { --inside; }
};

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

herr_t H5is_library_threadsafe(hbool_t* is_threadsafe) {
  *is_threadsafe = false;
  return 0;
}

hid_t H5Fcreate(const char* name, unsigned flags, hid_t creation, hid_t access) {
  const Visit visit("H5Fcreate");
  return real<decltype(H5Fcreate)>("H5Fcreate")(name, flags, creation, access);
}

hid_t H5Fopen(const char* name, unsigned flags, hid_t access) {
  const Visit visit("H5Fopen");
  return real<decltype(H5Fopen)>("H5Fopen")(name, flags, access);
}

herr_t H5Fclose(hid_t file) {
  const Visit visit("H5Fclose");
  return real<decltype(H5Fclose)>("H5Fclose")(file);
}

ssize_t H5Fget_file_image(hid_t file, void* buffer, size_t size) {
  const Visit visit("H5Fget_file_image");
  return real<decltype(H5Fget_file_image)>("H5Fget_file_image")(file, buffer, size);
}

herr_t H5Dread(hid_t set, hid_t type, hid_t memory, hid_t space, hid_t transfer, void* values) {
  const Visit visit("H5Dread");
  return real<decltype(H5Dread)>("H5Dread")(set, type, memory, space, transfer, values);
}

herr_t H5Dwrite(hid_t set, hid_t type, hid_t memory, hid_t space, hid_t transfer, const void* values) {
  const Visit visit("H5Dwrite");
  return real<decltype(H5Dwrite)>("H5Dwrite")(set, type, memory, space, transfer, values);
}

}  // extern "C"
