#include "spikeloop/nodes/register.hpp"

#include "argmax.hpp"
#include "connect.hpp"
#include "discretize.hpp"
#include "elementwise.hpp"
#include "linear_readout.hpp"
#include "nef_encoder.hpp"
#include "poisson_encoder.hpp"
#include "rate_encoder.hpp"

namespace spikeloop {

void register_nodes(Registry& registry) {
  registry.add(connect_class());
  registry.add(threshold_class());
  registry.add(sigmoid_class());
  registry.add(argmax_class());
  registry.add(discretize_class());
  registry.add(rate_encoder_class());
  registry.add(poisson_encoder_class());
  registry.add(nef_encoder_class());
  registry.add(linear_readout_class());
}

}  // namespace spikeloop
