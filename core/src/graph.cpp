#include "spikeloop/core/graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "renewable_node.hpp"
#include "spike_sort.hpp"
#include "spikeloop/core/graph_plan.hpp"
#include "thread_team.hpp"

namespace spikeloop {

namespace {

// The data of one output port; every connection from it reads here.
struct Output {
  PortKind kind = PortKind::signal;
  std::uint32_t width = 0;
  std::vector<double> values;
  std::uint64_t revision = 0;
  std::vector<Spike> spikes;  // of the interval, sorted
  std::vector<Spike> held;    // of a source: stamped after the interval

  static void append(void* sink, const Spike* spikes, std::uint64_t count) {
    auto& output = *static_cast<Output*>(sink);
    output.spikes.insert(output.spikes.end(), spikes, spikes + count);
  }
};

// A connection; with a delay of d ticks it keeps the outputs of the last d intervals in a ring.
struct Edge {
  struct Slot {
    std::vector<double> values;
    std::uint64_t revision = 0;
    std::vector<Spike> spikes;
  };
  Output* from = nullptr;
  TimeNs shift = 0;
  std::vector<Slot> ring;
  ConnectionReport report;

  spikeloop_signal_input signal(std::uint64_t tick_index) const {
    if (ring.empty()) {
      return {from->values.data(), from->revision, from->width, 0};
    }
    const Slot& slot = ring[tick_index % ring.size()];
    return {slot.values.data(), slot.revision, from->width, 0};
  }

  std::span<const Spike> spikes(std::uint64_t tick_index) {
    const auto& arrived = ring.empty() ? from->spikes : ring[tick_index % ring.size()].spikes;
    report.sent += arrived.size();
    return arrived;
  }

  // Of the sorted spikes that the receiver gets.
  void count(std::span<const Spike> passed, TimeNs begin) {
    report.spikes += passed.size();
    for (auto spike = passed.begin(); spike != passed.end() && spike->time_ns <= begin; ++spike) {
      ++report.late;
    }
  }

  // What is on its way gets lost.
  void clear() {
    for (Slot& slot : ring) {
      slot.revision = 0;
      slot.spikes.clear();
    }
  }

  // At the end of interval k: what interval k + d will read.
  void push(std::uint64_t tick_index) {
    if (ring.empty()) {
      return;
    }
    Slot& slot = ring[tick_index % ring.size()];
    if (from->kind == PortKind::signal) {
      slot.values = from->values;
      slot.revision = from->revision;
      return;
    }
    slot.spikes = from->spikes;
    for (Spike& spike : slot.spikes) {
      spike.time_ns += shift;
    }
  }
};

// What an input port reads: the output of one connection, or what several are combined to.
class Input {
 public:
  void add(Edge& edge, const ChannelRange& channels, Combination combination) {
    const std::uint32_t count = channels.count(edge.from->width);
    const std::uint32_t offset = combination == Combination::appended ? width_ : 0;
    parts_.push_back({&edge, channels.begin, count, offset});
    width_ = offset + count;
  }

  // Without a value until every sender has one.
  spikeloop_signal_input signal(std::uint64_t tick_index) {
    if (is_whole_output()) {
      return parts_.front().edge->signal(tick_index);
    }
    bool valid = true;
    bool changed = false;
    for (Part& part : parts_) {
      part.signal = part.edge->signal(tick_index);
      valid = valid && part.signal.revision != 0;
      changed = changed || part.signal.revision != part.revision;
      part.revision = part.signal.revision;
    }
    if (valid && changed) {
      combine();
    }
    return {values_.data(), valid ? revision_ : 0, width_, 0};
  }

  spikeloop_spike_input spikes(std::uint64_t tick_index, TimeNs begin, SpikeSorter& sorter) {
    if (is_whole_output()) {
      Edge& edge = *parts_.front().edge;
      const auto arrived = edge.spikes(tick_index);
      edge.count(arrived, begin);
      return {arrived.data(), arrived.size(), width_, 0};
    }
    spikes_.clear();
    for (const Part& part : parts_) {
      const std::size_t before = spikes_.size();
      for (const Spike& spike : part.edge->spikes(tick_index)) {
        const std::uint32_t channel = static_cast<std::uint32_t>(spike.channel) - part.begin;
        if (channel < part.count) {
          spikes_.push_back(
              make_spike(spike.time_ns, static_cast<std::int32_t>(channel + part.offset)));
        }
      }
      part.edge->count(std::span(spikes_).subspan(before), begin);
    }
    if (parts_.size() > 1) {
      sorter.sort(spikes_);
    }
    return {spikes_.data(), spikes_.size(), width_, 0};
  }

 private:
  struct Part {
    Edge* edge = nullptr;
    std::uint32_t begin = 0;   // of the sender's channels
    std::uint32_t count = 0;   // of channels
    std::uint32_t offset = 0;  // of the input's channels
    spikeloop_signal_input signal{};
    std::uint64_t revision = 0;  // that `values_` has
  };

  bool is_whole_output() const {
    return parts_.size() == 1 && parts_.front().count == parts_.front().edge->from->width;
  }

  // In the order in which the connections are listed, so that sums are equal in every layout.
  void combine() {
    values_.assign(width_, 0.0);
    for (const Part& part : parts_) {
      for (std::uint32_t c = 0; c < part.count; ++c) {
        values_[part.offset + c] += part.signal.values[part.begin + c];
      }
    }
    ++revision_;
  }

  std::vector<Part> parts_;
  std::uint32_t width_ = 0;
  std::vector<double> values_;
  std::uint64_t revision_ = 0;
  std::vector<Spike> spikes_;
};

// Calls a node: what goes wrong in it ends the run with its name.
template <typename Work>
auto of_node(const std::string& name, Work&& work) {
  try {
    return work();
  } catch (const std::exception& error) {
    throw NodeError(name, error.what());
  }
}

// A source, node or sink with its ports in the order of the step data.
struct Element {
  std::string name;
  Source* source = nullptr;
  std::unique_ptr<Node> node;
  Sink* sink = nullptr;
  std::vector<Input*> signal_inputs, spike_inputs;
  std::vector<Output*> signal_outputs, spike_outputs;
  std::vector<spikeloop_signal_input> signal_input_data;
  std::vector<spikeloop_spike_input> spike_input_data;
  std::vector<spikeloop_signal_output> signal_output_data;
  std::vector<spikeloop_spike_output> spike_output_data;

  std::vector<Counter> counters() const {
    if (source != nullptr) {
      return source->counters();
    }
    if (sink != nullptr) {
      return sink->counters();
    }
    return of_node(name, [&] { return node->counters(); });
  }
};

}  // namespace

struct Graph::Impl {
  TimeNs tick = 0;
  std::uint64_t tick_index = 0;
  std::vector<std::unique_ptr<Output>> outputs;
  std::vector<std::unique_ptr<Edge>> edges;
  std::vector<std::unique_ptr<Input>> inputs;
  std::vector<Element> elements;
  std::vector<std::size_t> order;
  SpikeSorter sorter;

  TimeNs time() const { return static_cast<TimeNs>(tick_index) * tick; }

  /// Calls use(node) for a node. False: there is no such node.
  template <typename Use>
  bool with(std::string_view name, Use&& use) {
    const auto found = std::ranges::find_if(
        elements, [&](const Element& each) { return each.node && each.name == name; });
    if (found != elements.end()) {
      of_node(found->name, [&] { use(*found->node); });
    }
    return found != elements.end();
  }

  void make_elements(const GraphDescription& description, const GraphPlan& plan);
  void wire(const GraphPlan& plan);
  spikeloop_step gather(Element& element, const Interval& interval);
  void collect(Element& element, const Interval& interval);
  void sort_and_check(const Element& element, Output& output, const Interval& interval);
};

void Graph::Impl::make_elements(const GraphDescription& description, const GraphPlan& plan) {
  elements.resize(plan.elements.size());
  std::size_t index = 0;
  for (const auto& entry : description.sources) {
    elements[index].name = entry.name;
    elements[index++].source = entry.source;
  }
  for (const auto& entry : description.nodes) {
    NodeSetup setup{entry.name, description.seed, entry.parameters, {}, entry.share};
    for (const PlannedPort& port : plan.elements[index].ports) {
      setup.widths.push_back(port.width);
    }
    elements[index].name = entry.name;
    try {
      elements[index++].node = entry.begins_anew
                                   ? make_renewable_node(*entry.node_class, setup, entry.threads)
                                   : make_node(*entry.node_class, setup, entry.threads);
    } catch (const ConfigurationError& error) {
      if (error.located()) {
        throw;  // a line is nearer than a name
      }
      throw ConfigurationError(entry.where, fmt::format("'{}': {}", entry.name, error.what()));
    }
  }
  for (const auto& entry : description.sinks) {
    elements[index].name = entry.name;
    elements[index++].sink = entry.sink;
  }
}

void Graph::Impl::wire(const GraphPlan& plan) {
  std::vector<std::vector<Output*>> output_of(elements.size());
  std::vector<std::vector<Input*>> input_of(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e) {
    output_of[e].resize(plan.elements[e].ports.size());
    input_of[e].resize(plan.elements[e].ports.size());
    for (std::size_t p = 0; p < plan.elements[e].ports.size(); ++p) {
      const PlannedPort& port = plan.elements[e].ports[p];
      if (port.direction == Direction::output) {
        auto output = std::make_unique<Output>();
        output->kind = port.kind;
        output->width = port.width;
        output->values.assign(port.kind == PortKind::signal ? port.width : 0, 0.0);
        output_of[e][p] = output.get();
        outputs.push_back(std::move(output));
      }
    }
  }
  for (const PlannedConnection& connection : plan.connections) {
    auto edge = std::make_unique<Edge>();
    edge->from = output_of[connection.from.element][connection.from.port];
    edge->shift = tick * connection.delay_ticks;
    edge->ring.resize(connection.delay_ticks);
    for (auto& slot : edge->ring) {
      slot.values = edge->from->values;
    }
    edge->report.from = plan.text(connection.from);
    edge->report.to = plan.text(connection.to);
    Input*& input = input_of[connection.to.element][connection.to.port];
    if (input == nullptr) {
      input = inputs.emplace_back(std::make_unique<Input>()).get();
    }
    input->add(*edge, connection.channels, connection.combination);
    edges.push_back(std::move(edge));
  }
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (std::size_t p = 0; p < plan.elements[e].ports.size(); ++p) {
      const bool spikes = plan.elements[e].ports[p].kind == PortKind::spikes;
      Element& element = elements[e];
      if (Input* input = input_of[e][p]) {
        (spikes ? element.spike_inputs : element.signal_inputs).push_back(input);
      } else {
        (spikes ? element.spike_outputs : element.signal_outputs).push_back(output_of[e][p]);
      }
    }
  }
}

// The step of an element; it refers to the element's data.
spikeloop_step Graph::Impl::gather(Element& element, const Interval& interval) {
  element.signal_input_data.clear();
  element.spike_input_data.clear();
  element.signal_output_data.clear();
  element.spike_output_data.clear();
  for (Input* input : element.signal_inputs) {
    element.signal_input_data.push_back(input->signal(tick_index));
  }
  for (Input* input : element.spike_inputs) {
    element.spike_input_data.push_back(input->spikes(tick_index, interval.begin, sorter));
  }
  for (Output* output : element.signal_outputs) {
    element.signal_output_data.push_back(
        {output->values.data(), output->revision, output->width, 0});
  }
  for (Output* output : element.spike_outputs) {
    output->spikes.clear();
    output->spikes.swap(output->held);
    element.spike_output_data.push_back({output, &Output::append, output->width, 0});
  }
  return {interval.begin,
          interval.end,
          element.signal_input_data.data(),
          element.spike_input_data.data(),
          element.signal_output_data.data(),
          element.spike_output_data.data(),
          static_cast<std::uint32_t>(element.signal_input_data.size()),
          static_cast<std::uint32_t>(element.spike_input_data.size()),
          static_cast<std::uint32_t>(element.signal_output_data.size()),
          static_cast<std::uint32_t>(element.spike_output_data.size())};
}

void Graph::Impl::sort_and_check(const Element& element, Output& output, const Interval& interval) {
  auto& spikes = output.spikes;
  sorter.sort(spikes);
  for (const Spike& spike : spikes) {
    if (spike.channel < 0 || static_cast<std::uint32_t>(spike.channel) >= output.width) {
      throw NodeError(element.name,
                      fmt::format("a spike on channel {}, but the port has channels 0 to {}",
                                  spike.channel, output.width - 1));
    }
    if (element.node && !interval.contains(spike.time_ns)) {
      throw NodeError(element.name,
                      fmt::format("a spike at {} ns lies outside the interval ({}, {}] ns",
                                  spike.time_ns, interval.begin, interval.end));
    }
  }
  if (element.node) {
    return;  // none is later than the interval
  }
  const auto after = std::find_if(spikes.begin(), spikes.end(),
                                  [&](const Spike& spike) { return spike.time_ns > interval.end; });
  output.held.assign(after, spikes.end());
  spikes.erase(after, spikes.end());
}

void Graph::Impl::collect(Element& element, const Interval& interval) {
  for (std::size_t i = 0; i < element.signal_outputs.size(); ++i) {
    element.signal_outputs[i]->revision = element.signal_output_data[i].revision;
  }
  for (Output* output : element.spike_outputs) {
    sort_and_check(element, *output, interval);
  }
}

Graph::Graph(const GraphDescription& description) : impl_(std::make_unique<Impl>()) {
  const GraphPlan checked = plan(description);
  impl_->tick = description.tick;
  impl_->order = checked.order;
  impl_->make_elements(description, checked);
  impl_->wire(checked);
}

Graph::~Graph() = default;
Graph::Graph(Graph&&) noexcept = default;
Graph& Graph::operator=(Graph&&) noexcept = default;

void Graph::step() {
  Impl& own = *impl_;
  const Interval interval{own.time(), own.time() + own.tick};
  for (const std::size_t index : own.order) {
    Element& element = own.elements[index];
    const spikeloop_step data = own.gather(element, interval);
    const Step step(data);
    if (element.source != nullptr) {
      element.source->receive(step);
    } else if (element.sink != nullptr) {
      element.sink->send(step);
    } else {
      of_node(element.name, [&] { element.node->step(step); });
    }
    own.collect(element, interval);
  }
  for (const auto& edge : own.edges) {
    edge->push(own.tick_index);
  }
  ++own.tick_index;
}

TimeNs Graph::time() const {
  return impl_->time();
}
TimeNs Graph::tick() const {
  return impl_->tick;
}

std::vector<ConnectionReport> Graph::connections() const {
  std::vector<ConnectionReport> reports;
  for (const auto& edge : impl_->edges) {
    reports.push_back(edge->report);
  }
  return reports;
}

bool Graph::change(std::string_view node, std::string_view parameter, double value) {
  return impl_->with(node, [&](Node& found) { found.change(parameter, value); });
}

void Graph::reset(std::string_view node) {
  const std::string ports = fmt::format("{}.", node);
  for (const auto& edge : impl_->edges) {
    if (edge->report.from.starts_with(ports) || edge->report.to.starts_with(ports)) {
      edge->clear();
    }
  }
  impl_->with(node, [&](Node& found) { found.reset(time()); });
}

std::vector<Counter> Graph::counters() const {
  std::vector<Counter> all;
  for (const Element& element : impl_->elements) {
    for (Counter& counter : element.counters()) {
      all.push_back({fmt::format("{}.{}", element.name, counter.name), counter.value});
    }
  }
  return all;
}

std::vector<LearningWeights> Graph::learning_weights() const {
  std::vector<LearningWeights> all;
  for (const Element& element : impl_->elements) {
    if (element.node) {
      for (const LearningWeights& each : element.node->learning_weights()) {
        all.push_back({fmt::format("{}/{}", element.name, each.name), each.weights});
      }
    }
  }
  return all;
}

std::vector<Result> Graph::results() {
  std::vector<Result> all;
  for (Element& element : impl_->elements) {
    if (element.node) {
      for (Result& result : element.node->results()) {
        all.push_back({fmt::format("{}.{}", element.name, result.file), std::move(result.table)});
      }
    }
  }
  return all;
}

}  // namespace spikeloop
