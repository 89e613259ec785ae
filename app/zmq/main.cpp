// spikeloop-zmq: JSON over ZeroMQ as a MUSIC program, under the name of one of its two adapters.
#include <fmt/format.h>

#include "programs.hpp"
#include "spikeloop/core/code.hpp"

namespace {

using namespace spikeloop;

music::ProgramText general_text() {
  music::ProgramText text;
  text.name = "spikeloop-zmq";
  text.summary = "Connects ZeroMQ sockets with MUSIC; run by one of two names";
  text.notes =
      "Write binary=zmq_cont_adapter (messages to channels) or binary=cont_zmq_adapter (channels\n"
      "to messages); each has --help.\n";
  return text;
}

int run(music::Process& process) {
  if (process.program() == "zmq_cont_adapter") {
    return run_zmq_sensor(process);
  }
  if (process.program() == "cont_zmq_adapter") {
    return run_zmq_command(process);
  }
  throw ConfigurationError(
      with_code(Code::music_job,
                "binary={} does not say which way messages go; write binary=zmq_cont_adapter or "
                "binary=cont_zmq_adapter",
                process.program()));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = music::called_as(argc, argv);
  const music::ProgramText text = name == "zmq_cont_adapter"   ? zmq_sensor_text()
                                  : name == "cont_zmq_adapter" ? zmq_command_text()
                                                               : general_text();
  return music::music_main(argc, argv, text, run);
}
