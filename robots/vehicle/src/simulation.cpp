#include "spikeloop/vehicle/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "model.hpp"
#include "model_files.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::vehicle {
namespace {

TimeNs read_timestep(const mjModel& model, const std::string& path, double longest) {
  const double seconds = model.opt.timestep;
  const auto where = [&] {
    const Location place = find_attribute(read_model_files(path), "option", "timestep");
    return place.line > 0 ? place : Location{path};
  };
  if (!(seconds >= 1e-6 && seconds <= longest)) {
    throw ConfigurationError(
        where(), with_code(Code::world,
                           "has a timestep of {} s; write a timestep from 1e-6 to {} s, such as "
                           "<option timestep=\"0.002\"/>",
                           seconds, longest));
  }
  try {
    return tick_from_seconds(seconds);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(where(), error.what());
  }
}

std::string name_or(const mjModel& model, mjtObj type, int id, const std::string& otherwise) {
  const char* const name = mj_id2name(&model, type, id);
  return name != nullptr && *name != '\0' ? name : otherwise;
}

/// The model does not hold the element's tag. <position kp> has gain kp and bias -kp * length,
/// <velocity kv> has gain kv and bias -kv * velocity (MuJoCo, XML Reference, actuator).
Quantity quantity_of(const mjModel& model, int id) {
  const mjtNum* const gain = model.actuator_gainprm + mjNGAIN * id;
  const mjtNum* const bias = model.actuator_biasprm + mjNBIAS * id;
  if (model.actuator_biastype[id] != mjBIAS_AFFINE || gain[0] == 0 ||
      model.actuator_dyntype[id] != mjDYN_NONE) {
    return Quantity::effort;
  }
  if (bias[1] == -gain[0]) {
    return Quantity::position;
  }
  return bias[1] == 0 && bias[2] == -gain[0] ? Quantity::velocity : Quantity::effort;
}

/// Names of the file, and others for the elements without one: NAME_0, NAME_1, ... by their place.
std::vector<std::string> names_for_all(const mjModel& model, mjtObj type, int count,
                                       const char* name) {
  std::vector<std::string> names;
  for (int id = 0; id < count; ++id) {
    names.push_back(name_or(model, type, id, ""));
  }
  for (int id = 0; id < count; ++id) {
    std::string& own = names[static_cast<std::size_t>(id)];
    if (own.empty()) {
      std::string numbered = fmt::format("{}_{}", name, id);
      while (std::ranges::find(names, numbered) != names.end()) {
        numbered += '_';
      }
      own = std::move(numbered);
    }
  }
  return names;
}

/// An actuator without a name has that of its joint, unless another one of its kind has it.
std::vector<Actuator> find_actuators(const mjModel& model) {
  const auto names = names_for_all(model, mjOBJ_ACTUATOR, model.nu, "actuator");
  std::vector<Actuator> actuators;
  for (int id = 0; id < model.nu; ++id) {
    actuators.push_back({names[static_cast<std::size_t>(id)], quantity_of(model, id)});
  }
  for (int id = 0; id < model.nu; ++id) {
    Actuator& own = actuators[static_cast<std::size_t>(id)];
    const int type = model.actuator_trntype[id];
    if (name_or(model, mjOBJ_ACTUATOR, id, "").empty() &&
        (type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT)) {
      const std::string joint = name_or(model, mjOBJ_JOINT, model.actuator_trnid[2 * id], "");
      const bool is_taken = std::ranges::any_of(actuators, [&](const Actuator& other) {
        return other.name == joint && other.quantity == own.quantity;
      });
      if (!joint.empty() && !is_taken) {
        own.name = joint;
      }
    }
  }
  return actuators;
}

std::vector<ModelSensor> find_sensors(const mjModel& model) {
  const auto names = names_for_all(model, mjOBJ_SENSOR, model.nsensor, "sensor");
  std::vector<ModelSensor> sensors;
  for (std::size_t id = 0; id < names.size(); ++id) {
    sensors.push_back({names[id], static_cast<std::size_t>(model.sensor_dim[id])});
  }
  return sensors;
}

std::vector<std::string> all_names(const mjModel& model, mjtObj type, int count) {
  std::vector<std::string> names;
  for (int id = 0; id < count; ++id) {
    if (std::string name = name_or(model, type, id, ""); !name.empty()) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

bool has_one_position(int joint_type) {
  return joint_type == mjJNT_HINGE || joint_type == mjJNT_SLIDE;
}

std::vector<InertialUnit> find_inertial_units(const mjModel& model) {
  std::vector<InertialUnit> units;
  for (int gyro = 0; gyro < model.nsensor; ++gyro) {
    for (int other = 0; other < model.nsensor; ++other) {
      if (model.sensor_type[gyro] == mjSENS_GYRO &&
          model.sensor_type[other] == mjSENS_ACCELEROMETER &&
          model.sensor_objid[gyro] == model.sensor_objid[other]) {
        const int site = model.sensor_objid[gyro];
        units.push_back({name_or(model, mjOBJ_SITE, site, fmt::format("site_{}", site)),
                         static_cast<std::size_t>(other), static_cast<std::size_t>(gyro)});
      }
    }
  }
  return units;
}

void start_from(const std::string& keyframe, const mjModel& model, const std::string& path,
                mjData& data) {
  if (keyframe.empty()) {
    return;
  }
  const int id = mj_name2id(&model, mjOBJ_KEY, keyframe.c_str());
  if (id < 0) {
    throw ConfigurationError(
        Location{path}, with_code(Code::world, "has no keyframe '{}'{}", keyframe,
                                  did_you_mean(keyframe, all_names(model, mjOBJ_KEY, model.nkey))));
  }
  mj_resetDataKeyframe(&model, &data, id);
}

}  // namespace

class Simulation::Impl {
 public:
  Impl(const ModelOptions& options, double longest_timestep)
      : path_(find_world(options.file)),
        keyframe_(options.keyframe),
        model_(load_model(path_)),
        timestep_(read_timestep(*model_, path_, longest_timestep)),
        data_(mj_makeData(model_.get())),
        now_(mj_makeData(model_.get())),
        actuators_(find_actuators(*model_)),
        sensors_(find_sensors(*model_)),
        units_(find_inertial_units(*model_)),
        joints_(names_for_all(*model_, mjOBJ_JOINT, model_->njnt, "joint")) {
    start_from(keyframe_, *model_, path_, *data_);
  }

  void reset() {
    mj_resetData(model_.get(), data_.get());
    start_from(keyframe_, *model_, path_, *data_);
    waiting_.clear();
    measured_ = -1;
    physics_time_ = time_;
  }

  void require_stable() const {
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC}) {
      if (data_->warning[warning].number > 0) {
        throw NodeError("robot",
                        fmt::format("the physics of {} became unstable at {}; write a smaller "
                                    "<option timestep=\"...\"/> (now {}) or weaker actuators",
                                    path_, format_time(physics_time_), format_time(timestep_)));
      }
    }
  }

  JointStates joint_states() {
    measure();
    JointStates states;
    states.stamp = time_;
    for (int joint = 0; joint < model_->njnt; ++joint) {
      if (!has_one_position(model_->jnt_type[joint])) continue;
      const int dof = model_->jnt_dofadr[joint];
      states.names.push_back(joints_[static_cast<std::size_t>(joint)]);
      states.positions.push_back(data_->qpos[model_->jnt_qposadr[joint]]);
      states.velocities.push_back(data_->qvel[dof]);
      states.efforts.push_back(now_->qfrc_actuator[dof]);
    }
    return states;
  }

  /// MuJoCo measures at the beginning of a physics step. A copy measures now, and what follows
  /// does not depend on who reads.
  std::vector<double> read_sensor(std::size_t index) {
    measure();
    const mjtNum* const values = now_->sensordata + model_->sensor_adr[index];
    return {values, values + sensors_[index].width};
  }

  Imu read_inertial_unit(std::size_t index) {
    const InertialUnit& unit = units_[index];
    Imu imu;
    imu.stamp = time_;
    std::ranges::copy(read_sensor(unit.accelerometer), imu.linear_acceleration_m_s2.begin());
    std::ranges::copy(read_sensor(unit.gyro), imu.angular_velocity_rad_s.begin());
    const int site = model_->sensor_objid[unit.gyro];
    mju_mat2Quat(imu.orientation.data(), now_->site_xmat + 9 * site);
    return imu;
  }

  void measure() {
    if (measured_ != physics_time_) {
      mj_copyData(now_.get(), model_.get(), data_.get());
      mj_forward(model_.get(), now_.get());
      measured_ = physics_time_;
    }
  }

  /// In the middle of a physics step, which is taken when it ends, a command waits for that end.
  void command(std::span<const double> numbers) {
    waiting_.resize(numbers.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (std::abs(numbers[i]) <= mjMAXVAL) waiting_[i] = numbers[i];
    }
    if (physics_time_ == time_) {
      act();
    }
  }

  /// MuJoCo sets all controls to 0 when one of them is larger than mjMAXVAL.
  void act() {
    for (std::size_t i = 0; i < waiting_.size() && i < actuators_.size(); ++i) {
      if (std::abs(waiting_[i]) <= mjMAXVAL) data_->ctrl[i] = waiting_[i];
    }
    waiting_.clear();
    measured_ = -1;
  }

  std::string path_;
  std::string keyframe_;
  ModelPointer model_;
  TimeNs timestep_;
  DataPointer data_;
  DataPointer now_;
  TimeNs measured_ = -1;
  std::vector<Actuator> actuators_;
  std::vector<ModelSensor> sensors_;
  std::vector<InertialUnit> units_;
  std::vector<std::string> joints_;
  std::vector<double> waiting_;  // a command
  TimeNs time_ = 0;
  TimeNs physics_time_ = 0;
};

Simulation::Simulation(const ModelOptions& options, double longest_timestep_s)
    : impl_(std::make_unique<Impl>(options, longest_timestep_s)) {}
Simulation::~Simulation() = default;

void Simulation::step(TimeNs dt) {
  if (dt <= 0) {
    throw ConfigurationError(with_code(
        Code::world, "cannot advance the robot by {}; write a time above 0", format_time(dt)));
  }
  impl_->time_ += dt;
  while (impl_->physics_time_ + impl_->timestep_ <= impl_->time_) {
    before_physics();
    mj_step(impl_->model_.get(), impl_->data_.get());
    impl_->physics_time_ += impl_->timestep_;
    impl_->act();
    impl_->require_stable();
    after_physics(impl_->physics_time_);
  }
}

void Simulation::reset() {
  impl_->reset();
}

TimeNs Simulation::time() const {
  return impl_->time_;
}
const std::string& Simulation::world() const {
  return impl_->path_;
}
JointStates Simulation::joint_states() const {
  return impl_->joint_states();
}
const std::vector<ModelSensor>& Simulation::sensors() const {
  return impl_->sensors_;
}
std::vector<double> Simulation::read_sensor(std::size_t index) const {
  return impl_->read_sensor(index);
}
const std::vector<InertialUnit>& Simulation::inertial_units() const {
  return impl_->units_;
}
Imu Simulation::read_inertial_unit(std::size_t index) const {
  return impl_->read_inertial_unit(index);
}
const std::vector<Actuator>& Simulation::actuators() const {
  return impl_->actuators_;
}
std::vector<std::string> Simulation::names_of(Named kind) const {
  const mjModel& model = *impl_->model_;
  return kind == Named::camera ? all_names(model, mjOBJ_CAMERA, model.ncam)
                               : all_names(model, mjOBJ_KEY, model.nkey);
}
void Simulation::command(std::span<const double> numbers) {
  impl_->command(numbers);
}
const mjModel_& Simulation::model() const {
  return *impl_->model_;
}
const mjData_& Simulation::data() const {
  return *impl_->data_;
}
mjModel_& Simulation::own_model() {
  return *impl_->model_;
}
mjData_& Simulation::own_data() {
  return *impl_->data_;
}
TimeNs Simulation::timestep() const {
  return impl_->timestep_;
}

}  // namespace spikeloop::vehicle
