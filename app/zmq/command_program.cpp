// cont_zmq_adapter: a continuous signal as the messages of a ZeroMQ publisher.
#include <nlohmann/json.hpp>

#include "programs.hpp"
#include "spikeloop/zmq/address.hpp"
#include "spikeloop/zmq/publisher.hpp"

namespace spikeloop {
namespace {

std::vector<ParameterDescription> parameters_of_command() {
  return {{.name = "message_type",
           .type = ParameterType::text,
           .default_value = "",
           .text = "GymCommand or FloatArray; required"},
          {.name = "zmq_addr",
           .type = ParameterType::text,
           .default_value = "tcp://127.0.0.1:5556",
           .text = "Address to bind for publishing"},
          {.name = "min",
           .unit = "1",
           .default_value = "0",
           .text = "GymCommand: lower bound of the values, sent with them; required"},
          {.name = "max",
           .unit = "1",
           .default_value = "0",
           .text = "GymCommand: upper bound of the values, sent with them; required"}};
}

}  // namespace

music::ProgramText zmq_command_text() {
  music::ProgramText text;
  text.name = "cont_zmq_adapter";
  text.summary = "Publishes a continuous signal as JSON over ZeroMQ at every tick";
  text.ports = "  in         input   continuous  Numbers to send\n";
  text.parameters = parameters_of_command();
  text.example =
      "  [command]\n  binary=cont_zmq_adapter\n  np=1\n  message_type=GymCommand\n"
      "  zmq_addr=tcp://*:5555\n  min=-1\n  max=1\n  SENDER.out -> command.in [1]\n";
  text.notes =
      "GymCommand: [{\"value\": x, \"ts\": s, \"max\": b, \"min\": a}, ...]; FloatArray: [x, "
      "...].\n"
      "No message is sent before the first value, or if a value is NaN or infinite.\n";
  return text;
}

int run_zmq_command(music::Process& process) {
  process.declare_ports({"in"});
  const Parameters parameters = process.read(parameters_of_command());
  process.written({"zmq_topic"});  // the older programs never read it: so that it is known
  const std::string& address = parameters.text("zmq_addr");
  located_at(parameters.where("zmq_addr"), [&] { zmq::check_bind_address(address); });
  const zmq::PublisherSettings settings{
      .address = address,
      .message_type = required_type(process, parameters, {"GymCommand", "FloatArray"}),
      .minimum = parameters.number("min"),
      .maximum = parameters.number("max"),
      .width = process.width("in")};
  const auto in = process.signal_input("in");
  if (process.checking()) {
    located_at(parameters.where(parameters.given("max") ? "max" : "min"),
               [&] { zmq::Publisher::check(settings); });
    process.check();
    return 0;
  }
  zmq::Publisher publisher =
      located_at(parameters.where("zmq_addr"), [&] { return zmq::Publisher(settings); });
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources = {{"in", in.get()}};
  description.sinks = {{"socket", &publisher}};
  description.connections = {{"in.in", "socket.in", 0, 0, {}}};
  process.attach_recorders(description);
  Graph graph(description);
  return process.run(graph);
}

}  // namespace spikeloop
