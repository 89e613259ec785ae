// An emergency button on Fast DDS, configured as rmw_fastrtps does.
//
//     fastdds_button DOMAIN once|once2|stay
#include "tests/ros2/button.hpp"
#include "tests/ros2/fastdds_node.hpp"

namespace fastdds_peer {
namespace {

int run(int argc, char** argv) {
  if (argc != 3) {
    throw std::runtime_error("write fastdds_button DOMAIN once|once2|stay");
  }
  const sigset_t signals = spikeloop::test::block_button_signals();
  Peer peer(static_cast<std::uint32_t>(std::atoi(argv[1])), "udp");
  DataWriter* const writer = peer.publisher()->create_datawriter(
      peer.topic<Bool>("rt/emergency_stop"), endpoint_qos(DATAWRITER_QOS_DEFAULT));
  spikeloop::test::run_button(
      argv[2], signals,
      [&] {
        PublicationMatchedStatus status;
        writer->get_publication_matched_status(status);
        return status.current_count;
      },
      [&] {
        Bool pressed{1};
        writer->write(&pressed);
      });
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  return fastdds_peer::run_program("fastdds_button", fastdds_peer::run, argc, argv);
}
