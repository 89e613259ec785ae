#include "spikeloop/record/reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>

#include "hdf5.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/processes/trial.hpp"
#include "spikeloop/record/recorder.hpp"

namespace spikeloop::record {

namespace {

/// @throws FileError with the system's reason, or with ours.
hdf5::Handle open_file(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    throw FileError("open", path, errno);
  }
  ::close(file);
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_file_locking(access.get(), 0, 1);  // its recorder may be at work
  hdf5::Handle opened(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()));
  if (!opened) {
    throw FileError(
        with_code(Code::no_access, "cannot read '{}': not an HDF5 file, or damaged", path));
  }
  const hdf5::Attributes attributes(opened.get(), path);
  if (!attributes.has("spikeloop_format")) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': an HDF5 file, but not a recording of Spikeloop's",
                              path));
  }
  const auto format = attributes.number<std::uint32_t>("spikeloop_format");
  if (format > kFormat) {
    throw FileError(with_code(
        Code::no_access,
        "cannot read '{}': it has format {}, this Spikeloop ({}) knows formats up to {}; read it "
        "with version {} or newer",
        path, format, SPIKELOOP_VERSION, kFormat, attributes.text("spikeloop_version")));
  }
  return opened;
}

extern "C" herr_t collect_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

std::vector<std::string> streams_of(const hdf5::Handle& file, const char* kind,
                                    const std::string& path) {
  std::vector<std::string> names;
  const hdf5::Handle group(hdf5::check(H5Gopen2(file.get(), kind, H5P_DEFAULT), "read", path));
  hdf5::check(H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_name, &names),
              "read", path);
  std::ranges::sort(names);
  return names;
}

hdf5::Handle open_stream(const hdf5::Handle& file, const char* kind, const std::string& path,
                         const std::string& stream) {
  const auto known = streams_of(file, kind, path);
  if (std::ranges::find(known, stream) == known.end()) {
    throw ConfigurationError(
        with_code(Code::unknown_choice, "'{}' has no {} called '{}'{}", path, kind, stream,
                  known.empty() ? "; it has none at all" : did_you_mean(stream, known)));
  }
  return hdf5::Handle(hdf5::check(
      H5Gopen2(file.get(), fmt::format("{}/{}", kind, stream).c_str(), H5P_DEFAULT), "read", path));
}

/// The latest of these streams'.
TimeNs until_of(const hdf5::Handle& file, const char* kind, const std::vector<std::string>& streams,
                const std::string& path) {
  TimeNs latest = 0;
  for (const std::string& stream : streams) {
    const hdf5::Handle group = open_stream(file, kind, path, stream);
    latest = std::max(latest, hdf5::Attributes(group.get(), path).number<TimeNs>("until_ns"));
  }
  return latest;
}

hdf5::Handle open_dataset(const hdf5::Handle& group, const char* name, const std::string& path) {
  return hdf5::Handle(hdf5::check(H5Dopen2(group.get(), name, H5P_DEFAULT), "read", path));
}

/// Of `width` values each; width 0: of one, in a dataset of one dimension. All may be claimed, but
/// the file has no more than it has.
std::size_t rows_of(const hdf5::Handle& dataset, std::uint32_t width, const std::string& path) {
  constexpr std::uint64_t kNotYetWritten = 100'000'000;  // bytes that a killed recorder claimed
  const hdf5::Handle space(hdf5::check(H5Dget_space(dataset.get()), "read", path));
  std::array<hsize_t, H5S_MAX_RANK> size{};
  const int rank =
      hdf5::check(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), "read", path);
  const std::uint64_t bytes = std::filesystem::file_size(path) + kNotYetWritten;
  const std::uint64_t row = std::max<std::uint64_t>(1, width) * sizeof(double);
  if (rank != (width == 0 ? 1 : 2) || (width > 0 && size[1] != width) || size[0] > bytes / row) {
    throw FileError(with_code(Code::no_access,
                              "cannot read '{}': damaged: a dataset has not the size that its "
                              "stream says, or a larger one than the file",
                              path));
  }
  return size[0];
}

/// The first `rows` rows.
template <typename T>
std::vector<T> read_rows(const hdf5::Handle& dataset, std::size_t rows, std::size_t width,
                         const std::string& path) {
  std::vector<T> values(rows * width);
  if (values.empty()) {
    return values;
  }
  const hdf5::Handle space(hdf5::check(H5Dget_space(dataset.get()), "read", path));
  const std::array<hsize_t, 2> start{0, 0};
  const std::array<hsize_t, 2> block{rows, width};
  const hsize_t count = values.size();
  hdf5::check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                                  nullptr),
              "read", path);
  const hdf5::Handle memory(H5Screate_simple(1, &count, nullptr));
  hdf5::check(H5Dread(dataset.get(), hdf5::type_of<T>(), memory.get(), space.get(), H5P_DEFAULT,
                      values.data()),
              "read", path);
  return values;
}

}  // namespace

std::string library_version() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  const hdf5::Lock lock;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

namespace {

FileInfo info_of(const std::string& path) {
  const hdf5::Handle file = open_file(path);
  const hdf5::Attributes attributes(file.get(), path);
  FileInfo info;
  info.process = attributes.text("process");
  info.version = attributes.text("spikeloop_version");
  info.format = attributes.number<std::uint32_t>("spikeloop_format");
  info.seed = attributes.number<std::uint64_t>("seed");
  info.tick = attributes.number<TimeNs>("tick_ns");
  info.complete = attributes.number<std::uint32_t>("complete") != 0;
  info.spikes = streams_of(file, "spikes", path);
  info.signals = streams_of(file, "signals", path);
  info.until = std::max(until_of(file, "spikes", info.spikes, path),
                        until_of(file, "signals", info.signals, path));
  return info;
}

SpikeRecording spikes_of(const std::string& path, const std::string& stream) {
  const hdf5::Handle file = open_file(path);
  const hdf5::Handle group = open_stream(file, "spikes", path, stream);
  const hdf5::Attributes attributes(group.get(), path);
  const hdf5::Handle times = open_dataset(group, "timestamps_ns", path);
  const hdf5::Handle ids = open_dataset(group, "node_ids", path);
  SpikeRecording recording;
  recording.width = attributes.number<std::uint32_t>("width");
  recording.until = attributes.number<TimeNs>("until_ns");
  recording.dropped = attributes.number<std::uint64_t>("dropped");
  // They differ when the process died between the two.
  const std::size_t count = std::min(rows_of(times, 0, path), rows_of(ids, 0, path));
  const auto time_values = read_rows<std::int64_t>(times, count, 1, path);
  const auto id_values = read_rows<std::uint64_t>(ids, count, 1, path);
  recording.spikes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (id_values[i] >= recording.width) {
      throw FileError(with_code(
          Code::no_access, "cannot read '{}': damaged: a spike of channel {} in a stream of {}",
          path, id_values[i], recording.width));
    }
    recording.spikes.push_back(make_spike(time_values[i], static_cast<std::int32_t>(id_values[i])));
  }
  return recording;
}

SignalRecording signal_of(const std::string& path, const std::string& stream) {
  const hdf5::Handle file = open_file(path);
  const hdf5::Handle group = open_stream(file, "signals", path, stream);
  const hdf5::Attributes attributes(group.get(), path);
  const hdf5::Handle times = open_dataset(group, "times_ns", path);
  const hdf5::Handle values = open_dataset(group, "values", path);
  SignalRecording recording;
  recording.width = attributes.number<std::uint32_t>("width");
  recording.until = attributes.number<TimeNs>("until_ns");
  recording.dropped = attributes.number<std::uint64_t>("dropped");
  recording.unit = hdf5::Attributes(values.get(), path).text("unit");
  if (attributes.has("channels")) {
    recording.channels = attributes.texts("channels");
  }
  const std::size_t rows =
      std::min(rows_of(times, 0, path), rows_of(values, recording.width, path));
  recording.times = read_rows<std::int64_t>(times, rows, 1, path);
  recording.values = read_rows<double>(values, rows, recording.width, path);
  return recording;
}

/// HDF5 crashes on some damaged files: the whole of this one is read in a copy of this process
/// first. The lock is held before, so that it is not another thread's in there.
void try_locked(const std::string& path) {
  require_regular_file(path, "recording");
  try_in_a_copy(path, "HDF5", [&] {
    const FileInfo info = info_of(path);
    for (const std::string& stream : info.spikes) {
      spikes_of(path, stream);
    }
    for (const std::string& stream : info.signals) {
      signal_of(path, stream);
    }
  });
}

}  // namespace

void try_recording(const std::string& path) {
  const hdf5::Lock lock;
  try_locked(path);
}

FileInfo read_info(const std::string& path) {
  const hdf5::Lock lock;
  try_locked(path);
  return info_of(path);
}

SpikeRecording read_spikes(const std::string& path, const std::string& stream) {
  const hdf5::Lock lock;
  try_locked(path);
  return spikes_of(path, stream);
}

SignalRecording read_signal(const std::string& path, const std::string& stream) {
  const hdf5::Lock lock;
  try_locked(path);
  return signal_of(path, stream);
}

}  // namespace spikeloop::record
