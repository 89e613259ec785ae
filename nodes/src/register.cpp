#include "spikeloop/nodes/register.hpp"

#include <utility>

namespace spikeloop {

// Each in the file of its name; those of elementwise.cpp share one.
NodeClass connect_class();
NodeClass threshold_class();
NodeClass sigmoid_class();
NodeClass argmax_class();
NodeClass discretize_class();
NodeClass rate_encoder_class();
NodeClass poisson_encoder_class();
NodeClass nef_encoder_class();
NodeClass linear_readout_class();
NodeClass clip_class();
NodeClass normalise_class();
NodeClass low_pass_class();
NodeClass delay_class();
NodeClass function_class();
NodeClass population_encoder_class();
NodeClass step_forward_encoder_class();
NodeClass temporal_contrast_encoder_class();
NodeClass time_to_first_spike_encoder_class();
NodeClass population_vector_class();
NodeClass winner_take_all_class();
NodeClass rate_window_class();
NodeClass disturb_signal_class();
NodeClass disturb_spikes_class();

void register_nodes(Registry& registry) {
  for (NodeClass (*make)() : {connect_class,
                              threshold_class,
                              sigmoid_class,
                              argmax_class,
                              discretize_class,
                              rate_encoder_class,
                              poisson_encoder_class,
                              nef_encoder_class,
                              linear_readout_class,
                              clip_class,
                              normalise_class,
                              low_pass_class,
                              delay_class,
                              function_class,
                              population_encoder_class,
                              step_forward_encoder_class,
                              temporal_contrast_encoder_class,
                              time_to_first_spike_encoder_class,
                              population_vector_class,
                              winner_take_all_class,
                              rate_window_class,
                              disturb_signal_class,
                              disturb_spikes_class}) {
    NodeClass made = make();
    made.description.reset = Reset::made_again;
    registry.add(std::move(made));
  }
}

}  // namespace spikeloop
