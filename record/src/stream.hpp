// One recorded stream: the loop's side (take) and the writer's side (collect, write).
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hdf5.hpp"
#include "ring.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/core/time.hpp"
#include "writer.hpp"

namespace spikeloop::record {

class Stream {
 public:
  Stream(std::string name, std::uint32_t width) : name_(std::move(name)), width_(width) {}
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  virtual ~Stream() = default;

  void be_patient() { patient_ = true; }
  const std::string& name() const { return name_; }
  std::uint32_t width() const { return width_; }
  hid_t group() const { return group_.get(); }
  /// Sets the semaphore that wakes the writer when the ring is half full or a patient loop waits.
  /// Null for a stream without a writer.
  void wake_by(std::shared_ptr<Wake> wake) { wake_ = std::move(wake); }

  /// Loop's thread: appends what the step brought. Waits only when it is patient.
  virtual void take(const Step& step) = 0;
  /// Any thread: number of spikes or rows dropped so far.
  std::uint64_t dropped() const { return overflow_.load() + lost_.load(); }

  /// Writer's thread: moves the contents of the ring to the batch.
  void collect();
  std::size_t batch_bytes() const;
  virtual std::size_t batch_items() const = 0;
  /// Writer's thread, HDF5 locked: bytes by which the batch may make the file grow.
  hsize_t growth();
  /// Writer's thread, HDF5 locked: appends the batch to the file. The stream's group and datasets
  /// are open only meanwhile: HDF5 visits every open dataset of the process whenever it flushes a
  /// file, and each has a cache. @throws FileError; then abandon() must follow.
  void write(hid_t file);
  /// Writer's thread, HDF5 locked: updates the attribute `dropped`. @throws FileError, as write().
  void write_dropped(hid_t file);
  /// Writer's thread: the batch is on the disk, or it never will be.
  void keep_batch();
  void lose_batch();
  /// Any thread: from now on take() only counts.
  void shut() { shut_.store(true); }
  /// HDF5 locked: leaks the handles of a failed write, because closing them would crash HDF5.
  void abandon();

  std::uint64_t written() const { return written_; }
  TimeNs written_until() const { return written_until_; }
  virtual bool is_spikes() const = 0;

  /// HDF5 locked, after construction. @throws FileError.
  void close();

 protected:
  void make_group(hid_t file, const std::string& path);
  void wake_when_half_full(std::size_t room, std::size_t capacity);
  virtual void drain() = 0;
  virtual void append() = 0;
  virtual void clear() = 0;
  virtual std::vector<hdf5::GrowingDataset*> datasets() = 0;

  const std::string& file_path() const { return path_; }
  /// Whether a patient loop has waited for the writer: then there may be room.
  bool waited();
  bool shut_now() const { return shut_.load(std::memory_order_relaxed); }
  void count_overflow(std::uint64_t items) { overflow_.fetch_add(items); }
  void reached(TimeNs end) { reached_.store(end, std::memory_order_release); }

 private:
  /// "spikes/out"
  std::string path_in_file() const;
  void open_group(hid_t file);

  std::string name_;
  std::uint32_t width_;
  std::string path_;
  hdf5::Handle group_;
  std::shared_ptr<Wake> wake_;  // wakes the writer when the ring is half full
  std::atomic<bool> shut_{false};
  std::atomic<bool> wake_asked_{false};
  bool patient_ = false;
  std::atomic<std::uint64_t> overflow_{0};  // the ring was full, or the recorder closed
  std::atomic<std::uint64_t> lost_{0};      // the disk refused
  std::atomic<TimeNs> reached_{0};          // everything up to here is in the ring
  // Writer's thread only.
  std::uint64_t written_ = 0;
  TimeNs batch_until_ = 0;
  TimeNs written_until_ = 0;
};

class SpikeStream : public Stream {
 public:
  SpikeStream(std::string name, std::uint32_t width, const std::vector<Population>& populations,
              hid_t file, const std::string& path, std::size_t capacity);
  void take(const Step& step) override;
  std::size_t batch_items() const override { return batch_.size(); }
  bool is_spikes() const override { return true; }

 private:
  void drain() override { ring_.drain(batch_); }
  void append() override;
  void clear() override { batch_.clear(); }
  std::vector<hdf5::GrowingDataset*> datasets() override {
    return {&timestamps_, &timestamps_ns_, &node_ids_};
  }
  void write_populations(const std::vector<Population>& populations) const;
  void write_sorting(bool sorted) const;

  Ring<Spike> ring_;
  std::vector<Spike> batch_;
  TimeNs last_ = std::numeric_limits<TimeNs>::min();
  bool sorted_ = true;
  hdf5::GrowingDataset timestamps_;
  hdf5::GrowingDataset timestamps_ns_;
  hdf5::GrowingDataset node_ids_;
};

class SignalStream : public Stream {
 public:
  SignalStream(std::string name, std::uint32_t width, const std::string& unit,
               const std::vector<std::string>& channels, hid_t file, const std::string& path,
               std::size_t rows);
  void take(const Step& step) override;
  /// A row of a signal of one channel.
  void take(TimeNs time, double value);
  std::size_t batch_items() const override { return batch_.size() / (width() + 1); }
  bool is_spikes() const override { return false; }

 private:
  void drain() override { ring_.drain(batch_); }
  void append() override;
  void clear() override { batch_.clear(); }
  std::vector<hdf5::GrowingDataset*> datasets() override { return {&times_, &values_}; }

  void put_row(TimeNs time, std::span<const double> values);

  Ring<std::int64_t> ring_;     // rows: the time, then the values' bits
  std::uint64_t revision_ = 0;  // loop's thread only
  std::vector<std::int64_t> batch_;
  hdf5::GrowingDataset times_;
  hdf5::GrowingDataset values_;
};

}  // namespace spikeloop::record
