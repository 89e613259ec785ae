#include "field_reading.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace spikeloop::messages {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kShownNames = 8;

/// True if the path takes all elements of an array that is parallel to an array of texts `name`.
bool has_names(const FieldPath& path) {
  const auto name = std::ranges::find(path.type->fields, "name", &FieldLayout::name);
  const PathStep& step = path.steps.front();
  return name != path.type->fields.end() && name->primitive == Primitive::text &&
         name->array == ArrayKind::variable && !step.selector && step.first == 0 &&
         step.last == PathStep::kEnd;
}

/// True for beams of a sensor_msgs/LaserScan or MultiEchoLaserScan.
bool takes_beams(const FieldPath& path) {
  const std::string& name = path.field(0).name;
  return (name == "ranges" || name == "intensities") &&
         std::ranges::find(path.type->fields, "angle_increment", &FieldLayout::name) !=
             path.type->fields.end();
}

template <typename Names>
std::string list_of(const Names& names) {
  const auto shown = std::min(names.size(), kShownNames);
  return fmt::format("[{}{}]", fmt::join(names.begin(), names.begin() + shown, ", "),
                     names.size() > shown ? ", ..." : "");
}

/// Scales and limits a value, or applies the rule of a field that is not a number.
/// @return false if the message is to be left out
bool convert_value(const SensorField& field, double& value, Held& held) {
  if (!std::isnan(value)) {
    value = std::clamp(field.scale * value + field.offset, field.minimum, field.maximum);
    return true;
  }
  if (field.not_a_number == NotANumber::number) {
    value = field.instead;
  }
  held = field.not_a_number == NotANumber::hold ? Held::no_reading : Held::no;
  return field.not_a_number != NotANumber::skip;
}

/// The texts from which a path selects an element: `name` of `position[name=elbow]`. nullopt if the
/// path has no name.
std::optional<TextField> names_of(const Catalog& catalog, const std::string& type,
                                  const std::string& path) {
  const auto bracket = std::min(path.find('['), path.size());
  const auto equals = path.find('=', bracket);
  if (equals == std::string::npos) {
    return std::nullopt;
  }
  const std::string array = path.substr(0, bracket);
  const std::string key = path.substr(bracket + 1, equals - bracket - 1);
  for (const std::string& names :
       {array + "." + key, array.substr(0, array.rfind('.') + 1) + key}) {
    try {
      return TextField(catalog, type, names);
    } catch (const ConfigurationError&) {  // the names are next to the array
    }
  }
  return std::nullopt;
}

}  // namespace

std::string NameOrder::read(std::span<const std::byte> message) {
  newest_.clear();
  places_.clear();
  names_.read(message, newest_);
  if (known_.empty() || std::ranges::equal(newest_, known_)) {
    for (std::size_t i = 0; i < newest_.size(); ++i) {
      places_.push_back(i);
      if (known_.size() == i) {
        add(newest_[i]);
      }
    }
    return {};
  }
  const std::string before = warned_ ? "" : list_of(known_);
  std::size_t surplus = 0;
  for (const std::string_view name : newest_) {
    const auto found = place_of_.find(name);
    if (found != place_of_.end()) {
      places_.push_back(found->second);
    } else if (known_.size() < most_) {
      places_.push_back(known_.size());
      add(name);
    } else {
      places_.push_back(known_.size() + surplus++);
    }
  }
  std::string warning;
  if (!warned_ && !newest_.empty() && surplus == 0) {
    warning = fmt::format(
        "'name' of a {} was {} and is now {}: each name keeps its channel, and new names get the "
        "next ones; select the elements by name, as in position[name={}]",
        names_.path().type->name, before, list_of(newest_), known_.front());
  }
  warned_ = warned_ || !newest_.empty();  // surplus values have a warning of their own
  return warning;
}

void NameOrder::add(std::string_view name) {
  place_of_.emplace(name, known_.size());  // of equal names the first
  known_.emplace_back(name);
}

FieldReading::FieldReading(const Catalog& catalog, const std::string& type,
                           const std::vector<SensorField>& fields, std::uint32_t width)
    : type_(type), dialect_(catalog.dialect()) {
  for (const SensorField& field : fields) {
    if (auto points = type == kPointCloud ? PointPath::parse(field.path) : std::nullopt) {
      const auto count = points->width();
      entries_.push_back({field, std::move(*points), count});
      continue;
    }
    FieldReader reader(catalog, type, field.path);
    if (!selected_names_) {
      selected_names_ = names_of(catalog, type, field.path);
    }
    const auto count = reader.path().width();
    const bool by_name = has_names(reader.path());
    if (by_name && !order_) {
      order_.emplace(catalog, type, width == 0 ? kMostElements : width);
    }
    if (takes_beams(reader.path())) {
      angle_increment_.emplace(catalog, type, "angle_increment");
    }
    entries_.push_back({field, std::move(reader), count, by_name});
  }
  share_channels(width);
}

std::optional<std::size_t> FieldReading::width() const {
  std::size_t sum = 0;
  for (const Entry& entry : entries_) {
    if (!entry.width) {
      return std::nullopt;
    }
    sum += *entry.width;
  }
  return sum;
}

std::string FieldReading::name_of(std::size_t channel) const {
  const auto [entry, element] = entry_of(channel);
  return entry == nullptr ? Reading::name_of(channel) : name_of(*entry, element);
}

std::pair<const FieldReading::Entry*, std::size_t> FieldReading::entry_of(
    std::size_t channel) const {
  for (const Entry& entry : entries_) {
    const std::size_t width = share_channels_ ? entry.channels : entry.width.value_or(channel + 1);
    if (channel < width) {
      return {&entry, channel};
    }
    channel -= width;
  }
  return {nullptr, channel};
}

std::string FieldReading::names_in(std::span<const std::byte> message) const {
  if (!selected_names_) {
    return {};
  }
  std::vector<std::string_view> names;
  selected_names_->read(message, names);
  return list_of(names);
}

std::string FieldReading::length_remedy(std::size_t /*channels*/) const {
  return order_ ? "select the elements by name, as in position[name=NAME]" : "";
}

std::string FieldReading::no_value_remedy(bool missing, std::size_t channel) const {
  const Entry* const entry = entry_of(channel).first;
  if (missing || entry == nullptr) {
    return Reading::no_value_remedy(missing, channel);
  }
  const std::string& path = entry->field.path;
  const char* const quote = path.find('[') == std::string::npos ? "" : "\"";
  return fmt::format("select another field, or write  fields: [{{path: {0}{1}{0}, nan: 0}}]", quote,
                     path);
}

std::string FieldReading::name_of(const Entry& entry, std::size_t element) const {
  const std::string& path = entry.field.path;
  if (entry.width == 1U) {
    return path;
  }
  if (entry.by_name && !order_->name_at(element).empty()) {
    return fmt::format("{}[name={}]", path.substr(0, path.find('[')), order_->name_at(element));
  }
  const auto* const reader = std::get_if<FieldReader>(&entry.reader);
  if (reader == nullptr || reader->path().steps.size() != 1) {
    return fmt::format("{}, value {}", path, element);
  }
  return fmt::format("{}[{}]", path.substr(0, path.find('[')),
                     reader->path().steps.front().first + element);
}

bool FieldReading::read(std::span<const std::byte> message, ReadValues& values) {
  if (order_) {
    warn(order_->read(message));
  }
  check_order(message);
  for (Entry& entry : entries_) {
    read_entry(entry, message);
  }
  fit_channels();
  bool is_used = true;
  std::size_t whole = 0;
  for (const Entry& entry : entries_) {
    is_used = append(entry, values, whole) && is_used;
  }
  if (values.misfit) {
    values.misfit->whole = whole;
  }
  return is_used;
}

void FieldReading::check_order(std::span<const std::byte> message) {
  std::vector<double> increment;
  if (angle_increment_ && angle_increment_->read(message, increment) == 1 && increment[0] < 0) {
    warn(fmt::format(
        "angle_increment of a {} is {:g}: 'fields' reads its beams from left to right, "
        "as they are in the message; leave out 'fields' to read them from right to left",
        type_, increment[0]));
    angle_increment_.reset();
  }
}

void FieldReading::read_entry(Entry& entry, std::span<const std::byte> message) {
  entry.numbers.clear();
  const auto* const path = std::get_if<FieldReader>(&entry.reader);
  if (path != nullptr) {
    path->read(message, entry.numbers);
  } else {
    std::get<PointPath>(entry.reader).read(dialect_, message, entry.numbers);
  }
  entry.held.assign(entry.numbers.size(), Held::no);
  if (entry.by_name && entry.numbers.size() == order_->places().size()) {
    order_by_name(entry);
  }
}

void FieldReading::order_by_name(Entry& entry) const {
  const std::vector<double> numbers = std::exchange(entry.numbers, {});
  entry.held.clear();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t place = order_->places()[i];
    if (place >= entry.numbers.size()) {
      entry.numbers.resize(place + 1, kNan);
      entry.held.resize(place + 1, Held::missing);
    }
    entry.numbers[place] = numbers[i];
    entry.held[place] = Held::no;
  }
}

void FieldReading::share_channels(std::uint32_t width) {
  std::size_t known = 0;
  std::size_t open = 0;
  for (const Entry& entry : entries_) {
    known += entry.width.value_or(0);
    open += entry.width ? 0 : 1;
  }
  share_channels_ = entries_.size() > 1 && open > 0 && width > known;
  if (!share_channels_) {
    return;
  }
  shared_ = width - known;
  std::size_t surplus = shared_ % open;
  for (Entry& entry : entries_) {
    entry.channels = entry.width.value_or(shared_ / open);
    if (!entry.width && surplus > 0) {
      ++entry.channels;
      --surplus;
    }
  }
}

void FieldReading::fit_channels() {
  std::size_t brought = 0;
  for (const Entry& entry : entries_) {
    brought += entry.width ? 0 : entry.numbers.size();
  }
  if (!share_channels_ || is_fitted_ || brought != shared_) {
    return;
  }
  is_fitted_ = true;
  for (Entry& entry : entries_) {
    entry.channels = entry.width.value_or(entry.numbers.size());
  }
}

bool FieldReading::append(const Entry& entry, ReadValues& values, std::size_t& whole) const {
  const std::size_t brought = entry.numbers.size();
  // A missing value must not move the values of the next fields to other channels.
  const std::size_t known = entry.by_name ? order_->size() : entry.width.value_or(0);
  const std::size_t width = share_channels_ ? entry.channels : std::max(brought, known);
  // A message may have a part of the names.
  const std::size_t fitting = std::max(brought, std::min(known, width));
  whole += fitting;
  if (!entry.width && fitting != width && !values.misfit) {
    values.misfit = {entry.field.path, fitting, width, 0};
  }
  bool is_used = true;
  for (std::size_t i = 0; i < width; ++i) {
    double value = i < brought ? entry.numbers[i] : kNan;
    Held held = i < brought ? entry.held[i] : Held::missing;
    is_used = (held != Held::no || convert_value(entry.field, value, held)) && is_used;
    values.numbers.push_back(value);
    values.held.push_back(held);
  }
  return is_used;
}

}  // namespace spikeloop::messages
