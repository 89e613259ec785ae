// spikeloop-node: one node as a MUSIC program, under its own name or an adapter's.
#include "programs.hpp"
#include "spikeloop/process/node_program.hpp"

int main(int argc, char** argv) {
  using namespace spikeloop;
  const auto text = node_program_text(music::called_as(argc, argv));
  return music::music_main(argc, argv, text, [](music::Process& process) {
    if (const NodeProgram* program = find_node_program(process.program())) {
      process.set_defaults({.clock_master = false,
                            .accept_one_tick = program->accept_one_tick,
                            .many_processes = true});
    }
    Registry registry;
    const NodeClass& node_class = node_class_of(process, registry);
    return music::run_node(process, node_class, node_parameters(process, node_class));
  });
}
