#include "hdf5.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop::record::hdf5 {

namespace {

constexpr hsize_t kChunkValues = 8192;  // 64 kB: small beside the disk, few chunks an hour

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// HDF5 hides errno in a sentence: "... errno = 28, error message = 'No space left on device',
/// ...".
std::string system_words(std::string_view description) {
  constexpr std::string_view kBefore = "error message = '";
  const auto begin = description.find(kBefore);
  if (begin == std::string_view::npos) {
    return {};
  }
  const auto words = description.substr(begin + kBefore.size());
  return std::string(words.substr(0, words.find('\'')));
}

struct Innermost {
  std::string description;
  std::string system;
};

extern "C" herr_t visit_error(unsigned, const H5E_error2_t* error, void* data) {
  auto& found = *static_cast<Innermost*>(data);
  if (error->desc == nullptr) {
    return 0;
  }
  if (found.description.empty()) {
    found.description = error->desc;
  }
  if (found.system.empty()) {
    found.system = system_words(error->desc);
  }
  return 0;
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

/// HDF5 keeps freed memory for later use, by default up to some 20 MB.
herr_t set_up_library() {
  constexpr int kAll = 1 << 20;  // bytes
  constexpr int kList = 1 << 16;
  H5dont_atexit();  // the first call: HDF5 registers its handler when it starts
  return H5set_free_list_limits(kAll, kList, kAll, kList, kAll, kList);
}

}  // namespace

Lock::Lock() : guard_(library_mutex()) {
  static const herr_t once = set_up_library();
  static_cast<void>(once);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Lock::~Lock() {
  H5Eclear2(H5E_DEFAULT);
}

std::string reason() {
  Innermost found;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, visit_error, &found);
  if (!found.system.empty()) {
    return found.system;
  }
  return found.description.empty() ? "unknown HDF5 error" : found.description;
}

void fail(std::string_view action, const std::string& path) {
  throw FileError(with_code(Code::no_access, "cannot {} '{}': {}", action, path, reason()));
}

bool Handle::close() {
  const hid_t id = std::exchange(id_, H5I_INVALID_HID);
  if (id < 0) {
    return true;
  }
  switch (H5Iget_type(id)) {
    case H5I_FILE:
      return H5Fclose(id) >= 0;
    case H5I_GROUP:
      return H5Gclose(id) >= 0;
    case H5I_DATASET:
      return H5Dclose(id) >= 0;
    case H5I_DATASPACE:
      return H5Sclose(id) >= 0;
    case H5I_DATATYPE:
      return H5Tclose(id) >= 0;
    case H5I_ATTR:
      return H5Aclose(id) >= 0;
    case H5I_GENPROP_LST:
      return H5Pclose(id) >= 0;
    default:
      return false;
  }
}

int descriptor_of(const Handle& file, const std::string& path) {
  void* descriptor = nullptr;
  check(H5Fget_vfd_handle(file.get(), H5P_DEFAULT, &descriptor), "write", path);
  return *static_cast<int*>(descriptor);
}

void reserve(const Handle& file, hsize_t bytes, const std::string& path) {
  if (bytes == 0) {
    return;
  }
  const int descriptor = descriptor_of(file, path);
  hsize_t size = 0;
  require_not_deleted(descriptor, path);
  check(H5Fget_filesize(file.get(), &size), "write", path);
  const int refused =
      ::posix_fallocate(descriptor, static_cast<off_t>(size), static_cast<off_t>(bytes));
  if (refused != 0) {
    throw FileError("write", path, refused);
  }
}

constexpr unsigned kCompression = 1;

GrowingDataset::GrowingDataset(hid_t group, const char* name, hid_t type, hsize_t width,
                               bool compressed, std::string path)
    : path_(std::move(path)), name_(name), width_(width) {
  chunk_rows_ = std::max<hsize_t>(1, kChunkValues / std::max<hsize_t>(1, width));
  const int rank = width == 0 ? 1 : 2;
  const std::array<hsize_t, 2> size{0, width};
  const std::array<hsize_t, 2> most{H5S_UNLIMITED, width};
  const std::array<hsize_t, 2> chunk{chunk_rows_, width};
  const Handle space(H5Screate_simple(rank, size.data(), most.data()));
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE));
  check(H5Pset_chunk(properties.get(), rank, chunk.data()), "write", path_);
  if (compressed) {  // neighbouring times, channels and values differ in few of their bytes
    check(H5Pset_shuffle(properties.get()), "write", path_);
    check(H5Pset_deflate(properties.get(), kCompression), "write", path_);
  }
  // A row that never reached the disk reads as "no value", not as zero.
  if (H5Tget_class(type) == H5T_FLOAT) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    H5Pset_fill_value(properties.get(), H5T_NATIVE_DOUBLE, &none);
  }
  dataset_ = Handle(
      check(H5Dcreate2(group, name, type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
            "write", path_));
}

void GrowingDataset::open(hid_t group) {
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS));
  // Rows are only appended: one chunk in the cache is enough, by default there are 1 MB.
  const std::size_t chunk_bytes = chunk_rows_ * std::max<hsize_t>(1, width_) * sizeof(double);
  H5Pset_chunk_cache(access.get(), 1, chunk_bytes, 1);
  dataset_ = Handle(check(H5Dopen2(group, name_.c_str(), access.get()), "write", path_));
}

void GrowingDataset::close() {
  check(H5Dflush(dataset_.get()), "write", path_);
  if (!dataset_.close()) {
    fail("write", path_);
  }
}

void GrowingDataset::append(const void* rows, hsize_t count, hid_t memory_type) {
  if (count == 0) {
    return;
  }
  const int rank = width_ == 0 ? 1 : 2;
  const std::array<hsize_t, 2> size{rows_ + count, width_};
  const std::array<hsize_t, 2> start{rows_, 0};
  const std::array<hsize_t, 2> block{count, width_};
  check(H5Dset_extent(dataset_.get(), size.data()), "write", path_);
  const Handle file_space(check(H5Dget_space(dataset_.get()), "write", path_));
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                            nullptr),
        "write", path_);
  const Handle memory_space(H5Screate_simple(rank, block.data(), nullptr));
  check(H5Dwrite(dataset_.get(), memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT,
                 rows),
        "write", path_);
  rows_ += count;
}

hsize_t GrowingDataset::growth(hsize_t count) const {
  constexpr hsize_t kIndex = 16'384;  // two levels of B-tree nodes may split
  const hsize_t chunks =
      (rows_ + count + chunk_rows_ - 1) / chunk_rows_ - (rows_ + chunk_rows_ - 1) / chunk_rows_;
  const hsize_t chunk_bytes = chunk_rows_ * std::max<hsize_t>(1, width_) * sizeof(double);
  return chunks * chunk_bytes + (1 + chunks / 32) * kIndex;
}

void Attributes::write(const char* name, hid_t type, hid_t space, const void* value) const {
  Handle attribute;
  if (H5Aexists(object_, name) > 0) {
    attribute = Handle(check(H5Aopen(object_, name, H5P_DEFAULT), "write", path_));
  } else {
    attribute = Handle(
        check(H5Acreate2(object_, name, type, space, H5P_DEFAULT, H5P_DEFAULT), "write", path_));
  }
  check(H5Awrite(attribute.get(), type, value), "write", path_);
}

void Attributes::write(const char* name, const std::string& text) const {
  const char* pointer = text.c_str();
  write(name, text_type().get(), Handle(H5Screate(H5S_SCALAR)).get(), &pointer);
}

void Attributes::write(const char* name, const std::vector<std::string>& texts) const {
  std::vector<const char*> pointers;
  pointers.reserve(texts.size());
  for (const auto& text : texts) {
    pointers.push_back(text.c_str());
  }
  const hsize_t count = pointers.size();
  write(name, text_type().get(), Handle(H5Screate_simple(1, &count, nullptr)).get(),
        pointers.data());
}

void Attributes::write(const char* name, std::int64_t value) const {
  write(name, H5T_NATIVE_INT64, Handle(H5Screate(H5S_SCALAR)).get(), &value);
}
void Attributes::write(const char* name, std::uint64_t value) const {
  write(name, H5T_NATIVE_UINT64, Handle(H5Screate(H5S_SCALAR)).get(), &value);
}
void Attributes::write(const char* name, std::uint32_t value) const {
  write(name, H5T_NATIVE_UINT32, Handle(H5Screate(H5S_SCALAR)).get(), &value);
}
void Attributes::write(const char* name, double value) const {
  write(name, H5T_NATIVE_DOUBLE, Handle(H5Screate(H5S_SCALAR)).get(), &value);
}

bool Attributes::has(const char* name) const {
  return H5Aexists(object_, name) > 0;
}

Handle Attributes::open(const char* name) const {
  if (!has(name)) {
    throw FileError(
        with_code(Code::no_access, "cannot read '{}': the attribute '{}' is missing", path_, name));
  }
  return Handle(check(H5Aopen(object_, name, H5P_DEFAULT), "read", path_));
}

void Attributes::require(const Handle& attribute, H5T_class_t kind, const char* name) const {
  const Handle space(check(H5Aget_space(attribute.get()), "read", path_));
  const Handle stored(check(H5Aget_type(attribute.get()), "read", path_));
  if (H5Sget_simple_extent_npoints(space.get()) != 1 || H5Tget_class(stored.get()) != kind) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': damaged: the attribute '{}' is not a number",
                              path_, name));
  }
}

std::string Attributes::text(const char* name) const {
  const auto all = texts(name);
  return all.empty() ? std::string() : all.front();
}

std::vector<std::string> Attributes::texts(const char* name) const {
  const Handle attribute = open(name);
  const Handle space(H5Aget_space(attribute.get()));
  const Handle stored(H5Aget_type(attribute.get()));
  if (H5Tis_variable_str(stored.get()) <= 0) {
    throw FileError(with_code(Code::no_access, "cannot read '{}': the attribute '{}' is not a text",
                              path_, name));
  }
  constexpr hssize_t kMost = 10'000'000;
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (count < 0 || count > kMost) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': damaged: the attribute '{}' has {} texts", path_,
                              name, count));
  }
  std::vector<char*> pointers(static_cast<std::size_t>(count));
  const Handle type = text_type();
  check(H5Aread(attribute.get(), type.get(), pointers.data()), "read", path_);
  std::vector<std::string> result;
  result.reserve(pointers.size());
  for (char* pointer : pointers) {
    result.emplace_back(pointer == nullptr ? "" : pointer);
  }
  H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
  return result;
}

}  // namespace spikeloop::record::hdf5
