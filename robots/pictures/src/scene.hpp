// What MuJoCo draws: a world with everything at its place, and the path of the vehicle.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/pictures/camera.hpp"
#include "spikeloop/pictures/film.hpp"
#include "spikeloop/vehicle/vehicle.hpp"

namespace spikeloop::pictures {

/// What is needed of a robot to draw it; copied, so that drawing changes nothing.
struct State {
  explicit State(const vehicle::Simulation& robot) { take(robot); }
  void take(const vehicle::Simulation& robot);

  TimeNs time = 0;
  std::optional<vehicle::Pose> pose;  ///< of the vehicle
  std::vector<mjtNum> qpos;
  std::vector<mjtNum> mocap_pos;
  std::vector<mjtNum> mocap_quat;
};

/// Points of the path, a few centimetres apart.
class Trail {
 public:
  void go_on(const std::optional<vehicle::Pose>& pose);
  const std::vector<std::array<double, 2>>& points() const { return points_; }

 private:
  std::vector<std::array<double, 2>> points_;
};

struct SceneOptions {
  Size buffer;      ///< the largest picture
  int samples = 4;  ///< a pixel, against jagged edges
  bool shadows = true;
};

/// Made, used and destroyed while an OpenGL context is current in the thread.
class Scene {
 public:
  Scene(const vehicle::Simulation& robot, const SceneOptions& options);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// Where things are from now on.
  void set(const State& state);
  /// A camera for a view, of a picture that is `aspect` times as wide as high.
  mjvCamera camera(View view, double aspect) const;
  /// Follows the vehicle where the view does.
  void follow(View view, mjvCamera& camera) const;
  void draw(mjrRect where, mjvCamera& camera, const Trail* trail);
  /// The same through a camera of the model, `tangent` half its width at distance 1.
  /// @param id as camera_id() has it
  void draw_camera(mjrRect where, int id, double tangent);
  void write(mjrRect where, const std::string& text);
  /// Of the buffer's lower left part.
  void read(Image& image);

  const mjModel& model() const { return *model_; }
  mjvScene& abstract() { return scene_; }
  const mjrContext& context() const { return context_; }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };

  void add(const Trail& trail);

  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::optional<vehicle::Arena> arena_;  // of the vehicle
  std::optional<vehicle::Pose> pose_;
  mjvOption option_;
  mjvScene scene_;
  mjrContext context_;
};

}  // namespace spikeloop::pictures
