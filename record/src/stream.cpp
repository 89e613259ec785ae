#include "stream.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <thread>

namespace spikeloop::record {
namespace {

/// Channels of a stream. Compression takes a third of a core for a million spikes a second, which
/// more neurons may well have.
constexpr std::uint32_t kMostCompressed = 10'000;
/// Values that are written at once. Buffers of the same size every time do not fragment the memory
/// of a long run.
constexpr std::size_t kSlice = std::size_t{1} << 14;
constexpr std::size_t kMostNames = 1000;  // an attribute has room for 64 KiB

}  // namespace

std::string Stream::path_in_file() const {
  return (is_spikes() ? "spikes/" : "signals/") + name_;
}

void Stream::make_group(hid_t file, const std::string& path) {
  path_ = path;
  group_ = hdf5::Handle(
      hdf5::check(H5Gcreate2(file, path_in_file().c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                  "write", path));
  const hdf5::Attributes attributes(group_.get(), path);
  attributes.write("width", width_);
  attributes.write("until_ns", TimeNs{0});
  attributes.write("dropped", std::uint64_t{0});
}

void Stream::open_group(hid_t file) {
  group_ = hdf5::Handle(
      hdf5::check(H5Gopen2(file, path_in_file().c_str(), H5P_DEFAULT), "write", path_));
}

void Stream::wake_when_half_full(std::size_t room, std::size_t capacity) {
  if (room < capacity / 2 && wake_ && !wake_asked_.exchange(true)) {
    wake_->post();
  }
}

bool Stream::waited() {
  if (!patient_ || shut_now() || !wake_) {
    return false;
  }
  constexpr std::chrono::microseconds kShort{200};
  wake_->post();
  std::this_thread::sleep_for(kShort);
  return !shut_now();
}

void Stream::collect() {
  wake_asked_.store(false);
  // Before the ring is emptied: what was in the ring at this time is surely in the batch.
  batch_until_ = reached_.load(std::memory_order_acquire);
  drain();
}

std::size_t Stream::batch_bytes() const {
  return batch_items() * (width_ + 1) * sizeof(double);
}

hsize_t Stream::growth() {
  hsize_t bytes = 0;
  for (const auto* dataset : datasets()) {
    bytes += dataset->growth(batch_items());
  }
  return bytes;
}

void Stream::write(hid_t file) {
  open_group(file);
  if (batch_items() > 0) {
    for (auto* dataset : datasets()) {
      dataset->open(group());
    }
    append();
    for (auto* dataset : datasets()) {
      dataset->close();
    }
  }
  const hdf5::Attributes attributes(group(), path_);
  attributes.write("until_ns", batch_until_);
  attributes.write("dropped", dropped());
  group_.close();
}

void Stream::write_dropped(hid_t file) {
  open_group(file);
  hdf5::Attributes(group(), path_).write("dropped", dropped());
  group_.close();
}

void Stream::keep_batch() {
  written_ += batch_items();
  written_until_ = batch_until_;
  clear();
}

void Stream::lose_batch() {
  lost_.fetch_add(batch_items());
  clear();
}

void Stream::close() {
  for (auto* dataset : datasets()) {
    dataset->close();
  }
  group_.close();
}

void Stream::abandon() {
  for (auto* dataset : datasets()) {
    dataset->abandon();
  }
  group_.abandon();
}

SpikeStream::SpikeStream(std::string name, std::uint32_t width,
                         const std::vector<Population>& populations, hid_t file,
                         const std::string& path, std::size_t capacity)
    : Stream(std::move(name), width), ring_(capacity) {
  make_group(file, path);
  const bool compressed = width <= kMostCompressed;
  timestamps_ = hdf5::GrowingDataset(group(), "timestamps", H5T_IEEE_F64LE, 0, compressed, path);
  node_ids_ = hdf5::GrowingDataset(group(), "node_ids", H5T_STD_U64LE, 0, compressed, path);
  timestamps_ns_ =
      hdf5::GrowingDataset(group(), "timestamps_ns", H5T_STD_I64LE, 0, compressed, path);
  hdf5::Attributes(timestamps_.get(), path).write("units", std::string("ms"));
  hdf5::Attributes(timestamps_ns_.get(), path).write("units", std::string("ns"));
  write_populations(populations);
  write_sorting(true);
}

void SpikeStream::take(const Step& step) {
  auto spikes = step.spike_input().spikes;
  std::size_t room = 0;
  do {
    room = shut_now() ? 0 : ring_.room();
    const std::size_t count = std::min(room, spikes.size());
    for (std::size_t i = 0; i < count; ++i) {
      ring_.put(i, spikes[i]);
    }
    ring_.publish(count);
    spikes = spikes.subspan(count);
    room -= count;
  } while (!spikes.empty() && waited());
  if (!spikes.empty()) {
    count_overflow(spikes.size());
  }
  reached(step.interval().end);
  wake_when_half_full(room, ring_.capacity());
}

void SpikeStream::append() {
  std::vector<double> milliseconds;
  std::vector<std::int64_t> nanoseconds;
  std::vector<std::uint64_t> ids;
  for (std::size_t begin = 0; begin < batch_.size(); begin += kSlice) {
    const auto slice = std::span(batch_).subspan(begin, std::min(kSlice, batch_.size() - begin));
    milliseconds.resize(slice.size());
    nanoseconds.resize(slice.size());
    ids.resize(slice.size());
    for (std::size_t i = 0; i < slice.size(); ++i) {
      nanoseconds[i] = slice[i].time_ns;
      milliseconds[i] = static_cast<double>(slice[i].time_ns) / 1e6;
      ids[i] = static_cast<std::uint64_t>(slice[i].channel);
      sorted_ = sorted_ && slice[i].time_ns >= last_;
      last_ = slice[i].time_ns;
    }
    timestamps_.append(milliseconds.data(), slice.size(), H5T_NATIVE_DOUBLE);
    node_ids_.append(ids.data(), slice.size(), H5T_NATIVE_UINT64);
    timestamps_ns_.append(nanoseconds.data(), slice.size(), H5T_NATIVE_INT64);
  }
  write_sorting(sorted_);
}

void SpikeStream::write_populations(const std::vector<Population>& populations) const {
  if (populations.empty() || populations.size() > kMostNames) {
    return;
  }
  std::vector<std::string> names;
  std::vector<std::uint32_t> sizes;
  for (const Population& population : populations) {
    names.push_back(population.name);
    sizes.push_back(population.size);
  }
  const hsize_t count = sizes.size();
  const hdf5::Attributes attributes(group(), file_path());
  attributes.write("populations", names);
  attributes.write("population_sizes", H5T_NATIVE_UINT32,
                   hdf5::Handle(H5Screate_simple(1, &count, nullptr)).get(), sizes.data());
}

/// SONATA: "sorting" is an enumeration of none, by_id and by_time.
void SpikeStream::write_sorting(bool sorted) const {
  const hdf5::Handle type(H5Tenum_create(H5T_STD_U8LE));
  for (std::uint8_t value = 0; const char* name : {"none", "by_id", "by_time"}) {
    H5Tenum_insert(type.get(), name, &value);
    ++value;
  }
  const std::uint8_t value = sorted ? 2 : 0;
  hdf5::Attributes(group(), file_path())
      .write("sorting", type.get(), hdf5::Handle(H5Screate(H5S_SCALAR)).get(), &value);
}

SignalStream::SignalStream(std::string name, std::uint32_t width, const std::string& unit,
                           const std::vector<std::string>& channels, hid_t file,
                           const std::string& path, std::size_t rows)
    : Stream(std::move(name), width), ring_(rows * (width + std::size_t{1})) {
  make_group(file, path);
  if (!channels.empty() && channels.size() <= kMostNames) {
    hdf5::Attributes(group(), path).write("channels", channels);
  }
  const bool compressed = width <= kMostCompressed;
  times_ = hdf5::GrowingDataset(group(), "times_ns", H5T_STD_I64LE, 0, compressed, path);
  values_ = hdf5::GrowingDataset(group(), "values", H5T_IEEE_F64LE, width, compressed, path);
  hdf5::Attributes(values_.get(), path).write("unit", unit);
}

void SignalStream::take(const Step& step) {
  const SignalInput input = step.signal_input();
  if (input.revision != revision_) {
    revision_ = input.revision;
    put_row(step.interval().end, input.valid() ? input.values : std::span<const double>());
  }
  reached(step.interval().end);
}

void SignalStream::take(TimeNs time, double value) {
  put_row(time, {&value, 1});
  reached(time);
}

/// @param values none: the value was lost
void SignalStream::put_row(TimeNs time, std::span<const double> values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::size_t row = width() + 1;
  std::size_t room = ring_.room();
  while (room < row && waited()) {
    room = ring_.room();
  }
  if (shut_now() || room < row) {
    count_overflow(1);
    return;
  }
  ring_.put(0, time);
  for (std::size_t i = 0; i < width(); ++i) {
    ring_.put(i + 1, std::bit_cast<std::int64_t>(values.empty() ? kNone : values[i]));
  }
  ring_.publish(row);
  wake_when_half_full(room - row, ring_.capacity());
}

void SignalStream::append() {
  const std::size_t row = width() + std::size_t{1};
  const std::size_t most = std::max<std::size_t>(1, kSlice / row);
  std::vector<std::int64_t> times;
  std::vector<double> values;
  for (std::size_t first = 0; first < batch_items(); first += most) {
    const std::size_t rows = std::min(most, batch_items() - first);
    times.resize(rows);
    values.resize(rows * width());
    for (std::size_t i = 0; i < rows; ++i) {
      const std::int64_t* begin = batch_.data() + (first + i) * row;
      times[i] = *begin;
      std::transform(begin + 1, begin + row, values.data() + i * width(),
                     [](std::int64_t bits) { return std::bit_cast<double>(bits); });
    }
    times_.append(times.data(), rows, H5T_NATIVE_INT64);
    values_.append(values.data(), rows, H5T_NATIVE_DOUBLE);
  }
}

}  // namespace spikeloop::record
