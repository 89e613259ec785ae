// The example's encoder passes the tests of the built-in one that it re-implements.
#include "python_file.hpp"
#include "regular_encoder_tests.hpp"

namespace spikeloop::testing {
namespace {

INSTANTIATE_TEST_SUITE_P(Python, RegularEncoder,
                         ::testing::Values(EncoderClass{"my_rate_encoder", [] {
                                                          return class_in(ENCODER_FILE,
                                                                          "my_rate_encoder");
                                                        }}));

}  // namespace
}  // namespace spikeloop::testing
