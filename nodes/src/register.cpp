#include "spikeloop/nodes/register.hpp"

#include "argmax.hpp"
#include "connect.hpp"
#include "delay.hpp"
#include "discretize.hpp"
#include "elementwise.hpp"
#include "function.hpp"
#include "linear_readout.hpp"
#include "low_pass.hpp"
#include "nef_encoder.hpp"
#include "poisson_encoder.hpp"
#include "population_encoder.hpp"
#include "population_vector.hpp"
#include "rate_encoder.hpp"
#include "rate_window.hpp"
#include "step_forward_encoder.hpp"
#include "temporal_contrast_encoder.hpp"
#include "time_to_first_spike_encoder.hpp"
#include "winner_take_all.hpp"

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
  registry.add(clip_class());
  registry.add(normalise_class());
  registry.add(low_pass_class());
  registry.add(delay_class());
  registry.add(function_class());
  registry.add(population_encoder_class());
  registry.add(step_forward_encoder_class());
  registry.add(temporal_contrast_encoder_class());
  registry.add(time_to_first_spike_encoder_class());
  registry.add(population_vector_class());
  registry.add(winner_take_all_class());
  registry.add(rate_window_class());
}

}  // namespace spikeloop
