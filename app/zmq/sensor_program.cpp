// zmq_cont_adapter: the newest message of a ZeroMQ publisher as a continuous signal.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/number_or_word.hpp"
#include "spikeloop/zmq/address.hpp"
#include "spikeloop/zmq/subscriber.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> parameters_of_sensor() {
  return {
      {.name = "message_type",
       .type = ParameterType::text,
       .default_value = "",
       .text = "GymObservation or FloatArray; required"},
      {.name = "zmq_addr",
       .type = ParameterType::text,
       .default_value = "tcp://localhost:5555",
       .text = "Address of the publisher"},
      number_or_word_parameter("initial", "none",
                               "Value of every channel before the first message; none: no value")};
}

}  // namespace

const std::string& required_type(const music::Process& process, const Parameters& parameters,
                                 const std::vector<std::string>& choices) {
  const std::string& type = parameters.text("message_type");
  const std::string remedy = fmt::format("write message_type={}", fmt::join(choices, " or "));
  if (type.empty()) {
    throw ConfigurationError(parameters.where("message_type"),
                             with_code(Code::missing_key, "section '{}' has no message_type; {}",
                                       process.label(), remedy));
  }
  if (std::ranges::find(choices, type) == choices.end()) {
    throw ConfigurationError(
        parameters.where("message_type"),
        with_code(Code::unknown_message, "message_type '{}' is not known; {}", type, remedy));
  }
  return type;
}

music::ProgramText zmq_sensor_text() {
  music::ProgramText text;
  text.name = "zmq_cont_adapter";
  text.summary = "Converts the newest JSON message over ZeroMQ to a continuous signal";
  text.ports = "  out        output  continuous  Numbers of the message\n";
  text.parameters = parameters_of_sensor();
  text.example =
      "  [observation]\n  binary=zmq_cont_adapter\n  np=1\n  message_type=GymObservation\n"
      "  zmq_addr=tcp://localhost:5556\n  observation.out -> RECEIVER.in [4]\n";
  text.notes =
      "GymObservation: [{\"value\": v, \"min\": a, \"max\": b, \"ts\": s}, ...] becomes\n"
      "2 (v - a) / (b - a) - 1, limited to [-1, 1]. FloatArray: [x, ...], unchanged.\n";
  text.defaults.clock_master = true;
  return text;
}

int run_zmq_sensor(music::Process& process) {
  process.declare_ports({"out"});
  process.set_defaults({.clock_master = true, .accept_one_tick = false});
  const Parameters parameters = process.read(parameters_of_sensor());
  process.written({"zmq_topic"});  // the older programs never read it: so that it is known
  const std::string& address = parameters.text("zmq_addr");
  located_at(parameters.where("zmq_addr"), [&] { zmq::check_connect_address(address); });
  zmq::Subscriber subscriber(
      {.address = address,
       .message_type = required_type(process, parameters, {"GymObservation", "FloatArray"}),
       .width = process.width("out"),
       .strict = process.common().strict,
       .initial = number_or_word(parameters, "initial", "none", "write for example 0")});
  const auto out = process.signal_output("out");
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources = {{"socket", &subscriber}};
  description.sinks = {{"out", out.get()}};
  description.connections = {{"socket.out", "out.out", 0, 0, {}}};
  process.attach_recorders(description);
  Graph graph(description);
  music::Process::LoopHooks hooks;
  hooks.after_loop = [&] {
    if (subscriber.counters().front().value == 0) {
      log::warning("no message arrived from {}; see whether its publisher binds this address",
                   address);
    }
  };
  return process.run(graph, hooks);
}

}  // namespace spikeloop
