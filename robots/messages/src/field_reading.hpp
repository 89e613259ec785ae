// The numbers of field paths, as values of a sensor.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "point_cloud.hpp"
#include "reading.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

/// Order of the elements of arrays that a message has beside an array `name`, as in
/// sensor_msgs/JointState. An element keeps its channel when later messages have other names or
/// another order.
class NameOrder {
 public:
  /// @param most number of names that have a place
  NameOrder(const Catalog& catalog, const std::string& type, std::size_t most)
      : names_(catalog, type, "name"), most_(most) {}

  /// Returns a warning at the first message with other names, else an empty text.
  std::string read(std::span<const std::byte> message);
  /// Index of each element's channel. New names get the next free indices.
  const std::vector<std::size_t>& places() const { return places_; }
  /// Number of names with an index.
  std::size_t size() const { return known_.size(); }
  /// Name with this index; empty if there is none.
  std::string name_at(std::size_t place) const {
    return place < known_.size() ? known_[place] : std::string();
  }

 private:
  void add(std::string_view name);

  TextField names_;
  std::size_t most_;
  std::vector<std::string> known_;
  std::map<std::string, std::size_t, std::less<>> place_of_;
  std::vector<std::string_view> newest_;
  std::vector<std::size_t> places_;
  bool warned_ = false;
};

class FieldReading : public Reading {
 public:
  /// @param width of the port; 0: not known
  FieldReading(const Catalog& catalog, const std::string& type,
               const std::vector<SensorField>& fields, std::uint32_t width);

  std::optional<std::size_t> width() const override;
  std::string name_of(std::size_t channel) const override;
  std::string length_remedy(std::size_t channels) const override;
  std::string no_value_remedy(bool missing, std::size_t channel) const override;
  std::string names_in(std::span<const std::byte> message) const override;

 private:
  struct Entry {
    SensorField field;
    std::variant<FieldReader, PointPath> reader;
    std::optional<std::size_t> width;  ///< nullopt: the message determines the number of values
    bool by_name = false;              ///< its elements are sorted by `order_`
    std::size_t channels = 0;          ///< with share_channels_
    std::vector<double> numbers{};     ///< of the newest message
    std::vector<Held> held{};
  };

  bool read(std::span<const std::byte> message, ReadValues& values) override;
  /// Warns about beams that the message has from left to right.
  void check_order(std::span<const std::byte> message);
  void read_entry(Entry& entry, std::span<const std::byte> message);
  void order_by_name(Entry& entry) const;
  void share_channels(std::uint32_t width);
  /// The first message whose values fill the port determines how many channels each field has.
  void fit_channels();
  /// Field of a channel, and its element; nullptr beyond the last field.
  std::pair<const Entry*, std::size_t> entry_of(std::size_t channel) const;
  std::string name_of(const Entry& entry, std::size_t element) const;
  /// False: the message is to be left out.
  /// @param whole grows by the number of the field's values
  bool append(const Entry& entry, ReadValues& values, std::size_t& whole) const;

  std::string type_;
  Dialect dialect_;
  std::vector<Entry> entries_;
  std::optional<NameOrder> order_;
  std::optional<TextField> selected_names_;     ///< of the first field that selects by name
  std::optional<FieldReader> angle_increment_;  ///< of beams; nullopt after the warning
  bool share_channels_ = false;                 ///< several fields, one of them of any length
  bool is_fitted_ = false;
  std::size_t shared_ = 0;  ///< number of channels of the fields of any length
};

}  // namespace spikeloop::messages
