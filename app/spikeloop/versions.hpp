// What takes part in a run, and on which machine: so that it can be repeated.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "doctor/probe.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::app {

struct Partners {
  bool music = false;  ///< MUSIC and MPI
  bool ros1 = false;   ///< roscpp
  bool ros2 = false;   ///< Cyclone DDS
  bool mujoco = false;
  bool python = false;  ///< for nodes
};

Partners partners_of(const experiment::Experiment& experiment);
Partners partners_of(const MusicFile& file, bool robot);

/// Of every program, library and Python package that Spikeloop uses and that has a version.
std::vector<doctor::Probe> versions();

/// {"versions": {"spikeloop": "0.1.0", "compiler": ..., "hdf5": ..., ...}, "machine": {"cpu": ...,
/// "cores": ..., "kernel": ...}}; null for what is missing.
nlohmann::json about_run(const Partners& partners);

}  // namespace spikeloop::app
