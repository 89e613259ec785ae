// A thin C++ skin over HDF5's C interface: handles that close themselves, errors as exceptions.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace spikeloop::record::hdf5 {

/// One thread at a time, whether or not HDF5 was built for threads. Also keeps HDF5 from printing
/// its error stacks, and from closing files by itself when the process ends (see abandon()).
class Lock {
 public:
  Lock();
  ~Lock();  ///< forgets the errors: a thread that ends with some leaks them
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  std::lock_guard<std::mutex> guard_;
};

/// What HDF5's error stack says, in one phrase: the system's words when the system refused.
std::string reason();

/// Throws FileError "cannot ACTION 'PATH': reason" unless `result` is a valid HDF5 result.
template <typename Result>
Result check(Result result, std::string_view action, const std::string& path);
[[noreturn]] void fail(std::string_view action, const std::string& path);

/// Owns an HDF5 identifier.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() { close(); }
  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  /// False when HDF5 could not close it: for a file, when its last data could not be written.
  bool close();
  /// Leaves it open for good. After a failed write HDF5 1.10 must not be asked to close the file or
  /// anything in it: it tries the write again, frees what it still uses, and crashes.
  void abandon() { id_ = H5I_INVALID_HID; }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// The system's descriptor of an open file. @throws FileError.
int descriptor_of(const Handle& file, const std::string& path);

/// Makes the disk promise `bytes` more than the file has. HDF5 writes the rest of what it holds
/// even when a part failed, and the file cannot be read any more; so what does not fit must be
/// known before anything is written. @throws FileError with the system's words.
void reserve(const Handle& file, hsize_t bytes, const std::string& path);

/// A dataset that grows by rows; `width` 0 makes it one-dimensional. It is open after construction,
/// and between open() and close().
class GrowingDataset {
 public:
  GrowingDataset() = default;
  GrowingDataset(hid_t group, const char* name, hid_t type, hsize_t width, bool compressed,
                 std::string path);
  void open(hid_t group);
  void append(const void* rows, hsize_t count, hid_t memory_type);
  /// Bytes by which the file may grow when so many rows are appended, its index included.
  hsize_t growth(hsize_t count) const;
  hid_t get() const { return dataset_.get(); }
  /// Writes the rows to the file first: HDF5 crashes if closing a dataset fails.
  void close();
  void abandon() { dataset_.abandon(); }

 private:
  std::string path_;
  std::string name_;
  hsize_t width_ = 0;
  hsize_t rows_ = 0;
  hsize_t chunk_rows_ = 1;
  Handle dataset_;
};

/// Attributes of files, groups and datasets; `path` is for the error text.
class Attributes {
 public:
  Attributes(hid_t object, std::string path) : object_(object), path_(std::move(path)) {}
  void write(const char* name, const std::string& text) const;
  void write(const char* name, const std::vector<std::string>& texts) const;
  void write(const char* name, std::int64_t value) const;
  void write(const char* name, std::uint64_t value) const;
  void write(const char* name, std::uint32_t value) const;
  void write(const char* name, double value) const;
  /// The same bytes with a type and space of one's own.
  void write(const char* name, hid_t type, hid_t space, const void* value) const;

  bool has(const char* name) const;
  std::string text(const char* name) const;
  std::vector<std::string> texts(const char* name) const;
  template <typename Number>
  Number number(const char* name) const;

 private:
  Handle open(const char* name) const;
  /// @throws FileError unless it is one number of this kind.
  void require(const Handle& attribute, H5T_class_t kind, const char* name) const;
  hid_t object_;
  std::string path_;
};

template <typename Result>
Result check(Result result, std::string_view action, const std::string& path) {
  if (result < 0) {
    fail(action, path);
  }
  return result;
}

/// The memory type of a C++ number.
template <typename Number>
hid_t type_of();
template <>
inline hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t type_of<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t type_of<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}
template <>
inline hid_t type_of<std::uint32_t>() {
  return H5T_NATIVE_UINT32;
}

template <typename Number>
Number Attributes::number(const char* name) const {
  Number value{};
  const Handle attribute = open(name);
  require(attribute, H5Tget_class(type_of<Number>()), name);
  check(H5Aread(attribute.get(), type_of<Number>(), &value), "read", path_);
  return value;
}

}  // namespace spikeloop::record::hdf5
