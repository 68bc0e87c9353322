// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files, in two ways. libhdf5 1.10.8 itself does not stand any bytes at all: of files with some bytes
// changed, one in a few thousand ends it with a segmentation fault, a request for petabytes or a leak, in its
// own decoding of attributes, compact groups and B-trees (H5A__close, H5G__link_release_table, H5C_protect).
// That cannot be repaired here. So libFuzzer's bytes are a recipe by which the library makes a file that is
// well-formed: any types, spaces, extents, layouts, filters, attributes and links, whatever sense they make.
// It is our reader that has to stand those, and they are what overran its memory. Bytes as they are come from
// the corpus, cut short at every length.
#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "io/file.h"
#include "io/hdf5_file.h"
#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "tests/fuzz/message.h"
#include "tests/fuzz/targets.h"
#include "tests/support/temporary_folder.h"

namespace salbench {
namespace {

constexpr std::uint64_t kMaxWritten = 1U << 15U;  // bytes of one data set: a recipe is quick to carry out
const std::vector<double> kSound = {0.5, -1, 3e300};

class Recipe {
 public:
  Recipe(std::string_view bytes, const std::string& file) : left_(bytes) {
    const unsigned kind = byte();
    const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (kind % 2 == 1) H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    file_ = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  }
  Recipe(const Recipe&) = delete;
  Recipe& operator=(const Recipe&) = delete;
  ~Recipe() { H5Fclose(file_); }

  void carry_out() {
    groups_ = {"/"};
    for (int n = 0; n < 2 && !left_.empty(); ++n) add_object(n);
    const hsize_t extent = kSound.size();
    const Id space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
    const Id set(H5Dcreate2(file_, "sound", H5T_IEEE_F64BE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                 H5Dclose);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, kSound.data());
    for (int n = 0; n < 2 && !left_.empty(); ++n) add_attribute(set);
  }

 private:
  struct Id {
    Id(hid_t made, herr_t (*closer)(hid_t)) : id(made), close(closer) {}
    Id(Id&& other) noexcept : id(std::exchange(other.id, -1)), close(other.close) {}
    Id(const Id&) = delete;
    Id& operator=(const Id&) = delete;
    ~Id() {
      if (id >= 0) close(id);
    }
    operator hid_t() const { return id; }  // NOLINT: as in io/hdf5_library.h
    hid_t id;
    herr_t (*close)(hid_t);
  };

  unsigned byte() {
    if (left_.empty()) return 0;
    const auto first = static_cast<unsigned char>(left_.front());
    left_.remove_prefix(1);
    return first;
  }
  std::uint64_t number() {  // small ones, and any power of two
    const unsigned b = byte();
    return b < 192 ? b : std::uint64_t{1} << (b - 192);
  }

  void add_object(int n) {
    const std::string name = groups_[byte() % groups_.size()] + std::string(1, static_cast<char>('a' + n));
    switch (byte() % 8) {
      case 0: {
        const Id group(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
        if (group >= 0) groups_.push_back(name + "/");
        return add_attribute(group);
      }
      case 1:
        H5Lcreate_hard(file_, groups_[byte() % groups_.size()].c_str(), file_, name.c_str(), H5P_DEFAULT,
                       H5P_DEFAULT);
        return;
      case 2:
        H5Lcreate_soft("sound", file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
        H5Lcreate_external("/dev/zero", "/", file_, (name + "x").c_str(), H5P_DEFAULT, H5P_DEFAULT);
        return;
      case 3: {
        const Id root(H5Oopen(file_, "/", H5P_DEFAULT), H5Oclose);
        return add_attribute(root);
      }
      default:
        return add_set(name);
    }
  }

  void add_set(const std::string& name) {
    const Id type = any_type(2), space = any_space();
    const int rank = H5Sget_simple_extent_ndims(space);
    const Id creation = any_layout(rank);
    const Id set(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
    if (set < 0) return;
    if (byte() % 4 != 0 && H5Pget_external_count(creation) == 0 && H5Pget_layout(creation) != H5D_VIRTUAL)
      write(set, type, space);
    for (unsigned n = byte() % 4; n > 0; --n) add_attribute(set);
  }

  void write(hid_t set, hid_t type, hid_t space) {
    const std::uint64_t size = H5Tget_size(type);
    std::uint64_t n_bytes = size;
    hsize_t extents[H5S_MAX_RANK] = {};
    const int rank = H5Sget_simple_extent_dims(space, extents, nullptr);
    for (int d = 0; d < rank; ++d)
      if (__builtin_mul_overflow(n_bytes, extents[d], &n_bytes)) return;
    if (n_bytes > kMaxWritten || written_chunk_ > kMaxWritten) return;
    const std::vector<char> values = content(type, n_bytes);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }

  // Types that hold pointers get null pointers.
  std::vector<char> content(hid_t type, std::uint64_t n_bytes) {
    std::vector<char> values(n_bytes, 0);
    const bool plain = H5Tdetect_class(type, H5T_VLEN) <= 0 && H5Tdetect_class(type, H5T_REFERENCE) <= 0 &&
                       H5Tis_variable_str(type) <= 0 && H5Tdetect_class(type, H5T_COMPOUND) <= 0 &&
                       H5Tdetect_class(type, H5T_ARRAY) <= 0;
    const std::size_t taken = plain ? std::min<std::size_t>(values.size(), left_.size() / 2) : 0;
    std::copy_n(left_.begin(), taken, values.begin());
    left_.remove_prefix(taken);
    return values;
  }

  hid_t made_type(int depth) {
    const std::array<hid_t, 10> integers = {H5T_STD_I8LE,  H5T_STD_U8LE,  H5T_STD_I16BE, H5T_STD_U16LE,
                                            H5T_STD_I32LE, H5T_STD_U32BE, H5T_STD_I64LE, H5T_STD_U64LE,
                                            H5T_STD_I64BE, H5T_STD_U32LE};
    const std::array<hid_t, 5> reals = {H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_IEEE_F64BE,
                                        H5T_NATIVE_LDOUBLE};
    const unsigned kind = byte() % (depth > 0 ? 16U : 12U);
    if (kind < 3) return H5Tcopy(reals[byte() % reals.size()]);
    if (kind < 6) return H5Tcopy(integers[byte() % integers.size()]);
    if (kind >= 12) return made_nested(kind, depth);
    const hid_t odd = H5Tcopy(kind == 6 ? H5T_STD_I64LE : kind == 7 ? H5T_IEEE_F32LE : H5T_C_S1);
    if (kind == 6) {
      H5Tset_size(odd, 1U + byte() % 40);  // integers of up to 320 bits
      H5Tset_precision(odd, 1 + byte() % 64);
      H5Tset_offset(odd, byte() % 16);
    } else if (kind == 7) {
      H5Tset_fields(odd, 15, 10, 5, 0, 10);  // half precision, as numpy's
      H5Tset_size(odd, 2);
      H5Tset_ebias(odd, 15);
    } else if (kind == 8) {
      H5Tset_size(odd, 1 + number() % 5000);
    } else if (kind == 9) {
      H5Tset_size(odd, H5T_VARIABLE);
    } else {
      H5Tclose(odd);
      return kind == 10 ? H5Tcopy(H5T_STD_REF_OBJ) : H5Tcreate(H5T_OPAQUE, 1 + byte());
    }
    return odd;
  }

  hid_t made_nested(unsigned kind, int depth) {
    const Id inner = any_type(depth - 1);
    const hsize_t extent = 1 + byte() % 5;
    if (kind == 12) return H5Tarray_create2(inner, 1, &extent);
    if (kind == 13) return H5Tvlen_create(inner);
    if (kind == 14) {
      const hid_t record = H5Tcreate(H5T_COMPOUND, H5Tget_size(inner) + byte() % 8);
      H5Tinsert(record, "member", 0, inner);
      return record;
    }
    const hid_t choice = H5Tenum_create(H5T_STD_I8LE);
    for (signed char value = 0; value < 3; ++value)
      H5Tenum_insert(choice, std::string(1, static_cast<char>('x' + value)).c_str(), &value);
    return choice;
  }
  Id any_type(int depth) { return {made_type(depth), H5Tclose}; }

  Id any_space() {
    const unsigned kind = byte() % 8;
    if (kind < 2) return {H5Screate(kind == 0 ? H5S_NULL : H5S_SCALAR), H5Sclose};
    const std::size_t rank = kind < 7 ? 1 + byte() % 3 : byte() % 11;
    std::vector<hsize_t> extents(rank), most(rank, H5S_UNLIMITED);
    for (hsize_t& extent : extents) extent = number();
    return {H5Screate_simple(static_cast<int>(rank), extents.data(), byte() % 4 == 0 ? most.data() : nullptr),
            H5Sclose};
  }

  Id any_layout(int rank) {
    Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    written_chunk_ = 0;
    switch (byte() % 8) {
      case 0:
        H5Pset_layout(creation, H5D_COMPACT);
        break;
      case 1:
        H5Pset_external(creation, "/dev/zero", 0, H5F_UNLIMITED);
        break;
      case 2: {
        const Id all(H5Scopy(H5S_ALL), H5Sclose);
        const hsize_t extent = 3;
        const Id space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
        H5Pset_virtual(creation, space, byte() % 2 == 0 ? "." : "/dev/zero", "/sound", space);
        break;
      }
      case 3:
      case 4:
      case 5:
        set_chunks(creation, rank);
        break;
      default:
        break;
    }
    return creation;
  }

  // With the filters nbit and scale-offset the library crashes where it writes, at types that they are not
  // for.
  void set_chunks(hid_t creation, int rank) {
    std::vector<hsize_t> chunk(static_cast<std::size_t>(std::max(rank, 1)));
    written_chunk_ = 8;
    for (hsize_t& extent : chunk) {
      extent = std::max<hsize_t>(1, number());
      if (__builtin_mul_overflow(written_chunk_, extent, &written_chunk_)) written_chunk_ = ~std::uint64_t{0};
    }
    H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
    const unsigned filters = byte();
    if ((filters & 1U) != 0) H5Pset_shuffle(creation);
    if ((filters & 2U) != 0) H5Pset_deflate(creation, 1);
    if ((filters & 4U) != 0) H5Pset_fletcher32(creation);
  }

  void add_attribute(hid_t object) {
    constexpr std::array<const char*, 5> kNames = {"unit", "description", "other", "a\nb", ""};
    const char* name = kNames[byte() % kNames.size()];
    const Id type = any_type(2), space = any_space();
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    if (n < 0 || n > 4096) return;
    const std::uint64_t n_bytes = H5Tget_size(type) * static_cast<std::uint64_t>(n);
    if (n_bytes > 8 * kMaxWritten) return;
    const Id attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (attribute >= 0 && n_bytes <= kMaxWritten && n_bytes > 0)
      H5Awrite(attribute, type, content(type, n_bytes).data());
  }

  std::string_view left_;
  hid_t file_ = -1;
  std::vector<std::string> groups_;  // with a slash behind
  std::uint64_t written_chunk_ =
      0;  // bytes, about: of a chunk, which the library holds in memory to write to it
};

void check_array(const Array& array) {
  const std::size_t n_values = std::visit([](const auto& values) { return values.size(); }, array.values);
  CHECK_EQ(n_values, array.count());
}

template <class Read>
bool is_read(const std::string& file, const Read& read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    check_message(error.what(), file);
    return false;
  }
}

// As `evaluate --maps` does. True if the data set that is sound came out as it was written.
bool read_foreign(const std::string& file, bool in_child_first) {
  bool is_sound = false;
  is_read(file, [&] {
    const Hdf5File opened(file, in_child_first);
    for (const std::string& name : opened.arrays())
      is_read(file, [&] {
        const Array array = opened.read(name);
        check_array(array);
        if (name == "sound") is_sound = std::get<std::vector<double>>(array.values) == kSound;
      });
  });
  return is_sound;
}

// As the cache does.
void read_artefact(std::string_view bytes) {
  const std::string file = "folder/file";
  is_read(file, [&] {
    for (const Array& array : hdf5_content(std::as_bytes(std::span(bytes)), file).arrays) check_array(array);
  });
}

const std::string& scratch_file() {
  static const TemporaryFolder folder;
  static const std::string file = (folder / "file.h5").string();
  return file;
}

}  // namespace

void fuzz_hdf5_bytes(std::string_view bytes) {
  std::ofstream(scratch_file(), std::ios::binary) << bytes;
  read_foreign(scratch_file(), true);
  read_artefact(bytes);
}

void fuzz_hdf5(std::string_view bytes) {
  // Without this the library returns half a megabyte per file to the system and asks for it again: twice the
  // time. It refuses H5dont_atexit() where another target has used it already, and then cleans up in the end.
  static const bool keeps = (H5dont_atexit(), H5set_free_list_limits(-1, -1, -1, -1, -1, -1)) >= 0;
  CHECK_EQ(keeps, true);
  constexpr int kKept = 1000;  // files after which that is given back all the same
  static int files = 0;
  if (++files % kKept == 0) H5garbage_collect();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Recipe(bytes, scratch_file()).carry_out();
  // One of the two, for speed: to open a file is most of the work.
  if (bytes.empty() || (static_cast<unsigned char>(bytes[0]) & 2U) == 0)
    CHECK_EQ(read_foreign(scratch_file(), false), true);
  else
    read_artefact(read_file(scratch_file()));
}

}  // namespace salbench
