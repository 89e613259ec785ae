#include "foreign_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "plugin_text.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop {

namespace {

std::vector<std::string> split_choices(const char* choices) {
  std::vector<std::string> all;
  std::string rest = text_or_empty(choices);
  while (!rest.empty()) {
    const auto bar = rest.find('|');
    all.push_back(rest.substr(0, bar));
    rest = bar == std::string::npos ? "" : rest.substr(bar + 1);
  }
  return all;
}

PortDescription port_description(const std::string& path, const spikeloop_node_class& foreign,
                                 const spikeloop_port& port) {
  const bool well_formed =
      port.name != nullptr && port.kind <= SPIKELOOP_SPIKES && port.direction <= SPIKELOOP_OUTPUT &&
      port.width_rule <= SPIKELOOP_WIDTH_SAME &&
      (port.width_rule != SPIKELOOP_WIDTH_SAME || port.width_value < foreign.port_count);
  if (!well_formed) {
    refuse(path, fmt::format("a port of the node class '{}' is malformed", foreign.name));
  }
  return {port.name,
          static_cast<PortKind>(port.kind),
          static_cast<Direction>(port.direction),
          {static_cast<WidthRule::Kind>(port.width_rule), port.width_value},
          text_or_empty(port.text)};
}

ParameterDescription parameter_description(const std::string& path,
                                           const spikeloop_node_class& foreign,
                                           const spikeloop_parameter& parameter) {
  if (parameter.name == nullptr || parameter.type > SPIKELOOP_WEIGHTS) {
    refuse(path, fmt::format("a parameter of the node class '{}' is malformed", foreign.name));
  }
  ParameterDescription description;
  description.name = parameter.name;
  description.type = static_cast<ParameterType>(parameter.type);
  description.unit = text_or_empty(parameter.unit);
  if (parameter.default_value != nullptr) {
    description.default_value = parameter.default_value;
  }
  description.minimum = parameter.minimum;
  description.maximum = parameter.maximum;
  description.choices = split_choices(parameter.choices);
  description.text = text_or_empty(parameter.text);
  return description;
}

// The plain form of a setup; owns what its pointers point to.
class PlainSetup {
 public:
  PlainSetup(const spikeloop_node_class& node_class, const NodeDescription& description,
             const NodeSetup& setup) {
    find_weight_widths(description, setup);
    tables_.reserve(setup.parameters.all().size());
    weights_.reserve(setup.parameters.all().size());
    for (const auto& [name, value] : setup.parameters.all()) {
      values_.push_back(plain_value(name, value, setup.parameters.given(name)));
    }
    plain_ = {setup.name.c_str(),
              setup.seed,
              values_.data(),
              setup.widths.data(),
              static_cast<std::uint32_t>(values_.size()),
              static_cast<std::uint32_t>(setup.widths.size()),
              &node_class};
  }
  const spikeloop_setup& plain() const { return plain_; }

 private:
  // Weights written without a size map the class's first input to its first output.
  void find_weight_widths(const NodeDescription& description, const NodeSetup& setup) {
    for (std::size_t i = description.ports.size(); i-- > 0;) {
      const bool input = description.ports[i].direction == Direction::input;
      (input ? weight_columns_ : weight_rows_) = setup.widths[i];
    }
  }

  spikeloop_value plain_value(const std::string& name, const Parameters::Value& value, bool given) {
    spikeloop_value plain{name.c_str(), "", nullptr, 0.0, 0, SPIKELOOP_NUMBER, given ? 1U : 0U};
    if (const auto* number = std::get_if<double>(&value)) {
      plain.number = *number;
    } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
      plain.type = SPIKELOOP_INTEGER;
      plain.integer = *integer;
      plain.number = static_cast<double>(*integer);
    } else if (const auto* boolean = std::get_if<bool>(&value)) {
      plain.type = SPIKELOOP_BOOLEAN;
      plain.integer = *boolean ? 1 : 0;
      plain.number = *boolean ? 1.0 : 0.0;
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      plain.type = SPIKELOOP_TEXT;
      plain.text = text->c_str();
    } else {
      plain.type = SPIKELOOP_WEIGHTS;  // plug-ins declare no lists and maps
      const WeightTable& table = tables_.emplace_back(
          std::get<WeightTable>(value).resized(weight_rows_, weight_columns_).compressed());
      weights_.push_back({table.rows, table.columns, table.row_start.data(), table.column.data(),
                          table.values.data()});
      plain.weights = &weights_.back();
    }
    return plain;
  }

  std::uint32_t weight_rows_ = 0;
  std::uint32_t weight_columns_ = 0;
  std::vector<WeightTable> tables_;
  std::vector<spikeloop_weights> weights_;
  std::vector<spikeloop_value> values_;
  spikeloop_setup plain_{};
};

using ErrorText = std::array<char, 2048>;

/// The plug-in's own sentence, and whose it is, unless it names the file itself: a run's last line
/// tells which one to mend.
std::string reason(ErrorText& text, const std::string& path) {
  text.back() = '\0';
  const std::string said = text.front() == '\0' ? "it failed without a reason" : text.data();
  const std::string file = path.substr(path.rfind('/') + 1);
  return said.find(file) == std::string::npos ? fmt::format("{} (plug-in '{}')", said, path) : said;
}

class ForeignNode : public Node {
 public:
  ForeignNode(const spikeloop_node_class& node_class, const NodeDescription& description,
              const NodeSetup& setup)
      : class_(node_class), path_(description.source) {
    ErrorText error{};
    const PlainSetup plain(class_, description, setup);
    node_ = class_.create(&plain.plain(), error.data(), error.size());
    if (node_ == nullptr) {
      throw ConfigurationError(with_code(Code::plug_in, reason(error, path_)));
    }
  }
  ~ForeignNode() override { class_.destroy(node_); }

  void step(const Step& step) override {
    ErrorText error{};
    if (class_.step(node_, &step.plain(), error.data(), error.size()) != 0) {
      throw std::runtime_error(reason(error, path_));  // the graph adds the node's name
    }
  }

  std::vector<Counter> counters() const override {
    std::array<spikeloop_counter, 32> plain{};
    ErrorText error{};
    const std::uint32_t count =
        class_.counters == nullptr
            ? 0
            : class_.counters(node_, plain.data(), static_cast<std::uint32_t>(plain.size()),
                              error.data(), error.size());
    if (count == SPIKELOOP_FAILED) {
      throw std::runtime_error(reason(error, path_));
    }
    std::vector<Counter> all;
    for (std::uint32_t i = 0; i < std::min<std::uint32_t>(count, plain.size()); ++i) {
      all.push_back({plain[i].name, plain[i].value});
    }
    return all;
  }

 private:
  const spikeloop_node_class& class_;
  std::string path_;
  void* node_ = nullptr;
};

}  // namespace

NodeClass foreign_node_class(const std::string& path, const spikeloop_node_class* foreign) {
  const bool well_formed = foreign != nullptr && foreign->name != nullptr &&
                           foreign->create != nullptr && foreign->step != nullptr &&
                           foreign->destroy != nullptr;
  if (!well_formed) {
    refuse(path, "a node class lacks its name or one of create, step, destroy");
  }
  NodeClass node_class;
  node_class.description.name = foreign->name;
  node_class.description.text = text_or_empty(foreign->text);
  node_class.description.source = path;
  for (std::uint32_t i = 0; i < foreign->port_count; ++i) {
    node_class.description.ports.push_back(port_description(path, *foreign, foreign->ports[i]));
  }
  for (std::uint32_t i = 0; i < foreign->parameter_count; ++i) {
    node_class.description.parameters.push_back(
        parameter_description(path, *foreign, foreign->parameters[i]));
  }
  node_class.create = [foreign, description = node_class.description](
                          const NodeSetup& setup) -> std::unique_ptr<Node> {
    return std::make_unique<ForeignNode>(*foreign, description, setup);
  };
  return node_class;
}

}  // namespace spikeloop
