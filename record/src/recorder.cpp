#include "spikeloop/record/recorder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <functional>
#include <mutex>

#include "hdf5.hpp"
#include "spikeloop/core/background.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/units.hpp"
#include "stream.hpp"
#include "writer.hpp"

namespace spikeloop::record {

namespace {

using Clock = std::chrono::steady_clock;

constexpr hsize_t kSpareBytes = 65'536;  // object headers, attributes
/// A file is flushed when this much of its data waits; less if many files share the memory.
constexpr std::size_t kMostBatchBytes = std::size_t{2} << 20;
constexpr std::size_t kLeastBatchBytes = std::size_t{1} << 16;
constexpr std::size_t kAllBatchBytes = std::size_t{2} << 20;
/// Size of HDF5's metadata cache, per file. HDF5 counts a node of the chunk index as 2 kB, but
/// allocates 25 kB.
constexpr std::size_t kMetadataBytes = std::size_t{1} << 15;
/// Buffers of wide streams are limited to kWideBufferBytes, but hold at least kLeastBuffered of
/// simulated time unless the recorder is patient.
constexpr std::size_t kWideBufferBytes = std::size_t{64} << 20;
constexpr std::size_t kMostBufferBytes = std::size_t{4} << 30;
constexpr TimeNs kLeastBuffered = kNsPerSecond / 10;
constexpr std::size_t kLeastRows = 4;

/// Limits the metadata cache, which would grow to 32 MB per file with the chunk index.
void bound_metadata(const hdf5::Handle& access) {
  H5AC_cache_config_t cache{};
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  H5Pget_mdc_config(access.get(), &cache);
  cache.set_initial_size = true;
  cache.initial_size = kMetadataBytes;
  cache.min_size = kMetadataBytes;
  cache.max_size = kMetadataBytes;
  cache.incr_mode = H5C_incr__off;
  cache.flash_incr_mode = H5C_flash_incr__off;
  cache.decr_mode = H5C_decr__off;
  H5Pset_mdc_config(access.get(), &cache);
}

/// The oldest format: the newer ones mark a file as open, and a killed process would leave it so.
/// Unlocked, so that one can look into the file of a run that is under way.
hdf5::Handle access_to_recording() {
  hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18);
  H5Pset_file_locking(access.get(), 0, 1);
  bound_metadata(access);
  return access;
}

/// For HDF5, which would follow a link that takes the name of the file.
std::string path_of(int descriptor) {
  return fmt::format("/proc/self/fd/{}", descriptor);
}

hdf5::Handle create_recording(const std::string& path) {
  const int made = create_file(path);
  const hid_t file =
      H5Fcreate(path_of(made).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_to_recording().get());
  ::close(made);
  return hdf5::Handle(hdf5::check(file, "create", path));
}

/// HDF5 keeps a list of the gaps in a file, which grows for as long as the file is open: a
/// compressed chunk that grows moves, and leaves one.
bool has_many_gaps(const hdf5::Handle& file) {
  constexpr ssize_t kMostGaps = 10;
  return H5Fget_free_sections(file.get(), H5FD_MEM_DEFAULT, 0, nullptr) > kMostGaps;
}

/// The same file, without the list of its gaps; unchanged if the process may open no more files.
hdf5::Handle reopen(hdf5::Handle file, const std::string& path) {
  const int kept = ::fcntl(hdf5::descriptor_of(file, path), F_DUPFD_CLOEXEC, 0);
  if (kept < 0) {
    return file;
  }
  const hid_t opened =
      file.close() ? H5Fopen(path_of(kept).c_str(), H5F_ACC_RDWR, access_to_recording().get())
                   : H5I_INVALID_HID;
  ::close(kept);
  return hdf5::Handle(hdf5::check(opened, "write", path));
}

void write_file_attributes(const hdf5::Handle& file, const std::string& path,
                           const std::string& process, const RunAttributes& run) {
  const hdf5::Attributes attributes(file.get(), path);
  const std::uint32_t sonata_version[] = {0, 1};
  const hsize_t two = 2;
  attributes.write("magic", std::uint32_t{0x0A7A});
  attributes.write("version", H5T_NATIVE_UINT32,
                   hdf5::Handle(H5Screate_simple(1, &two, nullptr)).get(), sonata_version);
  attributes.write("process", process);
  attributes.write("spikeloop_version", std::string(SPIKELOOP_VERSION));
  attributes.write("spikeloop_format", kFormat);
  attributes.write("seed", run.seed);
  attributes.write("tick_ns", run.tick);
  attributes.write("complete", std::uint32_t{0});
}

void create_group(const hdf5::Handle& file, const char* name, const std::string& path) {
  const hdf5::Handle group(hdf5::check(
      H5Gcreate2(file.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "write", path));
}

class RecordSink : public Sink {
 public:
  RecordSink(std::shared_ptr<Stream> stream, PortKind kind)
      : stream_(std::move(stream)), kind_(kind) {}
  std::vector<EndpointPort> ports() const override { return {{"in", kind_, stream_->width()}}; }
  void send(const Step& step) override { stream_->take(step); }
  std::vector<Counter> counters() const override {
    return {{kind_ == PortKind::spikes ? "spikes_dropped" : "signals_dropped", stream_->dropped()}};
  }

 private:
  std::shared_ptr<Stream> stream_;
  PortKind kind_;
};

}  // namespace

struct Recorder::Impl : WrittenFile {
  Impl(const std::string& path_, TimeNs tick_, const RecorderOptions& options_)
      : path(path_), tick(tick_), options(options_) {}

  bool serve(std::size_t files) override;
  bool is_patient() const override { return options.patient; }
  void collect(const std::vector<std::shared_ptr<Stream>>& all);
  void flush(const std::vector<std::shared_ptr<Stream>>& all);
  void write_safely(hsize_t growth, const std::function<void()>& action);
  /// Adds a stream to the file; `make` is called with HDF5 locked.
  std::shared_ptr<Stream> add(const std::function<std::shared_ptr<Stream>()>& make);
  void finish();
  void write_end(const std::vector<std::shared_ptr<Stream>>& all);
  void close_file();
  void abandon_file(const std::vector<std::shared_ptr<Stream>>& all);
  void check_name(const std::string& stream, std::uint32_t width);
  std::size_t rows_of(const std::string& stream, std::uint32_t width) const;
  std::vector<std::shared_ptr<Stream>> snapshot();
  Report report();
  std::string loss(const Report& counts) const;

  std::string path;
  TimeNs tick;
  RecorderOptions options;
  hdf5::Handle file;
  std::mutex streams_mutex;  // never taken by the loop
  std::vector<std::shared_ptr<Stream>> streams;
  // Under HDF5's lock until the writer has ended.
  std::string failure;
  bool broken = false;  // HDF5 itself failed and must not touch the file any more
  Clock::time_point next_flush = Clock::now();  // writer's thread only
  std::atomic<bool> stop{false};
  std::atomic<bool> ended{false};
  std::mutex close_mutex;
  std::shared_ptr<Wake> wake;
};

Recorder::Recorder(const std::string& path, const std::string& process,
                   const RunAttributes& attributes, const RecorderOptions& options)
    : writer_(Writer::shared()), impl_(std::make_shared<Impl>(path, attributes.tick, options)) {
  impl_->wake = writer_->wake();
  {
    const hdf5::Lock lock;
    impl_->file = create_recording(path);
    write_file_attributes(impl_->file, path, process, attributes);
    create_group(impl_->file, "spikes", path);
    create_group(impl_->file, "signals", path);
    hdf5::check(H5Fflush(impl_->file.get(), H5F_SCOPE_GLOBAL), "write", path);
  }
  impl_->next_flush += std::chrono::nanoseconds(options.flush_every);
  writer_->add(impl_);
}

Recorder::~Recorder() {
  close();
}

void Recorder::Impl::check_name(const std::string& stream, std::uint32_t width) {
  if (stream.empty() || stream == "." || stream.find('/') != std::string::npos) {
    throw ConfigurationError(fmt::format(
        "a recorded stream cannot be called '{}': write a name without '/', such as 'out'",
        stream));
  }
  if (width == 0) {
    throw ConfigurationError(
        fmt::format("the recorded stream '{}' has width 0: give it at least one channel", stream));
  }
  if (stop.load()) {
    throw ConfigurationError(
        fmt::format("cannot record '{}': '{}' is closed already", stream, path));
  }
  for (const auto& other : snapshot()) {
    if (other->name() == stream) {
      throw ConfigurationError(
          fmt::format("two recorded streams of '{}' are called '{}': rename one", path, stream));
    }
  }
}

std::vector<std::shared_ptr<Stream>> Recorder::Impl::snapshot() {
  const std::lock_guard lock(streams_mutex);
  return streams;
}

std::shared_ptr<Stream> Recorder::Impl::add(const std::function<std::shared_ptr<Stream>()>& make) {
  std::shared_ptr<Stream> stream;
  {
    const hdf5::Lock lock;
    write_safely(kSpareBytes, [&] {
      stream = make();
      stream->close();
    });
  }
  stream->wake_by(wake);
  if (options.patient) {
    stream->be_patient();
  }
  const std::lock_guard lock(streams_mutex);
  streams.push_back(stream);
  return stream;
}

std::unique_ptr<Sink> Recorder::spike_sink(const std::string& stream, std::uint32_t width,
                                           const std::vector<Population>& populations) {
  impl_->check_name(stream, width);
  const auto added = impl_->add([&] {
    return std::make_shared<SpikeStream>(stream, width, populations, impl_->file.get(), impl_->path,
                                         impl_->options.spike_capacity);
  });
  return std::make_unique<RecordSink>(added, PortKind::spikes);
}

std::unique_ptr<Sink> Recorder::signal_sink(const std::string& stream, std::uint32_t width,
                                            const std::string& unit,
                                            const std::vector<std::string>& channels) {
  impl_->check_name(stream, width);
  if (!channels.empty() && channels.size() != width) {
    throw ConfigurationError(
        fmt::format("the recorded stream '{}' has {} channels but {} names: give one name each",
                    stream, width, channels.size()));
  }
  const std::size_t rows = impl_->rows_of(stream, width);
  const auto added = impl_->add([&] {
    return std::make_shared<SignalStream>(stream, width, unit, channels, impl_->file.get(),
                                          impl_->path, rows);
  });
  return std::make_unique<RecordSink>(added, PortKind::signal);
}

std::unique_ptr<Sink> Recorder::output_sink(const GraphDescription& description,
                                            const std::string& end, const EndpointPort& port) {
  const PortDescription* const known = find_output(description, end);
  return port.kind == PortKind::spikes
             ? spike_sink(port.name, port.width,
                          known == nullptr ? std::vector<Population>() : known->populations)
             : signal_sink(port.name, port.width, known == nullptr ? "1" : known->unit,
                           known == nullptr ? std::vector<std::string>() : known->channels);
}

std::function<void(TimeNs, double)> Recorder::value_writer(const std::string& stream,
                                                           const std::string& unit) {
  impl_->check_name(stream, 1);
  const auto added = std::make_shared<std::shared_ptr<SignalStream>>();
  impl_->add([&]() -> std::shared_ptr<Stream> {
    *added =
        std::make_shared<SignalStream>(stream, 1, unit, std::vector<std::string>{},
                                       impl_->file.get(), impl_->path, impl_->options.least_rows);
    return *added;
  });
  return [signal = *added](TimeNs time, double value) { signal->take(time, value); };
}

/// Rows that wait for the writer. A loop in real time needs those of a tenth of a second.
std::size_t Recorder::Impl::rows_of(const std::string& stream, std::uint32_t width) const {
  const std::size_t row = (width + std::size_t{1}) * sizeof(double);
  const TimeNs ticks = tick > 0 ? (kLeastBuffered + tick - 1) / tick : 0;
  const std::size_t least =
      options.patient ? kLeastRows : std::max(kLeastRows, static_cast<std::size_t>(ticks));
  const std::size_t usual =
      std::max(options.least_rows, options.value_capacity / (width + std::size_t{1}));
  const std::size_t rows = std::min(usual, std::max(least, kWideBufferBytes / row));
  if (rows > kMostBufferBytes / row) {
    throw ConfigurationError(with_code(
        Code::out_of_bounds,
        "recording '{}' of '{}' needs a buffer of {} GB for {} rows of {} channels, {} rows "
        "per second; at most {} GB: write  record: false  for this node, fewer channels, a longer "
        "tick, or  sync: lockstep",
        stream, path, format_rounded(static_cast<double>(rows) * static_cast<double>(row) / 1e9, 3),
        rows, width, format_rounded(1e9 / static_cast<double>(tick), 3), kMostBufferBytes >> 30));
  }
  return rows;
}

bool Recorder::Impl::serve(std::size_t files) {
  if (stop.load()) {
    finish();
    ended.store(true);
    ended.notify_all();
    return false;
  }
  const auto all = snapshot();
  collect(all);
  std::size_t bytes = 0;
  for (const auto& stream : all) {
    bytes += stream->batch_bytes();
  }
  if (Clock::now() >= next_flush ||
      bytes > std::clamp(kAllBatchBytes / files, kLeastBatchBytes, kMostBatchBytes)) {
    flush(all);
    next_flush = Clock::now() + std::chrono::nanoseconds(options.flush_every);
  }
  return true;
}

void Recorder::Impl::collect(const std::vector<std::shared_ptr<Stream>>& all) {
  for (const auto& stream : all) {
    stream->collect();
  }
}

/// The batch of every stream goes to the disk as one, so the file is in disorder only meanwhile.
void Recorder::Impl::flush(const std::vector<std::shared_ptr<Stream>>& all) {
  const hdf5::Lock lock;
  if (failure.empty()) {
    hsize_t growth = kSpareBytes;
    for (const auto& stream : all) {
      growth += stream->growth();
    }
    try {
      if (has_many_gaps(file)) {
        write_safely(0, [&] { file = reopen(std::move(file), path); });
      }
      write_safely(growth, [&] {
        for (const auto& stream : all) {
          stream->write(file.get());
        }
      });
    } catch (const FileError&) {  // kept in `failure` for the report
    }
  }
  for (const auto& stream : all) {
    failure.empty() ? stream->keep_batch() : stream->lose_batch();
  }
}

/// HDF5 locked. What does not fit is refused before HDF5 knows of it; when HDF5 itself fails, it
/// holds what it can neither write nor forget. @throws FileError, kept in `failure`.
void Recorder::Impl::write_safely(hsize_t growth, const std::function<void()>& action) {
  try {
    hdf5::reserve(file, growth, path);  // refuses a deleted file, too
    broken = true;
    action();
    hdf5::check(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), "write", path);
    broken = false;
  } catch (const FileError& error) {
    failure = failure.empty() ? error.what() : failure;
    if (options.failures != nullptr) {
      options.failures->add(path, failure);
    }
    throw;
  }
}

void Recorder::Impl::finish() {
  const auto all = snapshot();
  for (const auto& stream : all) {
    stream->shut();
  }
  collect(all);
  flush(all);
  const hdf5::Lock lock;
  if (!broken) {
    try {
      write_safely(0, [&] { write_end(all); });
    } catch (const FileError&) {  // kept in `failure` for the report
    }
  }
  broken ? abandon_file(all) : close_file();
}

/// Overwrites what stands in the file already: it needs no room on the disk.
void Recorder::Impl::write_end(const std::vector<std::shared_ptr<Stream>>& all) {
  for (const auto& stream : all) {
    stream->write_dropped(file.get());
  }
  hdf5::Attributes(file.get(), path).write("complete", std::uint32_t{failure.empty()});
}

void Recorder::Impl::close_file() {
  if (!file.close() && failure.empty()) {
    failure = fmt::format("cannot close '{}': {}", path, hdf5::reason());
  }
}

void Recorder::Impl::abandon_file(const std::vector<std::shared_ptr<Stream>>& all) {
  for (const auto& stream : all) {
    stream->abandon();
  }
  file.abandon();
}

std::string Recorder::Impl::loss(const Report& counts) const {
  const std::string lost = fmt::format("{} spikes and {} signal rows are lost",
                                       counts.spikes_dropped, counts.signals_dropped);
  if (!failure.empty()) {
    TimeNs until = 0;
    for (const auto& stream : streams) {
      until = std::max(until, stream->written_until());
    }
    return lengthened(failure, fmt::format("; the recording ends at {} of simulated time, {}",
                                           format_time(until), lost));
  }
  if (counts.spikes_dropped + counts.signals_dropped > 0) {
    return fmt::format(
        "'{}' is incomplete: {}, because the disk is slower than the data or the run went on after "
        "the file was closed; record fewer streams or write to a faster disk",
        path, lost);
  }
  return {};
}

Report Recorder::Impl::report() {
  Report counts;
  const std::lock_guard lock(streams_mutex);
  for (const auto& stream : streams) {
    (stream->is_spikes() ? counts.spikes_written : counts.signals_written) += stream->written();
    (stream->is_spikes() ? counts.spikes_dropped : counts.signals_dropped) += stream->dropped();
  }
  counts.error = loss(counts);
  return counts;
}

void Recorder::begin_close() noexcept {
  impl_->stop.store(true);
  impl_->wake->post();
}

Report Recorder::close() {
  const std::lock_guard lock(impl_->close_mutex);
  begin_close();
  impl_->ended.wait(false);
  return impl_->report();
}

bool Recorder::flush_and_close_from_signal(TimeNs patience) noexcept {
  const int error_before = errno;
  constexpr TimeNs kLook = 1'000'000;
  begin_close();
  for (TimeNs waited = 0; !impl_->ended.load() && waited < patience; waited += kLook) {
    const timespec look{0, kLook};
    ::nanosleep(&look, nullptr);
  }
  errno = error_before;
  return impl_->ended.load();
}

}  // namespace spikeloop::record
